// Averaged lights at vertices, as published (Lensing and Broll 2013, Sec. 3.2 steps 3 and 4).
#pragma once

#include <utility>

#include "../points/surface_points_binding.h"
#include "lumivox/plugin/technique.h"
#include "vertex_points.h"

namespace lumivox::virtual_area_lights {

struct VertexInputs {
  const GBuffer& gbuffer;
  const SurfacePoints& points;
  const VertexPoints& vertices;
  bool plain;      ///< takes what points reflect in place of their lights
  bool published;  ///< applies Eq. 13 as printed to glossy lights, too
};

/// The averaged light of points, mixed at the vertices of all meshes and interpolated over the triangles that
/// the camera sees, and its place: a texel a pixel.
using SeenLight = std::pair<gpu::TextureRef, gpu::TextureRef>;
SeenLight diffuseOverTriangles(PassContext& frame, const VertexInputs& inputs, const gpu::TextureRef& lights,
                               const gpu::TextureRef& places);
SeenLight glossyOverTriangles(PassContext& frame, const VertexInputs& inputs, const gpu::TextureRef& lights,
                              const gpu::TextureRef& places);

}  // namespace lumivox::virtual_area_lights
