// Direct light that fragments reflect, for all passes that inject light into a store.
// GLSL side: shaders/voxel_cone_tracing/fragment_light.glsl.
#pragma once

#include "lumivox/plugin/technique.h"
#include "voxel_cone_tracing_shaders.h"
#include "voxel_sums.h"

namespace lumivox::voxel_cone_tracing {

/// Half floats end at 65504; filtering never exceeds the largest value. A store in half floats has the unit
/// of its brightest radiance over this.
inline constexpr float kLargestHalf = 32768.0f;

/// What Phong lobes of surfaces add to what voxels send on.
enum class Lobes { diffuse, none };

/// Lights and their visibility; members of a pass.
struct DirectLight {
  explicit DirectLight(Pass* pass);

  In<ShadowMap> shadow;
  In<ScatteringGrid> media;
  Param<int> mediumSteps;
  Param<float> ambient;
  Param<int> samples;
  Param<bool> twoSided;
  Param<bool> emission;
  Param<Lobes> lobes;

  /// The most that a voxel at least this far from lights can reflect, W/(sr m^2).
  float brightest(PassContext& frame, float nearest) const;

  /// Whether fragments also reflect by Phong lobes.
  bool glossy(PassContext& frame) const;

  /// Writes the radiance that each fragment reflects, at most `mostRadiance`, into `radiances`, and for each
  /// voxel the number and the brightest of its fragments. A clipmap has a bound per level.
  void reflect(PassContext& frame, const VoxelFragments& fragments, const VoxelSums& sums, float mostRadiance,
               const gpu::BufferRef& radiances) const;
};

}  // namespace lumivox::voxel_cone_tracing
