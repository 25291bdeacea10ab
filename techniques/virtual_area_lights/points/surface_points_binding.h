// Shader bindings of surface points.
#pragma once

#include "lumivox/pipeline/pass.h"
#include "surface_points_port.h"

namespace lumivox::virtual_area_lights {

/// Points spread over the surfaces, with their look-up grid
/// (shaders/virtual_area_lights/surface_points.glsl).
class SurfacePointsBinding : public shader::BindingSet {
 public:
  explicit SurfacePointsBinding(const SurfacePoints& points);
};

}  // namespace lumivox::virtual_area_lights
