// Error metrics by name, so that a new metric does not change the store's schema.
#include <cmath>
#include <limits>
#include <string_view>

#include "lumivox/results/records.h"

namespace lumivox {
namespace {

/// Visits each metric with its members: name, value, uncertainty, value of a black image. Missing members are
/// constants.
template <class Error, class Visit>
void visitMetrics(Error& error, Visit visit) {
  auto& e = error.error;
  auto& n = error.errorOfNothing;
  double zero = 0.0, none = std::numeric_limits<double>::quiet_NaN();
  const double rmseOfNothing = n.rmse.value, floorOfNothing = n.noiseFloor;
  double biasOfNothing =
      std::sqrt(std::max(0.0, rmseOfNothing * rmseOfNothing - floorOfNothing * floorOfNothing));
  visit("rmse", e.rmse.value, e.rmse.uncertainty, n.rmse.value);
  visit("relative_mse", e.relativeMse.value, e.relativeMse.uncertainty, n.relativeMse.value);
  visit("mean_ratio", e.meanRatio.value, e.meanRatio.uncertainty, n.meanRatio.value);
  visit("bias", e.bias.value, e.bias.uncertainty, n.bias.value);
  visit("percentile95", e.percentile95, e.percentile95Uncertainty, n.percentile95);
  visit("ssim", e.ssim, e.ssimUncertainty, n.ssim);
  visit("flip", e.flip, e.flipUncertainty, n.flip);
  visit("flip_ldr", e.flipLdr, e.flipLdrUncertainty, n.flipLdr);
  visit("rms_bias", error.parts.bias.value, error.parts.bias.uncertainty, biasOfNothing);
  visit("rms_noise", error.parts.noise.value, error.parts.noise.uncertainty, zero);
  visit("flicker", error.flicker.value, error.flicker.uncertainty, none);
  visit("exposure_ev", e.exposure, zero, n.exposure);
  visit("noise_floor", e.noiseFloor, zero, n.noiseFloor);
  visit("non_finite_image", e.nonFiniteImage, zero, zero);
  visit("non_finite_reference", e.nonFiniteReference, zero, zero);
}

/// Whether a metric is a count, which has no spread over seeds.
bool isCount(std::string_view metric) {
  return metric == "exposure_ev" || metric == "noise_floor" || metric.starts_with("non_finite");
}

}  // namespace

std::vector<NamedMetric> metricsOf(const ComponentError& error) {
  std::vector<NamedMetric> metrics;
  visitMetrics(error, [&](const char* name, auto value, double uncertainty, double ofNothing) {
    const bool enough = error.enoughSeeds() &&
                        (error.deterministic || error.everyMetricPerSeed || name == std::string_view("rmse"));
    metrics.push_back({name, {static_cast<double>(value), uncertainty, isCount(name) || enough}, ofNothing});
  });
  return metrics;
}

bool setMetric(ComponentError& error, const NamedMetric& metric) {
  bool known = false;
  visitMetrics(error, [&]<class T>(const char* name, T& value, double& uncertainty, double& ofNothing) {
    if (metric.name != name) return;
    value = static_cast<T>(metric.measured.value);
    uncertainty = metric.measured.uncertainty;
    ofNothing = metric.ofNothing;
    known = true;
  });
  if (metric.name == "noise_floor") error.parts.referenceNoise = metric.measured.value;
  return known;
}

}  // namespace lumivox
