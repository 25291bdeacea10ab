// Bins of directions in shaders are those of C++.
#include <random>

#include "lumivox/base/file.h"
#include "../../techniques/implicit_visibility/links/direction_bins.h"
#include "support/gpu_programs.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::gpu;
using namespace lumivox::test;
using namespace lumivox::implicit_visibility;

TEST_CASE("a shader finds the same bin of a direction, and the same middle of a bin, as C++ does") {
  constexpr int kDirections = 4096;
  std::vector<glm::vec4> directions;
  std::mt19937 random(3);
  std::normal_distribution<float> number;
  while (directions.size() < kDirections)
    directions.emplace_back(number(random), number(random), number(random), 0.0f);
  const std::string functions = readFile(sourceDirectory() / "shaders/implicit_visibility/direction_bins.glsl");
  for (const BinMapping mapping : {BinMapping::even, BinMapping::uniform})
    for (const int side : {1, 8, 12}) {
      const DirectionBins bins(side, mapping);
      const std::string even = mapping == BinMapping::even ? "true" : "false", n = std::to_string(side);
      const Program binning =
          computeProgram("bins", functions + R"(
        layout(local_size_x = 64) in;
        layout(std430, binding = 0) buffer Directions { vec4 directions[]; };
        layout(std430, binding = 1) buffer Bins { uint bins[]; };
        void main() {
          uint i = gl_GlobalInvocationID.x;
          bins[i] = directionBin(directions[i].xyz, )" +
                                     n + ", " + even + R"();
          directions[i] = vec4(directionOfBin(i % (6u * )" +
                                     n + "u * " + n + "u), " + n + ", " + even + R"(), 0.0);
        })");
      Buffer given(device(), kDirections * sizeof(glm::vec4)),
          found(device(), kDirections * sizeof(std::uint32_t));
      given.uploadValues(std::span<const glm::vec4>(directions));
      const Bindings bindings{storage(0, given), storage(1, found)};
      device().dispatch(binning, bindings, {kDirections / 64, 1, 1});
      device().barrier();
      const auto numbers = found.downloadValues<std::uint32_t>();
      const auto middles = given.downloadValues<glm::vec4>();
      int apart = 0;  // at the border of bins rounding may decide
      for (std::uint32_t i = 0; i < kDirections; ++i) {
        apart += numbers[i] != bins.binOf(glm::vec3(directions[i]));
        const std::uint32_t bin = i % (6u * bins.perFace());
        CHECK(glm::distance(glm::vec3(middles[i]), bins.centre(bin)) < 1e-5f);
      }
      CAPTURE(side, even);
      CHECK(apart <= 4);
    }
}
