// What passes over a sparse voxel octree share.
#pragma once

#include "lumivox/plugin/technique.h"
#include "radiance_octree.h"
#include "voxel_cone_tracing_shaders.h"

namespace lumivox::voxel_cone_tracing {

/// The nodes of an octree (shaders/voxel_cone_tracing/octree.glsl, octree_levels.glsl).
class OctreeBinding : public shader::BindingSet {
 public:
  explicit OctreeBinding(const VoxelOctree& tree, int poolShift = 0);
};

/// `threads` invocations for each brick of a depth, and for those of all depths where it is that of the
/// leaves and one more; the tree is bound besides, a barrier follows.
void forEachBrick(PassContext& frame, const shader::BoundProgram& program, const shader::BindingSet& bindings,
                  const VoxelOctree& tree, int depth, int threads);

}  // namespace lumivox::voxel_cone_tracing
