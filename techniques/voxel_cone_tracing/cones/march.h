// Cones through a store of light and opacity, for all passes that trace cones: the store, and how cones step
// through it. GLSL side: shaders/common/cone_march.glsl and shaders/voxel_cone_tracing/cones/store.glsl.
#pragma once

#include "../clipmap/radiance_clipmap.h"
#include "../octree/radiance_octree.h"
#include "lumivox/pipeline/ports/directional_radiance_grid.h"
#include "lumivox/plugin/technique.h"
#include "voxel_cone_tracing_shaders.h"

namespace lumivox::voxel_cone_tracing {

/// The bindings and properties of a store. Bindings go by name, so that every program that includes
/// store.glsl takes them.
struct StoreBinding : shader::BindingSet {
  int axis = 0;             ///< value of the shader's axis STORE
  int faces = 0;            ///< and of FACES
  float length = 0;         ///< longest useful cone, m
  float voxel = 0;          ///< finest voxels, m
  GridPlacement grid;       ///< of the finest level
  int bounces = 1;          ///< number of reflections of the stored light
  bool holdsMedia = false;  ///< whether the voxels hold participating media
};

StoreBinding storeOf(const RadianceGrid& grid);
/// Reads by layers, or filtered along all axes.
StoreBinding storeOf(const DirectionalRadianceGrid& grid, bool layers);
/// With six faces it reads by layers, or filtered along all axes.
StoreBinding storeOf(const RadianceOctree& octree, bool layers);
StoreBinding storeOf(const RadianceClipmap& clipmap, bool layers);

/// How cones step through a store; each member has the meaning of ConeMarch's parameter of its name.
struct MarchSettings {
  float step = 0.5f, offset = 1.0f, start = 1.0f, clearance = 0.5f, footprint = 0.5f, refinement = 0.5f;
  float reach = 0.0f, jitter = 0.0f;
  /// The block March for cones through this store.
  shader::BindingSet binding(const PassContext& frame, const StoreBinding& store) const;
};

/// The inputs for the one store that a pass reads, as members of the pass.
class StoreInput {
 public:
  explicit StoreInput(Pass* pass);
  /// Error unless exactly one of the inputs is connected.
  StoreBinding binding() const;

 private:
  enum class Reading { layers, interpolated };

  In<RadianceGrid> grid_;
  In<DirectionalRadianceGrid> directions_;
  In<RadianceOctree> octree_;
  In<RadianceClipmap> clipmap_;
  Param<Reading> reading_;
};

/// The parameters of steps along cones, as members of a pass.
class ConeMarch {
 public:
  explicit ConeMarch(Pass* pass);
  /// The block March for cones through this store.
  shader::BindingSet binding(const PassContext& frame, const StoreBinding& store) const;

 private:
  Param<float> step_, offset_, start_, clearance_, footprint_, refinement_, reach_, jitter_;
};

}  // namespace lumivox::voxel_cone_tracing
