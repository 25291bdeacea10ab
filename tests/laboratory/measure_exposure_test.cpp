// The display exposure on images whose log-average luminance is known.
#include <cmath>
#include <limits>

#include "lumivox/base/error.h"
#include "lumivox/measure/exposure.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr int kSide = 50;

/// Pixels of one value, the first of them of another.
ImageBuffer withFirst(std::size_t count, float first, float others) {
  ImageBuffer image(kSide, kSide, 3, others);
  std::fill_n(image.values().begin(), 3 * count, first);
  return image;
}

std::vector<unsigned char> maskOf(std::size_t count) {
  std::vector<unsigned char> mask(static_cast<std::size_t>(kSide * kSide), 0);
  std::fill_n(mask.begin(), count, static_cast<unsigned char>(1));
  return mask;
}

/// EV that shows this luminance as middle grey, in steps of a hundredth.
double greyAt(double luminance) {
  return std::round(100.0 * std::log2(0.18 / luminance)) / 100.0;
}

}  // namespace

TEST_CASE("the log-average luminance is shown as middle grey, in any unit of radiance") {
  for (const float unit : {1e-20f, 1e-3f, 1.0f, 1e3f, 1e20f}) {
    CAPTURE(unit);
    CHECK(displayExposure(ImageBuffer(4, 4, 3, unit)) == Approx(greyAt(unit)));
    // Half of it 1, half 4: the geometric mean is 2.
    CHECK(displayExposure(withFirst(kSide * kSide / 2, unit, 4.0f * unit)) == Approx(greyAt(2.0 * unit)));
  }
  ImageBuffer green(4, 4, 3);
  for (std::size_t i = 1; i < green.values().size(); i += 3) green.values()[i] = 2.0f;
  CHECK(displayExposure(green) == Approx(greyAt(2.0 * 0.7152)));
}

TEST_CASE("a lamp that is seen changes nothing, whether it fills one pixel in a hundred or half of them") {
  const double alone = displayExposure(withFirst(0, 0.0f, 0.5f));
  for (const double share : {0.01, 0.05, 0.2, 0.5, 0.99}) {
    CAPTURE(share);
    const auto pixels = static_cast<std::size_t>(share * kSide * kSide);
    CHECK(displayExposure(withFirst(pixels, 1000.0f, 0.5f), maskOf(pixels)) == alone);
  }
}

TEST_CASE("where nobody knows what emits, a lamp in up to a fifth of the pixels leaves the rest visible") {
  for (const double share : {0.01, 0.05, 0.1, 0.2}) {
    CAPTURE(share);
    const auto pixels = static_cast<std::size_t>(share * kSide * kSide);
    const ImageBuffer room = withFirst(pixels, 50.0f, 0.5f);
    const Display display{displayExposure(room), Tone::srgb};
    CHECK(int{displayBytes(room, display).back()} > 75);  // middle grey is 118
  }
}

TEST_CASE("black, NaN and infinite pixels do not count, and a few fireflies move next to nothing") {
  const double alone = greyAt(0.5);
  CHECK(displayExposure(withFirst(kSide * kSide - 10, 0.0f, 0.5f)) == Approx(alone));
  CHECK(displayExposure(withFirst(kSide * kSide - 10, 1e-9f, 0.5f)) != Approx(alone));  // that is most of it
  CHECK(displayExposure(withFirst(kSide * kSide / 2, 1e-9f, 0.5f)) == Approx(alone));
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float bad : {std::nanf(""), infinity, -infinity, -3.0f})
    CHECK(displayExposure(withFirst(900, bad, 0.5f)) == Approx(alone));
  CHECK(displayExposure(withFirst(3, 1e9f, 0.5f)) == Approx(alone).margin(0.06));
}

TEST_CASE("an image of nothing, of lamps alone and of fractions has an exposure too") {
  CHECK(displayExposure(ImageBuffer(4, 4, 3)) == 0.0);
  CHECK(displayExposure(ImageBuffer(4, 4, 3, std::nanf(""))) == 0.0);
  CHECK(displayExposure(ImageBuffer(4, 4, 3, 7.0f), std::vector<unsigned char>(16, 1)) == greyAt(7.0));
  CHECK(displayExposure(withFirst(5, 7.0f, 0.0f), maskOf(5)) == greyAt(7.0));
  CHECK(displayExposure(ImageBuffer(4, 4, 1, 0.01f)) == 0.0);
  CHECK(displayExposure(ImageBuffer(4, 4, 3, std::numeric_limits<float>::max())) == -kLargestExposure);
  CHECK_THROWS_AS(displayExposure(ImageBuffer(4, 4, 3), std::vector<unsigned char>(15, 0)), Error);
  CHECK_THROWS_AS(displayExposure(ImageBuffer(4, 4, 2)), Error);
}

TEST_CASE("radiance is displayed as it is asked for, and what is no radiance as it is") {
  const Display wanted{3.12, Tone::filmic};
  CHECK(displayOf(ImageBuffer(4, 4, 3, 0.1f), wanted).exposure == 3.12);
  CHECK(displayOf(ImageBuffer(4, 4, 3, 0.1f), wanted).tone == Tone::filmic);
  CHECK(displayOf(ImageBuffer(4, 4, 1, 0.9f), wanted).exposure == 0.0);
  CHECK(displayOf(ImageBuffer(4, 4, 1, 0.9f), wanted).tone == Tone::srgb);
  ImageBuffer colours(4, 4, 3, 0.1f);
  colours.setRadiance(false);
  CHECK(displayOf(colours, wanted).exposure == 0.0);
  CHECK(displayExposure(colours) == 0.0);
}

TEST_CASE("several images share one exposure, to which each adds what is lit in it") {
  ExposureMeter meter;
  CHECK(meter.exposure() == 0.0);
  meter.add(ImageBuffer(4, 4, 3, 1.0f));
  meter.add(ImageBuffer(4, 4, 3));  // a frame that is black
  meter.add(ImageBuffer(4, 4, 1, 0.3f));
  CHECK(meter.exposure() == greyAt(1.0));
  meter.add(ImageBuffer(4, 4, 3, 4.0f));
  CHECK(meter.exposure() == greyAt(2.0));
}

TEST_CASE("an exposure is lowered until less than 1 % of the pixels exceed white, no further") {
  const auto with = [](double share, float first) {
    ExposureMeter meter;
    meter.add(withFirst(static_cast<std::size_t>(share * kSide * kSide), first, 0.02f));
    return meter;
  };
  constexpr double kWhite = 10.0;
  // Sun on a fiftieth of a dark hall; on a five hundredth, which may be white; sun that is not too bright.
  CHECK(with(0.02, 50.0f).exposure(kWhite) == Approx(std::round(100.0 * std::log2(kWhite / 50.0)) / 100.0));
  CHECK(with(0.02, 50.0f).exposure() > std::log2(kWhite / 50.0) + 2.0);
  CHECK(with(0.002, 50.0f).exposure(kWhite) == with(0.002, 50.0f).exposure());
  CHECK(with(0.02, 0.5f).exposure(kWhite) == with(0.02, 0.5f).exposure());
  // A channel counts, not the luminance: pure red is four times as bright in its channel.
  ImageBuffer red = withFirst(0, 0.0f, 0.02f);
  for (std::size_t pixel = 0; pixel < 50; ++pixel) {
    red.values()[3 * pixel] = 50.0f;
    red.values()[3 * pixel + 1] = red.values()[3 * pixel + 2] = 0.0f;
  }
  ExposureMeter meter;
  meter.add(red);
  CHECK(meter.exposure(kWhite) == Approx(std::round(100.0 * std::log2(kWhite / 50.0)) / 100.0));
}
