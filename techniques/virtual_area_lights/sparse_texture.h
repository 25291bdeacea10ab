// Textures with a texel for each surface point.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "lumivox/pipeline/pass.h"
#include "points/surface_points_port.h"

namespace lumivox::virtual_area_lights {

/// A zero texel for each point.
inline gpu::TextureRef sparseTexture(PassContext& frame, const SurfacePoints& points,
                                     const std::string& label) {
  const glm::ivec2 size = SurfacePoints::sizeFor(points.count);
  gpu::TextureRef result =
      frame.texture({.format = gpu::Format::rgba32f, .width = size.x, .height = size.y}, label);
  result->clear(glm::vec4(0.0f));
  return result;
}

/// Runs an invocation for each point.
inline void forEachPoint(PassContext& frame, const shader::BoundProgram& program,
                         const shader::BindingSet& bindings, const SurfacePoints& points) {
  if (points.count > 0) frame.dispatchList(program, bindings, static_cast<std::uint64_t>(points.count));
}

}  // namespace lumivox::virtual_area_lights
