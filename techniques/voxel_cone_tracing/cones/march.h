// Cones through a store of light and opacity, as every pass that traces cones takes them: which store, and
// how they step through it. GLSL side: shaders/common/cone_march.glsl and
// shaders/voxel_cone_tracing/cones/store.glsl.
#pragma once

#include "../clipmap/radiance_clipmap.h"
#include "../octree/radiance_octree.h"
#include "lumivox/pipeline/ports/directional_radiance_grid.h"
#include "lumivox/plugin/technique.h"
#include "voxel_cone_tracing_shaders.h"

namespace lumivox::voxel_cone_tracing {

/// The bindings of a store, and what a pass must know of it. Named by name, so that every program that
/// includes store.glsl takes them.
struct StoreBinding : shader::BindingSet {
  int axis = 0;             ///< value of the shader's axis STORE
  int faces = 0;            ///< and of FACES
  float length = 0;         ///< no cone need be longer, m
  float voxel = 0;          ///< finest voxels, m
  GridPlacement grid;       ///< of the finest level
  int bounces = 1;          ///< times that light was reflected, as far as the store says
  bool holdsMedia = false;  ///< participating media are in the voxels
};

StoreBinding storeOf(const RadianceGrid& grid);
/// By layers, or filtered along all axes.
StoreBinding storeOf(const DirectionalRadianceGrid& grid, bool layers);
/// Of six faces by layers, or filtered along all axes.
StoreBinding storeOf(const RadianceOctree& octree, bool layers);
StoreBinding storeOf(const RadianceClipmap& clipmap, bool layers);

/// How cones step through a store; the meaning of each is that of the parameter of its name (ConeMarch).
struct MarchSettings {
  float step = 0.5f, offset = 1.0f, start = 1.0f, clearance = 0.5f, footprint = 0.5f, refinement = 0.5f;
  float reach = 0.0f, jitter = 0.0f;
  /// The block March for cones through this store.
  shader::BindingSet binding(const PassContext& frame, const StoreBinding& store) const;
};

/// The store that a pass reads, one of those that there are: members of the pass.
class StoreInput {
 public:
  explicit StoreInput(Pass* pass);
  /// Error where none of the inputs is connected, or more than one.
  StoreBinding binding() const;

 private:
  enum class Reading { layers, interpolated };

  In<RadianceGrid> grid_;
  In<DirectionalRadianceGrid> directions_;
  In<RadianceOctree> octree_;
  In<RadianceClipmap> clipmap_;
  Param<Reading> reading_;
};

/// Steps along cones: members of a pass.
class ConeMarch {
 public:
  explicit ConeMarch(Pass* pass);
  /// The block March for cones through this store.
  shader::BindingSet binding(const PassContext& frame, const StoreBinding& store) const;

 private:
  Param<float> step_, offset_, start_, clearance_, footprint_, refinement_, reach_, jitter_;
};

}  // namespace lumivox::voxel_cone_tracing
