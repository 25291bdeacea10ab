// Counter-based random numbers.
#include <algorithm>
#include <cmath>

#include "lumivox/base/low_discrepancy.h"
#include "lumivox/base/random.h"
#include "support/support.h"

using namespace lumivox;
using Block = std::array<std::uint32_t, 4>;

TEST_CASE("Philox4x32-10 gives the known answers of Salmon et al. 2011") {
  // The known-answer vectors that the authors publish with Random123: all zeros, all ones, and the digits of
  // pi.
  constexpr std::uint32_t kOnes = 0xFFFFFFFFu;
  CHECK(philox4x32({0, 0, 0, 0}, {0, 0}) == Block{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
  CHECK(philox4x32({kOnes, kOnes, kOnes, kOnes}, {kOnes, kOnes}) ==
        Block{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
  CHECK(philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}) ==
        Block{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});
}

TEST_CASE("a stream depends on its seed and both its addresses, and on nothing else") {
  const auto first = [](std::uint64_t seed, std::uint32_t a, std::uint32_t b) {
    return RandomStream(seed, a, b).bits();
  };
  CHECK(first(1, 2, 3) == first(1, 2, 3));
  CHECK(first(1, 2, 3) != first(2, 2, 3));
  CHECK(first(1, 2, 3) != first(1 + (std::uint64_t{1} << 32), 2, 3));
  CHECK(first(1, 2, 3) != first(1, 3, 3));
  CHECK(first(1, 2, 3) != first(1, 2, 4));
  RandomStream stream(7, 8, 9);
  const Block block = philox4x32({0, 0, 8, 9}, {7, 0}), next = philox4x32({1, 0, 8, 9}, {7, 0});
  for (const std::uint32_t expected : block) CHECK(stream.bits() == expected);
  CHECK(stream.bits() == next[0]);
}

TEST_CASE("uniform numbers fill [0, 1) evenly") {
  RandomStream stream(42, 0);
  constexpr int kCount = 200000, kBins = 20;
  std::array<int, kBins> bins{};
  double sum = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const float u = stream.uniform();
    REQUIRE(u >= 0.0f);
    REQUIRE(u < 1.0f);
    sum += double{u};
    ++bins[static_cast<std::size_t>(u * kBins)];
  }
  // Mean 1/2 with the standard error sqrt(1/12/n); chi-squared with 19 degrees of freedom stays below 43.8
  // in 99.9 % of all cases.
  CHECK(std::abs(sum / kCount - 0.5) < 4.0 * std::sqrt(1.0 / 12.0 / kCount));
  double chiSquared = 0.0;
  for (const int count : bins)
    chiSquared += std::pow(count - kCount / double{kBins}, 2) / (kCount / double{kBins});
  CHECK(chiSquared < 43.8);
}

TEST_CASE("lattice points cover as much behind an upright or level edge as the square") {
  for (const int count : {1, 2, 4, 5, 16, 36, 64, 100}) {
    INFO(count);
    const auto points = latticePoints(count);
    REQUIRE(points.size() == static_cast<std::size_t>(count));
    for (const std::size_t axis : {std::size_t{0}, std::size_t{1}})
      for (int step = 0; step <= 1000; ++step) {
        const double edge = step / 1000.0;
        const auto behind = std::count_if(points.begin(), points.end(),
                                          [&](const auto& point) { return point[axis] < edge; });
        CHECK(std::abs(static_cast<double>(behind) / count - edge) <= 0.5 / count + 1e-9);
      }
  }
  const auto centre = latticePoints(1).front();
  CHECK(centre[0] == 0.5);
  CHECK(centre[1] == 0.5);
}

TEST_CASE("lattice points keep their distance, so that slanting edges are covered too") {
  const auto points = latticePoints(16);
  double nearest = 1.0;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double x = std::abs(points[i][0] - points[j][0]), y = std::abs(points[i][1] - points[j][1]);
      nearest = std::min(nearest, std::hypot(std::min(x, 1.0 - x), std::min(y, 1.0 - y)));
    }
  CHECK(nearest > 0.19);  // along a diagonal it would be 0.088; a regular grid has 0.25
}
