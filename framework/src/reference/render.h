// All pixels of a picture, in tiles that threads take in any order.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>

#include "lumivox/base/picture.h"
#include "lumivox/reference/path_tracer.h"
#include "reference/integrator.h"

namespace lumivox::reference {

/// What the picture depends on, in the one form that the tracer and the cache's key share: nothing left at
/// "the default".
struct ResolvedOptions {
  ReferenceOptions options;
  SceneSnapshot snapshot;  ///< at options.time, from options.camera, at the resolution of the picture
};
/// Throws Error on options that make no picture.
ResolvedOptions resolve(const Scene& scene, const ReferenceOptions& options);

/// Everything that is built once before the first ray.
struct Tracer {
  Tracer(const Scene& scene, const ResolvedOptions& resolved);

  RayScene rays;
  LightSampler lights;
  Integrator integrator;
};

/// Mean and variance of the mean of the paths of one pixel.
class PixelStatistics {
 public:
  static constexpr int kRadianceLayers = 7;
  void add(const PathSample& sample) {
    const glm::vec3 oneBounce = sample.direct + sample.oneBounceDiffuse + sample.oneBounceGlossy;
    const glm::vec3 radiances[kRadianceLayers] = {
        sample.direct,          sample.oneBounceDiffuse, sample.oneBounceGlossy, oneBounce,
        sample.indirectDiffuse, sample.indirectGlossy,   sample.full()};
    std::array<float, kChannels> values;
    for (std::size_t layer = 0; layer < kRadianceLayers; ++layer) {
      for (std::size_t channel = 0; channel < 3; ++channel) {
        values[3 * layer + channel] = radiances[layer][static_cast<int>(channel)];
      }
    }
    values[kChannels - 1] = sample.unoccluded;
    for (std::size_t i = 0; i < kChannels; ++i) sum_[i] += static_cast<double>(values[i]);
    for (std::size_t i = 0; i < kChannels; ++i) {
      squares_[i] += static_cast<double>(values[i]) * static_cast<double>(values[i]);
    }
    ++count_;
  }
  float mean(int channel) const { return static_cast<float>(sum_[at(channel)] / count_); }
  float varianceOfMean(int channel) const {
    const double sum = sum_[at(channel)];
    const double centred = std::max(0.0, squares_[at(channel)] - sum * sum / count_);
    return static_cast<float>(centred / (count_ - 1.0) / count_);
  }

 private:
  static constexpr std::size_t kChannels = 3 * kRadianceLayers + 1;  ///< the last is the occlusion
  static std::size_t at(int channel) { return static_cast<std::size_t>(channel); }
  std::array<double, kChannels> sum_{}, squares_{};
  double count_ = 0.0;
};

/// The pictures that pixels are written to.
class Film {
 public:
  Film(int width, int height);
  void write(int x, int y, const PixelStatistics& pixel);
  LayeredPicture take();

 private:
  std::array<Picture, PixelStatistics::kRadianceLayers + 1> means_, variances_;
};

/// The picture's tiles, row by row.
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

/// Paths through the pixels of one tile. The numbers of a path depend on seed, pixel and sample only.
template <class Rays>
void renderTile(const Tracer& tracer, const ResolvedOptions& resolved, const Tiles& tiles, int tile,
                Rays& rays, Film& film) {
  const CameraView& camera = resolved.snapshot.camera;
  // The direction is affine in the picture's coordinates.
  const glm::vec3 corner = camera.direction(0.0f, 0.0f);
  const auto width = static_cast<float>(camera.width), height = static_cast<float>(camera.height);
  const glm::vec3 perColumn = (camera.direction(width, 0.0f) - corner) / width;
  const glm::vec3 perRow = (camera.direction(0.0f, height) - corner) / height;
  tiles.forEachPixel(tile, [&](int x, int y) {
    PixelStatistics pixel;
    const auto stream = static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(camera.width) +
                        static_cast<std::uint32_t>(x);
    for (int sample = 0; sample < resolved.options.samplesPerPixel; ++sample) {
      RandomStream random(resolved.options.seed, stream, static_cast<std::uint32_t>(sample));
      const float column = static_cast<float>(x) + random.uniform(),
                  row = static_cast<float>(y) + random.uniform();
      const glm::vec3 direction = glm::normalize(corner + column * perColumn + row * perRow);
      pixel.add(tracer.integrator.trace(rays, random, camera.eye, direction));
    }
    film.write(x, y, pixel);
  });
}

/// Threads that a request of `threads` (0: all) gets.
int threadsOf(int threads);

/// Runs work(tile) for all tiles on `threads` threads (0: all).
void forEachTile(const Tiles& tiles, int threads, const std::function<void(int)>& work);

}  // namespace lumivox::reference
