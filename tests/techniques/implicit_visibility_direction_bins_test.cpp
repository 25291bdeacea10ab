// Bins of directions in shaders are those of C++.
#include <random>

#include "../../techniques/implicit_visibility/links/direction_bins.h"
#include "support/glsl_functions.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::implicit_visibility;

TEST_CASE("a shader finds the same bin of a direction, and the same middle of a bin, as C++ does") {
  constexpr int kDirections = 4096;
  std::vector<glm::vec4> directions, numbers;
  std::mt19937 random(3);
  std::normal_distribution<float> number;
  for (int i = 0; i < kDirections; ++i) {
    const float x = number(random), y = number(random), z = number(random);
    directions.emplace_back(x, y, z, 0.0f);
    numbers.emplace_back(static_cast<float>(i), 0.0f, 0.0f, 0.0f);
  }
  const std::vector<std::string> files{"implicit_visibility/links/direction_bins.glsl"};
  for (const BinMapping mapping : {BinMapping::even, BinMapping::uniform})
    for (const int side : {1, 8, 12}) {
      const DirectionBins bins(side, mapping);
      const std::string even = mapping == BinMapping::even ? "true" : "false", n = std::to_string(side);
      const auto found =
          evaluated(files, "found.x = float(directionBin(given.xyz, " + n + ", " + even + "));", directions);
      const auto middles = evaluated(files,
                                     "found.xyz = directionOfBin(uint(given.x) % (6u * " + n + "u * " + n +
                                         "u), " + n + ", " + even + ");",
                                     numbers);
      int apart = 0;  // at the border of bins rounding may decide
      for (std::uint32_t i = 0; i < kDirections; ++i) {
        apart += static_cast<std::uint32_t>(found[i].x) != bins.binOf(glm::vec3(directions[i]));
        const std::uint32_t bin = i % (6u * bins.perFace());
        CHECK(glm::distance(glm::vec3(middles[i]), bins.centre(bin)) < 1e-5f);
      }
      CAPTURE(side, even);
      CHECK(apart <= 4);
    }
}
