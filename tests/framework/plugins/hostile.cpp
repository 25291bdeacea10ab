// A technique whose passes do what no pass may do, for the tests of the stress battery.
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <thread>

#include "lumivox/base/error.h"
#include "lumivox/plugin/technique.h"

namespace {

using namespace lumivox;

enum class Deed { paint, abort, fault, spin, nan, refuse, exhaust, tire, rest };

/// A white image, unless the deed is something else.
class Paint : public Pass {
 public:
  Param<Deed> deed{this, "deed", Deed::paint, "what it does in place of painting"};
  Param<float> value{this, "value", 1.0f, {0.0f, 10.0f}, "", "radiance"};
  Out<Image> radiance{this, "radiance", Contributes::direct};
  Reads readsFrom() const override { return Reads::camera; }
  void run(PassContext& frame) override {
    if (deed == Deed::abort) std::abort();
    if (deed == Deed::fault) *std::atomic<volatile int*>{nullptr}.load() = 1;
    static std::atomic<bool> spinning;
    if (deed == Deed::spin)
      for (spinning = true; spinning;) {
      }
    if (deed == Deed::refuse) throw Error("the pass refuses; expected a scene of another kind");
    if (deed == Deed::exhaust) throw std::bad_alloc();
    if (deed == Deed::rest) rest();
    // Images and the frame to warm up are no trouble, timed frames are.
    static int painted = 0;
    if (deed == Deed::tire && ++painted > 4) throw Error("the pass is tired; expected fewer frames");
    Image image{frame.image("image")};
    image.texture->clear(glm::vec4(value));
    if (deed == Deed::nan) {
      std::vector<float> values = image.texture->downloadFloats();
      const auto width = static_cast<std::size_t>(image.texture->description().width);
      constexpr std::size_t kX = 3, kY = 2;
      values[4 * (kY * width + kX)] = std::numeric_limits<float>::quiet_NaN();
      image.texture->uploadFloats(0, values);
    }
    radiance = image;
  }

 private:
  /// Without end at the value that a test wants to interrupt, whatever the machine does in the meantime.
  void rest() const {
    const char* held = std::getenv("LUMIVOX_TEST_HOLD_AT");
    do {
      std::this_thread::sleep_for(std::chrono::milliseconds(30));
    } while (held != nullptr && std::strtof(held, nullptr) == value);
  }
};

/// The mean over frames of a value that the camera's place tells; with a trail what earlier views left is not
/// forgotten.
class Mean : public Pass {
 public:
  Param<bool> trail{this, "trail", false, "whether frames go on when the camera has jumped"};
  Out<Image> radiance{this, "radiance", Contributes::direct};
  Reads readsFrom() const override { return Reads::camera | Reads::history; }
  void run(PassContext& frame) override {
    const int before = frame.accumulated();
    const History<gpu::TextureRef> sums =
        frame.history({.format = gpu::Format::rgba32f, .width = 1, .height = 1}, "sum");
    float sum = 1.0f + std::abs(frame.snapshot().camera.eye.x) + static_cast<float>(before);
    if (sums.previous && (before > 0 || trail)) sum += sums.previous->downloadFloats().front();
    sums.current->clear(glm::vec4(sum));
    Image image{frame.image("image")};
    image.texture->clear(glm::vec4(sum / static_cast<float>(before + 1)));
    radiance = image;
  }
};

}  // namespace

LUMIVOX_TECHNIQUE(registry) {
  registry.describe("does what no pass may do", "no paper");
  registry.add<Paint>("paint", "paints one value everywhere, or worse");
  registry.add<Mean>("mean", "goes on from frame to frame, as it should or not");
}
