// Common parts of all voxelizers of triangles: where the grid lies, the list of fragments, and static
// geometry that is voxelized once.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/grid_placement.h"

namespace lumivox::voxelization {

inline constexpr int kWorkGroupSize = 64;  // of the passes that read a list of fragments

/// Where the grid lies: around the whole scene, or around the camera, moving with it by whole voxels.
enum class Around { scene, camera };
constexpr auto words(Around) {
  return std::array{"scene", "camera"};
}

/// Bindings for appending to a list of fragments: the count and the fragments.
shader::BindingSet appending(const VoxelFragments& list);

/// Bounds of what lies within `bounds` in object space, in voxels; a voxel more on every side, since the
/// device's arithmetic may round otherwise.
Bounds boundsInGrid(const Bounds& bounds, const glm::mat4& toWorld, const GridPlacement& grid);

/// The base of all passes that make a grid of their own.
class GridPass : public Pass {
 public:
  std::string checkParameters() const override;

 protected:
  GridPlacement placement(PassContext& frame) const;
  /// Sources that voxels of the scene's surface in this grid depend on.
  Reads readsSurface() const;

  using Draws = std::vector<const SceneDraw*>;
  struct DrawsByMotion {
    Draws still, moving;
  };
  static DrawsByMotion drawsByMotion(PassContext& frame);
  /// The key of voxels of static geometry: where the grid lies, and where their objects are.
  using StaticKey = std::pair<GridPlacement, std::vector<glm::mat4>>;
  static StaticKey staticKey(const PassContext& frame, const GridPlacement& grid, const Draws& still);

  Param<int> resolution{this, "resolution", 64, within(1, kLargestGrid),
                        "voxels along the longest side of the grid"};
  Param<Around> around{this, "around", Around::scene,
                       "the grid contains the whole scene, or moves with the camera by whole voxels"};
  Param<float> extent{this, "extent",
                      0.0f, within(0.0f, 1e9f),
                      "m",  "side of a grid around the camera; needed there, unused else"};
};

/// A list of fragments begins with those of static geometry, and what moves is written behind them in every
/// frame anew: nothing has to be merged, and nothing old can stay.
class Voxelizer : public GridPass {
 public:
  Reads readsFrom() const override { return readsSurface(); }
  void run(PassContext& frame) override;

 protected:
  /// Appends the fragments of these draws: the shader takes an index by adding to list.count, and writes
  /// where the index is below list.capacity. The device's barrier follows.
  virtual void append(PassContext& frame, const VoxelFragments& list, const Draws& draws) = 0;
  /// How the coverages of one voxel's fragments are combined.
  virtual VoxelFragments::Coverage coverage() const { return VoxelFragments::Coverage::mean; }
  /// A first guess at the number of fragments; a frame whose list was too small is made anew.
  virtual std::uint64_t expectedFragments(const Scene& scene, const GridPlacement& grid) const;

  Out<VoxelFragments> fragments{this, "fragments", "surface samples"};

 private:
  /// The fragments of static geometry, in a list with room for those of what moves.
  struct StaticList {
    gpu::BufferRef fragments, count;
    std::uint64_t capacity = 0;
  };
  StaticList listOfStatic(PassContext& frame, const GridPlacement& grid, const Draws& still);
  VoxelFragments emptyList(const GridPlacement& grid) const;

  std::uint64_t room_ = 0;  ///< fragments that the list is made for: a guess, or what earlier frames needed
};

/// Each registers the pass of its file.
void addConservative(TechniqueRegistry& registry);
void addMsaaOpacity(TechniqueRegistry& registry);
void addSlicing(TechniqueRegistry& registry);
void addDepthPeeling(TechniqueRegistry& registry);
void addAverage(TechniqueRegistry& registry);
void addPoints(TechniqueRegistry& registry);
void addReproject(TechniqueRegistry& registry);
void addAtlasBinary(TechniqueRegistry& registry);
void addAtlasAttributes(TechniqueRegistry& registry);
void addSolid(TechniqueRegistry& registry);
void addView(TechniqueRegistry& registry);

}  // namespace lumivox::voxelization
