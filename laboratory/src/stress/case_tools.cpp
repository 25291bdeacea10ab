#include "stress/case_tools.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/experiment/report.h"
#include "lumivox/pipeline/pass.h"
#include "stress/measures.h"

namespace lumivox::stress {

namespace {

/// Why an output of the technique that the pipeline stands for stays black on such a scene; empty where none
/// does.
std::string whyBlack(Bench& bench, const SceneTraits& traits) {
  const Pipeline& pipeline = bench.pipeline();
  const std::string subject = techniqueOf(pipeline, bench.techniques());
  for (const Pipeline::Output& output : pipeline.outputs)
    for (const PassText& pass : pipeline.passes) {
      if (pass.name != output.pass || pass.technique != subject) continue;
      Pipeline one = pipeline;
      one.outputs = {output};
      if (const std::string why = whyUnsuited(one, bench.techniques(), traits); !why.empty()) return why;
    }
  return {};
}

}  // namespace

Scene suitableScene(Bench& bench) {
  std::string why;
  // Uniform fog costs less than particles.
  for (const char* name : {"cornell", "cornell_glossy", bench.quick() ? "fog" : "smoke"}) {
    Scene scene = bench.committedScene(name);
    why = whyBlack(bench, SceneTraits::of(scene));
    if (why.empty()) return scene;
  }
  throw AbsentError("no committed scene of the battery suits the pipeline: " + why);
}

bool seesCamera(Bench& bench) {
  return std::any_of(bench.pipeline().passes.begin(), bench.pipeline().passes.end(),
                     [&](const PassText& text) {
                       const Technique* technique = bench.techniques().technique(text.technique);
                       const PassEntry* entry = technique == nullptr ? nullptr : technique->find(text.pass);
                       return entry != nullptr && reads(entry->make()->readsFrom(), Reads::camera);
                     });
}

bool makesImages(const Bench& bench) {
  return !bench.pipeline().outputs.empty();
}

double spuriousShare(Bench& bench, const Scene& scene, const Shot& shot) {
  const std::optional<VoxelError> error = bench.voxelError(scene, shot);
  return error ? 1.0 - error->precision() : 0.0;
}

double meanOf(const ImageBuffer& image) {
  double sum = 0.0;
  for (const float value : image.values()) sum += value;
  return image.empty() ? 0.0 : sum / static_cast<double>(image.values().size());
}

double largestOf(const ImageBuffer& image) {
  double largest = 0.0;
  for (const float value : image.values()) largest = std::max(largest, std::abs(static_cast<double>(value)));
  return largest;
}

bool hasComponent(const FrameResult& frame, Contributes component) {
  return std::any_of(frame.components.begin(), frame.components.end(),
                     [&](const auto& entry) { return entry.second == component; });
}

Measured differenceFromReference(const ImageBuffer& image, const ReferenceLayer& reference) {
  const ImageError error = compare(image, reference.mean, reference.variance);
  const double mean = meanOf(reference.mean), scale = mean > 0.0 ? mean : 1.0;
  const double squares = error.rmse.value * error.rmse.value - error.noiseFloor * error.noiseFloor;
  return {std::sqrt(std::max(squares, 0.0)) / scale, error.noiseFloor / scale};
}

Finding notApplicable(std::string why) {
  Finding finding;
  finding.outcome = StressOutcome::notApplicable;
  finding.detail = std::move(why);
  return finding;
}

Finding withoutLight() {
  return notApplicable("none of its outputs is radiance, which the case is about");
}

std::map<std::string, Measured> ratiosToNothing(Bench& bench, const Scene& scene, const Shot& shot,
                                                int referenceSamples) {
  const Frame frame = bench.render(scene, shot);
  const LayeredImage reference = bench.reference(scene, shot, referenceSamples);
  std::map<std::string, Measured> ratios;
  for (const auto& [name, component] : frame.result.components) {
    const std::string layer = ownLayer(frame.result, name);
    const auto image = frame.result.outputs.find(name);
    const std::optional<ReferenceLayer> wanted =
        layer.empty() ? std::nullopt : referenceLayer(reference, layer);
    if (!wanted || image == frame.result.outputs.end() || !wanted->mean.sameShape(image->second)) continue;
    const ImageBuffer neutral = neutralImage(wanted->mean.width(), wanted->mean.height(), component);
    const Measured nothing = compare(neutral, wanted->mean, wanted->variance).rmse;
    if (!(nothing.value > 0.0)) continue;
    const Measured error = compare(image->second, wanted->mean, wanted->variance).rmse;
    const double ratio = error.value / nothing.value;
    ratios[name] = {ratio, std::hypot(error.uncertainty, ratio * nothing.uncertainty) / nothing.value};
  }
  return ratios;
}

}  // namespace lumivox::stress
