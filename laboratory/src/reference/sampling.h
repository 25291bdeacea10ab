// Random directions and the estimators' weights.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <numbers>
#include <vector>

#include "lumivox/base/random.h"

namespace lumivox::reference {

inline constexpr float kPi = std::numbers::pi_v<float>;

/// Veach 1997, "Robust Monte Carlo methods for light transport simulation", Sec. 9.2.4: the power heuristic
/// with exponent 2, for the ratio of the other technique's density to that of the technique which made the
/// sample. An infinite ratio gives 0, never NaN.
inline float powerHeuristic(float otherOverChosen) {
  return 1.0f / (1.0f + otherOverChosen * otherOverChosen);
}

/// Cosine and sine of 2 pi u for u in [0, 1], to the last bits of a float: Taylor series about the nearest
/// quarter turn, whose remainder at an eighth of a turn is 2e-9 for the sine and 3e-8 for the cosine. (Half
/// of the time of the library's pair, which first has to bring any angle into this range.)
inline glm::vec2 pointOfCircle(float u) {
  const float quarters = 4.0f * u;
  const int nearest = static_cast<int>(quarters + 0.5f);
  const float x = (quarters - static_cast<float>(nearest)) * (0.5f * kPi);
  const float squared = x * x;
  const float sine =
      x * (1.0f +
           squared * (-1.0f / 6.0f + squared * (1.0f / 120.0f +
                                                squared * (-1.0f / 5040.0f + squared * (1.0f / 362880.0f)))));
  const float cosine =
      1.0f + squared * (-1.0f / 2.0f +
                        squared * (1.0f / 24.0f + squared * (-1.0f / 720.0f + squared * (1.0f / 40320.0f))));
  // The quarter is unpredictable, so products replace branches.
  const auto odd = static_cast<float>(nearest & 1), even = 1.0f - odd;
  const auto sign = static_cast<float>(1 - (nearest & 2));
  return {sign * (even * cosine - odd * sine), sign * (even * sine + odd * cosine)};
}

/// The vector with these coordinates about an axis. Duff et al. 2017, "Building an orthonormal basis,
/// revisited", Listing 3.
inline glm::vec3 aboutAxis(const glm::vec3& axis, float x, float y, float z) {
  const float sign = std::copysign(1.0f, axis.z);
  const float a = -1.0f / (sign + axis.z);
  const float b = axis.x * axis.y * a;
  const glm::vec3 tangent(1.0f + sign * axis.x * axis.x * a, sign * b, -sign * axis.x);
  const glm::vec3 bitangent(b, sign + axis.y * axis.y * a, -axis.y);
  return x * tangent + y * bitangent + z * axis;
}

/// Density cos/pi about the axis.
inline glm::vec3 sampleCosine(const glm::vec3& axis, float u1, float u2) {
  const glm::vec2 inDisc = std::sqrt(u1) * pointOfCircle(u2);
  return aboutAxis(axis, inDisc.x, inDisc.y, std::sqrt(1.0f - u1));
}

/// Density (n+1)/(2 pi) cos^n about the axis.
inline glm::vec3 samplePowerCosine(const glm::vec3& axis, float exponent, float u1, float u2) {
  const float cosine = std::pow(1.0f - u1, 1.0f / (exponent + 1.0f));
  const glm::vec2 inDisc = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)) * pointOfCircle(u2);
  return aboutAxis(axis, inDisc.x, inDisc.y, cosine);
}

/// Mean of the channels, of which negative ones count as 0: the weight of choosing a light.
inline double meanOf(const glm::vec3& rgb) {
  return (std::max(0.0, double(rgb.x)) + std::max(0.0, double(rgb.y)) + std::max(0.0, double(rgb.z))) / 3.0;
}

/// Picks an index with given probabilities in constant time. Vose 1991, "A linear algorithm for generating
/// random numbers with a given distribution".
class AliasTable {
 public:
  AliasTable() = default;
  explicit AliasTable(std::vector<double> weights);    ///< not negative, with a positive sum
  static constexpr std::size_t kBytesWhileBuilt = 28;  ///< for each weight, the weights included
  bool empty() const { return slots_.empty(); }
  /// One of the indices for two independent numbers of 32 random bits: the first chooses the slot, the second
  /// between its two indices. (What a first number leaves below the slot would be 12 bits for a million
  /// slots, too coarse for the choice.)
  std::uint32_t pick(std::uint32_t slotBits, std::uint32_t choiceBits) const {
    const auto index = static_cast<std::uint32_t>((std::uint64_t{slotBits} * slots_.size()) >> 32);
    return choiceBits < slots_[index].threshold ? index : slots_[index].alias;
  }

 private:
  struct Slot {
    std::uint32_t threshold;  ///< second numbers below it keep the slot's own index
    std::uint32_t alias;
  };
  std::vector<Slot> slots_;
};

}  // namespace lumivox::reference
