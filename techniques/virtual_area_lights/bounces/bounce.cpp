// Light of the frame before at points, as lights of this frame: all bounces over frames. Beside Lensing and
// Broll 2013, whose lights are the texels of the maps alone.
#include <span>
#include <vector>

#include "../passes.h"
#include "../sparse_texture.h"
#include "lumivox/scene/bilinear.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/light_samples.h"
#include "virtual_area_lights_shaders.h"

namespace lumivox::virtual_area_lights {
namespace {

using namespace shaders::virtual_area_lights;

/// Diffuse albedo at the place of a point.
glm::vec3 albedoAt(const Scene& scene, const SurfacePoint& point) {
  const Material& material = scene.materials[static_cast<std::size_t>(point.material)];
  if (material.diffuseTexture < 0) return material.diffuse;
  const auto texcoord = [&](std::size_t k) {
    return scene.texcoords[scene.indices[3 * std::size_t{point.place.triangle} + k]];
  };
  const glm::vec2 at = (1.0f - point.place.second - point.place.third) * texcoord(0) +
                       point.place.second * texcoord(1) + point.place.third * texcoord(2);
  const SurfaceTexture& texture = scene.textures[static_cast<std::size_t>(material.diffuseTexture)];
  return material.diffuse * bilinearPlace(at, texture.width, texture.height).blend([&](std::size_t texel) {
    return glm::vec3(texture.values[3 * texel], texture.values[3 * texel + 1], texture.values[3 * texel + 2]);
  });
}

class BouncePass : public Pass {
  In<SurfacePoints> points{this, "points", "which reflect, each for the surface around it"};
  In<SparseLight> before{
      this, "before", Presence::history,
      "light that arrived in the frame before, from 'gather'; without it, in a first frame and in runs that do not accumulate, nothing is reflected"};
  Out<ReflectiveShadowMap> map{
      this, "map", Contributes::nothing, Needs::anyLight,
      "points as texels with the flux that they reflect; all surfaces, also those that no light sees"};

  Reads readsFrom() const override { return Reads::materials; }

  void run(PassContext& frame) override {
    const glm::ivec2 size = SurfacePoints::sizeFor(points->count);
    const auto layer = [&](const char* label) {
      gpu::TextureRef made =
          frame.texture({gpu::TextureKind::d2Array, gpu::Format::rgba32f, size.x, size.y, 1, 1}, label);
      made->clear(glm::vec4(0.0f));
      return made;
    };
    const bool lit = before.present() && points->count > 0 && before->diffuse->description().height == size.y;
    ReflectiveShadowMap result{.lights = frame.uploaded(std::vector<LightSampleData>(1), "no light"),
                               .views = nullptr,
                               .position = layer("positions of points"),
                               .normal = layer("normals and areas of points"),
                               .flux = layer("flux of points"),
                               .lightCount = lit ? 1 : 0,
                               .layerCount = lit ? 1 : 0,
                               .captured = true,
                               .overlapping = 1};
    map = result;
    if (!lit) return;
    using gpu::Sampling;
    forEachPoint(
        frame, frame.program(bounce::kProgram),
        {SurfacePointsBinding(*points), bounce::arrived(before->diffuse, Sampling::nearest),
         bounce::pointAlbedo(albedos(frame), Sampling::nearest), bounce::positionImage(result.position),
         bounce::normalImage(result.normal), bounce::fluxImage(result.flux)},
        *points);
  }

  /// Albedos do not move with the points.
  const gpu::TextureRef& albedos(PassContext& frame) const {
    return frame.kept("albedos of points", points->set, [&] {
      std::vector<glm::vec4> values;
      for (const SurfacePoint& point : points->set->points)
        values.emplace_back(albedoAt(frame.sceneDescription(), point), 1.0f);
      const glm::ivec2 size = SurfacePoints::sizeFor(points->count);
      values.resize(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y), glm::vec4(0.0f));
      gpu::TextureRef made = sparseTexture(frame, *points, "albedos of points");
      made->upload(0, std::as_bytes(std::span(values)));
      return made;
    });
  }
};

}  // namespace

void addBounce(TechniqueRegistry& registry) {
  registry.add<BouncePass>(
      "bounce", "Points reflect the light of the frame before: all bounces over frames that accumulate");
}

}  // namespace lumivox::virtual_area_lights
