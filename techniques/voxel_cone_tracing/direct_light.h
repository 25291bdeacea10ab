// Direct light that fragments reflect, for all passes that inject light into a store.
// GLSL side: shaders/voxel_cone_tracing/fragment_light.glsl.
#pragma once

#include "lumivox/plugin/technique.h"
#include "voxel_cone_tracing_shaders.h"
#include "voxel_sums.h"

namespace lumivox::voxel_cone_tracing {

/// Half floats end at 65504; filtering adds nothing to the largest. A store in half floats counts radiance in
/// units of its brightest over this.
inline constexpr float kLargestHalf = 32768.0f;

/// Lights, and what lies between them and surfaces: members of a pass.
struct DirectLight {
  explicit DirectLight(Pass* pass);

  In<ShadowMap> shadow;
  In<ScatteringGrid> media;
  Param<int> mediumSteps;
  Param<float> ambient;
  Param<int> samples;
  Param<bool> twoSided;
  Param<bool> emission;

  /// No voxel whose fragments are at this distance from lights at least can reflect more, W/(sr m^2).
  float brightest(PassContext& frame, float nearest) const;

  /// The radiance that each fragment reflects, at most `mostRadiance`, into `radiances`, and of each voxel
  /// the number and the brightest of its fragments. In a clipmap its levels say what is most.
  void reflect(PassContext& frame, const VoxelFragments& fragments, const VoxelSums& sums, float mostRadiance,
               const gpu::BufferRef& radiances) const;
};

}  // namespace lumivox::voxel_cone_tracing
