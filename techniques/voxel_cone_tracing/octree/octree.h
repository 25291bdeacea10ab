// What passes over a sparse voxel octree share.
#pragma once

#include "../voxel_sums.h"
#include "lumivox/plugin/technique.h"
#include "radiance_octree.h"
#include "voxel_cone_tracing_shaders.h"

namespace lumivox::voxel_cone_tracing {

/// The nodes of an octree (shaders/voxel_cone_tracing/octree/octree.glsl, octree_levels.glsl).
class OctreeBinding : public shader::BindingSet {
 public:
  explicit OctreeBinding(const VoxelOctree& tree, int poolShift = 0);
};

/// What a shader with the axis CHANGED copies of static geometry; nothing where that is not known.
shader::BindingSet stillBinding(const RadianceOctree& octree);

/// `threads` invocations for each brick of a depth, and for those of all depths where it is that of the
/// leaves and one more; a barrier follows.
void forEachBrick(PassContext& frame, const shader::BoundProgram& program, const shader::BindingSet& bindings,
                  const VoxelOctree& tree, int depth, int threads);

/// Bytes of a voxel in the pool, all of its faces, and of the sums that fill one of a leaf.
struct VoxelBytes {
  std::uint64_t texels = 0, sums = 0;
};
/// Before anything of it is taken: Error where there is no room for an octree of such voxels, with what it
/// takes and the largest that fits. `holdsTree`: its nodes and tags are there already.
void requireRoom(PassContext& frame, const VoxelOctree& tree, const VoxelBytes& voxel, bool holdsTree);

/// Room for the bricks of result.tree, of result.faces each; and of such sums for each voxel of the leaves.
gpu::BufferRef makePool(PassContext& frame, RadianceOctree& result, gpu::Format format,
                        const shader::StorageSlot& sums);

/// Fills all levels above the leaves of an octree, seen through along the axis that they face; what its
/// `still` says has not changed is copied from there.
void fillLevels(PassContext& frame, RadianceOctree& octree);

/// The bricks of the leaves from the sums of their voxels. `coverageSum`: coverages add up.
void resolveLeaves(PassContext& frame, const RadianceOctree& octree, const VoxelSums& sums, bool coverageSum);

}  // namespace lumivox::voxel_cone_tracing
