#include "bit_voxelizer.h"

#include <algorithm>

namespace lumivox::voxelization {

using namespace shaders::voxelization;

namespace {

glm::ivec3 wordCount(const GridPlacement& grid) {
  constexpr int kWordBits = 32;
  return {grid.resolution.x, grid.resolution.y, (grid.resolution.z + kWordBits - 1) / kWordBits};
}

}  // namespace

shader::BindingSet BitWords::bindings() const {
  return {shader::ImageSlot{"words"}(voxels), shader::ImageSlot{"surfaceWords"}(surface)};
}

gpu::TextureRef bitWords(PassContext& frame, const GridPlacement& grid, const char* label) {
  return frame.emptyVolume(wordCount(grid), gpu::Format::r32ui, label);
}

gpu::TextureRef bitsOf(PassContext& frame, const VoxelFragments& fragments, const char* label, Masks masks) {
  gpu::TextureRef words = bitWords(frame, fragments.grid, label);
  forEachFragment(frame, frame.program(bits_mark::kProgram),
                  {bits_mark::words(words), bits_mark::maskRule({static_cast<int>(masks), seedWords(frame)})},
                  fragments);
  return words;
}

gpu::TextureRef bitsOf(PassContext& frame, const OccupancyGrid& opacity, const char* label, Masks masks) {
  const glm::ivec3 count = wordCount(opacity.grid);
  gpu::TextureRef words = frame.volume(count, gpu::Format::r32ui, label);
  frame.dispatch(frame.program(bits_cover::kProgram),
                 {bits_cover::words(words), bits_cover::opacity(opacity.opacity, gpu::Sampling::nearest),
                  bits_cover::maskRule({static_cast<int>(masks), seedWords(frame)})},
                 count);
  return words;
}

void BitVoxelizer::run(PassContext& frame) {
  const GridPlacement grid = surface() != nullptr ? surface()->grid : placement(frame);
  BitWords words;
  words.voxels =
      markedWords(frame, grid, wordCount(grid), "bits",
                  [&](const gpu::Texture& marked, const Draws& draws) { mark(frame, grid, marked, draws); });
  if (surface() != nullptr) words.surface = bitsOf(frame, *surface(), "bits of the surface");
  if (bits.wanted()) bits = binaryGridOf(frame, grid, words);
  if (opacity.wanted()) {
    opacity = OccupancyGrid{grid, frame.volume(grid.resolution, gpu::Format::r8, "opacity")};
    frame.dispatch(frame.program(bits_opacity::Variant{words.surface != nullptr}),
                   {words.bindings(), bits_opacity::opacity(opacity->opacity)}, grid.resolution);
  }
  if (fragments.wanted()) fragments = fragmentsOf(frame, grid, words);
}

BinaryGrid binaryGridOf(PassContext& frame, const GridPlacement& grid, const BitWords& words) {
  const int width = grid.resolution.x, height = grid.resolution.y,
            layers = (grid.resolution.z + BinaryGrid::kStack - 1) / BinaryGrid::kStack,
            levels = gpu::fullLevelCount(width, height);
  BinaryGrid result;
  result.grid = grid;
  result.stacks = frame.texture(
      {gpu::TextureKind::d2Array, gpu::Format::rgba32ui, width, height, layers, levels}, "voxel stacks");
  frame.dispatch(frame.program(bits_stack::Variant{words.surface != nullptr}),
                 {words.bindings(), bits_stack::stacks(result.stacks)}, {width, height, layers});
  for (int level = 1; level < levels; ++level)
    frame.dispatch(frame.program(bits_mip::kProgram),
                   {bits_mip::finer(result.stacks, level - 1), bits_mip::coarser(result.stacks, level)},
                   {std::max(width >> level, 1), std::max(height >> level, 1), layers});
  return result;
}

VoxelFragments BitVoxelizer::fragmentsOf(PassContext& frame, const GridPlacement& grid,
                                         const BitWords& words) {
  // A first guess: surfaces fill about as many voxels as six sides of the grid.
  const auto side = static_cast<std::uint64_t>(grid.longest());
  if (room_ == 0) room_ = 6 * side * side;
  const VoxelFragments list = listBehind(frame, grid, surface(), room_);
  frame.dispatch(frame.program(bits_fragments::Variant{words.surface != nullptr}),
                 {words.bindings(), appending(list)}, wordCount(grid));
  finishGuessed(frame, list.count, list.capacity, list.capacity - room_, room_);
  return list;
}

}  // namespace lumivox::voxelization
