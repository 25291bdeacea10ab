// The numbers of an error by name, so that the store's schema does not change with every metric.
#include <cmath>
#include <limits>

#include "lumivox/results/records.h"

namespace lumivox {
namespace {

/// Reads or writes one metric; the same list serves both ways.
template <class Error, class Visit>
void visitMetrics(Error& error, Visit visit) {
  auto& e = error.error;
  auto& n = error.errorOfNothing;
  visit("rmse", e.rmse.value, &e.rmse.uncertainty, n.rmse.value);
  visit("relative_mse", e.relativeMse.value, &e.relativeMse.uncertainty, n.relativeMse.value);
  visit("mean_ratio", e.meanRatio.value, &e.meanRatio.uncertainty, n.meanRatio.value);
  visit("bias", e.bias.value, &e.bias.uncertainty, n.bias.value);
  visit("percentile95", e.percentile95, &e.percentile95Uncertainty, n.percentile95);
  visit("ssim", e.ssim, &e.ssimUncertainty, n.ssim);
  visit("flip", e.flip, &e.flipUncertainty, n.flip);
  visit("flip_ldr", e.flipLdr, &e.flipLdrUncertainty, n.flipLdr);
}

}  // namespace

std::vector<NamedMetric> metricsOf(const ComponentError& error) {
  std::vector<NamedMetric> metrics;
  visitMetrics(error, [&](const char* name, double value, const double* uncertainty, double ofNothing) {
    metrics.push_back({name, {value, *uncertainty}, ofNothing});
  });
  const double floorOfNothing = error.errorOfNothing.noiseFloor,
               rmseOfNothing = error.errorOfNothing.rmse.value;
  const double biasOfNothing =
      std::sqrt(std::max(0.0, rmseOfNothing * rmseOfNothing - floorOfNothing * floorOfNothing));
  metrics.push_back({"rms_bias", error.parts.bias, biasOfNothing});
  metrics.push_back({"rms_noise", error.parts.noise, 0.0});
  metrics.push_back({"flicker", error.flicker, std::numeric_limits<double>::quiet_NaN()});
  for (NamedMetric& metric : metrics)
    metric.measured.enoughRepeats = error.enoughSeeds() && (error.deterministic || error.everyMetricPerSeed ||
                                                            metric.name == std::string("rmse"));
  metrics.push_back({"exposure_ev", {error.error.exposure, 0.0}, error.errorOfNothing.exposure});
  metrics.push_back({"noise_floor", {error.error.noiseFloor, 0.0}, error.errorOfNothing.noiseFloor});
  metrics.push_back({"non_finite_image", {static_cast<double>(error.error.nonFiniteImage), 0.0}, 0.0});
  metrics.push_back(
      {"non_finite_reference", {static_cast<double>(error.error.nonFiniteReference), 0.0}, 0.0});
  return metrics;
}

std::vector<std::pair<std::string, double>> metricsOf(const std::optional<GatheredVoxels>& voxels) {
  const bool judged = voxels && voxels->whyNot.empty();
  const auto number = [&](double value) { return judged ? value : std::numeric_limits<double>::quiet_NaN(); };
  const GatheredVoxels& of = judged ? *voxels : GatheredVoxels();
  return {{"recall", number(of.error.recall())},
          {"precision", number(of.error.precision())},
          {"axis_holes", number(of.holes.axisShare())},
          {"oblique_holes", number(of.holes.obliqueShare())}};
}

bool setMetric(ComponentError& error, const NamedMetric& metric) {
  bool known = false;
  visitMetrics(error, [&](const char* name, double& value, double* uncertainty, double& ofNothing) {
    if (metric.name != name) return;
    value = metric.measured.value;
    *uncertainty = metric.measured.uncertainty;
    ofNothing = metric.ofNothing;
    known = true;
  });
  if (known) return true;
  if (metric.name == "rms_bias") {
    error.parts.bias = metric.measured;
  } else if (metric.name == "rms_noise") {
    error.parts.noise = metric.measured;
  } else if (metric.name == "flicker") {
    error.flicker = metric.measured;
  } else if (metric.name == "exposure_ev") {
    error.error.exposure = metric.measured.value;
    error.errorOfNothing.exposure = metric.ofNothing;
  } else if (metric.name == "noise_floor") {
    error.parts.referenceNoise = metric.measured.value;
    error.error.noiseFloor = metric.measured.value;
    error.errorOfNothing.noiseFloor = metric.ofNothing;
  } else if (metric.name == "non_finite_image") {
    error.error.nonFiniteImage = static_cast<std::uint64_t>(metric.measured.value);
  } else if (metric.name == "non_finite_reference") {
    error.error.nonFiniteReference = static_cast<std::uint64_t>(metric.measured.value);
  } else {
    return false;
  }
  return true;
}

}  // namespace lumivox
