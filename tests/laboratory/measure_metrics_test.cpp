// Image errors on vectors computed by hand, and their uncertainties against simulation.
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "lumivox/base/error.h"
#include "lumivox/base/random.h"
#include "lumivox/measure/exposure.h"
#include "lumivox/measure/metrics.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using lumivox::test::Tells;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

ImageBuffer imageOf(int width, int height, int channels, std::vector<float> values) {
  ImageBuffer image(width, height, channels);
  REQUIRE(image.values().size() == values.size());
  image.values() = std::move(values);
  return image;
}

ImageBuffer random(int width, int height, int channels, std::uint64_t seed, float low = 0.0f,
                   float high = 1.0f) {
  ImageBuffer image(width, height, channels);
  RandomStream stream(seed, 0);
  for (float& value : image.values()) value = low + (high - low) * stream.uniform();
  return image;
}

/// Numbers of an error that none of its noise leaves untouched.
std::vector<double> numbersOf(const ImageError& e) {
  return {e.rmse.value,
          e.rmse.uncertainty,
          e.relativeMse.value,
          e.relativeMse.uncertainty,
          e.flip,
          e.flipUncertainty,
          e.ssim,
          e.percentile95,
          e.percentile95Uncertainty};
}

/// A standard normal number (Box and Muller 1958).
float normal(RandomStream& stream) {
  const float radius = std::sqrt(-2.0f * std::log(1.0f - stream.uniform()));
  return radius * std::cos(6.2831853f * stream.uniform());
}

}  // namespace

TEST_CASE("errors of four grey pixels are those computed by hand") {
  // Differences 1, -1, 0, 2: mean square 6/4, mean 2/4, ratio 12/10. The reference's mean is 2.5, so epsilon
  // = 0.025: relative MSE = (1/(1 + e) + 1/(4 + e) + 0 + 4/(16 + e)) / 4 with e = 0.000625.
  const ImageBuffer reference = imageOf(2, 2, 1, {1, 2, 3, 4}), image = imageOf(2, 2, 1, {2, 1, 3, 6});
  const ImageError error = compare(image, reference);
  CHECK(error.rmse.value == Approx(std::sqrt(1.5)));
  CHECK(error.bias.value == Approx(0.5));
  CHECK(error.meanRatio.value == Approx(1.2));
  const double e = 0.025 * 0.025;
  CHECK(error.relativeMse.value == Approx((1 / (1 + e) + 1 / (4 + e) + 4 / (16 + e)) / 4));
  // Sorted 0, 1, 1, 2; the place 0.95 * 3 = 2.85 lies between the last two: 1 + 0.85.
  CHECK(error.percentile95 == Approx(1.85));
  CHECK(error.noiseFloor == 0.0);
  CHECK(error.rmse.uncertainty == 0.0);
  CHECK(error.nonFiniteImage + error.nonFiniteReference == 0);
}

TEST_CASE("channels count alike in the RMSE and by luminance in the percentile; alpha counts nowhere") {
  const ImageBuffer reference = imageOf(1, 1, 4, {1, 1, 1, 1}), image = imageOf(1, 1, 4, {2, 1, 1, 0.25f});
  const ImageError error = compare(image, reference);
  CHECK(error.rmse.value == Approx(std::sqrt(1.0 / 3.0)));
  CHECK(error.meanRatio.value == Approx(4.0 / 3.0));
  CHECK(error.percentile95 == Approx(0.2126));
}

TEST_CASE("an image against itself has no error") {
  const ImageBuffer image = random(20, 16, 3, 1);
  const ImageError error = compare(image, image);
  for (const double none : {error.rmse.value, error.relativeMse.value, error.bias.value, error.percentile95,
                            error.flip, error.flipLdr})
    CHECK(none == 0.0);
  CHECK(error.meanRatio.value == 1.0);
  CHECK(error.ssim == Approx(1.0).epsilon(1e-12));
}

TEST_CASE("NaN and infinite pixels are left out and counted, not spread") {
  ImageBuffer reference = random(30, 30, 3, 2), image = reference;
  for (float& value : image.values()) value *= 1.5f;
  const ImageError clean = compare(image, reference);
  image.at(4, 5, 2) = kNan;
  image.at(4, 5, 0) = kInfinity;  // the same pixel: counted once
  image.at(9, 9, 1) = -kInfinity;
  reference.at(20, 3, 0) = kNan;
  const ImageError error = compare(image, reference);
  CHECK(error.nonFiniteImage == 2);
  CHECK(error.nonFiniteReference == 1);
  CHECK(error.meanRatio.value == Approx(1.5));
  CHECK(error.rmse.value == Approx(clean.rmse.value).epsilon(0.01));
  CHECK(error.flip == Approx(clean.flip).epsilon(0.02));
  CHECK(error.ssim == Approx(clean.ssim).epsilon(0.02));
  // Where everything else is right, nothing else is wrong.
  ImageBuffer hurt = reference;
  hurt.at(15, 15, 0) = kNan;
  const ImageError alone = compare(hurt, reference);
  CHECK(alone.rmse.value == 0.0);
  CHECK(alone.flip == 0.0);
  CHECK(alone.ssim == Approx(1.0).epsilon(1e-12));
}

TEST_CASE("numbers that do not exist are NaN") {
  const ImageBuffer black(8, 8, 3), grey(8, 8, 3, 0.5f);
  const ImageError againstBlack = compare(grey, black), nothing = compare(ImageBuffer(8, 8, 3, kNan), grey);
  CHECK(againstBlack.rmse.value == Approx(0.5));
  CHECK(nothing.nonFiniteImage == 64);
  for (const double none : {againstBlack.meanRatio.value, againstBlack.relativeMse.value, nothing.rmse.value,
                            nothing.flip, nothing.ssim, nothing.percentile95})
    CHECK(std::isnan(none));
}

TEST_CASE("what cannot be compared is refused with the shapes") {
  const ImageBuffer rgb(4, 4, 3), grey(4, 4, 1);
  CHECK_THROWS_MATCHES(compare(rgb, ImageBuffer(5, 4, 3)), Error, Tells("4 x 4", "5 x 4"));
  CHECK_THROWS_AS(compare(ImageBuffer(4, 4, 2), ImageBuffer(4, 4, 2)), Error);
  CHECK_THROWS_AS(compare(ImageBuffer(), ImageBuffer()), Error);
  CHECK_THROWS_MATCHES(compare(rgb, rgb, grey), Error, Tells("variance"));
  for (const float wrong : {-1.0f, kNan})
    CHECK_THROWS_MATCHES(compare(grey, grey, ImageBuffer(4, 4, 1, wrong)), Error, Tells("variance"));
}

TEST_CASE("the noise floor is the root of the mean variance, and a right but noiseless image measures it") {
  // x is exact, t = x + noise: the expected mean square is the mean variance. 4096 values: its relative
  // scatter is sqrt(2 / 4096) = 2.2 %, that of the root 1.1 %.
  constexpr int kSize = 64;
  const ImageBuffer exact(kSize, kSize, 1, 2.0f), variance(kSize, kSize, 1, 0.04f);
  ImageBuffer reference = exact;
  RandomStream stream(5, 5);
  for (float& value : reference.values()) value += 0.2f * normal(stream);
  const ImageError error = compare(exact, reference, variance);
  CHECK(error.noiseFloor == Approx(0.2));
  CHECK(error.rmse.value == Approx(0.2).epsilon(0.045));
  // The bias of n independent values of deviation s has the deviation s / sqrt(n).
  CHECK(error.bias.uncertainty == Approx(0.2 / kSize));
  CHECK(error.meanRatio.uncertainty == Approx(0.1 / kSize).epsilon(0.01));
}

TEST_CASE("uncertainties of grey images by hand") {
  // One pixel: x = 3, t = 2, v = 0.01. RMSE = |x - t|: slope 1. Bias: slope 1. Ratio x / t: slope x / t^2 =
  // 0.75. Relative MSE (x - t)^2 / (t^2 (1 + 1e-4)): slope -2 (x - t) / (k t^2) - 2 (x - t)^2 / (k t^3) =
  // -(2/4 + 2/8) / k.
  const ImageError error =
      compare(ImageBuffer(1, 1, 1, 3.0f), ImageBuffer(1, 1, 1, 2.0f), ImageBuffer(1, 1, 1, 0.01f));
  CHECK(error.rmse.uncertainty == Approx(0.1));
  CHECK(error.bias.uncertainty == Approx(0.1));
  CHECK(error.meanRatio.uncertainty == Approx(0.075));
  CHECK(error.relativeMse.uncertainty == Approx(0.075 / 1.0001).epsilon(1e-5));
  // Equal images: the RMSE may be off by the noise floor.
  CHECK(compare(ImageBuffer(2, 2, 1, 2.0f), ImageBuffer(2, 2, 1, 2.0f), ImageBuffer(2, 2, 1, 0.01f))
            .rmse.uncertainty == Approx(0.1));
}

TEST_CASE("propagated uncertainties are the scatter that noisy references really cause") {
  enum class Noise { grey, sameInAllChannels, independentChannels };
  for (const Noise noise : {Noise::grey, Noise::sameInAllChannels, Noise::independentChannels}) {
    const int channels = noise == Noise::grey ? 1 : 3;
    constexpr int kSize = 6, kDraws = 800;
    const ImageBuffer image = random(kSize, kSize, channels, 21, 0.5f, 2.0f),
                      exact = random(kSize, kSize, channels, 22, 0.5f, 2.0f);
    ImageBuffer variance = random(kSize, kSize, channels, 23, 0.0001f, 0.0009f);
    std::vector<std::function<Measured(const ImageError&)>> metrics = {
        [](const ImageError& e) { return e.rmse; }, [](const ImageError& e) { return e.relativeMse; },
        [](const ImageError& e) { return e.meanRatio; }, [](const ImageError& e) { return e.bias; }};
    std::vector<double> sums(metrics.size()), squares(metrics.size());
    for (int draw = 0; draw < kDraws; ++draw) {
      ImageBuffer reference = exact;
      RandomStream stream(31, static_cast<std::uint32_t>(draw));
      for (std::size_t pixel = 0; pixel < reference.pixelCount(); ++pixel) {
        float g = normal(stream);
        for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) {
          const std::size_t i = pixel * static_cast<std::size_t>(channels) + c;
          if (noise == Noise::independentChannels) g = normal(stream);
          reference.values()[i] += g * std::sqrt(variance.values()[i]);
        }
      }
      const ImageError error = compare(image, reference);
      for (std::size_t m = 0; m < metrics.size(); ++m) {
        const double value = metrics[m](error).value;
        sums[m] += value;
        squares[m] += value * value;
      }
    }
    const ImageError stated = compare(image, exact, variance);
    for (std::size_t m = 0; m < metrics.size(); ++m) {
      const double mean = sums[m] / kDraws, scatter = std::sqrt(squares[m] / kDraws - mean * mean);
      const double uncertainty = metrics[m](stated).uncertainty;
      INFO("metric " << m << ", noise " << static_cast<int>(noise) << ": stated " << uncertainty << ", seen "
                     << scatter);
      // The scatter of 800 draws is itself known to 1 / sqrt(1600) = 2.5 %. Where the signs of the
      // differences in one pixel disagree, the stated bound is above it; for independent channels it is at
      // most sqrt(3) too large.
      CHECK(scatter <= uncertainty * 1.08);
      if (noise == Noise::grey) CHECK(scatter >= uncertainty * 0.92);
      if (noise == Noise::sameInAllChannels && m >= 2) CHECK(scatter >= uncertainty * 0.92);
      CHECK(scatter >= uncertainty * 0.5);
    }
  }
}

TEST_CASE("FLIP, SSIM and the percentile state an uncertainty that shrinks with the reference's noise") {
  const ImageBuffer reference = random(48, 48, 3, 41, 0.3f, 0.7f);
  ImageBuffer image = reference;
  for (float& value : image.values()) value *= 1.05f;
  const ImageError without = compare(image, reference);
  CHECK(without.flipUncertainty == 0.0);
  const ImageError little = compare(image, reference, ImageBuffer(48, 48, 3, 1e-8f));
  const ImageError much = compare(image, reference, ImageBuffer(48, 48, 3, 1e-2f));
  CHECK(little.flip == without.flip);
  CHECK(little.flipUncertainty < 0.01 * much.flipUncertainty);
  CHECK(little.flipLdrUncertainty < 0.01 * much.flipLdrUncertainty);
  CHECK(little.ssimUncertainty < 0.01 * much.ssimUncertainty);
  CHECK(little.percentile95Uncertainty < 0.01 * much.percentile95Uncertainty);
  CHECK(little.flipUncertainty > 0.0);
  // The stated error covers the effect of the noise: the same comparison against a reference with noise of
  // that size.
  ImageBuffer noisy = reference;
  RandomStream stream(43, 0);
  for (std::size_t pixel = 0; pixel < noisy.pixelCount(); ++pixel) {
    const float g = 0.1f * normal(stream);
    for (std::size_t c = 0; c < 3; ++c) noisy.values()[3 * pixel + c] += g;
  }
  const ImageError seen = compare(image, noisy);
  CHECK(std::abs(seen.flip - without.flip) < 1.3 * much.flipUncertainty);
  CHECK(std::abs(seen.percentile95 - without.percentile95) < 1.3 * much.percentile95Uncertainty);
}

TEST_CASE("all errors have the same bits on one thread and on many") {
  const ImageBuffer image = random(61, 47, 3, 51), reference = random(61, 47, 3, 52),
                    variance(61, 47, 3, 0.01f);
  const ImageError many = compare(image, reference, variance);
  const ImageBuffer map = flipHdr(image, reference);
  const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
  CHECK(numbersOf(compare(image, reference, variance)) == numbersOf(many));
  CHECK(flipHdr(image, reference).values() == map.values());
}

TEST_CASE("SSIM of constant images is its luminance term") {
  // No variance, no covariance: (2 a b + C1) / (a^2 + b^2 + C1), C1 = 0.01^2.
  const auto [a, b] =
      GENERATE(table<float, float>({{0.2f, 0.6f}, {0.0f, 1.0f}, {0.5f, 0.5f}, {0.01f, 0.02f}}));
  const double expected = (2.0 * a * b + 1e-4) / (1.0 * a * a + 1.0 * b * b + 1e-4);
  for (const int size : {24, 7})  // larger and smaller than a window
    CHECK(ssim(ImageBuffer(size, size, 1, a), ImageBuffer(size, size, 1, b)) ==
          Approx(expected).epsilon(1e-5));
}

TEST_CASE("SSIM of eleven by eleven pixels is the formula in one Gaussian window") {
  // The only window that lies within the image is centred on its middle: weights exp(-(x^2 + y^2) / (2
  // * 1.5^2)), normalised.
  const ImageBuffer x = random(11, 11, 1, 61), y = random(11, 11, 1, 62);
  double total = 0, meanX = 0, meanY = 0, xx = 0, yy = 0, xy = 0;
  for (int v = -5; v <= 5; ++v) {
    for (int u = -5; u <= 5; ++u) {
      const double weight = std::exp(-(u * u + v * v) / 4.5), a = double{x.at(u + 5, v + 5, 0)},
                   b = double{y.at(u + 5, v + 5, 0)};
      total += weight;
      meanX += weight * a;
      meanY += weight * b;
      xx += weight * a * a;
      yy += weight * b * b;
      xy += weight * a * b;
    }
  }
  meanX /= total;
  meanY /= total;
  const double varianceX = xx / total - meanX * meanX, varianceY = yy / total - meanY * meanY,
               covariance = xy / total - meanX * meanY;
  const double expected = (2 * meanX * meanY + 1e-4) * (2 * covariance + 9e-4) /
                          ((meanX * meanX + meanY * meanY + 1e-4) * (varianceX + varianceY + 9e-4));
  CHECK(ssim(x, y) == Approx(expected).epsilon(1e-6));
  CHECK(ssim(x, x) == Approx(1.0).epsilon(1e-12));
}

TEST_CASE("SSIM of an image and its negative is below zero, and refuses several channels") {
  const ImageBuffer x = random(40, 40, 1, 63);
  ImageBuffer negative = x;
  for (float& value : negative.values()) value = 1.0f - value;
  CHECK(ssim(x, negative) < -0.5);
  CHECK_THROWS_AS(ssim(ImageBuffer(12, 12, 3), ImageBuffer(12, 12, 3)), Error);
}

TEST_CASE("flicker is what changes without the reference's changing") {
  const ImageBuffer reference0 = random(9, 9, 3, 71), reference1 = random(9, 9, 3, 72);
  CHECK(flicker(reference0, reference1, reference0, reference1) == 0.0);
  // A constant error does not flicker.
  ImageBuffer frame0 = reference0, frame1 = reference1;
  for (float& value : frame0.values()) value += 0.5f;
  for (float& value : frame1.values()) value += 0.5f;
  CHECK(flicker(frame0, frame1, reference0, reference1) == Approx(0.0).margin(1e-6));
  // One of 243 values off by 3 in one frame: 3 / sqrt(243).
  frame1.at(4, 4, 1) += 3.0f;
  CHECK(flicker(frame0, frame1, reference0, reference1) == Approx(3.0 / std::sqrt(243.0)).epsilon(1e-5));
  frame0.at(4, 4, 2) = kNan;  // the pixel is left out
  CHECK(flicker(frame0, frame1, reference0, reference1) == Approx(0.0).margin(1e-6));
  CHECK_THROWS_AS(flicker(frame0, frame1, reference0, ImageBuffer(9, 8, 3)), Error);
}

TEST_CASE("SSIM and LDR-FLIP are taken at the exposure that is given, and say which") {
  ImageBuffer reference = random(24, 24, 3, 81, 0.1f, 0.9f), image = reference;
  for (float& value : image.values()) value *= 1.1f;
  const ImageError given = compare(image, reference, {}, -2.0), own = compare(image, reference);
  CHECK(given.exposure == -2.0);
  CHECK(own.exposure == displayExposure(reference));
  // The same as of images that are four times as dark, at exposure 0; other numbers know nothing of it.
  const auto darker = [](ImageBuffer bright) {
    for (float& value : bright.values()) value *= 0.25f;
    return bright;
  };
  const ImageError dark = compare(darker(image), darker(reference), {}, 0.0);
  CHECK(given.ssim == Approx(dark.ssim).epsilon(1e-9));
  CHECK(given.flipLdr == Approx(dark.flipLdr).epsilon(1e-6));
  CHECK(given.flipLdr != own.flipLdr);
  CHECK(given.rmse.value == own.rmse.value);
  CHECK(given.flip == own.flip);
  // So dark that the display shows nothing at all.
  CHECK(compare(image, reference, {}, -60.0).flipLdr == Approx(0.0).margin(1e-9));
}

TEST_CASE("luminance has the weights of Rec. 709, and white has luminance one") {
  const ImageBuffer y = luminance(imageOf(4, 1, 3, {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}));
  CHECK(y.values() == std::vector<float>{0.2126f, 0.7152f, 0.0722f, 1.0f});
  CHECK(luminance(y).values() == y.values());
  CHECK_THROWS_AS(luminance(ImageBuffer(1, 1, 2)), Error);
}

TEST_CASE("the false colours' lightness grows in proportion to the value, within the display's range") {
  constexpr int kSteps = 512;
  ImageBuffer map(kSteps + 1, 1, 1);
  for (int i = 0; i <= kSteps; ++i) map.at(i, 0, 0) = static_cast<float>(i) / kSteps;
  const ImageBuffer colours = falseColour(map), y = luminance(colours);
  for (int i = 0; i <= kSteps; ++i) {
    // CIE 15: L* of the luminance.
    const double luminance = double{y.at(i, 0, 0)};
    const double lightness =
        luminance > 216.0 / 24389.0 ? 116.0 * std::cbrt(luminance) - 16.0 : luminance * 24389.0 / 27.0;
    CHECK(lightness == Approx(97.0 * i / kSteps).margin(0.02));
    for (int c = 0; c < 3; ++c) {
      CHECK(colours.at(i, 0, c) >= 0.0f);
      CHECK(colours.at(i, 0, c) <= 1.0f);
      // Smooth: no step of an encoded channel is larger than 4 of 255 levels.
      if (i > 0)
        CHECK(std::abs(linearToSrgb(colours.at(i, 0, c)) - linearToSrgb(colours.at(i - 1, 0, c))) <
              4.0f / 255.0f);
    }
  }
  const ImageBuffer outside = falseColour(imageOf(3, 1, 1, {-1.0f, 2.0f, kNan}));
  CHECK(outside.at(0, 0, 0) == 0.0f);
  CHECK(outside.at(1, 0, 0) == colours.at(kSteps, 0, 0));
  CHECK(std::isnan(outside.at(2, 0, 1)));
  CHECK_THROWS_AS(falseColour(ImageBuffer(2, 2, 3)), Error);
}
