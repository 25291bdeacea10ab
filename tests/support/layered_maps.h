// The passes of layered reflective shadow maps on scenes of tests.
#pragma once

#include <string>
#include <vector>

#include "../techniques/layered_reflective_shadow_maps/layered_reflective_shadow_map.h"
#include "../techniques/layered_reflective_shadow_maps/opacity_levels.h"
#include "support/passes.h"

namespace lumivox::test::layered {

inline ReflectiveShadowMap mapOf(const Scene& scene, int size) {
  return LonePass("reflective_shadow_maps.render", scene,
                  {{"size", size}, {"area_size", size}, {"area_samples", 2}})
      .out<ReflectiveShadowMap>("map");
}

inline LayeredReflectiveShadowMap layersOf(const Scene& scene, const ReflectiveShadowMap& map,
                                           const Settings& settings = {}) {
  return LonePass("layered_reflective_shadow_maps.layers", scene, settings)
      .in("map", map)
      .out<LayeredReflectiveShadowMap>("layers");
}

inline OpacityLevels levelsOf(const Scene& scene, const OccupancyGrid& grid, const char* rule = "facing") {
  return LonePass("layered_reflective_shadow_maps.occlusion", scene, {{"rule", rule}})
      .in("opacity", grid)
      .out<OpacityLevels>("levels");
}

/// The opacity levels of a scene, with `resolution` voxels along its longest side.
inline OpacityLevels opacityOf(const Scene& scene, int resolution) {
  return levelsOf(scene, LonePass("voxelization.average", scene)
                             .in("fragments", fragmentsIn(scene, {{"resolution", resolution}}))
                             .out<OccupancyGrid>("opacity"));
}

/// `gather` over the same surface point in every pixel. Its position is in scene coordinates.
class Gatherer : public LonePass {
 public:
  Gatherer(const Scene& scene, const OpacityLevels& opacity, const SeenSurface& seen,
           const Settings& settings = {}, int side = 8)
      : LonePass("layered_reflective_shadow_maps.gather", withImage(scene, side), settings) {
    SeenSurface placed = seen;
    placed.position -= glm::vec3(snapshotOf(scene, 0.0).origin);
    GBuffer gbuffer = gbufferAt(placed, {side, side});
    if (seen.specular == glm::vec4(0.0f)) gbuffer.specular = nullptr;
    in("gbuffer", gbuffer);
    in("opacity", opacity);
  }
  /// The first channel's mean over the pixels.
  double mean(const char* output = "arriving") {
    const std::vector<float> values = floats(output);
    double sum = 0.0;
    for (std::size_t i = 0; i < values.size(); i += 4) sum += values[i];
    return 4.0 * sum / static_cast<double>(values.size());
  }

 private:
  static Scene withImage(Scene scene, int side) {
    scene.cameras.front().width = scene.cameras.front().height = side;
    return scene;
  }
};

/// `gather` for a scene with its own opacities and maps.
inline Gatherer gathererOf(const Scene& scene, int resolution, int mapSize, const SeenSurface& seen,
                           const Settings& settings = {}, const Settings& ofLayers = {}) {
  Gatherer result(scene, opacityOf(scene, resolution), seen, settings);
  result.in("layers", layersOf(scene, mapOf(scene, mapSize), ofLayers));
  return result;
}

}  // namespace lumivox::test::layered
