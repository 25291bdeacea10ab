// Stiff transport: albedos near 1, media from nearly nothing to opaque, very narrow phase functions, many
// iterations, and very bright beside very dark.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "stress/case_tools.h"
#include "stress/measures.h"

namespace lumivox::stress {
namespace {

// ---- closed box ------------------------------------------------------------------------------------------

/// A room of albedo a whose walls all emit radiance 1. By symmetry the radiance is the same everywhere and
/// every bounce multiplies it by a: N bounces give 1 + a + ... + a^(N+1), all bounces 1 / (1 - a).
Scene closedBox(const Bench& bench, double albedo) {
  return bench.sceneFromText(fmt::format(R"(scene "Closed box" {{
  camera main {{ eye 0.3 -0.2 0.8  target -0.2 0 -1  fov 60 deg  resolution 48 48 }}
  material wall {{ diffuse {0}  emission 1 }}
  mesh room {{ file "../models/furnace.obj"  material wall }}
}}
)",
                                         albedo));
}

/// The convergence of the path tracer's sum over bounces.
struct ReferenceSeries {
  double radius = 0.0;     ///< measured share of the missing light that a further bounce leaves
  int bounces = 0;         ///< the most that were measured
  double missing = 0.0;    ///< measured share of the whole that is missing after them
  double ofDefault = 0.0;  ///< that share after the default number of bounces
};

constexpr double kTelling = 0.1;  // share of missing light that the reference's noise does not hide

/// The error after N bounces is e(N) = a^(N+2) / (1 - a), so that e(2N) / e(N) = a^N.
ReferenceSeries referenceSeries(const Scene& scene, double albedo, bool quick) {
  ReferenceOptions options;
  options.width = options.height = 8;
  // Paths of a nearly white room are long, and there are many bounces to average over.
  options.samplesPerPixel = std::max(4, static_cast<int>(std::lround(640.0 * (1.0 - albedo))));
  options.roulette = false;  // its noise would hide the last bounces
  options.progress = false;
  const double whole = 1.0 / (1.0 - albedo);
  // Quick: until about 2/3 of the light is there. Full: until 1 % is missing.
  const double enough = quick ? whole : std::log(0.01) / std::log(albedo);
  ReferenceSeries series;
  double before = 0.0;
  for (int bounces = 1;; bounces *= 2) {
    options.bounces = bounces;
    const double error = whole - meanOf(cachedReference(scene, options).layers.at("full"));
    // Nearer to the whole the reference's noise is larger than what is missing.
    if (bounces > 1 && error > kTelling * whole) series.radius = std::pow(error / before, 2.0 / bounces);
    series.bounces = bounces;
    series.missing = error / whole;
    if (bounces == ReferenceOptions{}.bounces) series.ofDefault = series.missing;
    before = error;
    if (bounces >= enough) break;
  }
  if (series.bounces < ReferenceOptions{}.bounces)
    series.ofDefault = std::pow(series.radius, ReferenceOptions{}.bounces - series.bounces) * series.missing;
  return series;
}

std::optional<Finding> missingOfClosedBox(Bench& bench, double albedo) {
  if (!makesImages(bench)) return notApplicable("it makes no image");
  const Scene scene = closedBox(bench, albedo);
  const Frame frame = bench.render(scene);
  if (frame.whole.empty()) return withoutLight();
  bench.show(frame.whole);
  const double whole = 1.0 / (1.0 - albedo), found = meanOf(frame.whole);
  const ReferenceSeries series = referenceSeries(scene, albedo, bench.quick());
  Finding finding = judged(
      "distance from the full transport 1 / (1 - albedo), of it", {std::abs(found / whole - 1.0), 0.0}, 0.05,
      fmt::format("radiance {:.4g} of {:.4g}; one exact bounce would leave out albedo^3 = {:.3g}. Reference: "
                  "spectral radius {:.5f} measured over {} bounces ({:.3g} of the light missing then), {} "
                  "bounces to 1 %; its default of {} bounces leaves out {:.3g}",
                  found, whole, std::pow(albedo, 3.0), series.radius, series.bounces, series.missing,
                  static_cast<int>(std::ceil(std::log(0.01) / std::log(series.radius))),
                  ReferenceOptions{}.bounces, series.ofDefault));
  if (found > 1.05 * whole) finding.detail += ". It shows more light than there is";
  return finding;
}

/// The part of the transport that the pipeline has components for, in closed form: direct light is E (1 + a),
/// one bounce adds E a^2.
std::optional<Finding> bounceOfClosedBox(Bench& bench) {
  if (!makesImages(bench)) return notApplicable("it makes no image");
  constexpr double kAlbedo = 0.999;
  // The surrounding walls are the light: few samples of them say little about nearby points.
  Shot shot;
  shot.parameters["area_samples"].number = 64;
  const Frame frame = bench.render(closedBox(bench, kAlbedo), shot);
  if (frame.whole.empty()) return withoutLight();
  bench.show(frame.whole);
  const bool indirect = hasComponent(frame.result, Contributes::indirectDiffuse);
  const double wanted = 1.0 + kAlbedo + (indirect ? kAlbedo * kAlbedo : 0.0);
  const double found = meanOf(frame.whole);
  const ImageBuffer exact(frame.whole.width(), frame.whole.height(), 3, static_cast<float>(wanted));
  std::string detail = fmt::format("radiance {:.4g} of {:.4g}; RMS over the image {:.3g} of it", found,
                                   wanted, relativeDifference(frame.whole, exact));
  for (const auto& [name, component] : frame.result.components)
    if (component == Contributes::direct || component == Contributes::indirectDiffuse)
      detail += fmt::format("; {} {:.4g} of {:.4g}", name, meanOf(frame.result.outputs.at(name)),
                            component == Contributes::direct ? 1.0 + kAlbedo : kAlbedo * kAlbedo);
  return judged(indirect ? "energy of direct light and one bounce, distance from E (1 + a + a^2), of it"
                         : "energy of direct light, distance from E (1 + a), of it",
                {std::abs(found / wanted - 1.0), 0.0}, 0.1, detail);
}

// ---- iterations ------------------------------------------------------------------------------------------

/// The parameter that counts the steps of an iteration; null where there is none.
const PipelineParameter* iterationParameter(const Bench& bench) {
  for (const char* name : {"iterations", "bounces", "propagations"})
    if (const PipelineParameter* parameter = bench.parameter(name)) return parameter;
  return nullptr;
}

/// Where P(n) = P - c r^n, doublings differ by d1 = P(2n) - P(n) and d2 = P(4n) - P(2n) with
/// d2 / d1 = r^n (1 + r^n).
double radiusOfDoublings(double first, double second, int iterations) {
  if (first <= 0.0 || second <= 0.0) return 0.0;
  return std::pow(0.5 * (std::sqrt(1.0 + 4.0 * second / first) - 1.0), 1.0 / iterations);
}

std::optional<Finding> thousandIterations(Bench& bench) {
  const PipelineParameter* parameter = iterationParameter(bench);
  if (parameter == nullptr) return notApplicable("it has no parameter that counts iterations");
  const Scene scene = closedBox(bench, 0.999);
  std::vector<int> counts;
  for (const int count : {8, 16, 32, 64, 125, 250, 500, 1000})
    if ((!parameter->low || count >= *parameter->low) && (!parameter->high || count <= *parameter->high) &&
        (!bench.quick() || count <= 32 || count >= 500))
      counts.push_back(count);
  if (counts.size() < 2) return notApplicable(parameter->name + " cannot be varied far enough");
  std::vector<double> means;
  std::string detail = parameter->name + ":";
  for (const int count : counts) {
    Shot shot;
    shot.parameters[parameter->name].number = count;
    const Frame frame = bench.render(scene, shot);
    if (frame.whole.empty()) return withoutLight();
    means.push_back(meanOf(frame.whole));
    detail += fmt::format(" {} {:.5g}", count, means.back());
    if (count == counts.back()) bench.show(frame.whole);
  }
  if (means.size() >= 3) {
    const double first = means[1] - means[0], second = means[2] - means[1];
    detail += fmt::format("; spectral radius {:.4f}", radiusOfDoublings(first, second, counts[0]));
  }
  const std::size_t last = means.size() - 1;
  const double change = std::abs(means[last] - means[last - 1]);
  Finding finding =
      judged(fmt::format("change of the image's energy from {} to {} iterations, of it", counts[last - 1],
                         counts[last]),
             {change / std::max(means[last - 1], std::numeric_limits<double>::min()), 0.0}, 0.01, detail);
  // An iteration that converges changes less with every doubling; one that grows changes more.
  const double before = last >= 2 ? std::abs(means[last - 1] - means[last - 2]) : 0.0;
  if (finding.outcome != StressOutcome::stable && last >= 2 && change > 2.0 * before)
    finding.outcome = StressOutcome::diverges;
  return finding;
}

// ---- media -----------------------------------------------------------------------------------------------

/// A uniform slab 0 <= z <= 1 m, far wider than the view, before an environment. The scene holds nothing
/// else, so that single scattering has a closed form in every pixel.
struct Slab {
  double extinction = 1.0;  ///< 1/m
  double albedo = 0.5, anisotropy = 0.0;
  double environment = 0.0;                   ///< radiance
  glm::dvec3 light{0.3, -0.5, -0.8};          ///< direction in which it travels
  double fov = 30.0;                          ///< deg
  static constexpr double kIrradiance = 3.0;  ///< on a plane across the light's direction

  Scene scene(const Bench& bench) const {
    return bench.sceneFromText(fmt::format(R"(scene "Slab" {{
  camera main {{ eye 0 0 3  target 0 0 0  fov {} deg  resolution 48 48 }}
  light sun directional {{ direction {} {} {}  irradiance {} }}
  environment {{ radiance {} }}
  medium slab {{ extinction {} /m  albedo {}  anisotropy {}  low -40 -40 0  high 40 40 1 }}
}}
)",
                                           fov, light.x, light.y, light.z, kIrradiance, environment,
                                           extinction, albedo, anisotropy));
  }

  /// Radiance along a ray from above the slab, with m its cosine with z, D = 1 / m its length in the slab,
  /// and k = m / (the light's cosine with z). At distance s light from above has passed through s k, light
  /// from below through (D - s) k. With T the environment seen through D:
  ///   T + a p E sigma int_0^D exp(-sigma (s + s k)) ds, or with exp(-sigma (s + (D - s) k)).
  double radiance(const glm::dvec3& direction) const {
    const glm::dvec3 view = glm::normalize(direction), travel = glm::normalize(light);
    const double cosView = std::abs(view.z), path = 1.0 / cosView, ratio = cosView / std::abs(travel.z);
    // Henyey & Greenstein 1941, Eq. 2, with 1 - cos from the difference of the vectors: nothing cancels.
    const glm::dvec3 apart = anisotropy >= 0.0 ? travel + view : travel - view;
    const double g = std::abs(anisotropy);
    const double denominator = (1.0 - g) * (1.0 - g) + g * glm::dot(apart, apart);
    const double phase = (1.0 - g) * (1.0 + g) / (4.0 * std::numbers::pi * std::pow(denominator, 1.5));
    const double depth = extinction * path;
    const double rate = travel.z < 0.0 ? 1.0 + ratio : 1.0 - ratio;
    const double x = rate * depth;
    const double integral = depth * (std::abs(x) < 1e-8 ? 1.0 : -std::expm1(-x) / x);
    const double lit = travel.z < 0.0 ? 1.0 : std::exp(-ratio * depth);
    return environment * std::exp(-depth) + albedo * phase * kIrradiance * lit * integral;
  }

  ImageBuffer exact(const Scene& scene, int width, int height) const {
    const CameraView camera = snapshotOf(scene, 0.0, {}, width, height).camera;
    ImageBuffer image(width, height, 3);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const double value =
            radiance(camera.direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f));
        for (int channel = 0; channel < 3; ++channel) image.at(x, y, channel) = static_cast<float>(value);
      }
    return image;
  }
};

std::optional<Finding> notOfMedia(Bench& bench, const Scene& scene) {
  if (!makesImages(bench)) return notApplicable("it makes no image");
  if (!hasComponent(bench.render(scene).result, Contributes::scattered))
    return notApplicable("it renders no media");
  return std::nullopt;
}

std::optional<Finding> extinctions(Bench& bench) {
  Slab slab;
  slab.environment = 1.0;
  if (const auto why = notOfMedia(bench, slab.scene(bench))) return why;
  double worst = 0.0;
  std::string detail = "extinction and difference:";
  for (const double extinction : {1e-3, 1e-2, 0.1, 1.0, 10.0, 1e2, 1e3, 1e4, 1e5}) {
    slab.extinction = extinction;
    const Scene scene = slab.scene(bench);
    const Frame frame = bench.render(scene);
    const double difference =
        relativeDifference(frame.whole, slab.exact(scene, frame.whole.width(), frame.whole.height()));
    detail += fmt::format(" {:.0e} /m {:.2g},", extinction, difference);
    if (difference >= worst) {
      worst = difference;
      bench.show(frame.whole);
    }
  }
  detail.pop_back();
  return judged("largest RMSE against Beer-Lambert and single scattering of a slab, of its mean",
                {worst, 0.0}, 0.02, detail);
}

std::optional<Finding> narrowPhase(Bench& bench, double anisotropy) {
  // A peak of 0.06 degrees spans some 100 pixels: the camera looks towards the light for forward scattering
  // and away from it for backward scattering.
  Slab slab;
  slab.extinction = 0.05;
  slab.anisotropy = anisotropy;
  slab.light = {0.0, 0.0, anisotropy > 0.0 ? 1.0 : -1.0};
  slab.fov = 0.5;
  const Scene scene = slab.scene(bench);
  if (const auto why = notOfMedia(bench, scene)) return why;
  const Frame frame = bench.render(scene);
  bench.show(frame.whole);
  const ImageBuffer exact = slab.exact(scene, frame.whole.width(), frame.whole.height());
  const double energy = meanOf(frame.whole) / meanOf(exact);
  return judged(
      "scattered energy around the peak, distance from the closed form, of it", {std::abs(energy - 1.0), 0.0},
      0.02,
      fmt::format("brightest pixel {:.4g} of {:.4g}; RMSE {:.3g} of the mean", largestOf(frame.whole),
                  largestOf(exact), relativeDifference(frame.whole, exact)));
}

/// Means over squares of pixels.
ImageBuffer shrunk(const ImageBuffer& image, int factor) {
  ImageBuffer result(image.width() / factor, image.height() / factor, image.channels());
  const float share = 1.0f / static_cast<float>(factor * factor);
  for (int y = 0; y < result.height() * factor; ++y)
    for (int x = 0; x < result.width() * factor; ++x)
      for (int channel = 0; channel < image.channels(); ++channel)
        result.at(x / factor, y / factor, channel) += share * image.at(x, y, channel);
  return result;
}

/// Compares heterogeneous smoke, from thin to opaque at the same steps, with the reference of single
/// scattering.
std::optional<Finding> extinctionsOfSmoke(Bench& bench) {
  const auto smoke = [&](double extinction) {
    return bench.sceneFromText(fmt::format(R"(scene "Smoke" {{
  camera main {{ eye 0 0.6 3  target 0 0.6 0  fov 30 deg  resolution 48 48 }}
  light sun directional {{ direction 0.4 -1 -0.5  irradiance 3 }}
  environment {{ radiance 0.5 }}
  medium smoke {{
    extinction {} /m  albedo 0.5  anisotropy 0.3  particles 300  source 0 0.4 0  spread 0.3  radius 0.25  rise 0.1 m/s
    life 4 s
  }}
}}
)",
                                           extinction));
  };
  if (const auto why = notOfMedia(bench, smoke(1.0))) return why;
  Measured worst;
  std::string detail =
      "extinction, RMSE of the image of its mean, energy of the scattered light of the reference's:";
  // Few pixels of the reference, which takes a step for each mean free path of the densest smoke; more of the
  // image, so that filters which blend neighbours do not reach across the smoke.
  constexpr int kSide = 16, kFiner = 4;
  for (const double extinction : {1e-3, 1e-2, 0.1, 1.0, 10.0, 1e2, 1e3, 1e4, 1e5}) {
    const Scene scene = smoke(extinction);
    Shot shot;
    shot.time = 1.0;
    shot.parameters["pixels"].word = "full";
    shot.width = shot.height = kSide;
    // In thin smoke few paths scatter.
    const LayeredImage reference = bench.reference(scene, shot,
                                                   extinction < 1.0   ? 4096
                                                   : extinction < 1e3 ? 256
                                                                      : 16);
    shot.width = shot.height = kSide * kFiner;
    const Frame frame = bench.render(scene, shot);
    const Measured difference =
        differenceFromReference(shrunk(frame.whole, kFiner), *referenceLayer(reference, "one_bounce"));
    detail +=
        fmt::format(" {:.0e} /m {:.2g} (noise {:.1g})", extinction, difference.value, difference.uncertainty);
    const auto note = [&](const Measured& error, const ImageBuffer& image) {
      if (error.value < worst.value) return;
      worst = error;
      bench.show(image);
    };
    note(difference, frame.whole);
    // The light behind the smoke outshines it in the image, and single pixels of its reference are noisy.
    for (const auto& [name, component] : frame.result.components) {
      if (component != Contributes::scattered) continue;
      const ImageBuffer& scattered = frame.result.outputs.at(name);
      const auto layer = referenceLayer(reference, ownLayer(frame.result, name));
      const Measured energy = compare(shrunk(scattered, kFiner), layer->mean, layer->variance).meanRatio;
      detail += fmt::format(" {:.3f} +- {:.1g}", energy.value, energy.uncertainty);
      note({std::abs(energy.value - 1.0), energy.uncertainty}, scattered);
    }
    detail += ",";
  }
  detail.pop_back();
  return judged(
      "the worse of RMSE of the image and energy of the scattered light, against the reference of single "
      "scattering",
      worst, 0.1, detail);
}

// ---- bright beside dark ----------------------------------------------------------------------------------

/// Two closed rooms with a light each. The camera is in the left one, whose light has intensity 1.
Scene twoRooms(const Bench& bench, double gap, double otherIntensity) {
  return bench.sceneFromText(fmt::format(R"(scene "Bright and dark" {{
  camera main {{ eye -0.3 0.1 0.4  target 0.2 -0.1 -0.5  fov 60 deg  resolution 48 48 }}
  material wall {{ diffuse 0.5 }}
  mesh dark {{ file "../models/furnace.obj"  material wall  scale 0.5 }}
  mesh bright {{ file "../models/furnace.obj"  material wall  scale 0.5  translate {0} 0 0 }}
  light dim point {{ position 0.1 0.2 0.1  intensity 1 }}
  light blinding point {{ position {1} 0.2 0.1  intensity {2} }}
}}
)",
                                         1.0 + gap, 1.1 + gap, otherIntensity));
}

/// The rooms are closed, so that the other light must change nothing.
std::optional<Finding> brightAndDark(Bench& bench, double gap, double limit) {
  if (!makesImages(bench)) return notApplicable("it makes no image");
  const Frame alone = bench.render(twoRooms(bench, gap, 0.0));
  const Frame both = bench.render(twoRooms(bench, gap, 1e6));
  bench.show(both.compared);
  std::string detail;
  for (const auto& [name, image] : both.result.outputs) {
    const double difference = relativeDifference(image, alone.result.outputs.at(name));
    detail += fmt::format("{}{} {:.3g} (mean {:.4g}, alone {:.4g})", detail.empty() ? "" : "; ", name,
                          difference, meanOf(image), meanOf(alone.result.outputs.at(name)));
  }
  return judged("change of a room's image by a light 10^6 times as bright in the other room, of its mean",
                {relativeDifference(both.compared, alone.compared), 0.0}, limit, detail);
}

Case albedoCase(const char* name, double albedo, bool quick) {
  return {
      {"stiff_transport", name,
       fmt::format("A closed box of albedo {}: how much of the full transport is missing, and how fast the "
                   "sum over bounces converges",
                   albedo),
       quick},
      [albedo](Bench& bench) { return missingOfClosedBox(bench, albedo); }};
}

}  // namespace

std::vector<Case> stiffTransportCases() {
  const std::string family = "stiff_transport";
  return {
      albedoCase("closed_box_albedo_0.9", 0.9, false),
      albedoCase("closed_box_albedo_0.99", 0.99, false),
      albedoCase("closed_box_albedo_0.999", 0.999, true),
      {{family, "closed_box_one_bounce",
        "A closed box of albedo 0.999 that shines everywhere: direct light and one bounce against their closed "
        "form",
        true},
       bounceOfClosedBox},
      {{family, "thousand_iterations",
        "A parameter that counts iterations goes to 1000 in the closed box: energy must settle, not grow",
        true},
       thousandIterations},
      {{family, "extinction_1e-3_to_1e5",
        "An even slab with extinctions from 10^-3 to 10^5 /m and unchanged steps: transmittance and single "
        "scattering against their closed form",
        true},
       extinctions},
      {{family, "smoke_extinction_1e-3_to_1e5",
        "Smoke of particles with extinctions from 10^-3 to 10^5 /m and unchanged steps against the reference of "
        "single scattering",
        false},
       extinctionsOfSmoke},
      {{family, "anisotropy_0.999",
        "Henyey-Greenstein with g = 0.999 seen against the light: scattered energy against its closed form",
        true},
       [](Bench& bench) { return narrowPhase(bench, 0.999); }},
      {{family, "anisotropy_-0.999",
        "Henyey-Greenstein with g = -0.999 seen with the light: scattered energy against its closed form",
        false},
       [](Bench& bench) { return narrowPhase(bench, -0.999); }},
      {{family, "bright_beside_dark",
        "Two closed rooms two metres apart in one grid, one lit 10^6 times as bright: the dark one keeps its "
        "light",
        true},
       [](Bench& bench) { return brightAndDark(bench, 2.0, 0.02); }},
      {{family, "bright_behind_wall",
        "Two closed rooms with walls a tenth of a room apart, one lit 10^6 times as bright: the dark one keeps "
        "its light",
        false},
       [](Bench& bench) { return brightAndDark(bench, 0.1, 0.02); }},
  };
}

}  // namespace lumivox::stress
