// Committed scenes as imperfect volumes, on the device and on the host, and the committed pipeline with other
// voxelizers.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "lumivox/measure/voxel_walk.h"
#include "support/imperfect_volumes.h"
#include "support/near_field_scene.h"

namespace lumivox::test::volumes {

/// A scene as a lit imperfect volume.
struct Lit {
  Scene scene;
  SceneSnapshot snapshot;
  OccupancyGrid opacity;
  AttributeGrid attributes;
  BinaryGrid bits;
  ShGrid reflected;
  Lit(const std::string& name, int resolution) : Lit(committed(name), resolution) {}
  Lit(Scene made, int resolution) : scene(std::move(made)), snapshot(snapshotOf(scene, 0.0)) {
    const VoxelFragments points =
        LonePass("voxelization.points", scene, {{"resolution", resolution}, {"adaptive", "on"}})
            .out<VoxelFragments>("fragments");
    LonePass average("voxelization.average", scene), inject("imperfect_volumes.inject", scene);
    average.in("fragments", points);
    opacity = average.out<OccupancyGrid>("opacity");
    attributes = average.out<AttributeGrid>("attributes");
    bits = average.out<BinaryGrid>("bits");
    reflected = inject.in("fragments", points).in("shadow", shadowsOf(scene)).out<ShGrid>("reflected");
  }
  const GridPlacement& grid() const { return opacity.grid; }
  glm::vec3 middleOf(const glm::ivec3& voxel) const {
    return grid().low + (glm::vec3(voxel) + 0.5f) * grid().voxelSize;
  }
};

/// The volume read back, with the light that arrives in a voxel computed by plain Monte Carlo in double
/// precision.
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
  /// Mean normals of the voxels, rgba.
  const std::vector<float>& normals() const { return normals_; }

  /// SH coefficients of the light that arrives in a voxel. surface: senders emit by the side that is seen.
  /// harmonics: they emit by their two SH bands.
  struct Coefficients {
    std::array<glm::dvec4, 3> surface{}, harmonics{};
  };
  /// Integrates over jittered strata of the sphere: `strata` along z and twice as many around it.
  Coefficients quadratureIn(const glm::ivec3& voxel, int strata, unsigned seed,
                            const glm::dvec3& environment) const {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit;
    Coefficients sum;
    const double weight = 4.0 * kPi / (2.0 * strata * strata);
    for (int i = 0; i < strata; ++i)
      for (int j = 0; j < 2 * strata; ++j) {
        const double z = 2.0 * (i + unit(random)) / strata - 1.0, angle = kPi * (j + unit(random)) / strata,
                     sine = std::sqrt(std::max(1.0 - z * z, 0.0));
        const glm::dvec3 way(sine * std::cos(angle), sine * std::sin(angle), z);
        const auto met = meets(voxel, way);
        const glm::dvec3 surface = met ? sentBy(*met, way) : environment,
                         harmonics = met ? bandsOf(*met, way) : environment;
        for (std::size_t c = 0; c < 3; ++c) {
          const glm::dvec4 basis = weight * basisAlong(way);
          sum.surface[c] += surface[static_cast<int>(c)] * basis;
          sum.harmonics[c] += harmonics[static_cast<int>(c)] * basis;
        }
      }
    return sum;
  }

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
      const glm::dvec4 basis = basisAlong(way);
      for (std::size_t k = 0; k < 12; ++k) {
        const double value = 4.0 * kPi * radiance[static_cast<int>(k / 4)] * basis[static_cast<int>(k % 4)];
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

  /// The radiance of the voxel's side that a ray in direction `way` hits.
  glm::dvec3 sentBy(const glm::ivec3& voxel, const glm::dvec3& way) const {
    const std::size_t i = 4 * set_.bitOf(voxel);
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

 private:
  VoxelSet set_;
  std::vector<float> normals_;
  std::array<std::vector<float>, 3> sent_;

  static glm::dvec4 basisAlong(const glm::dvec3& way) { return {kY0, kY1 * way.y, kY1 * way.z, kY1 * way.x}; }
  std::optional<glm::ivec3> meets(const glm::ivec3& voxel, const glm::dvec3& way) const {
    const glm::vec3 direction(way), origin = glm::vec3(voxel) + 0.5f + 0.8660255f * direction;
    const auto hit = firstVoxel(set_, origin, direction);
    return hit ? std::optional(hit->voxel) : std::nullopt;
  }
  glm::dvec3 seenFrom(const glm::ivec3& voxel, const glm::dvec3& way) const {
    const auto met = meets(voxel, way);
    return met ? sentBy(*met, way) : glm::dvec3(0.0);
  }
  /// The radiance of a voxel's two SH bands towards the origin of a ray that hits it along `way`.
  glm::dvec3 bandsOf(const glm::ivec3& voxel, const glm::dvec3& way) const {
    const std::size_t i = 4 * set_.bitOf(voxel);
    glm::dvec3 radiance;
    for (int c = 0; c < 3; ++c) {
      const auto& sent = sent_[static_cast<std::size_t>(c)];
      radiance[c] = std::max(
          glm::dot(glm::dvec4(sent[i], sent[i + 1], sent[i + 2], sent[i + 3]), basisAlong(-way)), 0.0);
    }
    return radiance;
  }
};

/// How the volume is voxelized, and further lines for its passes.
struct Made {
  bool points = true, reprojected = true;
  /// Further lines: for all that read neighbours, and for `march` alone.
  std::string ofReading = {}, ofLight = {};
};

/// The committed pipeline of light and occlusion with such a volume.
inline Pipeline volumePipeline(const Made& made) {
  const Pipeline committedText = pipeline("imperfect_volumes_occlusion");
  std::string text = committedText.document->source;
  const auto cut = [&](const std::string& from, const std::string& to) {
    const std::size_t first = text.find(from), last = text.find(to, first);
    REQUIRE(first != std::string::npos);
    REQUIRE(last != std::string::npos);
    text.erase(first, last + to.size() - first);
  };
  const auto replace = [&](const std::string& old, const std::string& by) {
    REQUIRE(text.find(old) != std::string::npos);
    for (std::size_t at = text.find(old); at != std::string::npos; at = text.find(old, at + by.size()))
      text.replace(at, old.size(), by);
  };
  if (!made.reprojected) {
    cut("  pass voxels voxelization.reproject", "}\n");
    replace("voxels.fragments", "points.fragments");
  }
  if (!made.points) {
    cut("  pass points voxelization.points", "}\n");
    replace("fragments points.fragments", "resolution $resolution");
    for (const char* name : {"  param points", "  param adaptive", "  param density"}) cut(name, "\n");
  }
  for (const char* pass : {"imperfect_volumes.march {\n", "imperfect_volumes.occlude {\n"})
    replace(pass, pass + made.ofReading);
  replace("imperfect_volumes.march {\n", "imperfect_volumes.march {\n" + made.ofLight);
  replace("imperfect_volumes.gather {\n", "imperfect_volumes.gather {\n" + made.ofReading);
  return Pipeline::parse(text, committedText.file);
}

}  // namespace lumivox::test::volumes
