#include "bit_voxelizer.h"

#include <algorithm>

#include "fragment_list.h"
#include "voxelization_shaders.h"

namespace lumivox::voxelization {

namespace copyShader = shaders::voxelization::bits_copy;
namespace markShader = shaders::voxelization::bits_mark;
namespace stackShader = shaders::voxelization::bits_stack;
namespace mipShader = shaders::voxelization::bits_mip;
namespace opacityShader = shaders::voxelization::bits_opacity;
namespace fragmentShader = shaders::voxelization::bits_fragments;

namespace {

constexpr int kWordBits = 32;

glm::ivec3 wordCount(const GridPlacement& grid) {
  return {grid.resolution.x, grid.resolution.y, (grid.resolution.z + kWordBits - 1) / kWordBits};
}

}  // namespace

const gpu::Texture& BitVoxelizer::surfaceOf(const Words& words) {
  return words.surface != nullptr ? *words.surface : *words.voxels;
}

gpu::TextureRef bitWords(PassContext& frame, const GridPlacement& grid, const char* label) {
  gpu::TextureRef words = frame.volume(wordCount(grid), gpu::Format::r32ui, label);
  words->clear(glm::vec4(0.0f));
  return words;
}

void markFragments(PassContext& frame, const VoxelFragments& fragments, const gpu::Texture& words) {
  forEachFragment(frame, frame.program(markShader::kProgram), {markShader::words(words)}, fragments);
}

gpu::TextureRef BitVoxelizer::wordsOf(PassContext& frame, const GridPlacement& grid) {
  const auto [still, moving] = drawsByMotion(frame);
  const auto make = [&, &draws = still] {
    gpu::TextureRef words = bitWords(frame, grid, "bits of static geometry");
    if (!draws.empty()) mark(frame, grid, *words, draws);
    return words;
  };
  const gpu::TextureRef first =
      still.empty() ? make() : frame.kept("bits of static geometry", staticKey(frame, grid, still), make);
  if (moving.empty()) return first;
  const gpu::TextureRef words = bitWords(frame, grid, "bits");
  frame.dispatch(frame.program(copyShader::kProgram),
                 {copyShader::source(*first), copyShader::target(*words)}, wordCount(grid));
  mark(frame, grid, *words, moving);
  return words;
}

void BitVoxelizer::run(PassContext& frame) {
  const GridPlacement grid = surface() != nullptr ? surface()->grid : placement(frame);
  Words words{wordsOf(frame, grid), nullptr};
  if (surface() != nullptr) {
    words.surface = bitWords(frame, grid, "bits of the surface");
    markFragments(frame, *surface(), *words.surface);
  }
  if (bits.wanted()) bits = binaryGridOf(frame, grid, *words.voxels, words.surface.get());
  if (opacity.wanted()) opacity = opacityOf(frame, grid, words);
  if (fragments.wanted()) fragments = fragmentsOf(frame, grid, words);
}

BinaryGrid binaryGridOf(PassContext& frame, const GridPlacement& grid, const gpu::Texture& voxels,
                        const gpu::Texture* surface) {
  BinaryGrid result;
  result.grid = grid;
  gpu::TextureDescription description;
  description.kind = gpu::TextureKind::d2Array;
  description.format = gpu::Format::rgba32ui;
  description.width = grid.resolution.x;
  description.height = grid.resolution.y;
  description.depth = (grid.resolution.z + BinaryGrid::kStack - 1) / BinaryGrid::kStack;
  description.levels = gpu::fullLevelCount(grid.resolution.x, grid.resolution.y);
  result.stacks = frame.texture(description, "voxel stacks");
  frame.dispatch(
      frame.program(stackShader::Variant{surface != nullptr}),
      {stackShader::words(voxels), stackShader::surfaceWords(surface != nullptr ? *surface : voxels),
       stackShader::stacks(*result.stacks)},
      {description.width, description.height, description.depth});
  for (int level = 1; level < description.levels; ++level)
    frame.dispatch(frame.program(mipShader::kProgram),
                   {mipShader::finer(*result.stacks, level - 1), mipShader::coarser(*result.stacks, level)},
                   {std::max(description.width >> level, 1), std::max(description.height >> level, 1),
                    description.depth});
  return result;
}

OccupancyGrid BitVoxelizer::opacityOf(PassContext& frame, const GridPlacement& grid,
                                      const Words& words) const {
  OccupancyGrid result;
  result.grid = grid;
  result.opacity = frame.volume(grid.resolution, gpu::Format::r8, "opacity");
  frame.dispatch(frame.program(opacityShader::Variant{words.surface != nullptr}),
                 {opacityShader::words(*words.voxels), opacityShader::surfaceWords(surfaceOf(words)),
                  opacityShader::opacity(*result.opacity)},
                 grid.resolution);
  return result;
}

VoxelFragments BitVoxelizer::fragmentsOf(PassContext& frame, const GridPlacement& grid, const Words& words) {
  // A first guess: surfaces fill about as many voxels as six sides of the grid.
  const auto side =
      static_cast<std::uint64_t>(std::max({grid.resolution.x, grid.resolution.y, grid.resolution.z}));
  if (room_ == 0) room_ = 6 * side * side;
  const VoxelFragments list = listBehind(frame, grid, surface(), room_);
  frame.dispatch(
      frame.program(fragmentShader::Variant{words.surface != nullptr}),
      {fragmentShader::parameters({static_cast<int>(list.capacity)}), fragmentShader::words(*words.voxels),
       fragmentShader::surfaceWords(surfaceOf(words)), appending(list)},
      wordCount(grid));
  finishList(frame, list);
  frame.judgeLater(
      list.count, kWantedOffset,
      [this, room = room_, base = list.capacity - room_](PassContext& done, std::uint32_t count) {
        const bool fits = count <= base + room;
        if (!fits) room_ = roomFor(count - base, done.traits().movingGeometry);
        return fits;
      });
  return list;
}

}  // namespace lumivox::voxelization
