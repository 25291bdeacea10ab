#include "lumivox/scene/medium.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "lumivox/base/file.h"

namespace lumivox {
namespace {

/// Four words to four words: hash4 of shaders/common/random.glsl.
glm::uvec4 hash4(glm::uvec4 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.w;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v.w += v.y * v.z;
  v ^= v >> 16u;
  v.x += v.y * v.w;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v.w += v.y * v.z;
  return v;
}

/// A number in (-1, 1), most often near 0, from the halves of a random word: exact in single precision.
float aroundZero(std::uint32_t word) {
  const std::uint32_t sum = (word >> 16) + (word & 0xffffu);
  return (static_cast<float>(sum) + 1.0f) * 0x1.0p-16f - 1.0f;
}
glm::vec3 aroundZero(const glm::uvec3& words) {
  return {aroundZero(words.x), aroundZero(words.y), aroundZero(words.z)};
}

}  // namespace

ParticleClock particleClock(const Medium& medium, double time) {
  const double lives = time / medium.life, whole = std::floor(lives);
  ParticleClock clock;
  clock.lives = static_cast<std::uint32_t>(static_cast<std::int64_t>(whole));
  // Rounding must not reach a whole life, an age that no particle has.
  clock.share = std::min(static_cast<float>(lives - whole), 0x1.fffffep-1f);
  return clock;
}

glm::vec4 particleAt(const Medium& medium, const ParticleClock& clock, std::uint32_t index) {
  // A particle's first hash gives its birth within a life; each life uses two further hashes.
  const float birth = static_cast<float>(hash4({index, 0u, medium.seed, 0u}).x >> 8) * 0x1.0p-24f;
  float lived = clock.share + birth;
  std::uint32_t life = clock.lives;
  if (lived >= 1.0f) {
    lived -= 1.0f;
    ++life;
  }
  const float age = lived * static_cast<float>(medium.life);
  const glm::vec3 start = aroundZero(glm::uvec3(hash4({index, 2u * life + 1u, medium.seed, 0u})));
  const glm::vec3 sideways = aroundZero(glm::uvec3(hash4({index, 2u * life + 2u, medium.seed, 0u})));
  const glm::vec3 velocity =
      sideways * static_cast<float>(medium.drift) + glm::vec3(0.0f, static_cast<float>(medium.rise), 0.0f);
  return {start * static_cast<float>(medium.spread) + velocity * age, age};
}

std::pair<glm::dvec3, glm::dvec3> particleBounds(const Medium& medium) {
  const double sideways = medium.spread + medium.drift * medium.life + medium.radius;
  const double travel = medium.rise * medium.life;
  return {medium.source - sideways + glm::dvec3(0.0, std::min(travel, 0.0), 0.0),
          medium.source + sideways + glm::dvec3(0.0, std::max(travel, 0.0), 0.0)};
}

Bounds mediumBounds(const Medium& medium, const SceneSnapshot& snapshot) {
  glm::dvec3 low, high;
  if (medium.volume != nullptr) {
    // Trilinear densities end half a voxel outside of the last centres.
    const DensityVolume& volume = *medium.volume;
    low = volume.low - 0.5 * volume.voxelSize;
    high = volume.low + volume.voxelSize * (glm::dvec3(volume.resolution) + 0.5);
  } else if (medium.particles > 0) {
    std::tie(low, high) = particleBounds(medium);
  } else if (medium.box) {
    std::tie(low, high) = *medium.box;
  } else {
    return snapshot.gridBounds;
  }
  Bounds bounds;
  bounds.grow(glm::vec3(low - snapshot.origin));
  bounds.grow(glm::vec3(high - snapshot.origin));
  return bounds;
}

DensityVolume particleDensity(const Medium& medium, double time, double voxelSize) {
  const auto [low, high] = particleBounds(medium);
  const glm::dvec3 extent = high - low;
  const double longest = std::max({extent.x, extent.y, extent.z});
  DensityVolume volume;
  volume.low = low;
  volume.voxelSize = std::max(voxelSize, longest / kLargestVolume);
  volume.resolution =
      glm::clamp(glm::ivec3(glm::ceil(extent / volume.voxelSize)), glm::ivec3(1), glm::ivec3(kLargestVolume));
  const glm::ivec3 size = volume.resolution;
  const auto count = std::uint64_t(size.x) * std::uint64_t(size.y) * std::uint64_t(size.z);
  requireMemory(count * sizeof(float), "the density of medium '" + medium.name + "'");
  volume.values.assign(count, 0.0f);

  const ParticleClock clock = particleClock(medium, time);
  const double radius = medium.radius / volume.voxelSize;  // in voxels from here on
  for (int i = 0; i < medium.particles; ++i) {
    const glm::dvec3 offset(particleAt(medium, clock, static_cast<std::uint32_t>(i)));
    const glm::dvec3 centre = (medium.source + offset - volume.low) / volume.voxelSize;
    const glm::ivec3 first = glm::max(glm::ivec3(glm::ceil(centre - radius - 0.5)), glm::ivec3(0));
    const glm::ivec3 last = glm::min(glm::ivec3(glm::floor(centre + radius - 0.5)), size - 1);
    for (int z = first.z; z <= last.z; ++z) {
      for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) {
          const glm::dvec3 path = (glm::dvec3(x, y, z) + 0.5 - centre) / radius;
          const double inside = 1.0 - glm::dot(path, path);
          if (inside <= 0.0) continue;
          const auto index =
              (static_cast<std::size_t>(z) * static_cast<std::size_t>(size.y) + static_cast<std::size_t>(y)) *
                  static_cast<std::size_t>(size.x) +
              static_cast<std::size_t>(x);
          volume.values[index] += static_cast<float>(inside * inside * inside);
        }
      }
    }
  }
  return volume;
}

}  // namespace lumivox
