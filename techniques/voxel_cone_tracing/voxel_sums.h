// Integer sums over the fragments of each voxel, for all passes that inject light into a store.
// GLSL side: shaders/voxel_cone_tracing/bricks.glsl and sums.glsl.
#pragma once

#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/change_tracking.h"
#include "voxel_cone_tracing_shaders.h"

namespace lumivox::voxel_cone_tracing {

/// How fragments affect the six faces of their voxel.
struct FaceRule {
  float backWeight = 1.0f / 256.0f;  ///< of a fragment's back in the mean of a face, where fronts have 1
  bool alongAll = false;             ///< closes its voxel along all axes, not only along those that it faces
};

/// The sums of occupied voxels, and their places.
struct VoxelSums {
  int kind = 0;  ///< value of the shader's axis PLACES
  glm::ivec3 brickCount{0};
  bool directional = false;
  FaceRule faces;             ///< directional
  gpu::BufferRef bricks;      ///< of a grid
  gpu::BufferRef sideMasks;   ///< samples of voxels' sides, a word a fragment; null: none
  shader::BindingSet places;  ///< locate the sums of a voxel; refers to what it binds
  gpu::BufferRef voxels;
  const ChangedCells* changed = nullptr;  ///< where set, only the fragments in these cells are taken
  shader::BindingSet bindings() const {
    if (directional) return {places, shaders::voxel_cone_tracing::add::directionalSums(voxels)};
    return {places, shaders::voxel_cone_tracing::add::sums(voxels)};
  }
};

/// Finds the occupied bricks of a grid of this size and gives every occupied voxel its place among the sums.
/// There are at most as many as fragments, so that the host need not read anything back.
VoxelSums claimSums(PassContext& frame, const VoxelFragments& fragments, const glm::ivec3& size,
                    bool directional, OccupiedBricks& occupied);

/// The same where only some cells have changed since `bricks` was claimed, which is updated: sums of those
/// cells only. `changedBricks`: those that hold or held anything.
VoxelSums claimChanged(PassContext& frame, const VoxelFragments& fragments, const glm::ivec3& size,
                       bool directional, const ChangedCells& changed, const gpu::BufferRef& bricks,
                       OccupiedBricks& occupied, OccupiedBricks& changedBricks);

/// A buffer for the radiance that fragments reflect.
gpu::BufferRef radiancesOf(PassContext& frame, const VoxelFragments& fragments, const VoxelSums& sums);

/// Runs an invocation for each fragment that is taken, by a program with the axis CHANGED; then a barrier.
void forEachTaken(PassContext& frame, const shader::BoundProgram& program, const shader::BindingSet& bindings,
                  const VoxelFragments& fragments, const VoxelSums& sums);

/// Adds what fragments reflect to the sums of their voxels. The number and the brightest of each voxel's
/// fragments must be known.
void addUp(PassContext& frame, const VoxelFragments& fragments, const VoxelSums& sums,
           const gpu::BufferRef& radiances);

}  // namespace lumivox::voxel_cone_tracing
