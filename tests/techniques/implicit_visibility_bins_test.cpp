// Bins of directions.
#include <random>

#include "support/scene_builder.h"
#include "support/surface_elements.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

std::vector<glm::vec3> directions(int count) {
  std::mt19937 random(7);
  std::normal_distribution<float> number;
  std::vector<glm::vec3> result;
  while (static_cast<int>(result.size()) < count) {
    const glm::vec3 made(number(random), number(random), number(random));
    if (glm::length(made) > 0.01f) result.push_back(glm::normalize(made));
  }
  return result;
}

}  // namespace

TEST_CASE("solid angles of bins sum to 4 pi") {
  for (const BinMapping mapping : {BinMapping::even, BinMapping::uniform})
    for (const int side : {1, 2, 3, 8, 12, 64}) {
      const DirectionBins bins(side, mapping);
      double sum = 0.0;
      for (std::uint32_t bin = 0; bin < bins.count(); ++bin) sum += static_cast<double>(bins.solidAngle(bin));
      CHECK(sum == Approx(4.0 * kPi).epsilon(1e-6));
    }
}

TEST_CASE("as published bins differ in solid angle by about 4 : 1, evenly mapped ones by less than half") {
  const auto ratio = [](int side, BinMapping mapping) {
    const DirectionBins bins(side, mapping);
    float least = 100.0f, most = 0.0f;
    for (std::uint32_t bin = 0; bin < bins.count(); ++bin) {
      least = std::min(least, bins.solidAngle(bin));
      most = std::max(most, bins.solidAngle(bin));
    }
    return most / least;
  };
  CHECK(ratio(8, BinMapping::uniform) == Approx(3.8).epsilon(0.02));
  CHECK(ratio(16, BinMapping::uniform) == Approx(4.5).epsilon(0.02));
  for (const int side : {8, 12, 16}) CHECK(ratio(side, BinMapping::even) < 1.45f);
}

TEST_CASE("bins of opposite directions are opposite, and every bin holds its middle") {
  for (const BinMapping mapping : {BinMapping::even, BinMapping::uniform})
    for (const int side : {1, 8, 13}) {
      const DirectionBins bins(side, mapping);
      for (std::uint32_t bin = 0; bin < bins.count(); ++bin) {
        CHECK(bins.binOf(bins.centre(bin)) == bin);
        CHECK(bins.opposite(bins.opposite(bin)) == bin);
        CHECK(glm::length(bins.centre(bin) + bins.centre(bins.opposite(bin))) < 1e-6f);
      }
      for (const glm::vec3& direction : directions(500))
        CHECK(bins.binOf(-direction) == bins.opposite(bins.binOf(direction)));
    }
}

TEST_CASE("a direction's bin is as large a part of directions as its solid angle") {
  const DirectionBins bins(2, BinMapping::even);
  std::vector<double> counts(bins.count());
  const int total = 200000;
  for (const glm::vec3& direction : directions(total)) counts[bins.binOf(direction)] += 1.0;
  for (std::uint32_t bin = 0; bin < bins.count(); ++bin)
    CHECK(counts[bin] / total ==
          Approx(static_cast<double>(bins.solidAngle(bin)) / (4.0 * kPi)).epsilon(0.03));
}

TEST_CASE("projected solid angles of the bins of a side sum to pi for any normal, on both sides") {
  for (const int side : {1, 4, 8, 16}) {
    const BinTable table(DirectionBins(side, BinMapping::even));
    for (const glm::vec3& normal : directions(50))
      for (const float sign : {1.0f, -1.0f}) {
        double sum = 0.0;
        for (const glm::vec4& bin : table.bins)
          sum += std::max(static_cast<double>(sign * glm::dot(normal, glm::vec3(bin))), 0.0) *
                 static_cast<double>(bin.w);
        CHECK(sum * static_cast<double>(table.projectionScale(normal)) == Approx(kPi).epsilon(1e-5));
      }
  }
}
