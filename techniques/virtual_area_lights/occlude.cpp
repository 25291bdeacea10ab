// Finds the occlusion between points and their averaged lights (Lensing and Broll 2013, Sec. 3.3).
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/loop_limit.h"
#include "passes.h"
#include "sparse_texture.h"
#include "virtual_area_lights_shaders.h"

namespace lumivox::virtual_area_lights {
namespace {

using namespace shaders::virtual_area_lights;

class OccludePass : public Pass {
  enum class Combine { product, sum, nearest, mask };

  In<SurfacePoints> points{this, "points", "where light was gathered, and the discs that occlude it"};
  In<SparseLight> unoccluded{this, "light", "averaged light, from normalise"};
  In<SurfaceLights> occluders{this, "occluders", Presence::optional,
                              "discs of other surfaces that occlude too, such as captured ones"};
  Param<bool> occlusion{this, "occlusion", true, "off: the light passes unchanged"};
  Param<Visibility> visibility{this, "visibility", Visibility::sphere, kVisibilityMeaning,
                               published(Visibility::sphere)};
  Param<Combine> combine{
      this, "combine", Combine::mask,
      "how several discs occlude together; product: each occludes its share of what the others leave; sum: shares add up; nearest: only the nearest disc; mask: the union, by 64 bits over the light's square",
      published(Combine::product)};
  PublishedForm asPublished{this, "the sphere counts by the form factor of a disc"};
  Out<SparseLight> light{this, "light", Contributes::nothing, Needs::anyLight,
                         "averaged light without the part that discs occlude"};

  struct OccludedKey {
    gpu::TextureRef light;
    gpu::BufferRef occluders;
    bool operator==(const OccludedKey&) const = default;
  };

  bool uses(const InBase& input) const override {
    return occludes() || (&input != &points && &input != &occluders);
  }

  bool occludes() const { return occlusion && visibility == Visibility::sphere; }

  void run(PassContext& frame) override {
    SparseLight result = *unoccluded;
    if (occludes()) {
      result.diffuse = frame.kept(
          "occluded diffuse light", OccludedKey{result.diffuse, occluders ? occluders->lights : nullptr},
          [&] { return occlude(frame, unoccluded->diffuse, unoccluded->diffusePosition); });
      if (result.glossy) result.glossy = occlude(frame, unoccluded->glossy, unoccluded->glossyPosition);
    }
    light = result;
  }

  gpu::TextureRef occlude(PassContext& frame, const gpu::TextureRef& lights,
                          const gpu::TextureRef& places) const {
    gpu::TextureRef result = sparseTexture(frame, *points, "occluded light");
    const gpu::BufferRef states =
        frame.elements(occlude::states, static_cast<std::uint64_t>(points->count), "occlusion so far");
    const int others = occluders ? occluders->count : 0;
    const auto add = [&](int discs, int total, bool begins, bool ends, const shader::BindingSet& from) {
      const shader::BoundProgram& program = frame.program(
          occlude::Variant{.combine = static_cast<int>(static_cast<Combine>(combine)), .discs = discs});
      forEachPortion(total, 0, [&](int first, int count) {
        forEachPoint(frame, program,
                     {occlude::parameters(
                          {first, count, begins && first == 0, ends && first + count == total, asPublished}),
                      SurfacePointsBinding(*points), from, occlude::lights(lights, gpu::Sampling::nearest),
                      occlude::places(places, gpu::Sampling::nearest), occlude::states(states),
                      occlude::occludedImage(result)},
                     *points);
      });
    };
    add(occlude::Variant::discsPoints, points->count, true, others == 0, {});
    if (others > 0)
      add(occlude::Variant::discsSurfaces, others, points->count == 0, true,
          {occlude::surfaces(occluders->lights)});
    return result;
  }
};

}  // namespace

void addOcclude(TechniqueRegistry& registry) {
  registry.add<OccludePass>(
      "occlude", "Occlusion of averaged lights by the discs of points (Lensing & Broll 2013, Sec. 3.3)");
}

}  // namespace lumivox::virtual_area_lights
