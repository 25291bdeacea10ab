// Places the levels of a clipmap: thesis Gomes 2015, Sec. 3.5.1; Tanner et al. 1998.
#include <algorithm>
#include <cmath>

#include "clipmap.h"
#include "lumivox/toolkit/grid_placement.h"

namespace lumivox::voxel_cone_tracing {

namespace {

/// Largest number of a finest voxel.
constexpr double kFarthest = 1 << 27;

int halfDown(int value) {
  return value >= 0 ? value / 2 : -((1 - value) / 2);
}
int halfUp(int value) {
  return -halfDown(-value);
}
/// First or end of the voxels that lie in these finer ones.
glm::ivec3 halfDown(const glm::ivec3& v) {
  return {halfDown(v.x), halfDown(v.y), halfDown(v.z)};
}
glm::ivec3 halfUp(const glm::ivec3& v) {
  return {halfUp(v.x), halfUp(v.y), halfUp(v.z)};
}

}  // namespace

VoxelRange coarserTouching(const VoxelRange& finer) {
  return {halfDown(finer.first), halfUp(finer.end)};
}

ClipmapPlacement placeClipmap(const SceneSnapshot& snapshot, int resolution, int levels, float finestExtent) {
  ClipmapPlacement result;
  result.resolution = resolution;
  result.first.resize(static_cast<std::size_t>(levels));
  const bool holdsScene = !(finestExtent > 0.0f);
  const GridPlacement grid = placeGrid(snapshot.gridBounds, resolution);
  if (holdsScene) {
    result.origin = grid.low;
    result.voxelSize = std::ldexp(grid.voxelSize, 1 - levels);
    result.sceneSide = std::ldexp(static_cast<float>(resolution), levels - 1);
  } else {
    result.voxelSize = finestExtent / static_cast<float>(resolution);
    if (!snapshot.gridBounds.empty)
      for (int axis = 0; axis < 3; ++axis)
        for (const float end : {snapshot.gridBounds.low[axis], snapshot.gridBounds.high[axis]})
          result.sceneSide = std::max(result.sceneSide, 2.0f * std::abs(end) / result.voxelSize);
  }
  for (int level = levels - 1; level >= 0; --level) {
    const double size = std::ldexp(static_cast<double>(result.voxelSize), level);
    const glm::dvec3 middle =
        glm::round((glm::dvec3(snapshot.camera.eye) - glm::dvec3(result.origin)) / size);
    const double farthest = std::ldexp(kFarthest, -level);
    glm::ivec3& first = result.first[static_cast<std::size_t>(level)];
    first = glm::ivec3(glm::clamp(middle, glm::dvec3(-farthest), glm::dvec3(farthest))) - resolution / 2;
    if (holdsScene) {
      const glm::ivec3 scene = grid.resolution * (1 << (levels - 1 - level));
      result.scene.insert(result.scene.begin(), VoxelRange{glm::ivec3(0), scene});
      first = glm::clamp(first, glm::ivec3(0), glm::max(scene - resolution, glm::ivec3(0)));
    }
    if (level == levels - 1) continue;
    const glm::ivec3& coarser = result.first[static_cast<std::size_t>(level) + 1];
    first = glm::clamp(first, 2 * coarser, 2 * coarser + resolution);
  }
  return result;
}

ClipmapLayout layoutOf(const ClipmapPlacement& placement) {
  ClipmapLayout layout;
  const int resolution = placement.resolution, around = placement.levels();
  // Blocks of one period lie side by side, as many as fit into a layer of the first ones.
  const int width = std::max(resolution + 2, 2 * ((resolution + 1) / 2 + 3));
  glm::ivec3 cursor(0);
  int layer = 0, previous = 0;
  const auto place = [&](RadianceClipmap::Block& block, const VoxelRange& voxels, int period) {
    block.voxels = voxels;
    block.period = period;
    const int side = period + 2;
    if (side != previous) {  // a new layer for another size
      cursor = {0, 0, cursor.z + layer};
      layer = 0;
    }
    if (cursor.x + side > width) cursor = {0, cursor.y + previous, cursor.z};
    if (cursor.y + side > width) cursor = {0, 0, cursor.z + layer};
    block.texel = cursor + 1;
    block.word = static_cast<std::uint32_t>(layout.words);
    const auto bits = static_cast<std::uint64_t>(period) * static_cast<std::uint64_t>(period) *
                      static_cast<std::uint64_t>(period);
    layout.words += (bits + 31) / 32;
    cursor.x += side;
    layer = previous = side;
  };
  for (int level = 0; level < around; ++level) {
    RadianceClipmap::Level& made = layout.levels.emplace_back();
    const VoxelRange range = placement.rangeOf(level);
    place(made.own, range, resolution);
    made.reachFirst = range.first;
    made.reachEnd = range.end;
    if (placement.scene.empty()) continue;
    const VoxelRange& scene = placement.scene[static_cast<std::size_t>(level)];
    for (int axis = 0; axis < 3; ++axis) {
      if (range.first[axis] <= scene.first[axis]) made.reachFirst[axis] = -RadianceClipmap::kEndless;
      if (range.end[axis] >= scene.end[axis]) made.reachEnd[axis] = RadianceClipmap::kEndless;
    }
  }
  for (int level = 1; level < around; ++level) {
    const VoxelRange finer = placement.rangeOf(level - 1);
    place(layout.levels[static_cast<std::size_t>(level)].inner, {halfUp(finer.first), halfDown(finer.end)},
          (resolution + 1) / 2);
  }
  VoxelRange range = placement.rangeOf(around - 1);
  for (int size = resolution; size > 1; size = (size + 1) / 2) {
    range = coarserTouching(range);
    RadianceClipmap::Level& made = layout.levels.emplace_back();
    // A range that begins at an odd voxel reaches into one more.
    place(made.own, range, (size + 1) / 2 + (placement.scene.empty() ? 1 : 0));
    made.reachFirst = glm::vec3(-RadianceClipmap::kEndless);
    made.reachEnd = glm::vec3(RadianceClipmap::kEndless);
  }
  layout.volume = {width, width, cursor.z + layer};
  return layout;
}

gpu::ResourceBinding clipmapBinding(const RadianceClipmap& clipmap) {
  namespace code = shaders::voxel_cone_tracing::clipmap_clear;
  code::Clipmap block{.clipmapOrigin = clipmap.origin,
                      .clipmapVoxel = clipmap.voxelSize,
                      .clipmapLevels = clipmap.around,
                      .clipmapAll = static_cast<int>(clipmap.levels.size()),
                      .clipmapBorder = clipmap.border,
                      .clipmapRamp = clipmap.ramp};
  for (std::size_t i = 0; i < clipmap.levels.size(); ++i) {
    const RadianceClipmap::Level& level = clipmap.levels.at(i);
    block.ownFirst[i] = {level.own.voxels.first, level.own.period};
    block.ownEnd[i] = {level.own.voxels.end, static_cast<int>(level.own.word)};
    block.ownTexel[i] = {level.own.texel, 0};
    block.ownStart[i] = {VoxelRange::addressOf(level.own.voxels.first, level.own.period), 0};
    block.innerStart[i] = {VoxelRange::addressOf(level.inner.voxels.first, level.inner.period), 0};
    block.innerFirst[i] = {level.inner.voxels.first, level.inner.period};
    block.innerEnd[i] = {level.inner.voxels.end, static_cast<int>(level.inner.word)};
    block.innerTexel[i] = {level.inner.texel, 0};
    block.reachFirst[i] = {level.reachFirst, 0.0f};
    block.reachEnd[i] = {level.reachEnd, 0.0f};
  }
  return shader::UniformSlot<code::Clipmap>{"Clipmap"}(block);
}

shader::BindingSet facesOf(const std::array<gpu::TextureRef, 6>& faces, gpu::Sampling sampling) {
  constexpr std::array kFaces = {"positiveX", "negativeX", "positiveY",
                                 "negativeY", "positiveZ", "negativeZ"};
  shader::BindingSet result;
  for (std::size_t face = 0; face < kFaces.size(); ++face)
    result.add(shader::SampledSlot{kFaces[face]}(faces[face], sampling));
  return result;
}

shader::BindingSet writing(const RadianceClipmap& clipmap) {
  namespace code = shaders::voxel_cone_tracing::clipmap_clear;
  return {clipmapBinding(clipmap),
          shader::StorageSlot{"ClipmapOccupied"}(clipmap.occupied),
          shader::ImageSlot{"positiveXImage"}(clipmap.faces[0]),
          shader::ImageSlot{"negativeXImage"}(clipmap.faces[1]),
          shader::ImageSlot{"positiveYImage"}(clipmap.faces[2]),
          shader::ImageSlot{"negativeYImage"}(clipmap.faces[3]),
          shader::ImageSlot{"positiveZImage"}(clipmap.faces[4]),
          shader::ImageSlot{"negativeZImage"}(clipmap.faces[5])};
}

}  // namespace lumivox::voxel_cone_tracing
