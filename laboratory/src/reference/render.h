// Renders all pixels of an image in tiles, which threads take in any order.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lumivox/base/image.h"
#include "lumivox/reference/path_tracer.h"
#include "reference/integrator.h"

namespace lumivox::reference {

/// Options that the image depends on, with all defaults filled in. The tracer and the cache key share them.
struct ResolvedOptions {
  ReferenceOptions options;
  SceneSnapshot snapshot;  ///< at options.time, from options.camera, at the resolution of the image
};
/// Throws Error for invalid options.
ResolvedOptions resolve(const Scene& scene, const ReferenceOptions& options);

/// Everything that is built before the first ray.
struct Tracer {
  Tracer(const Scene& scene, const ResolvedOptions& resolved);

  RayScene rays;
  EnvironmentLight environment;
  LightSampler lights;
  Media media;
  Integrator integrator;
};

/// The radiance layers that one path contributes to, in this order.
inline constexpr std::array<const char*, 7> kSurfaceLayers = {
    "direct", "one_bounce_diffuse", "one_bounce_glossy", "one_bounce", "indirect_diffuse", "indirect_glossy",
    "full"};
/// The same with media; their layers follow those of surfaces.
inline constexpr std::array<const char*, 11> kMediaLayers = {"direct",
                                                             "one_bounce_diffuse",
                                                             "one_bounce_glossy",
                                                             "one_bounce",
                                                             "indirect_diffuse",
                                                             "indirect_glossy",
                                                             "full",
                                                             "transmittance",
                                                             "scattered_single",
                                                             "scattered_multiple",
                                                             "scattered"};

/// A real surface contributes to the layer "full" only.
inline std::array<glm::vec3, kSurfaceLayers.size()> radiancesOf(const PathSample& sample) {
  if (sample.real) {
    std::array<glm::vec3, kSurfaceLayers.size()> radiances{};
    radiances.back() = sample.full();
    return radiances;
  }
  const glm::vec3 oneBounce = sample.direct + sample.oneBounceDiffuse + sample.oneBounceGlossy;
  return {sample.direct,          sample.oneBounceDiffuse, sample.oneBounceGlossy, oneBounce,
          sample.indirectDiffuse, sample.indirectGlossy,   sample.full()};
}
inline std::array<glm::vec3, kMediaLayers.size()> radiancesOf(const MediaPathSample& sample) {
  if (sample.surfaces.real) {
    MediaPathSample before = sample;
    before.surfaces = PathSample{};
    std::array<glm::vec3, kMediaLayers.size()> radiances = radiancesOf(before);
    static_assert(std::string_view(kMediaLayers[6]) == "full");
    radiances[6] = sample.full();
    return radiances;
  }
  const PathSample& s = sample.surfaces;
  const glm::vec3 oneBounce =
      sample.transmittance * (s.direct + s.oneBounceDiffuse + s.oneBounceGlossy) + sample.scatteredSingle;
  return {s.direct,
          s.oneBounceDiffuse,
          s.oneBounceGlossy,
          oneBounce,
          s.indirectDiffuse,
          s.indirectGlossy,
          sample.full(),
          sample.transmittance,
          sample.scatteredSingle,
          sample.scatteredMultiple,
          sample.scattered()};
}

/// The layers of a number of bounces, in the order of bounceRadiancesOf().
inline std::array<std::string, 3> bounceLayerNames(int bounces) {
  const std::string name = "bounces_" + std::to_string(bounces);
  return {name, name + "_diffuse", name + "_glossy"};
}
/// `direct`: light of the path without further bounces, in the whole image. `transmittance`: between camera
/// and first surface.
inline std::array<glm::vec3, 3> bounceRadiancesOf(const BounceSums::Sum& sum, const glm::vec3& direct,
                                                  const glm::vec3& transmittance) {
  return {direct + transmittance * (sum.diffuse + sum.glossy) + sum.scattered, sum.diffuse, sum.glossy};
}

/// The layers of the environment's light, in the order of environmentRadiancesOf().
inline constexpr std::array<const char*, 3> kEnvironmentLayers = {"environment", "environment_diffuse",
                                                                  "environment_glossy"};
inline std::array<glm::vec3, 3> environmentRadiancesOf(const PathSample& sample) {
  if (sample.real) return {};
  return {sample.environmentDiffuse + sample.environmentGlossy, sample.environmentDiffuse,
          sample.environmentGlossy};
}

/// Mean and variance of the mean, in one pixel, of the layers that not every reference has: those of numbers
/// of bounces and of the environment.
class FurtherStatistics {
 public:
  explicit FurtherStatistics(std::size_t layers) : sum_(3 * layers), squares_(3 * layers) {}
  void add(const BounceSums& sums, const glm::vec3& direct, const glm::vec3& transmittance) {
    for (const BounceSums::Sum& sum : sums.sums) add(bounceRadiancesOf(sum, direct, transmittance));
  }
  void add(const std::array<glm::vec3, 3>& radiances) {
    for (const glm::vec3& radiance : radiances) {
      for (int i = 0; i < 3; ++i, ++next_) {
        const auto value = static_cast<double>(radiance[i]);
        sum_[next_] += value;
        squares_[next_] += value * value;
      }
    }
  }
  /// The path has added all its layers.
  void endPath() {
    assert(next_ == sum_.size());
    next_ = 0;
    ++count_;
  }
  /// Adds the paths of a later block.
  void add(const FurtherStatistics& block) {
    for (std::size_t i = 0; i < sum_.size(); ++i) {
      sum_[i] += block.sum_[i];
      squares_[i] += block.squares_[i];
    }
    count_ += block.count_;
  }
  /// Calls visit(value) for each number, for reading or writing.
  template <class Visit>
  void forEachNumber(Visit&& visit) {
    for (double& value : sum_) visit(value);
    for (double& value : squares_) visit(value);
    visit(count_);
  }
  std::size_t channels() const { return sum_.size(); }
  float mean(std::size_t channel) const { return static_cast<float>(sum_[channel] / count_); }
  float varianceOfMean(std::size_t channel) const {
    const double centred = std::max(0.0, squares_[channel] - sum_[channel] * sum_[channel] / count_);
    return static_cast<float>(centred / (count_ - 1.0) / count_);
  }

 private:
  std::vector<double> sum_, squares_;
  std::size_t next_ = 0;  ///< channel
  double count_ = 0.0;
};

/// Mean and variance of the mean over the paths of one pixel: radiance layers, then occlusion.
template <std::size_t Layers>
class PixelStatistics {
 public:
  static constexpr std::size_t kChannels = 3 * Layers + 1;
  void add(const std::array<glm::vec3, Layers>& radiances, float unoccluded) {
    std::array<float, kChannels> values;
    for (std::size_t layer = 0; layer < Layers; ++layer) {
      for (std::size_t channel = 0; channel < 3; ++channel) {
        values[3 * layer + channel] = radiances[layer][static_cast<int>(channel)];
      }
    }
    values[kChannels - 1] = unoccluded;
    for (std::size_t i = 0; i < kChannels; ++i) sum_[i] += static_cast<double>(values[i]);
    for (std::size_t i = 0; i < kChannels; ++i) {
      squares_[i] += static_cast<double>(values[i]) * static_cast<double>(values[i]);
    }
    ++count_;
  }
  void addLate(const LateLight& light) {
    for (int channel = 0; channel < 3; ++channel) {
      middle_ += static_cast<double>(light.middle[channel]);
      late_ += static_cast<double>(light.late[channel]);
    }
  }
  /// Adds the paths of a later block.
  void add(const PixelStatistics& block) {
    for (std::size_t i = 0; i < kChannels; ++i) {
      sum_[i] += block.sum_[i];
      squares_[i] += block.squares_[i];
    }
    middle_ += block.middle_;
    late_ += block.late_;
    count_ += block.count_;
  }
  /// Calls visit(value) for each number, for reading or writing.
  template <class Visit>
  void forEachNumber(Visit&& visit) {
    for (double& value : sum_) visit(value);
    for (double& value : squares_) visit(value);
    visit(middle_);
    visit(late_);
    visit(count_);
  }
  /// Sums of the three channels' means.
  double middle() const { return middle_ / count_; }
  double late() const { return late_ / count_; }
  float mean(std::size_t channel) const { return static_cast<float>(sum_[channel] / count_); }
  float varianceOfMean(std::size_t channel) const {
    const double sum = sum_[channel];
    const double centred = std::max(0.0, squares_[channel] - sum * sum / count_);
    return static_cast<float>(centred / (count_ - 1.0) / count_);
  }

 private:
  std::array<double, kChannels> sum_{}, squares_{};
  double middle_ = 0.0, late_ = 0.0;
  double count_ = 0.0;
};

/// The cost of the limit on bounces.
struct CutOff {
  double share =
      0.0;  ///< estimated share of all light that paths with more bounces would bring; 1: unbounded
  double radius = 0.0;  ///< factor by which one further bounce reduces the missing light
};
/// `middle` and `late` are LateLight, summed over the image like `full`. Where bounces shrink by a factor
/// r, late / middle = x (1 + x) with x = r^(N/4), and late x^2 / (1 - x^2) lies beyond the last bounce N.
CutOff cutOffOf(double middle, double late, double full, int bounces);

/// The images that pixels are written to: the radiance layers, the occlusion, the layers of numbers of
/// bounces and those of the environment.
class Film {
 public:
  Film(int width, int height, bool media, bool environment, const std::vector<int>& bounceLayers);
  template <std::size_t Layers>
  void write(int x, int y, const PixelStatistics<Layers>& pixel) {
    assert(means_.size() >= Layers + 1);
    for (std::size_t layer = 0; layer <= Layers; ++layer) {
      for (int channel = 0; channel < means_[layer].channels(); ++channel) {
        means_[layer].at(x, y, channel) = pixel.mean(3 * layer + static_cast<std::size_t>(channel));
        variances_[layer].at(x, y, channel) =
            pixel.varianceOfMean(3 * layer + static_cast<std::size_t>(channel));
      }
    }
    const std::size_t index = static_cast<std::size_t>(y) * static_cast<std::size_t>(means_[0].width()) +
                              static_cast<std::size_t>(x);
    middle_[index] = pixel.middle();
    late_[index] = pixel.late();
  }
  std::size_t furtherLayers() const { return furtherLayers_; }
  void write(int x, int y, const FurtherStatistics& pixel) {
    const std::size_t first = means_.size() - pixel.channels() / 3;
    for (std::size_t channel = 0; channel < pixel.channels(); ++channel) {
      const int component = static_cast<int>(channel % 3);
      means_[first + channel / 3].at(x, y, component) = pixel.mean(channel);
      variances_[first + channel / 3].at(x, y, component) = pixel.varianceOfMean(channel);
    }
  }
  /// Sums in pixel order, so that the result does not depend on threads.
  CutOff cutOff(int bounces) const;
  LayeredImage take();

 private:
  std::vector<std::string> names_;
  std::size_t furtherLayers_;
  std::vector<ImageBuffer> means_, variances_;
  std::vector<double> middle_, late_;  ///< LateLight of each pixel
};

/// The image's tiles, row by row.
class Tiles {
 public:
  static constexpr int kSize = 16;
  Tiles(int width, int height)
      : width_(width),
        height_(height),
        columns_((width + kSize - 1) / kSize),
        rows_((height + kSize - 1) / kSize) {}
  int count() const { return columns_ * rows_; }
  template <class Visit>
  void forEachPixel(int tile, Visit&& visit) const {
    const int left = tile % columns_ * kSize, top = tile / columns_ * kSize;
    for (int y = top; y < std::min(top + kSize, height_); ++y) {
      for (int x = left; x < std::min(left + kSize, width_); ++x) visit(x, y);
    }
  }

 private:
  int width_, height_, columns_, rows_;
};

/// The start of a path.
struct CameraRay {
  glm::vec3 origin, direction;  ///< direction: unit length
};

/// The ray through a point of the image, given by the direction from the eye whose component along the view
/// axis is 1. Through a lens: from a point of it, uniform by area, to where the plane in focus meets that
/// direction. A pinhole takes no random numbers.
inline CameraRay cameraRay(const CameraView& camera, const glm::vec3& direction, RandomStream& random) {
  if (!(camera.aperture > 0.0f)) return {camera.eye, glm::normalize(direction)};
  const float radius = 0.5f * camera.aperture * std::sqrt(random.uniform());
  const float angle = 2.0f * glm::pi<float>() * random.uniform();
  const glm::vec3 onLens = (radius * std::cos(angle)) * camera.right + (radius * std::sin(angle)) * camera.up;
  return {camera.eye + onLens, glm::normalize(camera.focus * direction - onLens)};
}

/// Samples of a pixel whose sums are made by themselves and then added in order. The sums of blocks that were
/// rendered elsewhere therefore add up to the same bits. One block has as many as the default asks for at
/// most.
inline constexpr int kBlockSamples = 4096;
inline int blocksOf(int samples) {
  return (samples + kBlockSamples - 1) / kBlockSamples;
}
struct BlockRange {
  int first = 0, end = 0;
};

/// Paths of some blocks of samples through the pixels of one tile: addPath(statistics, further statistics,
/// random, ray) each, then write(x, y, statistics, further statistics). The numbers of a path depend on seed,
/// pixel and sample only.
template <std::size_t Layers, class AddPath, class Write>
void renderPixels(const ResolvedOptions& resolved, const Tiles& tiles, int tile, BlockRange blocks,
                  std::size_t furtherLayers, AddPath&& addPath, Write&& write) {
  const CameraView& camera = resolved.snapshot.camera;
  // The direction is affine in the image's coordinates.
  const glm::vec3 corner = camera.direction(0.0f, 0.0f);
  const auto width = static_cast<float>(camera.width), height = static_cast<float>(camera.height);
  const glm::vec3 perColumn = (camera.direction(width, 0.0f) - corner) / width;
  const glm::vec3 perRow = (camera.direction(0.0f, height) - corner) / height;
  tiles.forEachPixel(tile, [&](int x, int y) {
    PixelStatistics<Layers> pixel;
    FurtherStatistics further(furtherLayers);
    const auto stream = static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(camera.width) +
                        static_cast<std::uint32_t>(x);
    for (int block = blocks.first; block < blocks.end; ++block) {
      PixelStatistics<Layers> ofBlock;
      FurtherStatistics furtherOfBlock(furtherLayers);
      const int end = std::min(resolved.options.samplesPerPixel, (block + 1) * kBlockSamples);
      for (int sample = block * kBlockSamples; sample < end; ++sample) {
        RandomStream random(resolved.options.seed, stream, static_cast<std::uint32_t>(sample));
        const float column = static_cast<float>(x) + random.uniform(),
                    row = static_cast<float>(y) + random.uniform();
        addPath(ofBlock, furtherOfBlock, random,
                cameraRay(camera, corner + column * perColumn + row * perRow, random));
        furtherOfBlock.endPath();
      }
      pixel.add(ofBlock);
      further.add(furtherOfBlock);
    }
    write(x, y, pixel, further);
  });
}

/// write(x, y, statistics, further statistics) gets each pixel's sums over some blocks of samples.
template <class Rays, class Write>
void renderBlocks(const Tracer& tracer, const ResolvedOptions& resolved, const Tiles& tiles, int tile,
                  BlockRange blocks, std::size_t furtherLayers, Rays& rays, Write&& write) {
  const Integrator& integrator = tracer.integrator;
  BounceSums sums(resolved.options.bounceLayers);
  BounceSums* const asked = sums.sums.empty() ? nullptr : &sums;
  const bool environment = furtherLayers > 3 * sums.sums.size();
  if (tracer.media.empty()) {
    renderPixels<kSurfaceLayers.size()>(
        resolved, tiles, tile, blocks, furtherLayers,
        [&](auto& pixel, auto& further, RandomStream& random, const CameraRay& ray) {
          sums.clear();
          const PathSample sample = integrator.trace(rays, random, ray.origin, ray.direction, asked);
          if (sample.real) sums.clear();
          pixel.add(radiancesOf(sample), sample.real ? 1.0f : sample.unoccluded);
          pixel.addLate(sample.lateLight);
          further.add(sums, sample.real ? glm::vec3(0.0f) : sample.direct, glm::vec3(1.0f));
          if (environment) further.add(environmentRadiancesOf(sample));
        },
        write);
  } else {
    renderPixels<kMediaLayers.size()>(
        resolved, tiles, tile, blocks, furtherLayers,
        [&](auto& pixel, auto& further, RandomStream& random, const CameraRay& ray) {
          sums.clear();
          const MediaPathSample sample =
              integrator.traceThroughMedia(rays, random, ray.origin, ray.direction, asked);
          const bool real = sample.surfaces.real;
          if (real) sums.clear();
          pixel.add(radiancesOf(sample), real ? 1.0f : sample.surfaces.unoccluded);
          pixel.addLate(sample.lateLight);
          further.add(sums,
                      sample.transmittance * (real ? glm::vec3(0.0f) : sample.surfaces.direct) +
                          sample.scatteredSingle,
                      sample.transmittance);
          if (environment) further.add(environmentRadiancesOf(sample.surfaces));
        },
        write);
  }
}

template <class Rays>
void renderTile(const Tracer& tracer, const ResolvedOptions& resolved, const Tiles& tiles, int tile,
                Rays& rays, Film& film) {
  renderBlocks(tracer, resolved, tiles, tile, {0, blocksOf(resolved.options.samplesPerPixel)},
               film.furtherLayers(), rays, [&](int x, int y, const auto& pixel, const auto& further) {
                 film.write(x, y, pixel);
                 if (further.channels() > 0) film.write(x, y, further);
               });
}

/// A scene with everything that stands in the place of what its captures saw.
struct PreparedScene {
  /// Error for less than two samples per pixel, and as resolve().
  PreparedScene(const Scene& virtualScene, const ReferenceOptions& options);
  PreparedScene(const PreparedScene&) = delete;
  PreparedScene& operator=(const PreparedScene&) = delete;

  ResolvedOptions resolved;
  std::optional<Scene> merged;
  const Scene& scene;  ///< that is traced
};
/// The image of a film that is done, with its provenance.
LayeredImage finished(const Scene& virtualScene, const ResolvedOptions& resolved, Film& film);

/// The cut-off recorded in the attributes of a reference; none when they contain no plausible one.
std::optional<CutOff> cutOffIn(const std::map<std::string, std::string>& attributes);

/// Warns if, by the attributes of a reference, the limit on bounces costs more than 1 % of the light.
void warnOfCutOff(const std::map<std::string, std::string>& attributes);

/// The number of threads for a request of `threads` (0: all).
int threadsOf(int threads);

/// Runs work(tile) for all tiles on `threads` threads (0: all).
void forEachTile(const Tiles& tiles, int threads, const std::function<void(int)>& work);

}  // namespace lumivox::reference
