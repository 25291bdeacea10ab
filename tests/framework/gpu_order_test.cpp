// Where no driver is needed: the order of fences and commands, and what becomes of a driver's messages.
#include <fmt/format.h>
#include <lumivox/base/log.h>

#include <map>
#include <set>

#include "gpu/driver_messages.h"
#include "gpu/uniform_ring.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::gpu;

namespace {

/// A device that has done nothing yet: it keeps the order of the commands and fences that it was given.
class RecordedDevice : public UniformRing::Fences {
 public:
  void insert(std::size_t segment) override { fences_[segment] = commands_; }
  void wait(std::size_t segment) override {
    // Before the segment is written again, its fence has to stand behind every command that reads it.
    const auto last = lastReader_.find(segment);
    if (last == lastReader_.end()) return;
    REQUIRE(fences_.count(segment) == 1);
    CHECK(fences_[segment] > last->second);
    ++reused;
    lastReader_.erase(segment);
  }
  /// A command that reads blocks in these segments.
  void command(const std::set<std::size_t>& segments) {
    for (const std::size_t segment : segments) lastReader_[segment] = commands_;
    ++commands_;
  }
  int reused = 0;

 private:
  int commands_ = 0;
  std::map<std::size_t, int> lastReader_, fences_;
};

}  // namespace

TEST_CASE("a segment of uniform blocks is fenced behind the last command that reads it") {
  constexpr std::size_t kAlignment = 16, kSegment = 64;
  RecordedDevice device;
  UniformRing ring(device, kSegment, kAlignment);
  // Commands of 1, 2 and 3 blocks of 16 bytes: they end at every place of a segment of four, so that some do
  // not fit in what is left of one.
  for (int i = 0; i < 200; ++i) {
    const int blocks = 1 + i % 3;
    ring.reserve(static_cast<std::size_t>(blocks) * ring.roomFor(10));
    std::set<std::size_t> segments;
    for (int block = 0; block < blocks; ++block) {
      const std::size_t offset = ring.place(10);
      CHECK(offset % kAlignment == 0);
      segments.insert(offset / kSegment);
    }
    CHECK(segments.size() == 1);
    device.command(segments);
  }
  CHECK(device.reused > 50);
}

TEST_CASE("blocks of one command do not overlap, and their segment is known") {
  RecordedDevice device;
  UniformRing ring(device, 256, 64);
  ring.reserve(ring.roomFor(1) + ring.roomFor(65));
  const std::uint64_t serial = ring.segmentSerial();
  CHECK(ring.place(1) == 0);
  CHECK(ring.place(65) == 64);
  ring.reserve(ring.roomFor(64));
  CHECK(ring.place(64) == 192);
  CHECK(ring.segmentSerial() == serial);
  ring.reserve(ring.roomFor(1));  // the segment is full
  CHECK(ring.segmentSerial() == serial + 1);
  CHECK(ring.place(1) == 256);
}

TEST_CASE("only what the driver calls an error fails, and advice is told once") {
  using Kind = DriverMessages::Kind;
  using Severity = DriverMessages::Severity;
  DriverMessages messages;
  const std::uint64_t before = warningCount();
  for (int i = 0; i < 5; ++i) {
    messages.hear(Kind::advice, Severity::high, 1, 42, fmt::format("buffer {} is in video memory\n", i),
                  "gather");
    messages.hear(Kind::undefinedBehaviour, Severity::low, 1, 43, "the texture has no base level", "gather");
    messages.hear(Kind::advice, Severity::notification, 1, 44, "a note", "");
  }
  CHECK_FALSE(messages.hasErrors());
  CHECK(warningCount() == before + 2);
  // The same number from another source is another piece of advice.
  messages.hear(Kind::advice, Severity::high, 2, 42, "the shader is compiled anew", "gather");
  CHECK(warningCount() == before + 3);

  messages.hear(Kind::error, Severity::high, 1, 7, "GL_INVALID_VALUE in glDispatchCompute\n", "gather");
  messages.hear(Kind::error, Severity::high, 1, 7, "GL_INVALID_VALUE in glDispatchCompute\n", "gather");
  CHECK(messages.takeErrors("running") ==
        "running: the OpenGL driver reports:\n  GL_INVALID_VALUE in glDispatchCompute\n  GL_INVALID_VALUE in "
        "glDispatchCompute");
  CHECK_FALSE(messages.hasErrors());
}
