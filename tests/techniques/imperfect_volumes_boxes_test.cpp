// Four errors apart: what voxels make of triangles, two bands of light in voxels of light from all sides,
// steps of whole voxels, and noise.
#include <fmt/format.h>

#include <atomic>
#include <map>
#include <thread>

#include "lumivox/reference/voxel_transport.h"
#include "support/against_reference.h"
#include "support/imperfect_volumes_reading.h"
#include "support/imperfect_volumes_scene.h"
#include "support/kept_table.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::volumes;

namespace {

using Pixels = std::vector<glm::dvec3>;  ///< E / pi

/// A scene as a volume, as its camera sees it, and what arrives at the pixels by one way or another.
class Transported {
 public:
  Transported(const std::string& name, int resolution, const Picture& picture)
      : lit_(sized(name, picture), resolution), host_(lit_) {
    gbuffer_ = gbufferOf(lit_.scene);
    positions_ = gbuffer_.position->downloadFloats(0);
    albedo_ = gbuffer_.diffuse->downloadFloats(0);
  }

  const Scene& scene() const { return lit_.scene; }

  /// Through boxes that shine as the voxels do, without bands and without a cache.
  Pixels boxes(int samples) const {
    const GridPlacement& grid = lit_.grid();
    std::vector<glm::ivec3> voxels;
    for (const Cell& cell : cellsOf(lit_.bits)) voxels.push_back({cell[0], cell[1], cell[2]});
    const std::vector<float> normals = gbuffer_.normal->downloadFloats(0),
                             geometric = gbuffer_.geometricNormal->downloadFloats(0);
    std::vector<BoxStart> starts(positions_.size() / 4);
    for (std::size_t i = 0; i < starts.size(); ++i) {
      if (positions_[4 * i + 3] == 0.0f) continue;
      const auto at = [&](const std::vector<float>& values) {
        return glm::dvec3(values[4 * i], values[4 * i + 1], values[4 * i + 2]);
      };
      // Beyond all voxels that a plane there can touch.
      const glm::dvec3 normal = at(geometric), sides = glm::abs(normal);
      starts[i].place = at(positions_) + grid.voxelSize * (sides.x + sides.y + sides.z + 1.0 / 16.0) * normal;
      starts[i].normal = glm::normalize(at(normals));
    }
    BoxTransport transport;
    transport.environment = lit_.scene.environment;
    transport.samples = samples;
    transport.radiance = [&](const BoxHit& hit) { return host_.sentBy(hit.voxel, hit.direction); };
    Pixels result;
    for (const BoxLight& light : transportThroughBoxes(VoxelBoxes(voxels, grid), starts, transport))
      result.push_back(light.arriving);
    return result;
  }

  /// By Eq. 5 on the host, in double precision: of each voxel that a pixel reads the coefficients by
  /// quadrature over rays that meet every voxel of their way. Of each source two halves with directions of
  /// their own, whose difference tells the noise of their mean.
  struct Quadrature {
    std::array<Pixels, 2> surface, harmonics;
  };
  Quadrature quadrature(int strata) const {
    const GridPlacement& grid = lit_.grid();
    const std::vector<float> normals = gbuffer_.normal->downloadFloats(0),
                             geometric = gbuffer_.geometricNormal->downloadFloats(0);
    const ReadingOnHost reading(host_.set(), host_.normals(), {});
    const auto at = [](const std::vector<float>& values, std::size_t i) {
      return glm::dvec3(values[4 * i], values[4 * i + 1], values[4 * i + 2]);
    };
    std::vector<std::vector<ReadingOnHost::Share>> shares(positions_.size() / 4);
    std::map<std::uint64_t, std::size_t> numbers;
    std::vector<glm::ivec3> voxels;
    for (std::size_t i = 0; i < shares.size(); ++i) {
      const glm::dvec3 place = (at(positions_, i) - glm::dvec3(grid.low)) / double{grid.voxelSize};
      if (positions_[4 * i + 3] == 0.0f || !host_.set().inside(glm::ivec3(glm::floor(place)))) continue;
      shares[i] = reading.sharesAt(place, at(geometric, i));
      for (const auto& [voxel, weight] : shares[i])
        if (numbers.try_emplace(host_.set().bitOf(voxel), voxels.size()).second) voxels.push_back(voxel);
    }
    std::vector<std::array<VolumeOnHost::Coefficients, 2>> coefficients(voxels.size());
    std::atomic<std::size_t> next = 0;
    {
      std::vector<std::jthread> threads;
      for (unsigned t = 0; t < std::max(std::thread::hardware_concurrency(), 1u); ++t)
        threads.emplace_back([&] {
          for (std::size_t v = next++; v < voxels.size(); v = next++)
            for (unsigned half = 0; half < 2; ++half)
              coefficients[v][half] = host_.quadratureIn(
                  voxels[v], strata, 2 * static_cast<unsigned>(v) + half, lit_.scene.environment);
        });
    }
    Quadrature result;
    for (std::size_t half = 0; half < 2; ++half)
      for (Pixels* pixels : {&result.surface[half], &result.harmonics[half]}) {
        pixels->resize(shares.size());
        for (std::size_t i = 0; i < shares.size(); ++i)
          for (std::size_t c = 0; c < 3; ++c) {
            glm::dvec4 sum(0.0);
            for (const auto& [voxel, weight] : shares[i]) {
              const auto& own = coefficients[numbers.at(host_.set().bitOf(voxel))][half];
              sum += weight * (pixels == &result.surface[half] ? own.surface : own.harmonics)[c];
            }
            (*pixels)[i][static_cast<int>(c)] = std::max(irradiance(sum, at(normals, i)) / kPi, 0.0);
          }
      }
    return result;
  }

  /// By the passes.
  Pixels passes(const char* walk, const char* source, int rays, std::uint64_t seed = 1) const {
    LonePass march("imperfect_volumes.march", lit_.scene,
                   {{"rays", rays}, {"walk", walk}, {"source", source}});
    march.in("opacity", lit_.opacity)
        .in("reflected", lit_.reflected)
        .in("attributes", lit_.attributes)
        .in("bits", lit_.bits)
        .in("gbuffer", gbuffer_)
        .run(seed);
    LonePass gather("imperfect_volumes.gather", lit_.scene);
    gather.in("gbuffer", gbuffer_)
        .in("incoming", march.out<ShGrid>("incoming"))
        .in("visibility", march.out<ShGrid>("incoming"))  // which nobody looks at
        .in("opacity", lit_.opacity)
        .in("attributes", lit_.attributes);
    const std::vector<float> reflected = gather.floats("diffuse");
    Pixels result(positions_.size() / 4);
    for (std::size_t i = 0; i < result.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        const std::size_t k = 4 * i + static_cast<std::size_t>(c);
        result[i][c] = albedo_[k] > 0.0f ? reflected[k] / albedo_[k] : 0.0;
      }
    return result;
  }

  /// Of two halves of a quadrature: their mean, and how far one is from it by noise.
  static Pixels meanOfHalves(const std::array<Pixels, 2>& halves) {
    Pixels result(halves[0].size());
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = 0.5 * (halves[0][i] + halves[1][i]);
    return result;
  }
  /// From the mean of two halves, without the noise of that mean.
  double differenceFromMean(const Pixels& one, const std::array<Pixels, 2>& halves) const {
    const double apart = difference(one, meanOfHalves(halves)),
                 noise = 0.5 * difference(halves[0], halves[1]);
    return std::sqrt(std::max(apart * apart - noise * noise, 0.0));
  }

  /// Root mean square of the difference of what is reflected.
  double difference(const Pixels& one, const Pixels& other) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < one.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        const double apart = albedo_[4 * i + static_cast<std::size_t>(c)] * (one[i][c] - other[i][c]);
        sum += apart * apart;
      }
    return std::sqrt(sum / (3.0 * static_cast<double>(one.size())));
  }
  /// The same against a picture; and that of the picture itself.
  std::pair<double, double> differenceFrom(const Pixels& one, const ImageBuffer& picture) const {
    double sum = 0.0, all = 0.0;
    for (std::size_t i = 0; i < one.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        const double right = picture.values()[3 * i + static_cast<std::size_t>(c)],
                     apart = albedo_[4 * i + static_cast<std::size_t>(c)] * one[i][c] - right;
        sum += apart * apart;
        all += right * right;
      }
    const double count = 3.0 * static_cast<double>(one.size());
    return {std::sqrt(sum / count), std::sqrt(all / count)};
  }

 private:
  Lit lit_;
  VolumeOnHost host_;
  GBuffer gbuffer_;
  std::vector<float> positions_, albedo_;

  static Scene sized(const std::string& name, const Picture& picture) {
    Scene scene = committed(name);
    scene.cameras.front().width = picture.width;
    scene.cameras.front().height = picture.height;
    return scene;
  }
};

}  // namespace

TEST_CASE("steps and noise of a hundred rays are small beside what voxels and two bands make of light") {
  const Picture picture{24, 24, 256};
  const Transported volume("cornell", 32, picture);
  const Pixels boxes = volume.boxes(1024), exact = volume.passes("exact", "surface", 2000),
               steps = volume.passes("steps", "surface", 2000), few = volume.passes("steps", "surface", 100);
  const auto [voxels, none] =
      volume.differenceFrom(boxes, referenceOf(volume.scene(), picture).layers.at("one_bounce_diffuse"));
  const double bands = volume.difference(exact, boxes) / none, walk = volume.difference(steps, exact) / none,
               noise = volume.difference(few, steps) / none;
  CAPTURE(voxels / none, bands, walk, noise);
  CHECK(voxels / none < 0.35);
  CHECK(bands < 0.35);
  CHECK(walk < 0.3 * bands);
  CHECK(noise < 0.5 * bands);
  // Noise falls as the root of the rays.
  CHECK(volume.difference(volume.passes("steps", "surface", 400), steps) < 0.75 * noise * none);
}

// The table of the card; minutes.
TEST_CASE("the four differences between triangles and a hundred rays", "[.]") {
  struct Row {
    const char* scene;
    int resolution;
    double voxels = 0.0, bands = 0.0, harmonics = 0.0, steps = 0.0, noise = 0.0, all = 0.0;
  };
  constexpr int kStrata = 32, kMany = 10000, kSeeds = 4;
  KeptTable table("imperfect_volumes.differences", {{"voxels", 3, 0.015},
                                                    {"bands", 3, 0.015},
                                                    {"harmonics", 3, 0.015},
                                                    {"steps", 3, 0.01},
                                                    {"noise", 3, 0.015},
                                                    {"all", 3, 0.015}});
  for (const Row& row : {Row{"cornell", 16}, Row{"cornell", 32}, Row{"cornell", 64}, Row{"cornell", 128},
                         Row{"arcade", 16}, Row{"arcade", 32}, Row{"arcade", 64}, Row{"arcade", 128}}) {
    const Picture picture =
        std::string(row.scene) == "cornell" ? Picture{24, 24, 1024} : Picture{32, 18, 1024};
    const Transported volume(row.scene, row.resolution, picture);
    const Pixels boxes = volume.boxes(4096), steps = volume.passes("steps", "surface", kMany);
    const Transported::Quadrature exact = volume.quadrature(kStrata);
    const ImageBuffer truth = referenceOf(volume.scene(), picture).layers.at("one_bounce_diffuse");
    const auto [voxels, none] = volume.differenceFrom(boxes, truth);
    double noise = 0.0;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      const double one =
          volume.difference(volume.passes("steps", "surface", 100, static_cast<std::uint64_t>(seed)), steps);
      noise += one * one / kSeeds;
    }
    const Row found{row.scene,
                    row.resolution,
                    voxels / none,
                    volume.differenceFromMean(boxes, exact.surface) / none,
                    volume.differenceFromMean(boxes, exact.harmonics) / none,
                    volume.differenceFromMean(steps, exact.surface) / none,
                    std::sqrt(noise) / none,
                    volume.differenceFrom(volume.passes("steps", "surface", 100), truth).first / none};
    table.row(fmt::format("{}, {} voxels", found.scene, found.resolution),
              {found.voxels, found.bands, found.harmonics, found.steps, found.noise, found.all});
    CHECK(found.harmonics > found.bands);
    CHECK(found.steps < 0.3 * found.bands);
    CHECK(found.noise < 0.5 * found.bands);
  }
}
