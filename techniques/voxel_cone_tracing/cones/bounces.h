// Bounces beyond the first: light that cones gather at the fragments of voxels, and that these reflect.
// GLSL side: shaders/voxel_cone_tracing/cones/bounce.comp, turns.glsl, reflected.comp.
#pragma once

#include <optional>
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
  const VoxelSums& sums;                    ///< of direct light; they stay as they are
  const OccupiedBricks* bricks = nullptr;   ///< of a grid
  const VoxelOctree* tree = nullptr;        ///< of an octree
  std::vector<glm::ivec3> firstOfLevels{};  ///< of a clipmap: the first voxel of each level
};

/// The store that the frame before ended with; a member of a pass. Its light is reflected once more and added
/// to the direct light, so that frames in a row hold ever more reflections and a still scene comes to all of
/// them. Without accumulation there is no such store, and nothing is added.
template <class Store>
class LightBefore {
 public:
  explicit LightBefore(Pass* pass)
      : before_(
            pass, "before", Presence::history,
            "light of the frame before, pre-filtered: cones gather it at fragments, so that frames in a row come to all bounces",
            Needs::nothing, Levels::all) {}
  const Store* get() const { return before_.present() ? &*before_ : nullptr; }

 private:
  In<Store> before_;
};

/// The most that a voxel can reflect after so many bounces, where the first brings at most `direct`,
/// W/(sr m^2): cones of further ones gather at most what voxels of the one before hold, or the environment.
float brightestAfter(PassContext& frame, float direct, int bounces);

/// Bounces beyond the first; members of a pass.
class Bounces {
 public:
  enum class Within { frame, frames };
  /// `within` frames alone: no more than one bounce in a frame.
  Bounces(Pass* pass, const DirectLight& light, Within within = Within::frame);
  /// Bytes of what a voxel reflects.
  static constexpr std::uint64_t bytesOfVoxel(bool directional) {
    return (directional ? 6 : 1) * 3 * sizeof(float);
  }
  int count() const { return count_ ? static_cast<int>(*count_) : 1; }
  /// The most reflections of light that a store can hold; `before`: it adds those of all frames before.
  int most(bool before) const { return before ? kMost : count(); }
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
  std::optional<Param<int>> count_;
  Param<int> cones_, turns_;

  /// What voxels reflected in a frame, and where it lies.
  struct Moment {
    gpu::BufferRef reflected;
    GridPlacement grid;
    std::vector<glm::ivec3> firstOfLevels;  ///< of a clipmap
    gpu::BufferRef bricks;                  ///< of a grid
    gpu::BufferRef ranks, levels;           ///< of an octree
    int turn = 0;
  };
  /// The frame before and this one; a frame that is rendered again finds the former once more.
  std::vector<Moment> moments_;

  static Moment momentOf(const ReflectingVoxels& voxels, gpu::BufferRef reflected);
  void gather(PassContext& frame, const ReflectingVoxels& voxels, const StoreBinding& store,
              float mostRadiance, const Moment* before, Moment& now) const;
};

}  // namespace lumivox::voxel_cone_tracing
