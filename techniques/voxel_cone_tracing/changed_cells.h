// What moves changes only some of the voxels: which, against static geometry that was lit once. Everything
// else is kept.
#pragma once

#include <optional>
#include <vector>

#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "octree/radiance_octree.h"
#include "voxel_cone_tracing_shaders.h"

namespace lumivox::voxel_cone_tracing {

/// Block Changes and its cells; `stillShift`: that of the pool of static geometry.
shader::BindingSet bindingOf(const ChangedCells& cells, int stillShift = 0);

/// Depth of the finest voxels in the smallest tree over a grid.
int voxelDepthOver(const GridPlacement& grid);
/// Words of tags before those of a depth (shaders/voxel_cone_tracing/octree/octree_tags.glsl).
std::uint64_t firstTagWord(int depth);

/// The fragments of what stands still, and of what moves: lists with counts of their own. A shader counts the
/// latter from `first` on (moving_fragments.glsl).
VoxelFragments stillOf(const VoxelFragments& list);
VoxelFragments movingOf(const VoxelFragments& list);
shader::BindingSet behindStill(const VoxelFragments& list);

/// Static fragments by their cells: where those of each cell end, and their places in the list.
struct CellFragments {
  gpu::BufferRef ends, fragments;
};
CellFragments sortedByCells(PassContext& frame, const VoxelFragments& still);

/// An invocation for each fragment in changed cells; a barrier follows.
void forEachChanged(PassContext& frame, const shader::BoundProgram& program,
                    const shader::BindingSet& bindings, const VoxelFragments& list,
                    const ChangedCells& changed);

/// What the light on static geometry depends on, beside its fragments and the geometry that casts shadows.
struct LightPlacement {
  std::vector<LightState> lights;
  glm::vec3 low{0.0f}, high{0.0f};  ///< of the scene, which lights are placed around
  int lightCount = 0, layerCount = 0, side = 0;
  float brightest = 0.0f;
  bool operator==(const LightPlacement&) const = default;
};

/// Boxes in the views of a shadow map (shadowed_anew.glsl).
struct BoxesInViews {
  int count = 0, lightCount = 0;  ///< no lights where nothing casts a shadow
  float texel = 0.0f;             ///< of the views, in clip space
  gpu::BufferRef bounds, casts;

  BoxesInViews(PassContext& frame, const In<ShadowMap>& shadow, const std::vector<Bounds>& boxes);
  shader::BindingSet bindings() const { return {shader::StorageSlot{"Casts"}(casts), lights_}; }

 private:
  LightBinding lights_;
};

/// Finds what has changed: a member of a pass.
class Changes {
 public:
  /// Bounds of what moves, m, at this moment; nothing where it cannot be told what moving geometry changes:
  /// it emits.
  std::optional<std::vector<Bounds>> moving(PassContext& frame);
  /// What contains the bounds of both of two moments: one box for two that lie near each other.
  static std::vector<Bounds> atEither(const std::vector<Bounds>& now, const std::vector<Bounds>& then);
  static LightPlacement placementOf(const PassContext& frame, const In<ShadowMap>& shadow, float brightest);
  /// The cells of moving fragments alone, which are listed.
  static ChangedCells movingCells(PassContext& frame, const VoxelFragments& list);
  /// The cells of moving fragments, and of light that passes through these bounds. `before`: bits of cells
  /// that count as well, those of the fragments that moved in another frame; they become those of this one.
  static ChangedCells cells(PassContext& frame, const VoxelFragments& list, const CellFragments& still,
                            const In<ShadowMap>& shadow, const std::vector<Bounds>& moving,
                            gpu::BufferRef* before = nullptr);

 private:
  std::vector<std::vector<Bounds>> atRest_;  ///< of draws, in their order: of runs of triangles; object space
};

}  // namespace lumivox::voxel_cone_tracing
