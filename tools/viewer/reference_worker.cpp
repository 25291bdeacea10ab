#include "viewer/reference_worker.h"

#include <algorithm>
#include <chrono>
#include <thread>

namespace lumivox::viewer {
namespace {

constexpr int kMostSamplesOfRound = 64;

bool isVariance(const std::string& layer) {
  return layer.ends_with(".variance");
}

}  // namespace

bool ReferenceWish::isSameView(const ReferenceWish& other) const {
  const Camera &a = camera, &b = other.camera;
  return scene == other.scene && a.eye == b.eye && a.target == b.target && a.up == b.up && a.fov == b.fov &&
         a.aperture == b.aperture && a.focus == b.focus && time == other.time && width == other.width &&
         height == other.height && bounceLayers == other.bounceLayers && samples == other.samples;
}

void addRound(LayeredImage& mean, int samples, const LayeredImage& round, int roundSamples) {
  const double all = samples + roundSamples;
  for (auto& [name, layer] : mean.layers) {
    const bool squared = isVariance(name);
    const double before = samples / all, added = roundSamples / all;
    const auto keep = static_cast<float>(squared ? before * before : before),
               take = static_cast<float>(squared ? added * added : added);
    const std::vector<float>& values = round.layers.at(name).values();
    for (std::size_t i = 0; i < values.size(); ++i)
      layer.values()[i] = keep * layer.values()[i] + take * values[i];
  }
}

ReferenceWorker::Work makeReferenceWork() {
  return [](const ReferenceWish& wish, ReferenceWorker::Turn& turn) {
    const auto start = std::chrono::steady_clock::now();
    ConvergingReference so{wish, {}, 0, 0.0, {}};
    try {
      // The tracer finds the camera by its name.
      Scene scene = *wish.scene;
      scene.cameras = {wish.camera};
      ReferenceOptions options;
      options.time = wish.time;
      options.width = wish.width;
      options.height = wish.height;
      options.bounceLayers = wish.bounceLayers;
      options.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()) - 1);
      options.progress = options.useCache = false;
      options.stop = &turn.outdated();
      for (std::uint64_t round = 1; so.samples < wish.samples && !turn.outdated(); ++round) {
        options.seed = round;
        options.samplesPerPixel =
            std::min({std::max(so.samples, 2), kMostSamplesOfRound, std::max(2, wish.samples - so.samples)});
        LayeredImage image = renderReference(scene, options);
        if (so.samples == 0) {
          so.image = std::move(image);
        } else {
          addRound(so.image, so.samples, image, options.samplesPerPixel);
        }
        so.samples += options.samplesPerPixel;
        so.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        turn.give(std::make_shared<const ConvergingReference>(so));
      }
    } catch (const StoppedError&) {
    } catch (const std::exception& error) {
      so.error = error.what();
      turn.give(std::make_shared<const ConvergingReference>(so));
    }
  };
}

}  // namespace lumivox::viewer
