// Sets of voxels and their differences.
#include <fmt/format.h>

#include <atomic>
#include <bit>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/measure/voxels.h"
#include "measure/voxel_resolution.h"

namespace lumivox {

VoxelSet::VoxelSet(const glm::ivec3& resolution) : resolution_(resolution) {
  constexpr int kMost = 4096;  // voxels along a side
  for (int axis = 0; axis < 3; ++axis)
    if (resolution[axis] < 0 || resolution[axis] > kMost)
      throw Error(fmt::format("a set of {} voxels: each side must be in 0..{}",
                              measure::resolutionText(resolution), kMost));
  const std::uint64_t voxels = static_cast<std::uint64_t>(resolution.x) *
                               static_cast<std::uint64_t>(resolution.y) *
                               static_cast<std::uint64_t>(resolution.z);
  const std::uint64_t words = (voxels + 63) / 64;
  constexpr std::uint64_t kWorthAsking = std::uint64_t{1} << 20;  // words
  if (words > kWorthAsking)
    requireMemory(words * sizeof(std::uint64_t),
                  fmt::format("a set of {} voxels", measure::resolutionText(resolution)));
  words_.resize(words);
}

void VoxelSet::insertShared(const glm::ivec3& voxel) {
  const std::uint64_t bit = bitOf(voxel);
  std::atomic_ref<std::uint64_t> word(words_[bit >> 6]);
  const std::uint64_t mask = std::uint64_t{1} << (bit & 63);
  if ((word.load(std::memory_order_relaxed) & mask) == 0) word.fetch_or(mask, std::memory_order_relaxed);
}

std::uint64_t VoxelSet::count() const {
  std::uint64_t count = 0;
  for (const std::uint64_t word : words_) count += static_cast<std::uint64_t>(std::popcount(word));
  return count;
}

double VoxelError::precision() const {
  const std::uint64_t claimed = truePositive + falsePositive;
  return claimed == 0 ? 1.0 : static_cast<double>(truePositive) / static_cast<double>(claimed);
}

double VoxelError::recall() const {
  const std::uint64_t present = truePositive + falseNegative;
  return present == 0 ? 1.0 : static_cast<double>(truePositive) / static_cast<double>(present);
}

namespace {

/// Whether the voxel and all its neighbours lie within the grid and are empty.
bool isBare(const VoxelSet& occupied, const glm::ivec3& voxel) {
  if (!occupied.inside(voxel - 1) || !occupied.inside(voxel + 1)) return false;
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x)
        if (occupied.contains(voxel + glm::ivec3(x, y, z))) return false;
  return true;
}

}  // namespace

VoxelError compareVoxels(const VoxelSet& occupied, const VoxelReference& reference) {
  measure::requireSameResolution(occupied, reference.certain);
  measure::requireSameResolution(occupied, reference.possible);
  VoxelError result;
  for (std::size_t i = 0; i < occupied.words().size(); ++i) {
    const std::uint64_t claimed = occupied.words()[i], certain = reference.certain.words()[i];
    const auto bits = [](std::uint64_t word) { return static_cast<std::uint64_t>(std::popcount(word)); };
    result.truePositive += bits(claimed & certain);
    result.falsePositive += bits(claimed & ~reference.possible.words()[i]);
    result.falseNegative += bits(certain & ~claimed);
    for (std::uint64_t open = reference.possible.words()[i] & ~certain; open != 0; open &= open - 1) {
      const std::uint64_t bit = 64 * i + static_cast<std::uint64_t>(std::countr_zero(open));
      if (isBare(occupied, occupied.voxelOf(bit))) ++result.falseNegative;
    }
  }
  return result;
}

}  // namespace lumivox
