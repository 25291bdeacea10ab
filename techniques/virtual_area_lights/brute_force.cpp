// Every virtual area light at every pixel: the oracle of the sparse points, and what they are faster than
// (Lensing and Broll 2013, Sec. 6).
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/loop_limit.h"
#include "passes.h"
#include "virtual_area_lights_shaders.h"

namespace lumivox::virtual_area_lights {
namespace {

using namespace shaders::virtual_area_lights;

class BruteForcePass : public Pass {
  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<SurfaceLights> lights{this, "lights", Presence::optional, "virtual area lights", Needs::anyLight};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::anyLight,
                     "indirect light reflected by the diffuse lobe, without occlusion, W/(sr m^2)"};
  Out<Image> glossy{this, "glossy", Contributes::indirectGlossy, Needs::anyLight | Needs::glossyMaterial,
                    "the same by the Phong lobe, W/(sr m^2)"};

  Reads readsFrom() const override { return Reads::camera; }

  void run(PassContext& frame) override {
    if (diffuse.wanted()) diffuse = sum(frame, brute_force::Variant::lobeDiffuse, true);
    if (glossy.wanted()) glossy = sum(frame, brute_force::Variant::lobeGlossy, gbuffer->specular != nullptr);
  }

  Image sum(PassContext& frame, int lobe, bool reflects) const {
    Image result{frame.image("light of all lights")};
    if (!reflects || !lights || lights->count == 0) {
      result.texture->clear(glm::vec4(0, 0, 0, 1));
      return result;
    }
    const shader::BoundProgram& program = frame.program(brute_force::Variant{lobe});
    forEachPortion(lights->count, 1, [&](int first, int count) {
      frame.dispatch(program,
                     {brute_force::parameters({frame.snapshot().camera.eye, first, count, first == 0}),
                      GBufferBinding(*gbuffer), brute_force::surfaceLights(lights->lights),
                      brute_force::reflectedImage(result.texture)},
                     pixels(frame));
    });
    return result;
  }
};

}  // namespace

void addBruteForce(TechniqueRegistry& registry) {
  registry.add<BruteForcePass>(
      "brute_force", "Every virtual area light at every pixel, unoccluded (Lensing & Broll 2013, Sec. 6)");
}

}  // namespace lumivox::virtual_area_lights
