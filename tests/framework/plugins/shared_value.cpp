// A technique whose default comes from an inline variable that is seen from outside. Without -fno-gnu-unique
// glibc has the whole process share the one of the library that was opened first.
#include "lumivox/plugin/technique.h"

namespace shared_value {

inline constexpr float kValue = LUMIVOX_TEST_VALUE;
/// By address, so that the compiler cannot put the number here.
__attribute__((noinline)) float read() {
  const float* volatile place = &kValue;
  return *place;
}

}  // namespace shared_value

namespace {

using namespace lumivox;

class Paint : public Pass {
 public:
  Param<float> value{this, "value", shared_value::read(), {0.0f, 100.0f}, "", "radiance"};
  Out<Image> radiance{this, "radiance", Contributes::direct};
  void run(PassContext& frame) override {
    Image image{frame.image("image")};
    image.texture->clear(glm::vec4(value));
    radiance = image;
  }
};

}  // namespace

LUMIVOX_TECHNIQUE(registry) {
  registry.describe("paints one value", "no paper");
  registry.add<Paint>("paint", "paints one value everywhere");
}
