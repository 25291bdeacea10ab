#include "nested_grids.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/toolkit/light_samples.h"

namespace lumivox::light_propagation_volumes {
namespace {

/// Empty cells between the scene and the border of the coarsest grid: half a cell is lost by the placement on
/// whole cells, and a surface on the bounds needs the cell behind it. The rest keeps such a surface a third
/// of a cell away from the nearest face in every level, so that rounding does not decide in which cell it
/// lies.
constexpr float kMargin = 1.5f + 1.0f / 6.0f;

/// Without the cells that the scene does not reach.
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

float largestFlux(const Scene& scene, const SceneSnapshot& snapshot) {
  const float radius = 0.5f * glm::length(snapshot.bounds.high - snapshot.bounds.low) * 1.01f;
  constexpr int kEmitters = 64;  // samples of the emissive triangles: only their sum counts
  float sum = 0.0f;
  for (const LightSampleData& light : sampleLights(scene, snapshot, kEmitters, 1).samples) {
    const float power = std::max({light.power.x, light.power.y, light.power.z});
    const auto kind = static_cast<LightSampleKind>(static_cast<int>(light.positionKind.w));
    // Through the sphere around the scene; over all directions; over the half sphere of a Lambert emitter.
    if (kind == LightSampleKind::directional) sum += power * glm::pi<float>() * radius * radius;
    if (kind == LightSampleKind::point || kind == LightSampleKind::spot)
      sum += power * 4.0f * glm::pi<float>();
    // Samples go by luminance: twice, for emitters of other colours.
    if (kind == LightSampleKind::area) sum += 2.0f * power * glm::pi<float>();
  }
  return sum > 0.0f && std::isfinite(sum) ? sum : 1.0f;
}

gpu::TextureRef cellTexture(PassContext& frame, const glm::ivec3& resolution, gpu::Format format,
                            const std::string& label) {
  gpu::TextureDescription description;
  description.kind = gpu::TextureKind::d3;
  description.format = format;
  description.width = resolution.x;
  description.height = resolution.y;
  description.depth = resolution.z;
  return frame.texture(description, label);
}

std::array<gpu::TextureRef, 3> coefficientTextures(PassContext& frame, const glm::ivec3& resolution,
                                                   const std::string& label) {
  std::array<gpu::TextureRef, 3> result;
  const char* const channels[] = {"red ", "green ", "blue "};
  for (std::size_t i = 0; i < 3; ++i)
    result[i] = cellTexture(frame, resolution, gpu::Format::rgba32f, channels[i] + label);
  return result;
}

const gpu::Texture& facesOrUnread(const gpu::TextureRef& faces, const ShGrid::Level& level) {
  return faces ? *faces : *level.coefficients[0];
}

void requireFaces(const ShGrid& light) {
  for (std::size_t i = 0; i < light.levels.size(); ++i)
    if (!light.levels[i].closed || !light.levels[i].moved)
      throw Error(fmt::format(
          "level {} of the light has no closed faces or no moved surfaces; expected both, from an injection "
          "without 'as_published on'",
          i));
}

void requirePackedVoxels(const ShGrid& light) {
  for (std::size_t i = 0; i < light.levels.size(); ++i)
    if (!light.levels[i].packed)
      throw Error(fmt::format(
          "level {} of the light has no packed voxels, whose normals occlude as published; expected an "
          "injection by inject_voxels with 'voxels packed' or 'as_published on'",
          i));
}

}  // namespace lumivox::light_propagation_volumes
