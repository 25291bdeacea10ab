// Which voxels the outputs of passes hold.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "lumivox/base/error.h"
#include "lumivox/experiment/voxelisers.h"
#include "lumivox/pipeline/pass.h"

namespace lumivox {
namespace {

OccupiedVoxels voxelsIn(const VoxelFragments& list) {
  OccupiedVoxels result{list.grid, VoxelSet(list.grid.resolution), 0, 0};
  std::uint32_t count = 0;
  const std::vector<std::byte> word = list.count->download(0, sizeof(count));
  std::memcpy(&count, word.data(), sizeof(count));
  result.fragments = std::min<std::uint64_t>(count, list.capacity);
  result.bytes = result.fragments * VoxelFragments::kFragmentBytes;
  if (result.fragments == 0) return result;
  // Through a small buffer: a list may be as large as the device's memory.
  constexpr std::uint64_t kAtOnce = std::uint64_t{1} << 18;  // fragments
  for (std::uint64_t first = 0; first < result.fragments; first += kAtOnce) {
    const std::uint64_t some = std::min(result.fragments - first, kAtOnce);
    const std::vector<std::byte> bytes = list.fragments->download(first * VoxelFragments::kFragmentBytes,
                                                                  some * VoxelFragments::kFragmentBytes);
    for (std::uint64_t i = 0; i < some; ++i) {
      std::uint32_t words[VoxelFragments::kFragmentBytes / sizeof(std::uint32_t)];
      std::memcpy(words, bytes.data() + i * sizeof(words), sizeof(words));
      const std::uint32_t packed = words[0], coverage = words[4] >> 16;  // a half; its sign bit is never set
      const glm::ivec3 voxel(packed & 1023u, packed >> 10 & 1023u, packed >> 20 & 1023u);
      if (coverage != 0 && result.voxels.inside(voxel)) result.voxels.insert(voxel);
    }
  }
  return result;
}

/// Whether a value that a texture holds is above 0.
bool isPositive(gpu::Format format, const std::byte* texel, int channel) {
  switch (format) {
    case gpu::Format::r8:
    case gpu::Format::rgba8:
      return texel[channel] != std::byte{0};
    case gpu::Format::r16f:
    case gpu::Format::rg16f:
    case gpu::Format::rgba16f: {
      std::uint16_t half = 0;
      std::memcpy(&half, texel + static_cast<std::size_t>(channel) * sizeof(half), sizeof(half));
      constexpr std::uint16_t kInfinity = 0x7c00;  // above it: not a number, or the sign
      return half > 0 && half <= kInfinity;
    }
    case gpu::Format::r32f:
    case gpu::Format::rg32f:
    case gpu::Format::rgba32f: {
      float value = 0.0f;
      std::memcpy(&value, texel + static_cast<std::size_t>(channel) * sizeof(value), sizeof(value));
      return value > 0.0f;
    }
    default:
      throw Error(fmt::format("voxels in a texture of {}: expected numbers with fractions", name(format)));
  }
}

/// Voxels whose value in one channel of a texture is above 0; read through a small buffer.
OccupiedVoxels voxelsIn(const GridPlacement& grid, const gpu::Texture& texture, int channel) {
  OccupiedVoxels result{grid, VoxelSet(grid.resolution), 0, 0};
  const gpu::Format format = texture.description().format;
  const std::size_t texelBytes = gpu::bytesPerTexel(format);
  std::vector<std::byte> slice(texelBytes * static_cast<std::size_t>(grid.resolution.x) *
                               static_cast<std::size_t>(grid.resolution.y));
  for (int z = 0; z < grid.resolution.z; ++z) {
    texture.downloadSlices(0, z, 1, slice);
    const std::byte* texel = slice.data();
    for (int y = 0; y < grid.resolution.y; ++y)
      for (int x = 0; x < grid.resolution.x; ++x, texel += texelBytes)
        if (isPositive(format, texel, channel)) result.voxels.insert({x, y, z});
  }
  return result;
}

OccupiedVoxels voxelsIn(const BinaryGrid& binary) {
  OccupiedVoxels result{binary.grid, VoxelSet(binary.grid.resolution), 0, 0};
  const gpu::TextureDescription& description = binary.stacks->description();
  const std::vector<std::byte> bytes = binary.stacks->download();
  std::vector<std::uint32_t> words(bytes.size() / sizeof(std::uint32_t));
  std::memcpy(words.data(), bytes.data(), words.size() * sizeof(std::uint32_t));
  constexpr int kWords = BinaryGrid::kStack / 32;
  for (int z = 0; z < binary.grid.resolution.z; ++z)
    for (int y = 0; y < binary.grid.resolution.y; ++y)
      for (int x = 0; x < binary.grid.resolution.x; ++x) {
        const int layer = z / BinaryGrid::kStack, bit = z % BinaryGrid::kStack;
        const std::size_t texel = (static_cast<std::size_t>(layer) * description.height + y) *
                                      static_cast<std::size_t>(description.width) +
                                  static_cast<std::size_t>(x);
        if (words[texel * kWords + static_cast<std::size_t>(bit / 32)] >> (bit % 32) & 1u)
          result.voxels.insert({x, y, z});
      }
  return result;
}

template <class Port>
const Port* as(const OutBase& output) {
  return output.portKind() == Port::kPortKind && output.hasValue()
             ? &static_cast<const Out<Port>&>(output).value()
             : nullptr;
}

}  // namespace

bool holdsVoxels(const std::string& portKind) {
  return portKind == VoxelFragments::kPortKind || portKind == OccupancyGrid::kPortKind ||
         portKind == BinaryGrid::kPortKind || portKind == AttributeGrid::kPortKind;
}

std::optional<OccupiedVoxels> occupiedVoxels(const OutBase& output) {
  std::optional<OccupiedVoxels> result;
  std::vector<gpu::TextureRef> textures = output.textures();
  if (const auto* list = as<VoxelFragments>(output)) return voxelsIn(*list);
  if (const auto* grid = as<OccupancyGrid>(output)) result = voxelsIn(grid->grid, *grid->opacity, 0);
  if (const auto* grid = as<AttributeGrid>(output)) result = voxelsIn(grid->grid, *grid->albedo, 3);
  if (const auto* grid = as<BinaryGrid>(output)) {
    result = voxelsIn(*grid);
    textures = {grid->stacks};
  }
  if (result)
    for (const gpu::TextureRef& texture : textures)
      if (texture) result->bytes += texture->sizeBytes();
  return result;
}

}  // namespace lumivox
