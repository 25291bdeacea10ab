// Evaluates every virtual area light at every pixel: the truth for sparse points, and the baseline of their
// speed (Lensing and Broll 2013, Sec. 6).
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
  In<SurfaceLights> moreLights{this, "more_lights", Presence::optional,
                               "more virtual area lights, from another pass"};
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
    const shader::BoundProgram& program = frame.program(brute_force::Variant{lobe, frame.traits().glossy});
    bool begins = true;
    for (const In<SurfaceLights>* some : {&lights, &moreLights}) {
      if (!reflects || !*some) continue;
      forEachPortion((*some)->count, 1, [&](int first, int count) {
        frame.dispatch(program,
                       {brute_force::parameters({frame.snapshot().camera.eye, first, count, begins}),
                        GBufferBinding(*gbuffer), brute_force::surfaceLights((*some)->lights),
                        brute_force::reflectedImage(result.texture)},
                       pixels(frame));
        begins = false;
      });
    }
    if (begins) result.texture->clear(glm::vec4(0, 0, 0, 1));
    return result;
  }
};

}  // namespace

void addBruteForce(TechniqueRegistry& registry) {
  registry.add<BruteForcePass>(
      "brute_force", "Every virtual area light at every pixel, unoccluded (Lensing & Broll 2013, Sec. 6)");
}

}  // namespace lumivox::virtual_area_lights
