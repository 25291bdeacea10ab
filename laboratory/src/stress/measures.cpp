#include "stress/measures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/experiment/report.h"

namespace lumivox::stress {
namespace {

void add(ImageBuffer& sum, const ImageBuffer& part) {
  if (sum.empty()) {
    sum = part;
    return;
  }
  if (!sum.sameShape(part)) throw Error("images of different shapes cannot be added up");
  for (std::size_t i = 0; i < part.values().size(); ++i) sum.values()[i] += part.values()[i];
}

bool isIndirect(Contributes component) {
  return component == Contributes::indirectDiffuse || component == Contributes::indirectGlossy;
}

/// Paths per pixel of the battery's references.
int referenceSamples(const Bench& bench) {
  return bench.quick() ? 64 : 1024;
}

/// "direct 0.998, indirect_diffuse 0.91": the ratio of the means of every output that has a reference with
/// light.
std::string ratiosOf(const Frame& frame, const LayeredImage& reference) {
  std::string text;
  for (const auto& [name, image] : frame.result.outputs) {
    const Contributes component = frame.result.components.at(name);
    if (component == Contributes::final || component == Contributes::ambientOcclusion) continue;
    const std::string wanted = ownLayer(frame.result, name);
    const auto layer = wanted.empty() ? std::nullopt : referenceLayer(reference, wanted);
    if (!layer || !layer->mean.sameShape(image)) continue;
    if (!text.empty()) text += ", ";
    const double mean = meanOf(layer->mean);
    text += mean > 0.0 ? fmt::format("{} {:.3g} of the reference's", name, meanOf(image) / mean)
                       : fmt::format("{} {:.3g} where the reference has none", name, meanOf(image));
  }
  return text;
}

}  // namespace

std::string ownLayer(const FrameResult& frame, const std::string& output) {
  return referenceLayers(frame.components.at(output), frame.indirectBounces.at(output)).first;
}

bool makesIndirect(const Frame& frame) {
  return std::any_of(frame.result.components.begin(), frame.result.components.end(),
                     [](const auto& output) { return isIndirect(output.second); });
}

ImageBuffer indirectOf(const Frame& frame) {
  ImageBuffer sum;
  for (const auto& [name, image] : frame.result.outputs)
    if (isIndirect(frame.result.components.at(name))) add(sum, image);
  return sum;
}

double wrongShare(const VoxelError& error) {
  const auto wrong = static_cast<double>(error.falsePositive + error.falseNegative);
  const auto touched = static_cast<double>(error.truePositive + error.falseNegative);
  return touched > 0.0 ? wrong / touched : wrong;
}

std::optional<Finding> sameAs(Bench& bench, const Scene& scene, const Scene& changed, double limit,
                              const std::string& what, const Shot& shot) {
  if (makesImages(bench)) {
    const Frame wanted = bench.render(scene, shot), got = bench.render(changed, shot);
    std::string detail;
    if (makesIndirect(wanted))
      detail = fmt::format("of the indirect light alone {:.3g}",
                           relativeDifference(indirectOf(got), indirectOf(wanted)));
    return judged("RMS difference from " + what + ", of its mean",
                  {relativeDifference(got.compared, wanted.compared), 0.0}, limit, detail);
  }
  const std::optional<VoxelError> wanted = bench.voxelError(scene, shot),
                                  got = bench.voxelError(changed, shot);
  if (!wanted || !got) return std::nullopt;
  return judged("share of wrong voxels beyond that of " + what,
                {std::max(wrongShare(*got) - wrongShare(*wanted), 0.0), 0.0}, limit,
                fmt::format("wrong: {:.3g}; {}: {:.3g}", wrongShare(*got), what, wrongShare(*wanted)));
}

ReferenceLayer referenceOf(Bench& bench, const Scene& scene, const Frame& frame, const Shot& shot) {
  int bounces = 1;
  for (const auto& [output, modelled] : frame.result.indirectBounces) bounces = std::max(bounces, modelled);
  const std::string name =
      makesIndirect(frame) ? referenceLayers(Contributes::final, bounces).first : "direct";
  const std::optional<ReferenceLayer> layer =
      referenceLayer(bench.reference(scene, shot, referenceSamples(bench)), name);
  if (!layer) throw Error(fmt::format("the reference of scene '{}' has no layer '{}'", scene.name, name));
  return *layer;
}

ReferenceLayer indirectLayer(Bench& bench, const Scene& scene, const Frame& frame, const Shot& shot,
                             int samples) {
  const LayeredImage reference =
      bench.reference(scene, shot, samples > 0 ? samples : referenceSamples(bench));
  ReferenceLayer sum;
  for (const auto& [name, component] : frame.result.components) {
    if (!isIndirect(component)) continue;
    const std::optional<ReferenceLayer> layer = referenceLayer(reference, ownLayer(frame.result, name));
    if (!layer)
      throw Error(fmt::format("the reference of scene '{}' lacks a layer for '{}'", scene.name, name));
    add(sum.mean, layer->mean);
    add(sum.variance, layer->variance);
  }
  return sum;
}

double indirectReference(Bench& bench, const Scene& scene, const Frame& frame, const Shot& shot) {
  return meanOf(indirectLayer(bench, scene, frame, shot).mean);
}

std::optional<Finding> againstReference(Bench& bench, const Scene& scene, double limit, const Shot& shot) {
  if (!makesImages(bench)) return std::nullopt;
  Shot filtered = shot;
  filtered.subpixels = bench.quick() ? 4 : 16;
  const Frame frame = bench.render(scene, filtered);
  if (frame.whole.empty()) return withoutLight();
  const ReferenceLayer reference = referenceOf(bench, scene, frame, shot);
  const ImageError error = compare(frame.whole, reference.mean, reference.variance);
  const double mean = meanOf(reference.mean);
  if (!(mean > 0.0)) throw Error(fmt::format("the reference of scene '{}' is black", scene.name));
  return judged("distance of the image's mean from the reference's, of it",
                {std::abs(error.meanRatio.value - 1.0), error.meanRatio.uncertainty}, limit,
                fmt::format("{}; RMSE {:.3g} of the reference's mean, of which its noise {:.2g}",
                            ratiosOf(frame, bench.reference(scene, shot, referenceSamples(bench))),
                            error.rmse.value / mean, error.noiseFloor / mean));
}

std::optional<Finding> leak(Bench& bench, const Scene& dark, const Shot& darkShot, const Scene& lit,
                            const Shot& litShot, const std::string& what, double limit) {
  if (!makesImages(bench)) return std::nullopt;
  const Frame light = bench.render(lit, litShot), shade = bench.render(dark, darkShot);
  if (light.whole.empty() || shade.whole.empty()) return withoutLight();
  const double mean = meanOf(light.whole);
  if (!(mean > 0.0)) throw Error(fmt::format("scene '{}' has no light to leak", lit.name));
  std::string detail = fmt::format("all light {:.3g} against {:.3g}", meanOf(shade.whole), mean);
  if (makesIndirect(light))
    detail +=
        fmt::format(", indirect {:.3g} against {:.3g}", meanOf(indirectOf(shade)), meanOf(indirectOf(light)));
  return judged("mean radiance " + what, {meanOf(shade.whole) / mean, 0.0}, limit, detail);
}

}  // namespace lumivox::stress
