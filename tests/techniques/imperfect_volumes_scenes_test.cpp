// Committed scenes: the volume against quadrature on the host, and pictures against the path-traced
// reference.
#include <algorithm>
#include <cmath>
#include <random>

#include "lumivox/measure/voxel_walk.h"
#include "support/imperfect_volumes.h"
#include "support/near_field_scene.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::volumes;
using near_field::committed;

namespace {

/// A scene as an imperfect volume that is lit.
struct Lit {
  Scene scene;
  SceneSnapshot snapshot;
  OccupancyGrid opacity;
  AttributeGrid attributes;
  BinaryGrid bits;
  ShGrid reflected;
  explicit Lit(const std::string& name, int resolution)
      : scene(committed(name)), snapshot(snapshotOf(scene, 0.0)) {
    const auto pass = [&](const char* technique, const char* which) {
      return PassHarness(device(), techniques(), technique, which, scene, snapshot);
    };
    PassHarness points = pass("voxelization", "points"), average = pass("voxelization", "average"),
                shadow = pass("direct_lighting", "shadow_map"), inject = pass("imperfect_volumes", "inject");
    points.setParameter("resolution", resolution);
    points.setParameter("adaptive", std::string("on"));
    points.run();
    average.setInput("fragments", points.output<VoxelFragments>("fragments"));
    average.run();
    shadow.run();
    inject.setInput("fragments", points.output<VoxelFragments>("fragments"));
    inject.setInput("shadow", shadow.output<ShadowMap>("depth"));
    inject.run();
    opacity = average.output<OccupancyGrid>("opacity");
    attributes = average.output<AttributeGrid>("attributes");
    bits = average.output<BinaryGrid>("bits");
    reflected = inject.output<ShGrid>("reflected");
  }
  const GridPlacement& grid() const { return opacity.grid; }
  glm::vec3 middleOf(const glm::ivec3& voxel) const {
    return grid().low + (glm::vec3(voxel) + 0.5f) * grid().voxelSize;
  }
};

/// The volume read back, and what arrives in a voxel by plain Monte Carlo in double precision.
class VolumeOnHost {
 public:
  explicit VolumeOnHost(const Lit& lit)
      : set_(lit.grid().resolution), normals_(lit.attributes.normal->downloadFloats(0)) {
    const std::vector<float> opacity = lit.opacity.opacity->downloadFloats(0);
    for (std::size_t i = 0; i < opacity.size(); ++i)
      if (opacity[i] > 0.0f) set_.insert(set_.voxelOf(i));
    for (std::size_t c = 0; c < 3; ++c) sent_[c] = lit.reflected.levels[0].coefficients[c]->downloadFloats(0);
  }
  const VoxelSet& set() const { return set_; }

  struct Arriving {
    std::array<double, 12> mean{}, deviation{};  ///< of one sample
  };
  Arriving arrivingIn(const glm::ivec3& voxel, int samples, std::mt19937& random) const {
    std::uniform_real_distribution<double> unit;
    std::array<double, 12> sum{}, squares{};
    for (int i = 0; i < samples; ++i) {
      const double z = 2.0 * unit(random) - 1.0, angle = 2.0 * kPi * unit(random),
                   sine = std::sqrt(1.0 - z * z);
      const glm::dvec3 way(sine * std::cos(angle), sine * std::sin(angle), z),
          radiance = seenFrom(voxel, way);
      const std::array<double, 4> basis{kY0, kY1 * way.y, kY1 * way.z, kY1 * way.x};
      for (std::size_t k = 0; k < 12; ++k) {
        const double value = 4.0 * kPi * radiance[static_cast<int>(k / 4)] * basis[k % 4];
        sum[k] += value;
        squares[k] += value * value;
      }
    }
    Arriving result;
    for (std::size_t k = 0; k < 12; ++k) {
      result.mean[k] = sum[k] / samples;
      result.deviation[k] = std::sqrt(std::max(squares[k] / samples - result.mean[k] * result.mean[k], 0.0));
    }
    return result;
  }

 private:
  VoxelSet set_;
  std::vector<float> normals_;
  std::array<std::vector<float>, 3> sent_;

  glm::dvec3 seenFrom(const glm::ivec3& voxel, const glm::dvec3& way) const {
    const glm::vec3 direction(way), origin = glm::vec3(voxel) + 0.5f + 0.8660255f * direction;
    const auto hit = firstVoxel(set_, origin, direction);
    if (!hit) return glm::dvec3(0.0);
    const std::size_t i = 4 * set_.bitOf(hit->voxel);
    glm::dvec3 normal(normals_[i], normals_[i + 1], normals_[i + 2]), along(0.0);
    for (const auto& channel : sent_) along += glm::dvec3(channel[i + 3], channel[i + 1], channel[i + 2]);
    normal = glm::length(normal) > 1.0 / 64.0 ? glm::normalize(normal)
             : glm::length(along) > 0.0       ? glm::normalize(along)
                                              : glm::dvec3(0.0);
    if (glm::dot(normal, -way) < 0.0) normal = -normal;
    glm::dvec3 radiance;
    for (int c = 0; c < 3; ++c) {
      const auto& sent = sent_[static_cast<std::size_t>(c)];
      const glm::dvec3 band(sent[i + 3], sent[i + 1], sent[i + 2]);
      radiance[c] = std::max(0.5 * (sent[i] / (2.0 * kPi * kY0) + glm::dot(band, normal) / (kPi * kY1)), 0.0);
    }
    return radiance;
  }
};

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

}  // namespace

TEST_CASE("what arrives in a voxel is what quadrature on the host finds, in all twelve coefficients") {
  for (const char* name : {"cornell", "arcade"}) {
    const Lit lit(name, 32);
    const VolumeOnHost host(lit);
    std::mt19937 random(5);
    const std::vector<glm::ivec3> voxels = someOfEachKind(host.set(), 50, random);
    std::vector<SurfacePoint> points;
    for (const glm::ivec3& voxel : voxels) points.push_back({lit.middleOf(voxel), {0, 0, 1}});
    // No sky: rays that leave bring nothing.
    Scene dark = lit.scene;
    dark.environment = glm::vec3(0.0f);
    Runner march("march", dark, static_cast<int>(points.size()));
    constexpr int kRays = 4096, kSamples = 30000;
    march.in("opacity", lit.opacity)
        .in("reflected", lit.reflected)
        .in("attributes", lit.attributes)
        .in("bits", lit.bits)
        .in("gbuffer", seen(points))
        .with({{"rays", kRays}, {"walk", 0, "exact"}, {"voxels", 0, "own"}});
    const ShGrid found = march.run<ShGrid>("incoming");
    std::array<std::vector<float>, 3> values;
    for (std::size_t c = 0; c < 3; ++c) values[c] = found.levels[0].coefficients[c]->downloadFloats(0);
    int outside = 0, all = 0;
    double largest = 0.0;
    for (const glm::ivec3& voxel : voxels) {
      const VolumeOnHost::Arriving expected = host.arrivingIn(voxel, kSamples, random);
      for (std::size_t k = 0; k < 12; ++k, ++all) {
        const double value = values[k / 4][4 * host.set().bitOf(voxel) + k % 4],
                     error = expected.deviation[k] * std::sqrt(1.0 / kRays + 1.0 / kSamples) + 1e-7;
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
