#include "sample_elimination.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "near_places.h"

namespace lumivox::virtual_area_lights {
namespace {

/// A heap with the most crowded sample first, the later one among equals. Each sample knows its position, so
/// that it can move down.
class CrowdingHeap {
 public:
  explicit CrowdingHeap(std::vector<float> crowding)
      : crowding_(std::move(crowding)), heap_(crowding_.size()), at_(crowding_.size()) {
    std::iota(heap_.begin(), heap_.end(), 0u);
    std::iota(at_.begin(), at_.end(), 0u);
    for (std::size_t i = heap_.size() / 2; i-- > 0;) sink(i);
  }
  bool holds(std::uint32_t sample) const { return at_[sample] < heap_.size(); }
  std::uint32_t takeFirst() {
    const std::uint32_t first = heap_.front();
    put(0, heap_.back());
    heap_.pop_back();
    at_[first] = kGone;
    if (!heap_.empty()) sink(0);
    return first;
  }
  void relieve(std::uint32_t sample, float by) {
    crowding_[sample] -= by;
    sink(at_[sample]);
  }

 private:
  static constexpr std::size_t kGone = ~std::size_t{0};

  bool before(std::uint32_t a, std::uint32_t b) const {
    return crowding_[a] != crowding_[b] ? crowding_[a] > crowding_[b] : a > b;
  }
  void put(std::size_t at, std::uint32_t sample) {
    heap_[at] = sample;
    at_[sample] = at;
  }
  void sink(std::size_t at) {
    const std::uint32_t sample = heap_[at];
    for (std::size_t child; (child = 2 * at + 1) < heap_.size(); at = child) {
      if (child + 1 < heap_.size() && before(heap_[child + 1], heap_[child])) ++child;
      if (!before(heap_[child], sample)) break;
      put(at, heap_[child]);
    }
    put(at, sample);
  }

  std::vector<float> crowding_;
  std::vector<std::uint32_t> heap_;
  std::vector<std::size_t> at_;
};

/// How much two samples crowd each other, and the distance where crowding ends.
class Crowding {
 public:
  Crowding(const SurfaceCandidates& candidates, std::span<const int> weights, std::size_t most)
      : candidates_(candidates), weights_(weights) {
    const auto count = static_cast<double>(candidates.places.size());
    const double sides = static_cast<double>(std::accumulate(weights.begin(), weights.end(), std::size_t{0}));
    const double left = std::max(count * static_cast<double>(most) / sides, 1.0);
    // Yuksel 2015, Sec. 3.2 and 3.3: the largest radius at which discs of two samples on a plane need not
    // overlap; and the smallest, below which samples count as equally near, or dense places would be thinned
    // too much. The exponent and the two constants are the published ones.
    const double largest = std::sqrt(candidates.area * count / (2.0 * std::sqrt(3.0) * left));
    const double smallest = largest * (1.0 - std::pow(left / count, 1.5)) * 0.65;
    reach_ = static_cast<float>(2.0 * largest);
    nearest_ = static_cast<float>(2.0 * smallest);
  }
  float reach() const { return reach_; }
  float operator()(std::uint32_t a, std::uint32_t b, float squaredDistance) const {
    const float facing = glm::dot(candidates_.normals[a], candidates_.normals[b]);
    if (weights_[a] < 2 && weights_[b] < 2 && facing < kOtherSideCosine) return 0.0f;
    const float part = 1.0f - std::clamp(std::sqrt(squaredDistance), nearest_, reach_) / reach_;
    const float squared = part * part, fourth = squared * squared;
    return fourth * fourth;
  }

 private:
  const SurfaceCandidates& candidates_;
  std::span<const int> weights_;
  float reach_ = 0.0f, nearest_ = 0.0f;
};

}  // namespace

std::vector<std::uint32_t> eliminateSamples(const SurfaceCandidates& candidates, std::span<const int> weights,
                                            std::size_t most) {
  const Crowding crowding(candidates, weights, most);
  const NearPlaces near(candidates.positions, crowding.reach());
  const auto count = static_cast<std::uint32_t>(candidates.places.size());
  std::vector<float> sums(count, 0.0f);
  for (std::uint32_t i = 0; i < count; ++i)
    near.within(candidates.positions[i], crowding.reach(), [&](std::uint32_t other, float squared) {
      if (other != i) sums[i] += crowding(i, other, squared);
    });
  CrowdingHeap heap(std::move(sums));
  std::size_t left = count;
  for (auto weight = std::accumulate(weights.begin(), weights.end(), std::size_t{0});
       weight > most && left > 1; --left) {
    const std::uint32_t gone = heap.takeFirst();
    weight -= static_cast<std::size_t>(weights[gone]);
    near.within(candidates.positions[gone], crowding.reach(), [&](std::uint32_t other, float squared) {
      if (heap.holds(other)) heap.relieve(other, crowding(gone, other, squared));
    });
  }
  std::vector<std::uint32_t> kept;
  for (std::uint32_t i = 0; i < count; ++i)
    if (heap.holds(i)) kept.push_back(i);
  return kept;
}

}  // namespace lumivox::virtual_area_lights
