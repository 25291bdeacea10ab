// Common parts of passes over a sparse voxel octree.
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

/// The static geometry that a shader with the axis CHANGED copies; empty where it is unknown.
shader::BindingSet stillBinding(const RadianceOctree& octree);

/// Runs `threads` invocations for each brick of a depth, or of all depths if it is one more than that of the
/// leaves; then a barrier.
void forEachBrick(PassContext& frame, const shader::BoundProgram& program, const shader::BindingSet& bindings,
                  const VoxelOctree& tree, int depth, int threads);

/// Bytes of a voxel in the pool with all of its faces, and of the sums that fill a leaf's voxel.
struct VoxelBytes {
  std::uint64_t texels = 0, sums = 0;
};
/// Checks, before any allocation, that an octree of such voxels fits. The Error names its bytes and the
/// largest one that fits. `holdsTree`: its nodes and tags already exist.
void requireRoom(PassContext& frame, const VoxelOctree& tree, const VoxelBytes& voxel, bool holdsTree);

/// Makes the pool for the bricks of result.tree with result.faces each. `bytesOfSums`: what fills a voxel of
/// the leaves beside it, for which there must be room too.
void makePool(PassContext& frame, RadianceOctree& result, gpu::Format format, std::uint64_t bytesOfSums);

/// Fills all levels above the leaves of an octree, composited along the axis that they face. Unchanged parts
/// are copied from `still`.
void fillLevels(PassContext& frame, RadianceOctree& octree);

/// Fills the bricks of the leaves from the sums of their voxels. `coverageSum`: coverages add up.
/// `reflected`: what voxels reflect beside the light of the sums (Bounces); null: nothing.
void resolveLeaves(PassContext& frame, const RadianceOctree& octree, const VoxelSums& sums, bool coverageSum,
                   const gpu::BufferRef& reflected = nullptr);

}  // namespace lumivox::voxel_cone_tracing
