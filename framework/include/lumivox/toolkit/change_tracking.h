// What moves changes only some of the voxels that a pass fills. Change tracking finds them, so that the pass
// keeps all others: a frame costs what moves, and equals one that is filled from nothing, bit for bit.
#pragma once

#include <optional>
#include <vector>

#include "lumivox/pipeline/pass.h"
#include "lumivox/toolkit/bindings.h"

namespace lumivox {

// ---- fragments

/// The static fragments of a list, and those that move: lists with counts of their own. A shader numbers the
/// latter from the count of static ones on (shaders/toolkit/moving_fragments.glsl), which is bound besides.
VoxelFragments staticOf(const VoxelFragments& list);
VoxelFragments movingOf(const VoxelFragments& list);
shader::BindingSet bindStaticCount(const VoxelFragments& list);

/// Cells of voxels whose fragments or whose light may differ from before.
struct ChangedCells {
  gpu::BufferRef bits;  ///< of cells, and of all that lies above them in a tree over the grid (bit_tree.h)
  gpu::BufferRef fragments, count;    ///< those in changed cells: their places in the list; as countBuffer()
  int cellDepth = 0, voxelDepth = 0;  ///< in that tree, whose root is at depth 0

  /// For shaders/toolkit/changed_cells.glsl.
  shader::BindingSet bindings() const;
};

/// An invocation for each fragment in changed cells (shaders/toolkit/taken_fragments.glsl, axis CHANGED); a
/// barrier follows.
void forEachChanged(PassContext& frame, const shader::BoundProgram& program,
                    const shader::BindingSet& bindings, const VoxelFragments& list,
                    const ChangedCells& changed);

/// Static fragments by their cells: where those of each cell end, and their places in the list.
struct CellFragments {
  gpu::BufferRef ends, fragments;
};

// ---- light

/// What the light of a moment depends on, beside the geometry that casts shadows.
struct LightPlacement {
  std::vector<LightState> lights;
  glm::vec3 low{0.0f}, high{0.0f};  ///< of the scene, which lights are placed around
  int lightCount = 0, layerCount = 0, side = 0;
  float brightest = 0.0f;  ///< what the pass takes as most, W/(sr m^2)
  bool operator==(const LightPlacement&) const = default;
};
LightPlacement lightPlacement(const PassContext& frame, const In<ShadowMap>& shadow, float brightest);

/// Boxes in the views of a shadow map: light behind them may change (shaders/toolkit/shadowed_anew.glsl).
struct BoxesInViews {
  int count = 0, lightCount = 0;  ///< no lights where nothing casts a shadow
  float texel = 0.0f;             ///< of the views, in clip space
  gpu::BufferRef bounds, casts;

  BoxesInViews(PassContext& frame, const In<ShadowMap>& shadow, const std::vector<Bounds>& boxes);
  shader::BindingSet bindings() const { return {shader::StorageSlot{"Casts"}(casts), lights_}; }

 private:
  LightBinding lights_;
};

/// What contains the bounds of both of two moments: one box for two that lie near each other.
std::vector<Bounds> boundsAtEither(const std::vector<Bounds>& now, const std::vector<Bounds>& then);

// ---- moments

/// Static fragments in their light: a key for PassContext::kept(). While it stays equal, only what moves
/// changes voxels.
struct StaticLight {
  gpu::BufferRef still;  ///< VoxelFragments::still
  LightPlacement lights;
  bool operator==(const StaticLight&) const = default;
};

/// A moment in whose light something was made and kept.
struct LitMoment {
  std::vector<Bounds> moving;  ///< what cast shadows, m
  gpu::BufferRef movingCells;  ///< bits of the cells of moving fragments; null: only static ones were taken
  CellFragments still;         ///< sorted when first needed
};

/// Follows what moves: a member of a pass that reads Reads::geometry and Reads::lights.
class ChangeTracking {
 public:
  /// Bounds of what moves in this frame, m; nothing where it cannot be told what they change: it emits.
  std::optional<std::vector<Bounds>> moving(PassContext& frame);

  /// Nothing where changes cannot be told: no static fragments are known apart, or light comes from elsewhere
  /// than from the lights. Media that move are the caller's to exclude.
  std::optional<StaticLight> staticLight(PassContext& frame, const VoxelFragments& list,
                                         const In<ShadowMap>& shadow, float brightest);

  // Of a frame that has a StaticLight.
  /// This moment, for what is made of all fragments in the light of this frame.
  LitMoment momentOfAll(PassContext& frame, const VoxelFragments& list);
  /// This moment, for what is made of static fragments alone.
  LitMoment momentOfStatic(PassContext& frame, const VoxelFragments& list);
  /// Cells in which this frame differs from what was made at a moment: those of moving fragments, now and
  /// then, and those to which light comes past what moves, now or then. A moment of all fragments becomes
  /// this one.
  ChangedCells since(PassContext& frame, const VoxelFragments& list, const In<ShadowMap>& shadow,
                     LitMoment& moment);

 private:
  std::vector<std::vector<Bounds>> atRest_;  ///< of draws, in their order: of runs of triangles; object space
};

}  // namespace lumivox
