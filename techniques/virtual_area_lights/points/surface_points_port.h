#pragma once

#include <algorithm>
#include <memory>

#include "lumivox/pipeline/port.h"
#include "surface_points.h"

namespace lumivox::virtual_area_lights {

/// Points spread over the surfaces, which move with them (surface_points.h). Point i is texel (i %
/// kWidth, i / kWidth); texels behind the last one hold zeros. The grid lists, cell by cell, every point that
/// may be among the `neighbours` nearest of some place of the surface in the cell, of any model and on either
/// side; cells are numbered with x fastest. GLSL side: shaders/virtual_area_lights/surface_points.glsl.
struct SurfacePoints {
  static constexpr int kWidth = 1024;
  gpu::TextureRef position, normal, radius;
  GridPlacement grid;
  gpu::BufferRef cells, candidates;
  int count = 0;
  int neighbours = 0;     ///< number of neighbours that the grid was made for: at most so many are found
  float spacing = 0.0f;   ///< m: side of the square that a point stands for, in the mean, at rest
  float farthest = 0.0f;  ///< m: how far away neighbours are sought; the nearest one may be farther
  /// Of points at pixels (pixels.cpp): so many along x and y, one at every `stride` pixels; 0 for points spread
  /// over triangles. Points at pixels have neither grid nor set.
  glm::ivec2 pixels{0};
  int stride = 0;
  std::shared_ptr<const SurfacePointSet> set;
  std::shared_ptr<const SurfacePointState> state;

  /// Size of a texture with a texel for each of so many points.
  static glm::ivec2 sizeFor(int points) { return {kWidth, std::max((points + kWidth - 1) / kWidth, 1)}; }
};

}  // namespace lumivox::virtual_area_lights

namespace lumivox {

template <>
struct PortTraits<virtual_area_lights::SurfacePoints> {
  static PortKind kind() {
    constexpr auto kAny = PortResource::Sign::any;
    return {
        "SurfacePoints",
        "points spread evenly over the surfaces, on the host and on the device",
        {{"position", "d2 rgba32f, a texel a point",
          "xyz posWorld, m; w area of the surface that the point represents, m^2", kAny},
         {"normal", "d2 rgba32f, a texel a point",
          "xyz unit normal to the point's side; w number of the model, 0 for static objects", kAny},
         {"radius", "d2 rgba32f, a texel a point",
          "x radius of the surface that the point represents, m; y Phong exponent; z 1 for a glossy surface, else 0; w 1 for a front side, 0 for the back of a point at the same position"},
         {"cells", "buffer",
          "uint for each cell: where its list begins in `candidates`; and one more for the end"},
         {"candidates", "buffer", "uint: numbers of points, ascending in each cell"}}};
  }
  static void contents(const virtual_area_lights::SurfacePoints& port, PortContents& contents) {
    contents.texture("position", port.position);
    contents.texture("normal", port.normal);
    contents.texture("radius", port.radius);
    contents.buffer("cells", port.cells);
    contents.buffer("candidates", port.candidates);
  }
};

}  // namespace lumivox
