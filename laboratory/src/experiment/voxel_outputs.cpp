// Reads the voxels that passes' outputs hold.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <set>

#include "lumivox/base/error.h"
#include "lumivox/experiment/voxelizers.h"
#include "lumivox/pipeline/pass.h"

namespace lumivox {
namespace {

/// Reads the voxels of one kind of source.
class Reader {
 public:
  explicit Reader(OccupiedVoxels& result) : result_(result) {}
  void operator()(const VoxelTexels& source);
  void operator()(const VoxelBits& source);
  void operator()(const VoxelList& source);
  void operator()(const VoxelsFilled&);
  void operator()(const VoxelsRead& source);

 private:
  void read(const gpu::Texture& texture, int level, int component);
  OccupiedVoxels& result_;
};

void Reader::operator()(const VoxelList& list) {
  std::uint32_t count = 0;
  const std::vector<std::byte> word = list.count->download(0, sizeof(count));
  std::memcpy(&count, word.data(), sizeof(count));
  result_.fragments = std::min<std::uint64_t>(count, list.capacity);
  result_.bytes = result_.fragments * list.itemBytes;
  if (result_.fragments == 0) return;
  // Reads through a small buffer, since a list may fill the device's memory.
  constexpr std::uint64_t kAtOnce = std::uint64_t{1} << 18;  // items
  std::vector<std::uint32_t> words(list.itemBytes / sizeof(std::uint32_t));
  for (std::uint64_t first = 0; first < result_.fragments; first += kAtOnce) {
    const std::uint64_t some = std::min(result_.fragments - first, kAtOnce);
    const std::vector<std::byte> bytes = list.items->download(first * list.itemBytes, some * list.itemBytes);
    for (std::uint64_t i = 0; i < some; ++i) {
      std::memcpy(words.data(), bytes.data() + i * list.itemBytes, list.itemBytes);
      const std::uint32_t packed = words[0];
      const glm::ivec3 voxel(packed & 1023u, packed >> 10 & 1023u, packed >> 20 & 1023u);
      if ((list.fills == nullptr || list.fills(words.data())) && result_.voxels.inside(voxel))
        result_.voxels.insert(voxel);
    }
  }
}

/// Whether a texel's channel is above 0.
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
      constexpr std::uint16_t kInfinity = 0x7c00;  // above it: NaN, or the sign bit
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

/// Collects voxels with a value above 0 in some channel, through a small buffer.
void Reader::operator()(const VoxelTexels& source) {
  for (const VoxelTexels::Channel& channel : source.channels)
    read(*source.textures.at(static_cast<std::size_t>(channel.texture)), source.level, channel.component);
}

void Reader::read(const gpu::Texture& texture, int level, int component) {
  const gpu::Format format = texture.description().format;
  const glm::ivec3& size = result_.grid.resolution;
  const std::size_t texelBytes = gpu::bytesPerTexel(format);
  std::vector<std::byte> slice(texelBytes * static_cast<std::size_t>(size.x) *
                               static_cast<std::size_t>(size.y));
  for (int z = 0; z < size.z; ++z) {
    texture.downloadSlices(level, z, 1, slice);
    const std::byte* texel = slice.data();
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x, texel += texelBytes)
        if (isPositive(format, texel, component)) result_.voxels.insert({x, y, z});
  }
}

void Reader::operator()(const VoxelBits& source) {
  const gpu::TextureDescription& description = source.stacks->description();
  const std::vector<std::byte> bytes = source.stacks->download(source.level);
  std::vector<std::uint32_t> words(bytes.size() / sizeof(std::uint32_t));
  std::memcpy(words.data(), bytes.data(), words.size() * sizeof(std::uint32_t));
  constexpr int kWords = BinaryGrid::kStack / 32;
  const glm::ivec3& size = result_.grid.resolution;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const int layer = z / BinaryGrid::kStack, bit = z % BinaryGrid::kStack;
        const std::size_t texel = (static_cast<std::size_t>(layer) * description.height + y) *
                                      static_cast<std::size_t>(description.width) +
                                  static_cast<std::size_t>(x);
        if (words[texel * kWords + static_cast<std::size_t>(bit / 32)] >> (bit % 32) & 1u)
          result_.voxels.insert({x, y, z});
      }
}

void Reader::operator()(const VoxelsFilled&) {
  const glm::ivec3& size = result_.grid.resolution;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) result_.voxels.insert({x, y, z});
}

void Reader::operator()(const VoxelsRead& source) {
  for (const VoxelsRead::Voxel& one : source.read())
    if (glm::any(glm::greaterThan(one.value, glm::vec3(0.0f))) && result_.voxels.inside(one.voxel))
      result_.voxels.insert(one.voxel);
}

}  // namespace

bool holdsVoxels(const PortKind& kind) {
  return !kind.occupancy.empty();
}

std::optional<OccupiedVoxels> occupiedVoxels(const OutBase& output) {
  const PortContents contents = output.contents();
  const PortContents::Occupancy* occupancy = contents.occupancy();
  if (occupancy == nullptr) return std::nullopt;
  OccupiedVoxels result{occupancy->grid, VoxelSet(occupancy->grid.resolution), 0, 0};
  std::visit(Reader(result), occupancy->source);
  if (std::holds_alternative<VoxelList>(occupancy->source)) return result;
  result.bytes = heldBytes(output);
  return result;
}

std::uint64_t heldBytes(const OutBase& output) {
  const PortContents contents = output.contents();
  std::uint64_t bytes = 0;
  std::set<const void*> counted;  // a resource may appear under two names
  for (const PortContents::Resource& resource : contents.resources()) {
    const void* which =
        resource.texture ? static_cast<const void*>(resource.texture.get()) : resource.buffer.get();
    if (!counted.insert(which).second) continue;
    bytes += resource.texture ? resource.texture->sizeBytes() : resource.buffer->sizeBytes();
  }
  return bytes;
}

std::optional<std::uint64_t> opaqueVoxels(const OutBase& output) {
  const PortContents contents = output.contents();
  for (const PortContents::Field& field : contents.fields()) {
    // Voxels with faces have one such field per axis.
    if ((field.name != "opacity" && field.name != "opacity_along") || field.level != 0) continue;
    GridPlacement grid;
    grid.resolution = field.box.resolution;
    OccupiedVoxels found{grid, VoxelSet(grid.resolution), 0, 0};
    std::visit(Reader(found), field.source);
    return found.voxels.count();
  }
  return std::nullopt;
}

}  // namespace lumivox
