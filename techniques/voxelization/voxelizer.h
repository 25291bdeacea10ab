// Common parts of all voxelizers of triangles: the placement of the grid, the list of fragments, and static
// geometry, which is voxelized once.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/counts.h"
#include "lumivox/toolkit/grid_placement.h"
#include "voxelization_shaders.h"

namespace lumivox::voxelization {

inline constexpr int kWorkGroupSize =
    kCountedGroupSize;  // work group size of passes that read a list of fragments

/// Placement of the grid: around the whole scene, or around the camera, moving with it by whole voxels.
enum class Around { scene, camera };

/// Bounds in voxels of `bounds` in object space, with a margin of one voxel, since the device may round
/// differently.
Bounds boundsInGrid(const Bounds& bounds, const glm::mat4& toWorld, const GridPlacement& grid);

/// A list in this grid that begins with a copy of `base` and has room for `more` fragments; all on the
/// device. Without a base (null) it is empty. Error where it would be too large.
VoxelFragments listBehind(PassContext& frame, const GridPlacement& grid, const VoxelFragments* base,
                          std::uint64_t more);

/// Block ListGrid of list_grid.glsl, for shaders that append to no list.
gpu::ResourceBinding gridBinding(const GridPlacement& grid, std::uint64_t capacity = 0);
/// Bindings for appending to a list of fragments (fragment_list.glsl).
shader::BindingSet appending(const VoxelFragments& list);

/// Block View of view_axis.glsl: the slice between two depths, in voxels, along axis 0, 1 or 2, one pixel a
/// column of voxels in a square target of the grid's longest side.
gpu::ResourceBinding viewAlong(const GridPlacement& grid, int axis, float depthLow, float depthHigh);

/// Base class of passes that make a grid of their own.
class GridPass : public Pass {
 public:
  std::string checkParameters() const override;
  /// Sources that the voxels of the scene's surfaces depend on.
  Reads readsFrom() const override;

 protected:
  GridPlacement placement(PassContext& frame) const;

  using Draws = std::vector<const SceneDraw*>;
  struct DrawsByMotion {
    Draws still, moving;
  };
  static DrawsByMotion drawsByMotion(PassContext& frame);
  /// The result of make(), kept while the grid and the objects of these draws stay in place.
  template <class Make>
  static auto keptWhile(PassContext& frame, const GridPlacement& grid, const Draws& still,
                        const std::string& what, const Make& make) {
    if (still.empty()) return make();
    std::pair<GridPlacement, std::vector<glm::mat4>> key{grid, {}};
    for (const SceneDraw* draw : still)
      key.second.push_back(frame.snapshot().objects[static_cast<std::size_t>(draw->object)].toWorld);
    return frame.kept(what, key, make);
  }
  /// Words, d3 r32ui, in which draws set bits. Those of static geometry are kept; every frame adds those of
  /// moving geometry to a copy of them.
  using Mark = std::function<void(const gpu::Texture& words, const Draws& draws)>;
  static gpu::TextureRef markedWords(PassContext& frame, const GridPlacement& grid, const glm::ivec3& size,
                                     const std::string& label, const Mark& mark);

  Param<int> resolution{this, "resolution", 64, within(1, kLargestGrid),
                        "voxels along the longest side of the grid"};
  Param<Around> around{this, "around", Around::scene,
                       "scene: the grid contains the scene; camera: it follows the camera by whole voxels"};
  Param<float> extent{this, "extent",
                      0.0f, within(0.0f, 1e9f),
                      "m",  "side of the grid with 'around camera', where it is required; unused otherwise"};
};

/// Base class of voxelizers that append to a list. It begins with the fragments of static geometry; every
/// frame writes those of moving geometry behind them. Nothing has to be merged, and nothing old can stay.
class Voxelizer : public GridPass {
 public:
  void run(PassContext& frame) override;

 protected:
  /// Appends the fragments of these draws, at least one of them. The caller issues the barrier.
  virtual void append(PassContext& frame, const VoxelFragments& list, const Draws& draws) = 0;
  /// How the coverages of a voxel's fragments combine.
  virtual VoxelFragments::Coverage coverage() const { return VoxelFragments::Coverage::mean; }
  /// First guess at the number of fragments; a frame whose list was too small is rendered again.
  virtual std::uint64_t expectedFragments(const Scene& scene, const GridPlacement& grid) const;

  Out<VoxelFragments> fragments{this, "fragments", "surface samples"};

 private:
  VoxelFragments listOfStatic(PassContext& frame, const GridPlacement& grid, const Draws& still);

  std::uint64_t room_ = 0;  ///< fragments that the list has room for: a guess, or what earlier frames needed
};

/// Each function registers the passes of its file.
void addConservative(TechniqueRegistry& registry);
void addMsaaOpacity(TechniqueRegistry& registry);
void addSlicing(TechniqueRegistry& registry);
void addDepthPeeling(TechniqueRegistry& registry);
void addAverage(TechniqueRegistry& registry);
void addPoints(TechniqueRegistry& registry);
void addReproject(TechniqueRegistry& registry);
void addAtlas(TechniqueRegistry& registry);
void addSolid(TechniqueRegistry& registry);

}  // namespace lumivox::voxelization
