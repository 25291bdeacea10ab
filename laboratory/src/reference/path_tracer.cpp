#include "lumivox/reference/path_tracer.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <sstream>

#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "reference/cache.h"
#include "reference/real_scene.h"
#include "reference/render.h"

namespace lumivox {
namespace reference {
namespace {

void require(bool good, const char* option, const std::string& value, const char* expected) {
  if (!good) throw Error(fmt::format("reference: {} is {}; expected {}", option, value, expected));
}

}  // namespace

ResolvedOptions resolve(const Scene& scene, const ReferenceOptions& given) {
  require(given.samplesPerPixel >= 1, "the number of samples per pixel",
          std::to_string(given.samplesPerPixel), "at least 1");
  require(given.bounces >= 0, "the number of bounces", std::to_string(given.bounces), "at least 0");
  require(given.threads >= 0, "the number of threads", std::to_string(given.threads),
          "at least 0 (0 for all)");
  require(given.width >= 0 && given.height >= 0, "the resolution",
          fmt::format("{} x {}", given.width, given.height),
          "positive numbers of pixels (0 for the camera's)");
  require(std::isfinite(given.time), "the time", std::to_string(given.time), "a finite number of seconds");
  require(given.occlusionDistance >= 0.0 && !std::isnan(given.occlusionDistance),
          "the distance of ambient occlusion", std::to_string(given.occlusionDistance),
          "a positive number of metres (0 for a tenth of the scene's diagonal)");
  for (const int bounces : given.bounceLayers)
    require(bounces >= 1 && bounces <= given.bounces, "a number of bounces with layers of its own",
            std::to_string(bounces), "at least 1 and at most the number of bounces");
  ResolvedOptions resolved{given, snapshotOf(scene, given.time, given.camera, given.width, given.height)};
  std::vector<int>& layers = resolved.options.bounceLayers;
  std::sort(layers.begin(), layers.end());
  layers.erase(std::unique(layers.begin(), layers.end()), layers.end());
  resolved.options.camera = scene.camera(given.camera).name;
  resolved.options.width = resolved.snapshot.camera.width;
  resolved.options.height = resolved.snapshot.camera.height;
  if (given.occlusionDistance == 0.0)
    resolved.options.occlusionDistance = ambientOcclusionDistance(resolved.snapshot.bounds);
  return resolved;
}

Tracer::Tracer(const Scene& scene, const ResolvedOptions& resolved)
    : rays(scene, resolved.snapshot),
      environment(scene),
      lights(rays, resolved.snapshot, environment),
      media(scene, resolved.snapshot),
      integrator{rays,
                 lights,
                 media,
                 environment,
                 resolved.options.bounces,
                 resolved.options.roulette,
                 static_cast<float>(resolved.options.occlusionDistance)} {}

Film::Film(int width, int height, bool media, bool environment, const std::vector<int>& bounceLayers)
    : furtherLayers_(3 * (bounceLayers.size() + (environment ? 1 : 0))) {
  if (media) {
    names_.assign(kMediaLayers.begin(), kMediaLayers.end());
  } else {
    names_.assign(kSurfaceLayers.begin(), kSurfaceLayers.end());
  }
  for (std::size_t layer = 0; layer < names_.size(); ++layer) means_.emplace_back(width, height, 3);
  names_.push_back("ambient_occlusion");
  means_.emplace_back(width, height, 1);
  for (const int bounces : bounceLayers) {
    for (const std::string& name : bounceLayerNames(bounces)) {
      names_.push_back(name);
      means_.emplace_back(width, height, 3);
    }
  }
  for (std::size_t layer = 0; environment && layer < kEnvironmentLayers.size(); ++layer) {
    names_.push_back(kEnvironmentLayers[layer]);
    means_.emplace_back(width, height, 3);
  }
  variances_ = means_;
  middle_.assign(means_[0].pixelCount(), 0.0);
  late_ = middle_;
}

CutOff cutOffOf(double middle, double late, double full, int bounces) {
  constexpr int kFewestBounces = 8;  // with fewer, the quarters show no geometric series
  if (bounces < kFewestBounces || !(middle > 0.0) || !(late > 0.0) || !(full > 0.0)) return {};
  const double quarter = 0.5 * (std::sqrt(1.0 + 4.0 * late / middle) - 1.0);
  if (quarter >= 1.0) return {1.0, 1.0};
  const double beyond = late * quarter * quarter / (1.0 - quarter * quarter);
  return {beyond / (full + beyond), std::pow(quarter, 4.0 / bounces)};
}

CutOff Film::cutOff(int bounces) const {
  const auto layer = std::find(names_.begin(), names_.end(), "full");
  const std::vector<float>& full = means_[static_cast<std::size_t>(layer - names_.begin())].values();
  return cutOffOf(std::accumulate(middle_.begin(), middle_.end(), 0.0),
                  std::accumulate(late_.begin(), late_.end(), 0.0),
                  std::accumulate(full.begin(), full.end(), 0.0), bounces);
}

LayeredImage Film::take() {
  LayeredImage result;
  for (std::size_t layer = 0; layer < names_.size(); ++layer) {
    result.layers.emplace(names_[layer], std::move(means_[layer]));
    result.layers.emplace(names_[layer] + ".variance", std::move(variances_[layer]));
  }
  return result;
}

std::optional<CutOff> cutOffIn(const std::map<std::string, std::string>& attributes) {
  const auto entry = attributes.find("cut_off");
  if (entry == attributes.end()) return std::nullopt;
  CutOff cutOff;
  std::istringstream words(entry->second);
  if (!(words >> cutOff.share >> cutOff.radius) || !(words >> std::ws).eof()) return std::nullopt;
  const bool good =
      cutOff.share >= 0.0 && cutOff.share <= 1.0 && cutOff.radius >= 0.0 && cutOff.radius <= 1.0;
  return good ? std::optional(cutOff) : std::nullopt;
}

void warnOfCutOff(const std::map<std::string, std::string>& attributes) {
  constexpr double kTolerable = 0.01;
  const std::optional<CutOff> cutOff = cutOffIn(attributes);
  if (!cutOff || cutOff->share <= kTolerable) return;
  const auto text = [&](const char* name) {
    const auto found = attributes.find(name);
    return found == attributes.end() ? std::string() : found->second;
  };
  int bounces = 0;
  std::istringstream(text("bounces")) >> bounces;
  const std::string enough =
      cutOff->radius > 0.0 && cutOff->radius < 1.0
          ? fmt::format("about {:.0f} bounces leave out 1 %",
                        bounces + std::ceil(std::log(kTolerable / cutOff->share) / std::log(cutOff->radius)))
          : "the light hardly decreases from bounce to bounce";
  logWarning(
      "reference of {}: paths end after {} bounces, which leaves out about {:.2g} % of the light; {} (--bounces)",
      text("scene"), bounces, 100.0 * cutOff->share, enough);
}

int threadsOf(int threads) {
  return threads == 0 ? tbb::this_task_arena::max_concurrency() : threads;
}

void forEachTile(const Tiles& tiles, int threads, const std::function<void(int)>& work) {
  tbb::task_arena arena(threadsOf(threads));
  arena.execute([&] { tbb::parallel_for(0, tiles.count(), work); });
}

PreparedScene::PreparedScene(const Scene& virtualScene, const ReferenceOptions& given)
    : resolved(resolve(virtualScene, given)),
      merged(withRealScenes(virtualScene)),
      scene(merged ? *merged : virtualScene) {
  const ReferenceOptions& options = resolved.options;
  if (merged)
    resolved.snapshot = snapshotOf(scene, options.time, options.camera, options.width, options.height);
  if (options.samplesPerPixel < 2) {
    throw Error(
        "reference: one sample per pixel; expected at least 2, because the noise is estimated from their spread");
  }
}

LayeredImage finished(const Scene& virtualScene, const ResolvedOptions& resolved, Film& film) {
  const CutOff cutOff = film.cutOff(resolved.options.bounces);
  LayeredImage image = film.take();
  image.attributes = provenance(virtualScene, resolved);
  image.attributes["cut_off"] = fmt::format("{:.3g} {:.6g}", cutOff.share, cutOff.radius);
  if (resolved.options.progress) warnOfCutOff(image.attributes);
  return image;
}

}  // namespace reference

LayeredImage renderReference(const Scene& virtualScene, const ReferenceOptions& given) {
  using namespace reference;
  const PreparedScene prepared(virtualScene, given);
  const ResolvedOptions& resolved = prepared.resolved;
  const ReferenceOptions& options = resolved.options;
  const Tracer tracer(prepared.scene, resolved);
  Film film(options.width, options.height, !tracer.media.empty(), hasEnvironment(virtualScene),
            options.bounceLayers);
  const Tiles tiles(options.width, options.height);
  std::optional<Progress> progress;
  if (options.progress) {
    progress.emplace(fmt::format("reference of {}: {} x {} pixels, {} samples", prepared.scene.name,
                                 options.width, options.height, options.samplesPerPixel),
                     static_cast<std::uint64_t>(tiles.count()));
  }
  const auto stopped = [&] { return options.stop != nullptr && options.stop->load(); };
  forEachTile(tiles, options.threads, [&](int tile) {
    if (stopped()) return;
    CountingRays rays{tracer.rays};
    renderTile(tracer, resolved, tiles, tile, rays, film);
    if (progress) progress->advance();
  });
  if (stopped()) throw StoppedError(fmt::format("the reference of {} was given up", prepared.scene.name));
  return finished(virtualScene, resolved, film);
}

glm::vec3 referenceRadiance(const Scene& scene, double time, glm::dvec3 originWorld, glm::vec3 direction,
                            const ReferenceOptions& given) {
  using namespace reference;
  ReferenceOptions timed = given;
  timed.time = time;
  ResolvedOptions resolved = resolve(scene, timed);
  const float length = glm::length(direction);
  if (!(length > 0.0f) || !std::isfinite(length)) throw Error("reference: the ray's direction has no length");
  Tracer tracer(scene, resolved);
  tracer.integrator.occlusionDistance = 0.0f;
  const glm::vec3 origin(originWorld - resolved.snapshot.origin);
  CountingRays rays{tracer.rays};
  glm::dvec3 sum(0.0);
  for (int sample = 0; sample < resolved.options.samplesPerPixel; ++sample) {
    // A random stream apart from those of pixels.
    RandomStream random(resolved.options.seed, std::numeric_limits<std::uint32_t>::max(),
                        static_cast<std::uint32_t>(sample));
    const glm::vec3 unit = direction / length;
    sum += glm::dvec3(tracer.media.empty()
                          ? tracer.integrator.trace(rays, random, origin, unit).full()
                          : tracer.integrator.traceThroughMedia(rays, random, origin, unit).full());
  }
  return glm::vec3(sum / static_cast<double>(resolved.options.samplesPerPixel));
}

}  // namespace lumivox
