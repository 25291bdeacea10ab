// FLIP against closed forms and against a direct evaluation of its definition, written here without separable
// filters.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "lumivox/analysis/comparison.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/random.h"
#include "lumivox/measure/metrics.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;
using Vector = std::array<double, 3>;

namespace {

using std::numbers::pi;

// ---- the definition, straight from Andersson et al. 2020, with the published rational matrix from linear
// Rec. 709 to XYZ

Vector xyzOf(const Vector& rgb) {
  return {(10135552.0 * rgb[0] + 8788810.0 * rgb[1] + 4435075.0 * rgb[2]) / 24577794.0,
          (2613072.0 * rgb[0] + 8788810.0 * rgb[1] + 887015.0 * rgb[2]) / 12288897.0,
          (1425312.0 * rgb[0] + 8788810.0 * rgb[1] + 70074185.0 * rgb[2]) / 73733382.0};
}

const Vector kWhite = xyzOf({1, 1, 1});

Vector rgbOf(const Vector& xyz) {
  // Published to nine digits, as the inverse of the above.
  constexpr double kInverse[3][3] = {{3.241003275, -1.537398934, -0.498615861},
                                     {-0.969224334, 1.875930071, 0.041554224},
                                     {0.055639423, -0.204011202, 1.057148933}};
  Vector rgb{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) rgb[i] += kInverse[i][j] * xyz[j];
  }
  return rgb;
}

Vector opponentOf(const Vector& rgb) {
  const Vector xyz = xyzOf(rgb);
  const double x = xyz[0] / kWhite[0], y = xyz[1] / kWhite[1], z = xyz[2] / kWhite[2];
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Vector huntLabOf(const Vector& rgb) {
  const Vector xyz = xyzOf(rgb);
  const auto f = [](double t) {
    return t > 216.0 / 24389.0 ? std::cbrt(t) : (24389.0 / 27.0 * t + 16) / 116;
  };
  const double x = f(xyz[0] / kWhite[0]), y = f(xyz[1] / kWhite[1]), z = f(xyz[2] / kWhite[2]);
  const double lightness = 116 * y - 16;
  return {lightness, 0.01 * lightness * 500 * (x - y), 0.01 * lightness * 200 * (y - z)};
}

double hyab(const Vector& a, const Vector& b) {
  return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

/// The colour difference in [0,1] of two Hunt-adjusted colours.
double colourDifference(const Vector& a, const Vector& b) {
  const double largest = std::pow(hyab(huntLabOf({0, 1, 0}), huntLabOf({0, 0, 1})), 0.7);
  const double distance = std::pow(hyab(a, b), 0.7);
  if (distance < 0.4 * largest) return 0.95 / (0.4 * largest) * distance;
  return 0.95 + (distance - 0.4 * largest) / (0.6 * largest) * 0.05;
}

/// Weights of the pixels around one, and how far they lie from it in x and y.
struct Tap {
  int x, y;
  double weight;
};
using Kernel = std::vector<Tap>;

template <class Function>
Kernel kernelOf(int radius, const Function& function) {
  Kernel kernel;
  for (int y = -radius; y <= radius; ++y)
    for (int x = -radius; x <= radius; ++x) kernel.push_back({x, y, function(x, y)});
  return kernel;
}

Kernel sensitivity(double pixelsPerDegree, double a1, double b1, double a2, double b2) {
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * pixelsPerDegree));
  Kernel kernel = kernelOf(radius, [&](int x, int y) {
    const double squared = (x * x + y * y) / (pixelsPerDegree * pixelsPerDegree);
    return a1 * std::sqrt(pi / b1) * std::exp(-pi * pi * squared / b1) +
           a2 * std::sqrt(pi / b2) * std::exp(-pi * pi * squared / b2);
  });
  double sum = 0;
  for (const Tap& tap : kernel) sum += tap.weight;
  for (Tap& tap : kernel) tap.weight /= sum;
  return kernel;
}

Kernel feature(double pixelsPerDegree, bool edge, bool across) {
  const double sigma = 0.5 * 0.082 * pixelsPerDegree;
  Kernel kernel = kernelOf(static_cast<int>(std::ceil(3 * sigma)), [&](int x, int y) {
    const int u = across ? x : y;
    return (edge ? -u : u * u / (sigma * sigma) - 1) * std::exp(-(x * x + y * y) / (2 * sigma * sigma));
  });
  double positive = 0, negative = 0;
  for (const Tap& tap : kernel) (tap.weight > 0 ? positive : negative) += std::abs(tap.weight);
  for (Tap& tap : kernel) tap.weight /= tap.weight > 0 ? positive : negative;
  return kernel;
}

using Image = std::vector<Vector>;

double filtered(const Image& image, int width, int height, int x, int y, std::size_t channel,
                const Kernel& kernel) {
  double sum = 0;
  for (const Tap& tap : kernel) {
    const int px = std::clamp(x + tap.x, 0, width - 1), py = std::clamp(y + tap.y, 0, height - 1);
    sum += tap.weight * image[static_cast<std::size_t>(py * width + px)][channel];
  }
  return sum;
}

std::vector<double> directFlip(const ImageBuffer& image, const ImageBuffer& reference, double ppd) {
  const int width = reference.width(), height = reference.height();
  const Kernel achromatic = sensitivity(ppd, 1, 0.0047, 0, 1e-5),
               redGreen = sensitivity(ppd, 1, 0.0053, 0, 1e-5);
  const Kernel blueYellow = sensitivity(ppd, 34.1, 0.04, 13.5, 0.025);
  const Kernel features[4] = {feature(ppd, true, true), feature(ppd, true, false), feature(ppd, false, true),
                              feature(ppd, false, false)};
  Image opponents[2];
  for (int which = 0; which < 2; ++which) {
    const ImageBuffer& source = which == 0 ? image : reference;
    for (std::size_t i = 0; i < source.pixelCount(); ++i) {
      Vector rgb{};
      for (std::size_t c = 0; c < 3; ++c) rgb[c] = std::clamp(double{source.values()[3 * i + c]}, 0.0, 1.0);
      opponents[which].push_back(opponentOf(rgb));
    }
  }
  std::vector<double> map;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      Vector lab[2];
      double edges[2], points[2];
      for (int which = 0; which < 2; ++which) {
        const Image& opponent = opponents[which];
        const Vector seen = {filtered(opponent, width, height, x, y, 0, achromatic),
                             filtered(opponent, width, height, x, y, 1, redGreen),
                             filtered(opponent, width, height, x, y, 2, blueYellow)};
        const double luminance = (seen[0] + 16) / 116;
        Vector rgb = rgbOf({(luminance + seen[1] / 500) * kWhite[0], luminance * kWhite[1],
                            (luminance - seen[2] / 200) * kWhite[2]});
        for (double& value : rgb) value = std::clamp(value, 0.0, 1.0);
        lab[which] = huntLabOf(rgb);
        double strength[4];  // the filters see (Y + 16) / 116; the offset has no features, so Y / 116 does as
                             // well
        for (int k = 0; k < 4; ++k)
          strength[k] = filtered(opponent, width, height, x, y, 0, features[k]) / 116;
        edges[which] = std::hypot(strength[0], strength[1]);
        points[which] = std::hypot(strength[2], strength[3]);
      }
      const double difference = std::max(std::abs(edges[0] - edges[1]), std::abs(points[0] - points[1]));
      map.push_back(std::pow(colourDifference(lab[0], lab[1]), 1 - std::sqrt(difference / std::sqrt(2.0))));
    }
  }
  return map;
}

// ---- images

ImageBuffer constant(int width, int height, const Vector& rgb) {
  ImageBuffer image(width, height, 3);
  for (std::size_t i = 0; i < image.values().size(); ++i) image.values()[i] = static_cast<float>(rgb[i % 3]);
  return image;
}

ImageBuffer random(int width, int height, std::uint64_t seed, float scale = 1.0f) {
  ImageBuffer image(width, height, 3);
  RandomStream stream(seed, 0);
  for (float& value : image.values()) value = scale * stream.uniform();
  return image;
}

double meanOf(const ImageBuffer& map) {
  double sum = 0;
  for (const float value : map.values()) sum += double{value};
  return sum / static_cast<double>(map.values().size());
}

/// Sets a rectangle of all channels.
ImageBuffer painted(ImageBuffer image, int left, int top, int width, int height, float value) {
  for (int y = top; y < top + height; ++y)
    for (int x = left; x < left + width; ++x)
      for (int c = 0; c < image.channels(); ++c) image.at(x, y, c) = value;
  return image;
}

bool allNear(const ImageBuffer& map, double expected, double tolerance) {
  return std::all_of(map.values().begin(), map.values().end(),
                     [&](float value) { return std::abs(double{value} - expected) <= tolerance; });
}

double aces(double x) {
  // Narkowicz's curve x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14) at the film exposure 0.6.
  const double v = 0.6 * x;
  return std::clamp(v * (2.51 * v + 0.03) / (v * (2.43 * v + 0.59) + 0.14), 0.0, 1.0);
}

}  // namespace

TEST_CASE("FLIP of an image and itself is zero") {
  const ImageBuffer image = random(31, 23, 1, 3.0f);
  REQUIRE(allNear(flipLdr(image, image), 0.0, 0.0));
  REQUIRE(allNear(flipHdr(image, image), 0.0, 0.0));
}

TEST_CASE("FLIP of black against white is that of a lightness difference of 100") {
  // Constant images have no features, and filters of sum 1 leave them alone. L* differs by 100, chroma by
  // nothing: 100^0.7 = 25.119 is above the knee 0.4 * largest. The largest distance is green (87.74,
  // -75.61, 72.98) to blue (32.30, 25.58, -34.84), after Hunt: 55.44 + sqrt(101.2^2 + 107.8^2) = 203.3;
  // 203.3^0.7 = 41.28; knee 16.51; 0.95 + 0.05 (25.12 - 16.51) / (41.28 - 16.51) = 0.9674.
  const ImageBuffer black = constant(40, 30, {0, 0, 0}), white = constant(40, 30, {1, 1, 1});
  REQUIRE(allNear(flipLdr(black, white), 0.9674, 1e-4));
  REQUIRE(allNear(flipLdr(white, black), colourDifference({100, 0, 0}, {0, 0, 0}), 1e-6));
}

TEST_CASE("FLIP of constant colours is the remapped HyAB distance of their Hunt-adjusted colours") {
  REQUIRE(colourDifference(huntLabOf({0, 1, 0}), huntLabOf({0, 0, 1})) ==
          Approx(1.0));  // the largest of the display
  const Vector colours[] = {{0.2, 0.4, 0.1}, {0.25, 0.35, 0.1}, {0.9, 0.1, 0.5}, {0.003, 0.002, 0.001},
                            {1, 1, 0.2},     {0, 1, 0},         {0, 0, 1}};
  for (const Vector& a : colours) {
    for (const Vector& b : colours) {
      const double expected = colourDifference(huntLabOf(a), huntLabOf(b));
      REQUIRE(allNear(flipLdr(constant(5, 4, a), constant(5, 4, b)), expected, 2e-4));
    }
  }
}

TEST_CASE("FLIP of any two images is its definition evaluated directly with two-dimensional kernels") {
  for (const double pixelsPerDegree : {67.0206, 25.0}) {
    const ImageBuffer reference = random(26, 19, 2);
    ImageBuffer image = painted(reference, 9, 4, 11, 8, 0.3f);
    for (int y = 4; y < 12; ++y)
      for (int x = 9; x < 20; ++x) image.at(x, y, 1) = 0.6f, image.at(x, y, 2) = 0.9f;
    const ImageBuffer map = flipLdr(image, reference, pixelsPerDegree);
    const std::vector<double> expected = directFlip(image, reference, pixelsPerDegree);
    double largest = 0, sum = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      largest = std::max(largest, std::abs(expected[i] - double{map.values()[i]}));
      sum += expected[i];
    }
    REQUIRE(sum / static_cast<double>(expected.size()) > 0.05);  // there is something to see
    REQUIRE(largest < 2e-4);  // the nine digits of the published inverse matrix, raised to the power 0.7
  }
}

TEST_CASE("FLIP of a displaced edge grows with the displacement and stays near the edge") {
  constexpr int kWidth = 96, kHeight = 24, kEdge = 48;
  const auto whiteFrom = [](int edge) {
    return painted(constant(kWidth, kHeight, {0, 0, 0}), edge, 0, kWidth - edge, kHeight, 1.0f);
  };
  double before = 0.0;
  for (const int shift : {1, 2, 4, 8}) {
    const ImageBuffer map = flipLdr(whiteFrom(kEdge + shift), whiteFrom(kEdge));
    REQUIRE(meanOf(map) > before);
    before = meanOf(map);
    // Beyond the reach of the filters (10 pixels at 67 pixels per degree) nothing differs.
    REQUIRE(map.at(kEdge - 12, 12, 0) == 0.0f);
    REQUIRE(map.at(kEdge + shift + 12, 12, 0) == 0.0f);
    REQUIRE(map.at(kEdge, 12, 0) > 0.5f);
  }
}

TEST_CASE("FLIP moves with the images and turns with them") {
  // The same small square on grey, at two places; then with rows and columns exchanged.
  const auto ofSquare = [](int left, int top) {
    const ImageBuffer grey = constant(64, 64, {0.2, 0.2, 0.2});
    return flipLdr(painted(grey, left, top, 7, 3, 0.9f), grey);
  };
  const ImageBuffer one = ofSquare(20, 24), other = ofSquare(33, 29);
  for (int y = 14; y < 38; ++y)
    for (int x = 8; x < 40; ++x) REQUIRE(one.at(x, y, 0) == Approx(other.at(x + 13, y + 5, 0)).margin(1e-6));
  const auto turned = [](const ImageBuffer& image) {
    ImageBuffer result(image.height(), image.width(), image.channels());
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x)
        for (int c = 0; c < image.channels(); ++c) result.at(y, x, c) = image.at(x, y, c);
    return result;
  };
  const ImageBuffer a = random(30, 22, 5), b = random(30, 22, 6);
  const ImageBuffer expected = turned(flipLdr(a, b)), map = flipLdr(turned(a), turned(b));
  for (std::size_t i = 0; i < map.values().size(); ++i)
    REQUIRE(map.values()[i] == Approx(expected.values()[i]).margin(1e-6));
}

TEST_CASE("one channel is grey") {
  ImageBuffer greyA(12, 12, 1, 0.3f), greyB(12, 12, 1, 0.6f);
  REQUIRE(meanOf(flipLdr(greyA, greyB)) ==
          Approx(meanOf(flipLdr(constant(12, 12, {0.3, 0.3, 0.3}), constant(12, 12, {0.6, 0.6, 0.6})))));
}

TEST_CASE("HDR-FLIP of constant greys is LDR-FLIP at the exposure that shows the reference at 0.85") {
  // Largest and median luminance agree, so every exposure maps the reference to 0.85. The exposed radiance x
  // solves aces(x) = 0.85; the image at twice the radiance is shown at aces(2 x).
  double low = 0, high = 100;
  for (int i = 0; i < 200; ++i) (aces((low + high) / 2) < 0.85 ? low : high) = (low + high) / 2;
  const double brighter = aces(2 * low);
  const double expected =
      colourDifference(huntLabOf({brighter, brighter, brighter}), huntLabOf({0.85, 0.85, 0.85}));
  const ImageBuffer map = flipHdr(constant(8, 8, {7, 7, 7}), constant(8, 8, {3.5, 3.5, 3.5}));
  REQUIRE(expected > 0.02);
  REQUIRE(allNear(map, expected, 1e-5));
}

TEST_CASE("HDR-FLIP of brighter images is what pages, terminal and guide say") {
  // Greys from 0.01 to 10.
  ImageBuffer ramp(96, 48, 3);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 96; ++x)
      for (int c = 0; c < 3; ++c)
        ramp.at(x, y, c) = static_cast<float>(std::pow(10.0, -2.0 + 3.0 * x / 95.0));
  const ImageBuffer grey = constant(96, 48, {0.5, 0.5, 0.5});
  const auto brighter = [](ImageBuffer image, float factor) {
    const ImageBuffer reference = image;
    for (float& value : image.values()) value *= factor;
    return meanOf(flipHdr(image, reference));
  };
  std::string guide = readFile(sourceDirectory() / "docs/metrics.md");
  std::replace(guide.begin(), guide.end(), '\n', ' ');
  CHECK(guide.find(kDefaultMetricSays) != std::string::npos);
  const auto said = [&](const std::string& before, const std::string& form, const ImageBuffer& image) {
    const std::size_t at = guide.find(before);
    REQUIRE(at != std::string::npos);
    std::string numbers;
    for (const float factor : {1.02f, 1.1f, 1.5f})
      numbers += (numbers.empty()  ? ""
                  : factor == 1.5f ? " and "
                                   : ", ") +
                 fmt::format(fmt::runtime(form), brighter(image, factor));
    INFO(numbers);
    CHECK(guide.compare(at + before.size(), numbers.size(), numbers) == 0);
  };
  said("50 % brighter has ", "{:.2f}", ramp);
  said("made brighter alike, has ", "{:.3f}", grey);
}

TEST_CASE("HDR-FLIP does not depend on the unit of radiance") {
  const ImageBuffer image = random(24, 24, 8), reference = random(24, 24, 9);
  ImageBuffer scaledImage = image, scaledReference = reference;
  for (float& value : scaledImage.values()) value *= 1024.0f;
  for (float& value : scaledReference.values()) value *= 1024.0f;
  const ImageBuffer map = flipHdr(image, reference), scaledMap = flipHdr(scaledImage, scaledReference);
  for (std::size_t i = 0; i < map.values().size(); ++i)
    REQUIRE(map.values()[i] == Approx(scaledMap.values()[i]).margin(1e-5));
}

TEST_CASE("HDR-FLIP sees a difference in the dark beside a bright area light and one within the area light") {
  // An area light of 1000 in a room of 1: no single exposure shows both errors.
  const ImageBuffer reference = painted(constant(48, 32, {1, 1, 1}), 4, 10, 8, 10, 1000.0f);
  const ImageBuffer image = painted(painted(reference, 6, 12, 4, 6, 500.0f), 34, 12, 6, 6, 0.5f);
  const ImageBuffer map = flipHdr(image, reference);
  REQUIRE(map.at(8, 15, 0) > 0.1f);
  REQUIRE(map.at(37, 15, 0) > 0.1f);
  REQUIRE(map.at(24, 28, 0) < 1e-3f);
}

TEST_CASE("HDR-FLIP stays between 0 and 1 for black, mostly black, negative and enormous radiance") {
  const ImageBuffer black = constant(16, 16, {0, 0, 0});
  ImageBuffer mostlyBlack = black, negative = random(16, 16, 4);
  mostlyBlack.at(3, 3, 1) = 2.0f;
  for (float& value : negative.values()) value = 0.5f - value;
  const std::vector<ImageBuffer> images{black, mostlyBlack,
                                        random(16, 16, 3, std::numeric_limits<float>::max()),
                                        random(16, 16, 3, 1e-38f), negative};
  for (const ImageBuffer& a : images)
    for (const ImageBuffer& b : images) {
      REQUIRE(allNear(flipHdr(a, b), 0.5, 0.5));
      REQUIRE(allNear(flipLdr(a, b), 0.5, 0.5));
    }
  REQUIRE(meanOf(flipHdr(black, black)) == 0.0);
  REQUIRE(flipHdr(black, mostlyBlack).at(3, 3, 0) > 0.1f);
}

TEST_CASE("a NaN pixel is marked in the FLIP map and does not spread") {
  const ImageBuffer reference = random(40, 40, 11);
  ImageBuffer image = reference;
  image.at(20, 20, 1) = std::numeric_limits<float>::quiet_NaN();
  image.at(5, 6, 0) = std::numeric_limits<float>::infinity();
  for (ImageBuffer map : {flipLdr(image, reference), flipHdr(image, reference), flipHdr(reference, image)}) {
    for (float* bad : {&map.at(20, 20, 0), &map.at(5, 6, 0)}) {
      REQUIRE(std::isnan(*bad));
      *bad = 0.0f;
    }
    REQUIRE(allNear(map, 0.0, 0.0));
  }
}

TEST_CASE("FLIP refuses shapes that differ and impossible viewing distances") {
  REQUIRE_THROWS_AS(flipLdr(ImageBuffer(4, 4, 3), ImageBuffer(4, 5, 3)), Error);
  REQUIRE_THROWS_AS(flipLdr(ImageBuffer(4, 4, 2), ImageBuffer(4, 4, 2)), Error);
  REQUIRE_THROWS_AS(flipHdr(ImageBuffer(), ImageBuffer()), Error);
  REQUIRE_THROWS_AS(flipLdr(ImageBuffer(4, 4, 3), ImageBuffer(4, 4, 3), 0.0), Error);
  REQUIRE_THROWS_AS(flipLdr(ImageBuffer(4, 4, 3), ImageBuffer(4, 4, 3), std::nan("")), Error);
}
