// The reference's layers as the components of a pipeline need them.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "experiment/measure.h"
#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/measure/exposure.h"
#include "lumivox/reference/emission.h"

namespace lumivox {
namespace {

void add(ImageBuffer& sum, const ImageBuffer& part) {
  for (std::size_t i = 0; i < sum.values().size(); ++i) sum.values()[i] += part.values()[i];
}

}  // namespace

std::pair<std::string, std::string> referenceLayers(Contributes component, int bounces) {
  const auto upTo = [&](const char* one, const char* lobe) {
    return bounces == 1 ? std::string(one) : fmt::format("bounces_{}{}", bounces, lobe);
  };
  switch (component) {
    case Contributes::direct:
      return {"direct", "direct"};
    case Contributes::indirectDiffuse:
      return {upTo("one_bounce_diffuse", "_diffuse"), "indirect_diffuse"};
    case Contributes::indirectGlossy:
      return {upTo("one_bounce_glossy", "_glossy"), "indirect_glossy"};
    case Contributes::ambientOcclusion:
      return {"ambient_occlusion", "ambient_occlusion"};
    case Contributes::scattered:
      return {"scattered_single", "scattered"};
    case Contributes::final:
      return {upTo("one_bounce", ""), "full"};
    case Contributes::nothing:
      break;
  }
  return {};
}

std::optional<ReferenceLayer> referenceLayer(const LayeredImage& reference, const std::string& name) {
  const auto find = [&](const std::string& layer) -> std::optional<ReferenceLayer> {
    const auto mean = reference.layers.find(layer);
    if (mean == reference.layers.end()) return std::nullopt;
    const auto variance = reference.layers.find(layer + ".variance");
    return ReferenceLayer{mean->second,
                          variance == reference.layers.end() ? ImageBuffer{} : variance->second};
  };
  if (name != "one_bounce" || reference.layers.count(name) != 0) return find(name);
  std::optional<ReferenceLayer> sum = find("direct");
  for (const char* part : {"one_bounce_diffuse", "one_bounce_glossy"}) {
    const std::optional<ReferenceLayer> layer = find(part);
    if (!sum || !layer || !sum->mean.sameShape(layer->mean)) return std::nullopt;
    add(sum->mean, layer->mean);
    // The layers share camera rays. Their covariance is not recorded, so the sum of variances leaves it out.
    if (sum->variance.sameShape(layer->variance)) add(sum->variance, layer->variance);
  }
  return sum;
}

void meterImage(ExposureMeter& meter, const Scene& scene, const SceneSnapshot& snapshot,
                const ImageBuffer& image) {
  if (image.empty()) return;
  const bool seen = image.width() == snapshot.camera.width && image.height() == snapshot.camera.height;
  meter.add(image, seen ? emittingPixels(scene, snapshot) : std::vector<unsigned char>{});
}

double viewExposure(const Scene& scene, const ReferenceOptions& view, const std::vector<double>& times) {
  constexpr int kPixels = 32, kSamples = 64;
  const CameraView camera = snapshotOf(scene, view.time, view.camera, view.width, view.height).camera;
  const double scale = std::min(1.0, static_cast<double>(kPixels) / std::max(camera.width, camera.height));
  ReferenceOptions options;
  options.samplesPerPixel = kSamples;
  options.camera = view.camera;
  options.width = std::max(1, static_cast<int>(std::lround(camera.width * scale)));
  options.height = std::max(1, static_cast<int>(std::lround(camera.height * scale)));
  options.threads = view.threads;
  options.useCache = view.useCache;
  options.progress = false;
  ExposureMeter meter;
  for (const double time : times.empty() ? std::vector{view.time} : times) {
    options.time = time;
    meterImage(meter, scene, snapshotOf(scene, time, options.camera, options.width, options.height),
               cachedReference(scene, options).layers.at("full"));
  }
  // The least exposed radiance that kShownTone shows as white.
  constexpr float kBrightestGrey = 254.0f / 255.0f;
  static const double white = FilmicCurve::inverse(double{srgbToLinear(kBrightestGrey)});
  return meter.exposure(white);
}

}  // namespace lumivox

namespace lumivox::experiment {
namespace {

/// Whether pictures light the scene and no scene stands for what they show: its truth is unknown.
bool lacksTruth(const Scene& scene) {
  return !scene.captures.empty() && std::all_of(scene.captures.begin(), scene.captures.end(),
                                                [](const auto& one) { return one->realScene == nullptr; });
}

}  // namespace

SceneReference::SceneReference(const Scene& scene, const ReferenceOptions& options,
                               std::optional<double> given)
    : scene_(&scene), options_(options), exposure_(given), lacksTruth_(lacksTruth(scene)) {
  if (lacksTruth_)
    logWarning(
        "scene '{}': no errors, since capture '{}' does not say what its pictures show; expected stands_for and a "
        "scene of the real room",
        scene.name, scene.captures.front()->name);
  const auto start = std::chrono::steady_clock::now();
  layers_ = cachedReference(scene, options);
  seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void SceneReference::require(int bounces) {
  std::vector<int>& layers = options_.bounceLayers;
  if (bounces <= 1 || std::find(layers.begin(), layers.end(), bounces) != layers.end()) return;
  layers.insert(std::upper_bound(layers.begin(), layers.end(), bounces), bounces);
  *this = SceneReference(*scene_, options_, exposure_);
}

SceneReference& SceneReference::later(int frame) {
  if (frame == 0) return *this;
  std::unique_ptr<SceneReference>& reference = later_[frame];
  if (!reference) {
    constexpr int kFewerSamples = 4, kFewest = 16;
    ReferenceOptions options = options_;
    options.time += frame * kFlickerStep;
    options.seed += static_cast<std::uint64_t>(frame);
    options.samplesPerPixel =
        std::min(options.samplesPerPixel, std::max(kFewest, options.samplesPerPixel / kFewerSamples));
    reference = std::make_unique<SceneReference>(*scene_, options);
  }
  return *reference;
}

const ReferenceLayer* SceneReference::layer(const std::string& name) {
  if (lacksTruth_) return nullptr;
  auto found = cache_.find(name);
  if (found == cache_.end()) found = cache_.emplace(name, referenceLayer(layers_, name)).first;
  return found->second ? &*found->second : nullptr;
}

const ImageError& SceneReference::errorOfNothing(const std::string& name) {
  auto found = nothing_.find(name);
  if (found == nothing_.end()) {
    const ReferenceLayer& reference = *layer(name);
    const Contributes component = name == lumivox::name(Contributes::ambientOcclusion)
                                      ? Contributes::ambientOcclusion
                                      : Contributes::final;
    const ImageBuffer nothing = neutralImage(reference.mean.width(), reference.mean.height(), component);
    found =
        nothing_.emplace(name, compare(nothing, reference.mean, reference.variance, display(name).exposure))
            .first;
  }
  return found->second;
}

double SceneReference::exposure() {
  if (!exposure_) exposure_ = viewExposure(*scene_, options_);
  return *exposure_;
}

Display SceneReference::display(const std::string& name, Tone tone) {
  const ReferenceLayer* const reference = layer(name);
  const Display ofRadiance{exposure(), tone};
  return reference != nullptr ? displayOf(reference->mean, ofRadiance) : ofRadiance;
}

std::vector<ReferenceRecord> referenceRecords(SceneReference& reference, const std::set<std::string>& used,
                                              Tone tone) {
  std::vector<ReferenceRecord> records;
  for (const std::string& name : used) {
    const ReferenceLayer* layer = reference.layer(name);
    if (layer == nullptr) continue;
    ReferenceRecord record;
    record.layer = name;
    const Display display = reference.display(name, tone);
    record.exposure = display.exposure;
    record.image = encodePng(layer->mean, display);
    double sum = 0.0, variance = 0.0;
    for (const float value : layer->mean.values()) {
      sum += value;
      record.largest = std::max(record.largest, static_cast<double>(value));
    }
    for (const float value : layer->variance.values()) variance += value;
    record.mean = layer->mean.values().empty() ? 0.0 : sum / static_cast<double>(layer->mean.values().size());
    record.noise = layer->variance.empty()
                       ? 0.0
                       : std::sqrt(variance / static_cast<double>(layer->variance.values().size()));
    records.push_back(std::move(record));
  }
  return records;
}

}  // namespace lumivox::experiment
