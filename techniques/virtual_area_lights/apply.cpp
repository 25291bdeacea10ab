// Applies the averaged lights of sparse points to visible surfaces (Lensing and Broll 2013, Sec. 3.2 steps 3
// and 4).
#include <tuple>

#include "lumivox/base/error.h"
#include "lumivox/toolkit/bindings.h"
#include "passes.h"
#include "vertices/apply_vertices.h"
#include "virtual_area_lights_shaders.h"

namespace lumivox::virtual_area_lights {
namespace {

using namespace shaders::virtual_area_lights;

class ApplyPass : public Pass {
  enum class Interpolate { averaged, plain };
  enum class At { pixels, vertices };

  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<SurfacePoints> points{this, "points", "where light was gathered"};
  In<SparseLight> light{this, "light", Presence::optional, "averaged light of the points", Needs::anyLight};
  In<VertexPoints> vertices{this, "vertices", Presence::optional,
                            "with 'at vertices': the points that vertices refer to, from the pass `vertices`",
                            Needs::anyLight};
  Param<Interpolate> interpolate{
      this, "interpolate", Interpolate::averaged,
      "what is interpolated for the diffuse lobe; averaged: the points' averaged lights, shaded with the pixel's normal; plain: the light that the points reflect",
      published(Interpolate::averaged)};
  Param<At> at{
      this, "at", At::pixels,
      "where the nearest points are interpolated; pixels: at each pixel; vertices: at the vertices of the meshes and from there by the rasteriser, for meshes finer than the points",
      published(At::vertices)};
  PublishedForm asPublished{
      this,
      "Eq. 10 with its squared distance to the averaged place (normalise must be as published too); for the glossy lobe too, the mean of the lights' places in place of their offsets from the points"};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::anyLight,
                     "indirect light reflected by the diffuse lobe, W/(sr m^2)"};
  Out<Image> glossy{this, "glossy", Contributes::indirectGlossy, Needs::anyLight | Needs::glossyMaterial,
                    "indirect light reflected by the Phong lobe, W/(sr m^2)"};

  Reads readsFrom() const override {
    return atVertices() ? Reads::camera | Reads::geometry | Reads::materials : Reads::camera;
  }
  bool uses(const InBase& input) const override { return &input != &vertices || atVertices(); }

  void run(PassContext& frame) override {
    const bool isGlossy =
        glossy.wanted() && light && light->glossy != nullptr && gbuffer->specular != nullptr;
    const bool isDiffuse = diffuse.wanted() && light;
    if (diffuse.wanted()) diffuse = Image{frame.image("diffuse light of points")};
    if (glossy.wanted()) glossy = Image{frame.image("glossy light of points")};
    if (diffuse.wanted() && !isDiffuse) diffuse->texture->clear(glm::vec4(0, 0, 0, 1));
    if (glossy.wanted() && !isGlossy) glossy->texture->clear(glm::vec4(0, 0, 0, 1));
    if (!isDiffuse && !isGlossy) return;
    if (points->stride > 0)
      throw Error(
          "virtual_area_lights.apply: 'points' lie at pixels; expected points spread over triangles, by "
          "virtual_area_lights.points");
    SparseLight shown = *light;
    if (atVertices()) {
      checkVertices();
      const VertexInputs inputs{*gbuffer, *points, *vertices, interpolated() != 0, asPublished};
      if (isDiffuse)
        std::tie(shown.diffuse, shown.diffusePosition) =
            diffuseOverTriangles(frame, inputs, light->diffuse, light->diffusePosition);
      if (isGlossy)
        std::tie(shown.glossy, shown.glossyPosition) =
            glossyOverTriangles(frame, inputs, light->glossy, light->glossyPosition);
    }
    shader::BindingSet bound{apply::parameters({frame.snapshot().camera.eye, asPublished}),
                             GBufferBinding(*gbuffer), SurfacePointsBinding(*points), lightBinding(shown)};
    if (isDiffuse) bound.add(apply::diffuseImage(diffuse->texture));
    if (isGlossy) bound.add(apply::glossyImage(glossy->texture));
    frame.dispatch(frame.program(apply::Variant{.diffuse = isDiffuse,
                                                .glossy = isGlossy,
                                                .interpolate = interpolated(),
                                                .at = atVertices() ? apply::Variant::atVertices
                                                                   : apply::Variant::atPixels},
                                 apply::Constants{.neighbours = points->neighbours}),
                   bound, pixels(frame));
  }

  bool atVertices() const { return at == At::vertices; }
  /// Error where vertices are missing or refer to other points.
  void checkVertices() const {
    if (!vertices.present())
      throw Error(
          "virtual_area_lights.apply: light at vertices reads 'vertices'; expected it to be connected to a pass "
          "virtual_area_lights.vertices");
    if (vertices->set != points->set || vertices->neighbours != points->neighbours)
      throw Error(
          "virtual_area_lights.apply: 'vertices' refer to other points than 'points' are; expected those of one "
          "pass virtual_area_lights.points");
  }
  int interpolated() const { return interpolate == Interpolate::plain; }

  static shader::BindingSet lightBinding(const SparseLight& of) {
    using gpu::Sampling;
    return {apply::diffuseLight(of.diffuse, Sampling::nearest),
            apply::diffusePlace(of.diffusePosition, Sampling::nearest),
            apply::glossyLight(of.glossy, Sampling::nearest),
            apply::glossyPlace(of.glossyPosition, Sampling::nearest)};
  }
};

}  // namespace

void addApply(TechniqueRegistry& registry) {
  registry.add<ApplyPass>(
      "apply",
      "Averaged lights of sparse points at the visible surfaces (Lensing & Broll 2013, Eq. 10, 12, 13)");
}

}  // namespace lumivox::virtual_area_lights
