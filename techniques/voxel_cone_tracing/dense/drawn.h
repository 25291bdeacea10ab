// Voxels as the vertices of a draw without attributes, in place of the invocations of a compute shader
// (thesis Gomes 2015, Sec. 4.2.1, Table 1). GLSL side: shaders/voxel_cone_tracing/dense/drawn.glsl.
#pragma once

#include <fmt/format.h>

#include "lumivox/base/error.h"
#include "lumivox/plugin/technique.h"

namespace lumivox::voxel_cone_tracing {

/// What the parameter `drawn` of a pass means.
inline constexpr const char* kDrawnMeaning =
    "voxels are the vertices of a draw without attributes, as published for comparison (thesis Table 1); off: invocations of a compute shader";

/// One vertex for each voxel of a volume, whose shader stores to so many images, and a barrier. Error where
/// the device has no such vertex shaders: OpenGL 4.5 asks for none. Vertices come in threes, as triangles
/// that lie outside of what is seen: as many as are needed to reach the last voxel.
inline void drawVoxels(PassContext& frame, const shader::BoundProgram& program,
                       const shader::BindingSet& bindings, const glm::ivec3& size, int images = 1) {
  if (frame.device().info().vertexImages < images)
    throw Error(fmt::format(
        "voxel_cone_tracing: 'drawn on' stores to {} images from a vertex shader, and this device allows {}; expected 'drawn off'",
        images, frame.device().info().vertexImages));
  const std::uint64_t voxels = GridPlacement{.resolution = size}.voxelCount();
  {
    const gpu::Drawing drawing = frame.device().drawTo({.width = 1, .height = 1}, {});
    frame.shaders().draw(program, bindings, static_cast<std::uint32_t>((voxels + 2) / 3 * 3));
  }
  frame.device().barrier();
}

}  // namespace lumivox::voxel_cone_tracing
