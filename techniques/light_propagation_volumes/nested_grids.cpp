#include "nested_grids.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"

namespace lumivox::light_propagation_volumes {
namespace {

/// Empty cells between the scene and the border of the coarsest grid: half a cell is lost by the placement on
/// whole cells, and a surface on the bounds needs the cell behind it. The rest keeps such a surface a third
/// of a cell away from the nearest face in every level, so that rounding does not decide in which cell it
/// lies.
constexpr float kMargin = 1.5f + 1.0f / 6.0f;

/// The grid without the cells that the scene does not reach.
GridPlacement trimmed(const GridPlacement& grid, const Bounds& bounds) {
  GridPlacement result = grid;
  for (int axis = 0; axis < 3; ++axis) {
    const float low = (bounds.low[axis] - grid.low[axis]) / grid.voxelSize - kMargin + 0.5f;
    const float high = (bounds.high[axis] - grid.low[axis]) / grid.voxelSize + kMargin - 0.5f;
    const int last = grid.resolution[axis] - 1;
    const int first = std::clamp(static_cast<int>(std::floor(low)), 0, last);
    const int end = std::clamp(static_cast<int>(std::ceil(high)), first + 1, last + 1);
    result.low[axis] = grid.low[axis] + static_cast<float>(first) * grid.voxelSize;
    result.resolution[axis] = end - first;
  }
  return result;
}

}  // namespace

std::vector<GridPlacement> placeGrids(const SceneSnapshot& snapshot, int levels, int resolution,
                                      float finestExtent) {
  Bounds bounds = snapshot.gridBounds;
  if (bounds.empty) {
    bounds.low = glm::vec3(-0.5f);
    bounds.high = glm::vec3(0.5f);
  }
  const glm::vec3 size = bounds.high - bounds.low;
  const bool around = finestExtent > 0.0f;
  if (!around) {
    const float longest = std::max({size.x, size.y, size.z, 1e-6f});
    const auto cells = static_cast<float>(resolution);
    finestExtent = std::ldexp(longest * cells / (cells - 2.0f * kMargin), 1 - levels);
  }
  std::vector<GridPlacement> grids;
  for (int level = 0; level < levels; ++level) {
    const float extent = std::ldexp(finestExtent, level);
    glm::vec3 centre = snapshot.camera.eye;
    if (!around) {
      const float margin = kMargin * extent / static_cast<float>(resolution);
      for (int axis = 0; axis < 3; ++axis) {
        const float low = bounds.low[axis] - margin + 0.5f * extent,
                    high = bounds.high[axis] + margin - 0.5f * extent;
        centre[axis] = low < high ? std::clamp(centre[axis], low, high) : 0.5f * (low + high);
      }
    }
    const GridPlacement grid = placeNestedGrid(centre, finestExtent, resolution, level);
    grids.push_back(around ? grid : trimmed(grid, bounds));
  }
  return grids;
}

Channels coefficientTextures(PassContext& frame, const glm::ivec3& resolution, const std::string& label) {
  Channels result;
  for (std::size_t i = 0; i < 3; ++i)
    result[i] = frame.volume(resolution, gpu::Format::rgba32f, kRgb[i] + (" " + label));
  return result;
}

shader::BindingSet sampled(const Channels& channels, gpu::Sampling sampling,
                           const std::array<const char*, 3>& names) {
  shader::BindingSet set;
  for (std::size_t i = 0; i < 3; ++i) set.add(shader::SampledSlot{names[i]}(channels[i], sampling));
  return set;
}

gpu::ResourceBinding cellsBinding(const GridPlacement& grid) {
  return shader::UniformSlot<shaders::light_propagation_volumes::Cells>{"Cells"}(
      {grid.low, grid.voxelSize, grid.resolution});
}

shader::BindingSet sampled(const ShGrid::Level& level, gpu::Sampling sampling) {
  return {cellsBinding(level.grid), ShLevelBinding(level, sampling)};
}

shader::BindingSet images(const Channels& channels, const std::array<const char*, 3>& names) {
  shader::BindingSet set;
  for (std::size_t i = 0; i < 3; ++i) set.add(shader::ImageSlot{names[i]}(channels[i]));
  return set;
}

shader::BindingSet facesOf(const OccludedFaces::Level& faces, const ShGrid::Level& level) {
  const auto orUnread = [&](const gpu::TextureRef& texture) -> const gpu::TextureRef& {
    return texture ? texture : level.coefficients[0];
  };
  return {shader::SampledSlot{"occluded"}(orUnread(faces.occluded), gpu::Sampling::nearest),
          shader::SampledSlot{"moved"}(orUnread(faces.moved), gpu::Sampling::nearest)};
}

NestedGrids fluxIn(const In<ShGrid>& light) {
  return readShGrid(light, {.quantity = ShGrid::Quantity::flux}).levels;
}

void requireFaces(NestedGrids light, const In<OccludedFaces>& faces) {
  for (std::size_t i = 0; i < light.size(); ++i)
    if (!faces.present() || i >= faces->levels.size() || !faces->levels[i].occluded ||
        !faces->levels[i].moved)
      throw Error(fmt::format(
          "level {} of the light has no occluded faces or no moved surfaces; expected both at input 'faces', from "
          "an injection without 'as_published on'",
          i));
}

void requirePackedVoxels(NestedGrids light, const In<OccludedFaces>& faces) {
  for (std::size_t i = 0; i < light.size(); ++i)
    if (!faces.present() || i >= faces->levels.size() || !faces->levels[i].packed)
      throw Error(fmt::format(
          "level {} of the light has no packed voxels, whose normals occlude as published; expected them at "
          "input 'faces', from an injection by inject_voxels with 'voxels packed' or 'as_published on'",
          i));
}

}  // namespace lumivox::light_propagation_volumes
