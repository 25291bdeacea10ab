// Committed scenes: the volume against quadrature on the host, and in other units of length.
#include <algorithm>
#include <cmath>
#include <random>

#include "support/imperfect_volumes_scene.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::volumes;

namespace {

/// Voxels of four kinds alike: occupied, beside one occupied voxel's face, beside several, and with none
/// near.
std::vector<glm::ivec3> someOfEachKind(const VoxelSet& set, int ofEach, std::mt19937& random) {
  std::array<std::vector<glm::ivec3>, 4> kinds;
  const glm::ivec3 size = set.resolution();
  for (int z = 1; z + 1 < size.z; ++z)
    for (int y = 1; y + 1 < size.y; ++y)
      for (int x = 1; x + 1 < size.x; ++x) {
        const glm::ivec3 voxel(x, y, z);
        int beside = 0;
        for (int axis = 0; axis < 3; ++axis)
          for (const int way : {-1, 1}) {
            glm::ivec3 other = voxel;
            other[axis] += way;
            beside += set.contains(other);
          }
        const std::size_t kind = set.contains(voxel) ? 0 : beside == 0 ? 3 : beside == 1 ? 1 : 2;
        kinds[kind].push_back(voxel);
      }
  std::vector<glm::ivec3> result;
  for (auto& kind : kinds) {
    std::shuffle(kind.begin(), kind.end(), random);
    REQUIRE(kind.size() >= static_cast<std::size_t>(ofEach));
    result.insert(result.end(), kind.begin(), kind.begin() + ofEach);
  }
  return result;
}

void checkAgainstQuadrature(int samples) {
  for (const char* name : {"cornell", "arcade"}) {
    const Lit lit(name, 32);
    const VolumeOnHost host(lit);
    std::mt19937 random(5);
    const std::vector<glm::ivec3> voxels = someOfEachKind(host.set(), 50, random);
    std::vector<ReadPoint> points;
    for (const glm::ivec3& voxel : voxels) points.push_back({lit.middleOf(voxel), {0, 0, 1}});
    // No sky: rays that leave bring nothing.
    Scene dark = lit.scene;
    dark.environment = glm::vec3(0.0f);
    LonePass march = volumePass("march", dark, static_cast<int>(points.size()));
    constexpr int kRays = 4096;
    march.in("opacity", lit.opacity)
        .in("reflected", lit.reflected)
        .in("attributes", lit.attributes)
        .in("bits", lit.bits)
        .in("gbuffer", seen(points))
        .with({{"rays", kRays}, {"walk", "exact"}, {"voxels", "own"}});
    const ShGrid found = march.out<ShGrid>("incoming");
    std::array<std::vector<float>, 3> values;
    for (std::size_t c = 0; c < 3; ++c) values[c] = found.levels[0].coefficients[c]->downloadFloats(0);
    int outside = 0, all = 0;
    double largest = 0.0;
    for (const glm::ivec3& voxel : voxels) {
      const VolumeOnHost::Arriving expected = host.arrivingIn(voxel, samples, random);
      for (std::size_t k = 0; k < 12; ++k, ++all) {
        const double value = values[k / 4][4 * host.set().bitOf(voxel) + k % 4],
                     error = expected.deviation[k] * std::sqrt(1.0 / kRays + 1.0 / samples) + 1e-7;
        outside += std::abs(value - expected.mean[k]) > 3.0 * error;
        largest = std::max(largest, std::abs(value - expected.mean[k]) / error);
      }
    }
    INFO(name << ": " << outside << " of " << all << " beyond three standard errors, the largest "
              << largest);
    CHECK(outside <= all / 300);
    CHECK(largest < 5.0);
  }
}

}  // namespace

TEST_CASE("what arrives in a voxel is what quadrature on the host finds, in all twelve coefficients") {
  checkAgainstQuadrature(30000);
}

// A minute.
TEST_CASE("what arrives in a voxel is what quadrature over a hundred thousand directions finds", "[.]") {
  checkAgainstQuadrature(100000);
}

TEST_CASE("openness is by default that of a tenth of the scene's diagonal, as the reference's") {
  const Lit lit("cornell", 16);
  const glm::dvec3 diagonal(lit.snapshot.bounds.high - lit.snapshot.bounds.low);
  const auto open = [&](double distance) {
    return LonePass("imperfect_volumes.occlude", lit.scene, {{"rays", 64}, {"distance", distance}})
        .in("opacity", lit.opacity)
        .out<ShGrid>("visibility")
        .levels[0]
        .coefficients[0]
        ->downloadFloats(0);
  };
  const std::vector<float> byDefault = open(0.0);
  CHECK(byDefault == open(0.1 * glm::length(diagonal)));
  CHECK(byDefault != open(0.2 * glm::length(diagonal)));
}

TEST_CASE("a scene a thousand times as small has the same picture, where free voxels are equally near too") {
  std::vector<std::vector<float>> pictures;
  for (const auto& [name, unit] : {std::pair("cornell", 1.0), {"stress/tiny", 1e-3}}) {
    Scene scene = committed(name);
    scene.cameras.front().target = unit * glm::dvec3(0.2739, 0.1431, 0.0);
    pictures.push_back(
        rendered(scene, pipeline("imperfect_volumes_visible"), {"rays=25", "resolution=16"}, sized(48, 48))
            .outputs.at("indirect_diffuse")
            .values());
  }
  double different = 0.0, all = 0.0;
  for (std::size_t i = 0; i < pictures[0].size(); ++i) {
    different += std::abs(pictures[0][i] - pictures[1][i]);
    all += pictures[0][i];
  }
  REQUIRE(all > 0.0);
  CHECK(different < 1e-3 * all);
}
