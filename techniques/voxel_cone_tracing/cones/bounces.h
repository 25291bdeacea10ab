// Bounces beyond the first: light that cones gather at the fragments of voxels, and that these reflect.
// GLSL side: shaders/voxel_cone_tracing/cones/bounce.comp, turns.glsl, reflected.comp.
#pragma once

#include <string>
#include <vector>

#include "../direct_light.h"
#include "../octree/radiance_octree.h"
#include "../voxel_sums.h"
#include "lumivox/plugin/technique.h"
#include "march.h"
#include "voxel_cone_tracing_shaders.h"

namespace lumivox::voxel_cone_tracing {

/// Voxels that reflect: their fragments, and where the sums of each lie.
struct ReflectingVoxels {
  const VoxelFragments& fragments;
  const VoxelSums& sums;                   ///< of direct light; they stay as they are
  const OccupiedBricks* bricks = nullptr;  ///< of a grid
  const VoxelOctree* tree = nullptr;       ///< of an octree
};

/// Bounces beyond the first; members of a pass.
class Bounces {
 public:
  Bounces(Pass* pass, const DirectLight& light);
  /// Bytes of what a voxel reflects.
  static constexpr std::uint64_t bytesOfVoxel(bool directional) {
    return (directional ? 6 : 1) * 3 * sizeof(float);
  }
  int count() const { return count_; }
  /// The most reflections of light that a store can hold; `before`: it adds those of all frames before.
  int most(bool before) const { return before ? kMost : count_; }
  /// What is wrong with the parameters; empty: nothing.
  std::string check() const;

  /// What voxels reflect of the light that cones gather in a store, at most `mostRadiance`: r, g, b of each
  /// of their faces by the place of their sums, W/(sr m^2).
  gpu::BufferRef ofStore(PassContext& frame, const ReflectingVoxels& voxels, const StoreBinding& store,
                         float mostRadiance) const;
  /// The same from the store of the frame before: only voxels that have their turn gather light, and those
  /// that were empty; the others reflect what they did. Needs Reads::history.
  gpu::BufferRef ofStoreBefore(PassContext& frame, const ReflectingVoxels& voxels, const StoreBinding& store,
                               float mostRadiance);

 private:
  static constexpr int kMost = 256, kMostTurns = 8;
  const DirectLight& light_;
  Param<int> count_, cones_, turns_;

  /// What voxels reflected in a frame, and where it lies.
  struct Moment {
    gpu::BufferRef reflected;
    GridPlacement grid;
    gpu::BufferRef bricks;         ///< of a grid
    gpu::BufferRef ranks, levels;  ///< of an octree
    int turn = 0;
  };
  /// The frame before and this one; a frame that is rendered again finds the former once more.
  std::vector<Moment> moments_;

  static Moment momentOf(const ReflectingVoxels& voxels, gpu::BufferRef reflected);
  void gather(PassContext& frame, const ReflectingVoxels& voxels, const StoreBinding& store,
              float mostRadiance, const Moment* before, Moment& now) const;
};

}  // namespace lumivox::voxel_cone_tracing
