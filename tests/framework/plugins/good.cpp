// A technique library as it should be.
#include "lumivox/plugin/technique.h"

namespace {

using namespace lumivox;

class Paint : public Pass {
 public:
  Param<float> value{this, "value", 1.0f, {0.0f, 10.0f}, "", "radiance"};
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
