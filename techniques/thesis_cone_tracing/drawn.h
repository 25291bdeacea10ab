// Passes over all voxels, by a compute shader or by a draw without attributes (thesis Gomes 2015, Sec. 4.2.1,
// Table 1). GLSL side: shaders/thesis_cone_tracing/drawn.glsl.
#pragma once

#include <fmt/format.h>

#include "lumivox/base/error.h"
#include "lumivox/plugin/technique.h"

namespace lumivox::thesis_cone_tracing {

/// What the parameter `drawn` of a pass means.
inline constexpr const char* kDrawnMeaning =
    "voxels are the vertices of a draw without attributes (Table 1); off: invocations of a compute shader";

/// The two programs of a pass over voxels, and the number of images that they store to.
struct VoxelPrograms {
  shader::ProgramName compute, drawn;
  int images = 1;
};

/// Runs an invocation of one of them for each voxel of a volume, then a barrier. Error where the device's
/// vertex shaders cannot store to images, which OpenGL 4.5 does not demand. Vertices come in threes, as
/// invisible triangles, until the last voxel is reached.
inline void forEachVoxel(PassContext& frame, const VoxelPrograms& programs,
                         const shader::BindingSet& bindings, const glm::ivec3& size, bool drawn) {
  if (!drawn) {
    frame.dispatch(frame.program(programs.compute), bindings, size);
    return;
  }
  if (frame.device().info().vertexImages < programs.images)
    throw Error(fmt::format(
        "thesis_cone_tracing: 'drawn on' stores to {} images from a vertex shader, and this device allows {}; expected 'drawn off'",
        programs.images, frame.device().info().vertexImages));
  const std::uint64_t voxels = GridPlacement{.resolution = size}.voxelCount();
  {
    const gpu::Drawing drawing = frame.device().drawTo({.width = 1, .height = 1}, {});
    frame.shaders().draw(frame.program(programs.drawn), bindings,
                         static_cast<std::uint32_t>((voxels + 2) / 3 * 3));
  }
  frame.device().barrier();
}

}  // namespace lumivox::thesis_cone_tracing
