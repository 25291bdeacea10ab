// Bias, noise, flicker and slopes on images and series whose answers are known.
#include <cmath>
#include <numbers>

#include "lumivox/base/error.h"
#include "lumivox/base/random.h"
#include "lumivox/measure/metrics.h"
#include "lumivox/measure/power_law.h"
#include "support/support.h"

using namespace lumivox;

namespace {

constexpr int kSize = 64;

/// Standard normal numbers (Box and Muller 1958), one stream per image.
class Normal {
 public:
  explicit Normal(std::uint64_t seed) : stream_(seed, 7) {}
  float operator()() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - double{stream_.uniform()}));
    return static_cast<float>(radius * std::cos(2.0 * std::numbers::pi * double{stream_.uniform()}));
  }

 private:
  RandomStream stream_;
};

ImageBuffer noisy(float mean, float sigma, std::uint64_t seed) {
  ImageBuffer image(kSize, kSize, 3, mean);
  Normal normal(seed);
  for (float& value : image.values()) value += sigma * normal();
  return image;
}

std::vector<ImageBuffer> seedsOf(int count, float mean, float sigma) {
  std::vector<ImageBuffer> seeds;
  for (int seed = 0; seed < count; ++seed)
    seeds.push_back(noisy(mean, sigma, 100 + static_cast<std::uint64_t>(seed)));
  return seeds;
}

constexpr float kReference = 1.0f, kBias = 0.03f, kNoise = 0.2f, kReferenceNoise = 0.05f;

ImageBuffer reference() {
  return noisy(kReference, kReferenceNoise, 1);
}
ImageBuffer referenceVariance() {
  return ImageBuffer(kSize, kSize, 3, kReferenceNoise * kReferenceNoise);
}

}  // namespace

TEST_CASE("a known bias and noise are told apart; their squares and the reference's add up") {
  const std::vector<ImageBuffer> seeds = seedsOf(8, kReference + kBias, kNoise);
  const ErrorParts parts = errorParts(seeds, reference(), referenceVariance());
  // 12288 values: a square is known to sqrt(2/12288) = 1.3 % of what noise there is.
  CHECK(parts.noise.value == Approx(kNoise).epsilon(0.01));
  CHECK(std::abs(parts.bias.value - kBias) < 3.0 * parts.bias.uncertainty);
  CHECK(parts.bias.uncertainty < 0.5 * kBias);
  CHECK(parts.bias.uncertainty > 0.0);
  CHECK(parts.referenceNoise == Approx(kReferenceNoise));
  double square = 0.0;
  for (const ImageBuffer& seed : seeds) {
    const double rmse = compare(seed, reference(), referenceVariance()).rmse.value;
    square += rmse * rmse / static_cast<double>(seeds.size());
  }
  // Exact by construction, as long as no square was negative.
  CHECK(parts.bias.value * parts.bias.value + parts.noise.value * parts.noise.value +
            parts.referenceNoise * parts.referenceNoise ==
        Approx(square).epsilon(1e-5));
}

TEST_CASE("an image without bias has none within the uncertainty, however noisy it and its reference are") {
  const ErrorParts parts = errorParts(seedsOf(6, kReference, 0.5f), reference(), referenceVariance());
  CHECK(parts.bias.value <= 3.0 * parts.bias.uncertainty);
  // Averaging six images and looking would have said 0.2.
  CHECK(parts.bias.value + parts.bias.uncertainty < 0.1);
}

TEST_CASE("noise that moves all pixels together does not make the bias look certain") {
  // Each seed is the reference plus one number for all pixels: the mean of four is off by sigma / 2, and no
  // number of pixels helps.
  std::vector<ImageBuffer> seeds;
  Normal normal(11);
  for (int seed = 0; seed < 4; ++seed) seeds.emplace_back(kSize, kSize, 3, kReference + kNoise * normal());
  const ErrorParts parts = errorParts(seeds, ImageBuffer(kSize, kSize, 3, kReference));
  CHECK(parts.bias.value - 0.0 <= 2.0 * parts.bias.uncertainty);
  CHECK(parts.bias.uncertainty > 0.2f * kNoise);
  CHECK(parts.noise.uncertainty > 0.1 * parts.noise.value);
  const ErrorParts two = errorParts({seeds[0], seeds[1]}, ImageBuffer(kSize, kSize, 3, kReference));
  CHECK(two.bias.uncertainty > 0.2 * two.noise.value);
}

TEST_CASE("without noise the reference's is taken off the error, and one seed tells nothing") {
  const ImageBuffer flat(kSize, kSize, 3, kReference + kBias);
  const ErrorParts parts = errorParts({flat, flat}, reference(), referenceVariance(), true);
  CHECK(std::abs(parts.bias.value - kBias) < 3.0 * parts.bias.uncertainty);
  CHECK(parts.bias.value == Approx(kBias).epsilon(0.1));
  CHECK(parts.noise.value == 0.0);
  CHECK(std::isnan(errorParts({flat}, reference(), referenceVariance()).bias.value));
  CHECK(std::isnan(errorParts({flat}, reference(), referenceVariance()).noise.value));
  CHECK_THROWS_AS(errorParts({}, reference()), Error);
  CHECK_THROWS_AS(errorParts({ImageBuffer(2, 2, 3)}, reference()), Error);
}

TEST_CASE("a value that is not finite in one seed does not count in any") {
  std::vector<ImageBuffer> seeds = seedsOf(3, kReference + kBias, kNoise);
  seeds[1].values()[0] = std::nanf("");
  const ErrorParts parts = errorParts(seeds, reference(), referenceVariance());
  CHECK(parts.noise.value == Approx(kNoise).epsilon(0.02));
}

TEST_CASE("a pixel that is not finite in one channel of one seed counts in no number of any seed") {
  std::vector<ImageBuffer> seeds = seedsOf(3, kReference + kBias, kNoise);
  // The channels beside the broken one hold what would rule every number.
  seeds[1].at(5, 5, 0) = std::numeric_limits<float>::quiet_NaN();
  for (ImageBuffer& seed : seeds) seed.at(5, 5, 1) = 1e4f;
  std::vector<ImageBuffer> clean = seeds;
  ImageBuffer cleanReference = reference();
  for (ImageBuffer& seed : clean)
    for (int c = 0; c < 3; ++c) seed.at(5, 5, c) = cleanReference.at(5, 5, c);
  const SeedsError error = compareSeeds(seeds, reference(), referenceVariance());
  const SeedsError without = compareSeeds(clean, cleanReference, referenceVariance());
  const double values = kSize * kSize;
  CHECK(error.mean.nonFiniteImage == 1);
  CHECK(error.mean.rmse.value == Approx(without.mean.rmse.value * std::sqrt(values / (values - 1.0))));
  CHECK(error.mean.flip < 2.0 * without.mean.flip);
  CHECK(std::isnan(error.flipMap.at(5, 5, 0)));
  const ErrorParts parts = errorParts(seeds, reference(), referenceVariance());
  CHECK(parts.noise.value == Approx(kNoise).epsilon(0.02));
  CHECK(parts.bias.value < 2.0 * kBias);
}

TEST_CASE("every number over seeds is the mean of each seed's, their spread added to its noise") {
  const std::vector<ImageBuffer> seeds = seedsOf(4, kReference + kBias, kNoise);
  const SeedsError all = compareSeeds(seeds, reference(), referenceVariance());
  std::vector<ImageError> each;
  for (const ImageBuffer& seed : seeds) each.push_back(compare(seed, reference(), referenceVariance()));
  const auto check = [&](const char* name, const auto& number) {
    INFO(name);
    std::vector<double> values;
    for (const ImageError& one : each) values.push_back(number(one).value);
    const Measured over = meanOverSeeds(values), mean = number(all.mean);
    CHECK(over.uncertainty > 0.0);
    CHECK(mean.value == over.value);
    CHECK(mean.uncertainty == Approx(std::hypot(number(each.front()).uncertainty, over.uncertainty)));
  };
  for (const auto& [name, member] :
       {std::pair{"rmse", &ImageError::rmse}, std::pair{"relative MSE", &ImageError::relativeMse},
        std::pair{"mean ratio", &ImageError::meanRatio}, std::pair{"bias", &ImageError::bias}})
    check(name, [member = member](const ImageError& e) { return e.*member; });
  using Numbers = std::pair<double ImageError::*, double ImageError::*>;
  for (const auto& [value, uncertainty] :
       {Numbers{&ImageError::percentile95, &ImageError::percentile95Uncertainty},
        Numbers{&ImageError::ssim, &ImageError::ssimUncertainty},
        Numbers{&ImageError::flip, &ImageError::flipUncertainty},
        Numbers{&ImageError::flipLdr, &ImageError::flipLdrUncertainty}})
    check("percentile, SSIM or FLIP", [value = value, uncertainty = uncertainty](const ImageError& e) {
      return Measured{e.*value, e.*uncertainty};
    });
  CHECK(all.flipMap.values() == flipHdr(seeds.front(), reference()).values());
}

TEST_CASE("a static image does not flicker, and frames with noise of their own flicker by sqrt(2) sigma") {
  const std::vector<ImageBuffer> references{reference(), noisy(kReference, kReferenceNoise, 2),
                                            noisy(kReference, kReferenceNoise, 3)};
  const std::vector<ImageBuffer> variances(3, referenceVariance());
  const ImageBuffer still(kSize, kSize, 3, kReference);
  const std::vector<ImageBuffer> exact(3, still);
  CHECK(flicker({still, still, still}, exact).value == 0.0);
  // The reference's noise is taken off, so that against a noisy reference it is 0 within the uncertainty.
  const Measured quiet = flicker({still, still, still}, references, variances);
  CHECK(quiet.value <= 3.0 * quiet.uncertainty);
  CHECK(quiet.value + quiet.uncertainty < 0.5 * kReferenceNoise);
  const Measured restless = flicker(seedsOf(3, kReference, kNoise), references, variances);
  CHECK(restless.value == Approx(std::sqrt(2.0) * kNoise).epsilon(0.03));
  CHECK(restless.uncertainty < 0.03 * restless.value);
}

TEST_CASE("the reference's motion is no flicker; an image that lags flickers by what it missed") {
  std::vector<ImageBuffer> references, following, frozen;
  for (int f = 0; f < 5; ++f) {
    references.emplace_back(kSize, kSize, 3, kReference + 0.1f * static_cast<float>(f));
    following.emplace_back(kSize, kSize, 3, 0.5f + 0.1f * static_cast<float>(f));  // wrong, but as steadily
    frozen.emplace_back(kSize, kSize, 3, kReference);
  }
  CHECK(flicker(following, references).value == Approx(0.0).margin(1e-6));
  CHECK(flicker(frozen, references).value == Approx(0.1).epsilon(1e-5));
  CHECK(std::isnan(flicker({frozen[0]}, {references[0]}).value));
  CHECK_THROWS_AS(flicker(frozen, {references[0]}), Error);
}

TEST_CASE("the error c h^p gives the slope p exactly, of whatever sign") {
  for (const double slope : {-2.0, -0.5, 1.0, 3.0}) {
    std::vector<PowerLawPoint> points;
    for (const double x : {16.0, 32.0, 64.0, 128.0}) points.push_back({x, {0.7 * std::pow(x, slope), 0.0}});
    const PowerLaw law = fitPowerLaw(points);
    CHECK(law.slope.value == Approx(slope).epsilon(1e-10));
    CHECK(law.slope.uncertainty < 1e-6);
    CHECK(law.factor == Approx(0.7));
    CHECK_FALSE(law.hasPlateau());
  }
}

TEST_CASE("the slope of noisy errors is p within its uncertainty, which is as large as it should be") {
  constexpr double kSlope = -1.0, kRelative = 0.05;
  Normal normal(5);
  int within = 0;
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<PowerLawPoint> points;
    for (const double x : {16.0, 32.0, 64.0, 128.0, 256.0}) {
      const double y = std::pow(x, kSlope) * (1.0 + kRelative * normal());
      points.push_back({x, {y, kRelative * y}});
    }
    const PowerLaw law = fitPowerLaw(points);
    within += std::abs(law.slope.value - kSlope) <= law.slope.uncertainty ? 1 : 0;
    CHECK(law.slope.uncertainty < 0.15);
  }
  // One standard uncertainty: 68 %; somewhat more, since scatter larger than stated widens it.
  CHECK(within > 0.6 * kTrials);
  CHECK(within < 0.9 * kTrials);
}

TEST_CASE("an error that stops falling shows its plateau, and one that falls on shows none") {
  const auto series = [](double plateau, double relative) {
    std::vector<PowerLawPoint> points;
    for (const double x : {8.0, 16.0, 32.0, 64.0, 128.0, 256.0}) {
      const double y = plateau + 2.0 / x;
      points.push_back({x, {y, relative * y}});
    }
    return fitPowerLaw(points);
  };
  const PowerLaw flat = series(0.05, 0.01);
  CHECK(flat.hasPlateau());
  CHECK(flat.plateau.value == Approx(0.05).epsilon(0.01));
  CHECK(flat.slopeAbove == Approx(-1.0).epsilon(0.01));
  CHECK(flat.slope.value > -0.9);
  // Without stated uncertainties the exact series is found too.
  CHECK(series(0.05, 0.0).plateau.value == Approx(0.05).epsilon(0.01));
  CHECK_FALSE(series(0.0, 0.01).hasPlateau());
}

TEST_CASE("too few values give no slope, and three no plateau") {
  std::vector<PowerLawPoint> points{{16, {0.5, 0}}, {32, {0.25, 0}}};
  CHECK(std::isnan(fitPowerLaw(points).slope.value));
  points.push_back({32, {0.26, 0}});
  CHECK(std::isnan(fitPowerLaw(points).slope.value));  // still two different values
  points.push_back({64, {0.125, 0}});
  CHECK(fitPowerLaw(points).slope.value == Approx(-1.0).epsilon(0.05));
  CHECK(std::isnan(fitPowerLaw(points).plateau.value));
  points.push_back({128, {0.0, 0.0}});  // no logarithm: left out
  CHECK(fitPowerLaw(points).points == 4);
}

TEST_CASE("a step is no power: where the steepest slope fits best, no plateau is told") {
  const PowerLaw law =
      fitPowerLaw({{8, {16.2, 0.1}}, {16, {16.2, 0.1}}, {32, {16.2, 0.1}}, {64, {188.0, 0.1}}});
  CHECK(law.slope.value > 0.5);
  CHECK(std::isnan(law.plateau.value));
}
