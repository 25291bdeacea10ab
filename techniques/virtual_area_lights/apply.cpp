// The averaged lights of sparse points where the camera sees surfaces (Lensing and Broll 2013, Sec. 3.2 steps
// 3 and 4).
#include "lumivox/toolkit/bindings.h"
#include "passes.h"
#include "virtual_area_lights_shaders.h"

namespace lumivox::virtual_area_lights {
namespace {

using namespace shaders::virtual_area_lights;

class ApplyPass : public Pass {
  enum class Interpolate { averaged, plain };

  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<SurfacePoints> points{this, "points", "where light was gathered"};
  In<SparseLight> light{this, "light", Presence::optional, "averaged light of the points", Needs::anyLight};
  Param<Interpolate> interpolate{
      this, "interpolate", Interpolate::averaged,
      "of the diffuse lobe; averaged: the points' lights, which the pixel's normal then meets; plain: what the "
      "points reflect"};
  Param<bool> asPublished{
      this, "as_published", false,
      "of the glossy lobe too the mean of the lights' places, in place of their offsets from the points"};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::anyLight,
                     "indirect light reflected by the diffuse lobe, W/(sr m^2)"};
  Out<Image> glossy{this, "glossy", Contributes::indirectGlossy, Needs::anyLight | Needs::glossyMaterial,
                    "indirect light reflected by the Phong lobe, W/(sr m^2)"};

  Reads readsFrom() const override { return Reads::camera; }
  bool uses(const InBase& input) const override {
    return &input == &gbuffer || diffuse.wanted() || glossy.wanted();
  }

  void run(PassContext& frame) override {
    const bool isGlossy =
        glossy.wanted() && light && light->glossy != nullptr && gbuffer->specular != nullptr;
    const bool isDiffuse = diffuse.wanted() && light;
    if (diffuse.wanted()) diffuse = Image{frame.image("diffuse light of points")};
    if (glossy.wanted()) glossy = Image{frame.image("glossy light of points")};
    if (diffuse.wanted() && !isDiffuse) diffuse->texture->clear(glm::vec4(0, 0, 0, 1));
    if (glossy.wanted() && !isGlossy) glossy->texture->clear(glm::vec4(0, 0, 0, 1));
    if (!isDiffuse && !isGlossy) return;
    using gpu::Sampling;
    shader::BindingSet bound{
        apply::parameters({frame.snapshot().camera.eye, points->neighbours, asPublished}),
        GBufferBinding(*gbuffer), SurfacePointsBinding(*points)};
    if (isDiffuse) {
      bound.add(apply::diffuseLight(light->diffuse, Sampling::nearest));
      bound.add(apply::diffusePlace(light->diffusePosition, Sampling::nearest));
      bound.add(apply::diffuseImage(diffuse->texture));
    }
    if (isGlossy) {
      bound.add(apply::glossyLight(light->glossy, Sampling::nearest));
      bound.add(apply::glossyPlace(light->glossyPosition, Sampling::nearest));
      bound.add(apply::glossyImage(glossy->texture));
    }
    frame.dispatch(
        frame.program(apply::Variant{
            .diffuse = isDiffuse, .glossy = isGlossy, .interpolate = interpolate == Interpolate::plain}),
        bound, pixels(frame));
  }
};

}  // namespace

void addApply(TechniqueRegistry& registry) {
  registry.add<ApplyPass>(
      "apply",
      "Averaged lights of sparse points at the visible surfaces (Lensing & Broll 2013, Eq. 10, 12, 13)");
}

}  // namespace lumivox::virtual_area_lights
