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
  forEachFragment(frame, frame.program(bits_mark::Variant{}),
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
  frame.dispatch(frame.program(bits_stack::Variant{.surface = words.surface != nullptr}),
                 {words.bindings(), bits_stack::stacks(result.stacks)}, {width, height, layers});
  for (int level = 1; level < levels; ++level)
    frame.dispatch(frame.program(bits_mip::Variant{}),
                   {bits_mip::finer(result.stacks, level - 1), bits_mip::coarser(result.stacks, level)},
                   {std::max(width >> level, 1), std::max(height >> level, 1), layers});
  return result;
}

namespace {

/// State kept while the still fragments of a list are the same.
struct FollowedBits {
  gpu::TextureRef still, words;  ///< bits of still geometry, and of all geometry
  BinaryGrid grid;
  /// d2 r32ui with the levels of the stacks: 1 where something moves, 2 where something moved the frame
  /// before.
  gpu::TextureRef touched;
};
struct FollowedKey {
  gpu::BufferRef still;
  GridPlacement grid;
  Masks masks;
  bool operator==(const FollowedKey&) const = default;
};

FollowedBits stillBitsOf(PassContext& frame, const VoxelFragments& fragments, Masks masks) {
  VoxelFragments still = fragments;
  still.count = fragments.still;
  FollowedBits bits;
  bits.still = bitsOf(frame, still, "bits of what stands still", masks);
  const glm::ivec3 count = wordCount(fragments.grid);
  bits.words = frame.volume(count, gpu::Format::r32ui, "bits");
  frame.dispatch(frame.program(bits_copy::kProgram),
                 {bits_copy::source(bits.still), bits_copy::target(bits.words)}, count);
  bits.grid = binaryGridOf(frame, fragments.grid, {bits.words, nullptr});
  bits.touched = frame.texture({.format = gpu::Format::r32ui,
                                .width = count.x,
                                .height = count.y,
                                .levels = bits.grid.stacks->description().levels},
                               "columns with something that moves");
  bits.touched->clear(glm::vec4(0.0f));
  return bits;
}

}  // namespace

BinaryGrid followedGridOf(PassContext& frame, const VoxelFragments& fragments, Masks masks) {
  const FollowedBits& bits =
      frame.kept("bits of what stands still", FollowedKey{fragments.still, fragments.grid, masks},
                 [&] { return stillBitsOf(frame, fragments, masks); });
  const gpu::TextureDescription& size = bits.grid.stacks->description();
  const glm::ivec3 columns(size.width, size.height, 1);
  frame.dispatch(
      frame.program(bits_restore::kProgram),
      {bits_restore::still(bits.still), bits_restore::words(bits.words), bits_restore::touched(bits.touched)},
      columns);
  VoxelFragments moving = fragments;
  moving.count = fragments.moving;
  forEachFragment(frame, frame.program(bits_mark::Variant{.moving = 1}),
                  {bits_mark::words(bits.words), bits_mark::touched(bits.touched),
                   bits_mark::stillFragments(fragments.still),
                   bits_mark::maskRule({static_cast<int>(masks), seedWords(frame)})},
                  moving);
  frame.dispatch(frame.program(bits_stack::Variant{.touched = 1}),
                 {bits_stack::words(bits.words), bits_stack::stacks(bits.grid.stacks),
                  bits_stack::touched(bits.touched)},
                 {size.width, size.height, size.depth});
  for (int level = 1; level < size.levels; ++level)
    frame.dispatch(
        frame.program(bits_mip::Variant{.touched = 1}),
        {bits_mip::finer(bits.grid.stacks, level - 1), bits_mip::coarser(bits.grid.stacks, level),
         bits_mip::touchedFiner(bits.touched, level - 1), bits_mip::touchedCoarser(bits.touched, level)},
        {std::max(size.width >> level, 1), std::max(size.height >> level, 1), size.depth});
  return bits.grid;
}

VoxelFragments BitVoxelizer::fragmentsOf(PassContext& frame, const GridPlacement& grid,
                                         const BitWords& words) {
  // First guess: surfaces fill about as many voxels as the grid's six sides.
  const auto side = static_cast<std::uint64_t>(grid.longest());
  if (room_ == 0) room_ = 6 * side * side;
  const VoxelFragments list = listBehind(frame, grid, surface(), room_);
  frame.dispatch(frame.program(bits_fragments::Variant{words.surface != nullptr}),
                 {words.bindings(), appending(list)}, wordCount(grid));
  finishGuessed(frame, list.count, list.capacity, list.capacity - room_, room_);
  return list;
}

}  // namespace lumivox::voxelization
