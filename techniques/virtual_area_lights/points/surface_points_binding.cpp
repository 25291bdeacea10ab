#include "surface_points_binding.h"

namespace lumivox::virtual_area_lights {

using gpu::Sampling;
using shader::SampledSlot;
using shader::StorageSlot;

namespace {

/// Block PointGrid of surface_points.glsl.
struct alignas(16) PointGridBlock {
  glm::vec3 low;
  float cellsPerMetre;
  glm::ivec3 cells;
  std::int32_t count;
  float spacing, farthest;
};

}  // namespace

SurfacePointsBinding::SurfacePointsBinding(const SurfacePoints& points)
    : BindingSet{SampledSlot{"pointPosition"}(points.position, Sampling::nearest),
                 SampledSlot{"pointNormal"}(points.normal, Sampling::nearest),
                 SampledSlot{"pointRadius"}(points.radius, Sampling::nearest),
                 StorageSlot{"PointCells"}(points.cells), StorageSlot{"PointCandidates"}(points.candidates)} {
  const GridPlacement& grid = points.grid;
  add(shader::UniformSlot<PointGridBlock>{"PointGrid"}(
      {grid.low, points.stride > 0 ? 0.0f : 1.0f / grid.voxelSize, grid.resolution, points.count, points.spacing, points.farthest}));
}

}  // namespace lumivox::virtual_area_lights
