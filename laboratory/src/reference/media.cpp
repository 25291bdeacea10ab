#include "reference/media.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lumivox/base/file.h"
#include "reference/sampling.h"

namespace lumivox::reference {
namespace {

float largestOf(const glm::vec3& rgb) {
  return std::max({rgb.x, rgb.y, rgb.z});
}

/// Particles' clouds are sampled at this share of their radius R. Trilinear interpolation at spacing h errs
/// by up to h^2/8 times the second derivative along each axis; that of (1 - q^2)^3 is at most 6 / R^2, so
/// this is 3.5 % in the middle of a lone cloud, where it is worst, and far less where many overlap.
constexpr double kCloudSpacing = 0.125;

/// Ratio tracking applies Russian roulette below this transmittance.
constexpr float kFaint = 0.05f;

}  // namespace

float phase(float anisotropy, float cosine) {
  const float g = anisotropy;
  // 1 + g^2 - 2 g cos, in a form without cancellation for nearly straight directions.
  const float denominator = g >= 0.0f ? (1.0f - g) * (1.0f - g) + 2.0f * g * (1.0f - cosine)
                                      : (1.0f + g) * (1.0f + g) - 2.0f * g * (1.0f + cosine);
  return (1.0f - g) * (1.0f + g) / (4.0f * kPi * denominator * std::sqrt(denominator));
}

float samplePhaseCosine(float anisotropy, float u) {
  const float g = anisotropy;
  const float even = 1.0f - 2.0f * u;
  constexpr float kNearlyEven = 1e-3f;  // below it the inversion is less accurate than its first-order series
  if (std::abs(g) < kNearlyEven) return even + 1.5f * g * (1.0f - even * even);
  const float ratio = (1.0f - g * g) / (1.0f + g - 2.0f * g * u);
  return glm::clamp((1.0f + g * g - ratio * ratio) / (2.0f * g), -1.0f, 1.0f);
}

// ---- densities

Media::Field::Field(const DensityVolume& volume, const glm::dvec3& snapshotOrigin)
    : low(volume.low + 0.5 * volume.voxelSize - snapshotOrigin),
      voxelSize(static_cast<float>(volume.voxelSize)),
      resolution(volume.resolution),
      values(volume.values),
      blocksLow(volume.low - 0.5 * volume.voxelSize - snapshotOrigin),
      blocks((volume.resolution + kBlock) / kBlock) {
  // Block b holds the points whose eight centres are b*kBlock-1 .. (b+1)*kBlock-1 along each axis.
  majorants.assign(static_cast<std::size_t>(blocks.x) * static_cast<std::size_t>(blocks.y) *
                       static_cast<std::size_t>(blocks.z),
                   0.0f);
  std::size_t i = 0;
  for (int z = 0; z < resolution.z; ++z) {
    for (int y = 0; y < resolution.y; ++y) {
      for (int x = 0; x < resolution.x; ++x) {
        const float value = values[i++];
        if (value == 0.0f) continue;
        const glm::ivec3 voxel(x, y, z);
        const glm::ivec3 first = voxel / kBlock, last = (voxel + 1) / kBlock;
        for (int bz = first.z; bz <= last.z; ++bz)
          for (int by = first.y; by <= last.y; ++by)
            for (int bx = first.x; bx <= last.x; ++bx) {
              float& most = majorants[static_cast<std::size_t>((bz * blocks.y + by) * blocks.x + bx)];
              most = std::max(most, value);
            }
      }
    }
  }
}

float Media::Field::densityAt(const glm::vec3& position) const {
  const glm::vec3 place = (position - low) / voxelSize;
  const glm::vec3 floored = glm::floor(place), f = place - floored;
  const glm::ivec3 base(floored);
  const auto value = [&](int x, int y, int z) {
    const glm::ivec3 p = base + glm::ivec3(x, y, z);
    if (p.x < 0 || p.y < 0 || p.z < 0 || p.x >= resolution.x || p.y >= resolution.y || p.z >= resolution.z)
      return 0.0f;
    return values[(static_cast<std::size_t>(p.z) * static_cast<std::size_t>(resolution.y) +
                   static_cast<std::size_t>(p.y)) *
                      static_cast<std::size_t>(resolution.x) +
                  static_cast<std::size_t>(p.x)];
  };
  const auto row = [&](int y, int z) { return glm::mix(value(0, y, z), value(1, y, z), f.x); };
  return glm::mix(glm::mix(row(0, 0), row(1, 0), f.y), glm::mix(row(0, 1), row(1, 1), f.y), f.z);
}

Media::Media(const Scene& scene, const SceneSnapshot& snapshot) {
  for (const Medium& medium : scene.media) {
    Entry entry{mediumBounds(medium, snapshot), medium.extinction, medium.extinction * medium.albedo,
                largestOf(medium.extinction),   medium.anisotropy, -1};
    if (entry.bounds.empty || entry.largest == 0.0f) continue;
    if (!medium.homogeneous()) {
      entry.field = static_cast<int>(fields_.size());
      if (medium.volume) {
        fields_.emplace_back(*medium.volume, snapshot.origin);
      } else {
        fields_.emplace_back(particleDensity(medium, snapshot.time, kCloudSpacing * medium.radius),
                             snapshot.origin);
      }
    }
    media_.push_back(entry);
  }
}

// ---- tracking

bool Media::clip(const Bounds& bounds, const glm::vec3& origin, const glm::vec3& direction, float reach,
                 float& begin, float& end) {
  begin = 0.0f;
  end = reach;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0f) {
      if (origin[axis] < bounds.low[axis] || origin[axis] > bounds.high[axis]) return false;
      continue;
    }
    const float a = (bounds.low[axis] - origin[axis]) / direction[axis];
    const float b = (bounds.high[axis] - origin[axis]) / direction[axis];
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  return begin < end;
}

void Media::Flight::begin(const Media& media, const Entry& medium, const glm::vec3& origin,
                          const glm::vec3& direction, float reach) {
  entry = &medium;
  origin_ = origin;
  direction_ = direction;
  if (!clip(medium.bounds, origin, direction, reach, distance, end_)) {
    entry = nullptr;
    return;
  }
  field_ = medium.field < 0 ? nullptr : &media.fields_[static_cast<std::size_t>(medium.field)];
  majorant = medium.largest;
  blockEnd_ = end_;
  if (field_ == nullptr) return;
  // Amanatides & Woo 1987, "A fast voxel traversal algorithm for ray tracing", over the blocks.
  const float size = field_->voxelSize * static_cast<float>(Field::kBlock);
  const glm::vec3 place = (origin + distance * direction - field_->blocksLow) / size;
  block_ = glm::clamp(glm::ivec3(glm::floor(place)), glm::ivec3(0), field_->blocks - 1);
  for (int axis = 0; axis < 3; ++axis) {
    const float d = direction[axis];
    step_[axis] = d > 0.0f ? 1 : -1;
    crossing_[axis] = d == 0.0f ? std::numeric_limits<float>::infinity() : size / std::abs(d);
    const float wall = field_->blocksLow[axis] + size * static_cast<float>(block_[axis] + (d > 0.0f ? 1 : 0));
    nextCrossing_[axis] = d == 0.0f ? std::numeric_limits<float>::infinity() : (wall - origin[axis]) / d;
  }
  enterBlock();
}

void Media::Flight::enterBlock() {
  majorant = entry->largest * field_->majorant(block_);
  blockEnd_ = std::min({nextCrossing_.x, nextCrossing_.y, nextCrossing_.z, end_});
}

bool Media::Flight::next(RandomStream& random) {
  float depth = -std::log(1.0f - random.uniform());  // optical depth of the majorant
  for (;;) {
    const float within = majorant * (blockEnd_ - distance);
    if (depth < within) {
      distance += depth / majorant;
      return true;
    }
    if (blockEnd_ >= end_) return false;
    depth -= std::max(within, 0.0f);
    distance = std::max(distance, blockEnd_);
    const int axis = nextCrossing_.x <= nextCrossing_.y ? (nextCrossing_.x <= nextCrossing_.z ? 0 : 2)
                                                        : (nextCrossing_.y <= nextCrossing_.z ? 1 : 2);
    block_[axis] += step_[axis];
    if (block_[axis] < 0 || block_[axis] >= field_->blocks[axis]) return false;
    nextCrossing_[axis] += crossing_[axis];
    enterBlock();
  }
}

glm::vec3 Media::transmittance(const glm::vec3& origin, const glm::vec3& direction, float reach,
                               RandomStream& random) const {
  glm::vec3 through(1.0f);
  for (const Entry& entry : media_) {
    if (entry.field < 0) {
      float begin, end;
      if (clip(entry.bounds, origin, direction, reach, begin, end))
        through *= glm::exp(-entry.extinction * (end - begin));
      continue;
    }
    Flight flight;
    flight.begin(*this, entry, origin, direction, reach);
    while (flight.entry != nullptr && flight.next(random)) {
      const float density = densityAt(entry, origin + flight.distance * direction);
      through *= 1.0f - entry.extinction * (density / flight.majorant);
      const float largest = largestOf(through);
      if (largest >= kFaint) continue;
      if (random.uniform() * kFaint >= largest) return glm::vec3(0.0f);
      through *= kFaint / largest;
    }
  }
  return through;
}

bool Media::collide(const glm::vec3& origin, const glm::vec3& direction, float reach, RandomStream& random,
                    glm::vec3& throughput, Collision& collision) const {
  // The tentative collisions of all media together, nearest first.
  std::array<Flight, kMostMedia> flights;
  std::size_t count = 0;
  for (const Entry& entry : media_) {
    Flight& flight = flights[count];
    flight.begin(*this, entry, origin, direction, reach);
    if (flight.entry != nullptr && flight.next(random)) ++count;
  }
  while (count > 0) {
    Flight* nearest = &flights[0];
    for (std::size_t i = 1; i < count; ++i) {
      if (flights[i].distance < nearest->distance) nearest = &flights[i];
    }
    const glm::vec3 position = origin + nearest->distance * direction;
    const Entry& entry = *nearest->entry;
    const float share = densityAt(entry, position) / nearest->majorant;
    const glm::vec3 real = glm::min(entry.extinction * share,
                                    1.0f);  // share of real collisions among tentative ones, by channel
    const float sum = throughput.x + throughput.y + throughput.z;
    if (!(sum > 0.0f)) return false;
    const float probability = glm::dot(throughput, real) / sum;
    if (random.uniform() < probability) {
      throughput *= entry.scattering * share / probability;
      collision = {position, entry.anisotropy};
      return true;
    }
    throughput *= (1.0f - real) / (1.0f - probability);
    if (!nearest->next(random)) *nearest = flights[--count];
  }
  return false;
}

}  // namespace lumivox::reference
