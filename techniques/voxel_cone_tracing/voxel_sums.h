// Integer sums over the fragments of each voxel, for all passes that inject light into a store.
// GLSL side: shaders/voxel_cone_tracing/bricks.glsl and sums.glsl.
#pragma once

#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/change_tracking.h"
#include "voxel_cone_tracing_shaders.h"

namespace lumivox::voxel_cone_tracing {

/// What fragments do to the faces of their voxel, where it has six.
struct FaceRule {
  float backWeight = 1.0f / 256.0f;  ///< of a fragment's back in the mean of a face, where fronts have 1
  bool alongAll = false;             ///< closes its voxel along all axes, not only along those that it faces
};

/// Room for the sums of occupied voxels, and where they lie.
struct VoxelSums {
  int kind = 0;  ///< value of the shader's axis PLACES
  glm::ivec3 brickCount{0};
  bool directional = false;
  FaceRule faces;             ///< directional
  gpu::BufferRef bricks;      ///< of a grid
  gpu::BufferRef sideMasks;   ///< samples of voxels' sides, a word a fragment; null: none
  shader::BindingSet places;  ///< where the sums of a voxel are found; refers to what it binds
  gpu::BufferRef voxels;
  const ChangedCells* changed = nullptr;  ///< where there are some, the fragments in them are taken alone
  shader::BindingSet bindings() const {
    if (directional) return {places, shaders::voxel_cone_tracing::add::directionalSums(voxels)};
    return {places, shaders::voxel_cone_tracing::add::sums(voxels)};
  }
};

/// Finds the occupied bricks of a grid of this size, and gives every occupied voxel its place among the sums.
/// There are no more of them than fragments, so that nothing that happens on the device need be known here.
VoxelSums claimSums(PassContext& frame, const VoxelFragments& fragments, const glm::ivec3& size,
                    bool directional, OccupiedBricks& occupied);

/// The same where only some cells have changed since `bricks` was claimed, which is brought up to date: room
/// for the sums of those alone. `changedBricks`: those that hold or held anything.
VoxelSums claimChanged(PassContext& frame, const VoxelFragments& fragments, const glm::ivec3& size,
                       bool directional, const ChangedCells& changed, const gpu::BufferRef& bricks,
                       OccupiedBricks& occupied, OccupiedBricks& changedBricks);

/// Room for what fragments reflect.
gpu::BufferRef radiancesOf(PassContext& frame, const VoxelFragments& fragments, const VoxelSums& sums);

/// An invocation for each fragment that is taken, by a program with the axis CHANGED; a barrier follows.
void forEachTaken(PassContext& frame, const shader::BoundProgram& program, const shader::BindingSet& bindings,
                  const VoxelFragments& fragments, const VoxelSums& sums);

/// Adds what fragments reflect to the sums of their voxels, of which the number and the brightest of the
/// fragments are known.
void addUp(PassContext& frame, const VoxelFragments& fragments, const VoxelSums& sums,
           const gpu::BufferRef& radiances);

}  // namespace lumivox::voxel_cone_tracing
