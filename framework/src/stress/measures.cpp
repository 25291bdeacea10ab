#include "stress/measures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/experiment/report.h"

namespace lumivox::stress {
namespace {

void add(Picture& sum, const Picture& part) {
  if (sum.empty()) {
    sum = part;
    return;
  }
  if (!sum.sameShape(part)) throw Error("pictures of different shapes cannot be added up");
  for (std::size_t i = 0; i < part.values().size(); ++i) sum.values()[i] += part.values()[i];
}

bool isIndirect(Contributes component) {
  return component == Contributes::indirectDiffuse || component == Contributes::indirectGlossy;
}

/// Paths a pixel of the truths that the battery compares with.
int truthSamples(const Bench& bench) {
  return bench.quick() ? 64 : 1024;
}

/// "direct 0.998, indirect_diffuse 0.91": the ratio of the means of every output that has a truth with light.
std::string ratiosOf(const Frame& frame, const LayeredPicture& truth) {
  std::string text;
  for (const auto& [name, picture] : frame.result.outputs) {
    const Contributes component = frame.result.components.at(name);
    if (component == Contributes::final || component == Contributes::ambientOcclusion) continue;
    const std::string wanted = truthLayers(component).first;
    const auto layer = wanted.empty() ? std::nullopt : truthLayer(truth, wanted);
    if (!layer || !layer->mean.sameShape(picture)) continue;
    if (!text.empty()) text += ", ";
    const double mean = meanOf(layer->mean);
    text += mean > 0.0 ? fmt::format("{} {:.3g} of the truth's", name, meanOf(picture) / mean)
                       : fmt::format("{} {:.3g} where the truth has none", name, meanOf(picture));
  }
  return text;
}

}  // namespace

bool makesIndirect(const Frame& frame) {
  return std::any_of(frame.result.components.begin(), frame.result.components.end(),
                     [](const auto& output) { return isIndirect(output.second); });
}

Picture indirectOf(const Frame& frame) {
  Picture sum;
  for (const auto& [name, picture] : frame.result.outputs)
    if (isIndirect(frame.result.components.at(name))) add(sum, picture);
  return sum;
}

double wrongShare(const VoxelError& error) {
  const auto wrong = static_cast<double>(error.falsePositive + error.falseNegative);
  const auto touched = static_cast<double>(error.truePositive + error.falseNegative);
  return touched > 0.0 ? wrong / touched : wrong;
}

std::optional<Finding> sameAs(Bench& bench, const Scene& scene, const Scene& changed, double limit,
                              const std::string& what, const Shot& shot) {
  if (makesPictures(bench)) {
    const Frame wanted = bench.render(scene, shot), got = bench.render(changed, shot);
    if (wanted.whole.empty() || got.whole.empty()) return std::nullopt;
    std::string detail;
    if (makesIndirect(wanted))
      detail = fmt::format("of the indirect light alone {:.3g}",
                           relativeDifference(indirectOf(got), indirectOf(wanted)));
    return judged("RMS difference from " + what + ", of its mean",
                  {relativeDifference(got.whole, wanted.whole), 0.0}, limit, detail);
  }
  const std::optional<VoxelError> wanted = bench.voxelError(scene, shot),
                                  got = bench.voxelError(changed, shot);
  if (!wanted || !got) return std::nullopt;
  return judged("share of wrong voxels beyond that of " + what,
                {std::max(wrongShare(*got) - wrongShare(*wanted), 0.0), 0.0}, limit,
                fmt::format("wrong: {:.3g}; {}: {:.3g}", wrongShare(*got), what, wrongShare(*wanted)));
}

TruthLayer truthOf(Bench& bench, const Scene& scene, const Frame& frame, const Shot& shot) {
  const char* name = makesIndirect(frame) ? "one_bounce" : "direct";
  const std::optional<TruthLayer> layer = truthLayer(bench.truth(scene, shot, truthSamples(bench)), name);
  if (!layer) throw Error(fmt::format("the truth of scene '{}' has no layer '{}'", scene.name, name));
  return *layer;
}

double indirectTruth(Bench& bench, const Scene& scene, const Frame& frame, const Shot& shot) {
  const LayeredPicture truth = bench.truth(scene, shot, truthSamples(bench));
  double sum = 0.0;
  for (const auto& [name, component] : frame.result.components) {
    if (!isIndirect(component)) continue;
    const std::optional<TruthLayer> layer = truthLayer(truth, truthLayers(component).first);
    if (!layer) throw Error(fmt::format("the truth of scene '{}' lacks a layer for '{}'", scene.name, name));
    sum += meanOf(layer->mean);
  }
  return sum;
}

std::optional<Finding> againstTruth(Bench& bench, const Scene& scene, double limit, const Shot& shot) {
  if (!makesPictures(bench)) return std::nullopt;
  Shot filtered = shot;
  filtered.subpixels = bench.quick() ? 4 : 16;
  const Frame frame = bench.render(scene, filtered);
  if (frame.whole.empty()) return std::nullopt;
  const TruthLayer truth = truthOf(bench, scene, frame, shot);
  const PictureError error = compare(frame.whole, truth.mean, truth.variance);
  const double mean = meanOf(truth.mean);
  if (!(mean > 0.0)) throw Error(fmt::format("the truth of scene '{}' is black", scene.name));
  return judged("distance of the picture's mean from the truth's, of it",
                {std::abs(error.meanRatio.value - 1.0), error.meanRatio.uncertainty}, limit,
                fmt::format("{}; RMSE {:.3g} of the truth's mean, of which its noise {:.2g}",
                            ratiosOf(frame, bench.truth(scene, shot, truthSamples(bench))),
                            error.rmse.value / mean, error.noiseFloor / mean));
}

std::optional<Finding> leak(Bench& bench, const Scene& dark, const Shot& darkShot, const Scene& lit,
                            const Shot& litShot, const std::string& what, double limit) {
  if (!makesPictures(bench)) return std::nullopt;
  const Frame light = bench.render(lit, litShot), shade = bench.render(dark, darkShot);
  if (light.whole.empty() || shade.whole.empty()) return std::nullopt;
  const double mean = meanOf(light.whole);
  if (!(mean > 0.0)) throw Error(fmt::format("scene '{}' has no light to leak", lit.name));
  std::string detail = fmt::format("all light {:.3g} against {:.3g}", meanOf(shade.whole), mean);
  if (makesIndirect(light))
    detail +=
        fmt::format(", indirect {:.3g} against {:.3g}", meanOf(indirectOf(shade)), meanOf(indirectOf(light)));
  return judged("mean radiance " + what, {meanOf(shade.whole) / mean, 0.0}, limit, detail);
}

}  // namespace lumivox::stress
