// Common parts of passes over the octree. GLSL side: shaders/thesis_cone_tracing/octree.glsl and
// octree_levels.glsl.
#pragma once

#include "lumivox/plugin/technique.h"
#include "octree_ports.h"
#include "thesis_cone_tracing_shaders.h"

namespace lumivox::thesis_cone_tracing {

/// The nodes of an octree, for programs that include octree.glsl.
class OctreeBinding : public shader::BindingSet {
 public:
  explicit OctreeBinding(const OctreeNodes& tree, int poolShift = 0);
};

/// Runs `threads` invocations for each brick of a depth, then a barrier.
void forEachBrick(PassContext& frame, const shader::BoundProgram& program, const shader::BindingSet& bindings,
                  const OctreeNodes& tree, int depth, int threads);

}  // namespace lumivox::thesis_cone_tracing
