// Joint bilateral filters of gathered light, on g-buffers made by hand.
#include <cmath>
#include <functional>
#include <random>

#include "lumivox/base/error.h"
#include "support/facts.h"
#include "support/passes.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr int kSize = 21;  // pixels along both sides: no multiple of 2 or 4
constexpr double kFov = 0.8;

using Surfaces = std::function<SeenSurface(int, int)>;
using Values = std::function<float(int, int)>;

/// The point of a plane z = -depth that a pixel sees from the origin.
glm::vec3 onPlane(int x, int y, float depth, int size = kSize) {
  const auto half = static_cast<float>(std::tan(0.5 * kFov));
  const float right = (static_cast<float>(x) + 0.5f) / static_cast<float>(size) * 2.0f - 1.0f,
              up = 1.0f - (static_cast<float>(y) + 0.5f) / static_cast<float>(size) * 2.0f;
  return {half * right * depth, half * up * depth, -depth};
}
SeenSurface facing(int x, int y, float depth = 2.0f) {
  return {onPlane(x, y, depth), {0, 0, 1}};
}

struct Smoothing {
  int every = 1;  // pixels from one sample to the next
  const char* kernel = "tent";
  int radius = 0;
  const char* what = "diffuse";
  int size = kSize;
  int samplesAcross = 0;  // 0: as many as belong to `every`
};

ImageBuffer smoothed(const Surfaces& surfaces, const Values& values, const Smoothing& settings) {
  const int size = settings.size, every = settings.every;
  SceneBuilder builder;
  builder.look({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, kFov, size, size);
  const int across = settings.samplesAcross > 0 ? settings.samplesAcross : (size + every - 1) / every;
  const auto pixel = [&](int i) { return std::min(every * i + every / 2, size - 1); };
  return LonePass("image_filters.smooth", builder.scene,
                  {{"kernel", settings.kernel}, {"radius", settings.radius}})
      .in("gbuffer", gbufferWhere({size, size}, surfaces))
      .in(settings.what, Image{pixelsWhere({across, across},
                                           [&](int x, int y) {
                                             return glm::vec4(glm::vec3(values(pixel(x), pixel(y))), 1.0f);
                                           })})
      .image(settings.what);
}

const Smoothing kAll[] = {{1, "tent", 0},     {1, "tent", 3},  {2, "tent"},     {4, "tent"},
                          {1, "gaussian", 3}, {2, "gaussian"}, {4, "gaussian"}, {1, "bilinear", 2},
                          {2, "bilinear"},    {4, "bilinear"}, {4, "tent", 16}, {2, "gaussian", 9}};

}  // namespace

TEST_CASE("a constant comes back, from all pixels, half and a quarter of them, by every kernel") {
  for (Smoothing settings : kAll)
    for (const char* what : {"diffuse", "glossy", "occlusion"})
      for (const int size : {kSize, 1, 16}) {
        settings.what = what;
        settings.size = size;
        const ImageBuffer image = smoothed(
            [&](int x, int y) {
              return SeenSurface{onPlane(x, y, 1.0f + 0.2f * static_cast<float>((3 * x + y) % 7), size),
                                 glm::normalize(glm::vec3(0.1f * static_cast<float>(x % 5), 0.2f, 1.0f))};
            },
            [](int, int) { return 0.7f; }, settings);
        CAPTURE(settings.every, settings.kernel, settings.radius, what, size);
        for (const float value : image.values()) CHECK(value == Approx(0.7f).epsilon(1e-6));
      }
}

TEST_CASE("smoothing none multiplies arriving light by the albedo, to the bit, and leaves the others alone") {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  std::vector<float> light(kSize * kSize), albedo(kSize * kSize);
  for (float& value : light) value = uniform(random);
  for (float& value : albedo) value = uniform(random);
  const auto at = [](const std::vector<float>& of) {
    return [&of](int x, int y) { return of[static_cast<std::size_t>(y * kSize + x)]; };
  };
  const Surfaces surfaces = [&](int x, int y) {
    SeenSurface surface = facing(x, y);
    surface.diffuse = glm::vec3(at(albedo)(x, y));
    return surface;
  };
  for (const char* what : {"diffuse", "glossy", "occlusion"}) {
    Smoothing settings;
    settings.what = what;
    const ImageBuffer image = smoothed(surfaces, at(light), settings);
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const float reflected = at(light)(x, y) * (what == std::string("diffuse") ? at(albedo)(x, y) : 1.0f);
        CHECK(image.at(x, y, 0) == reflected);
      }
  }
}

TEST_CASE("textures stay as sharp as they are where one of sixteen pixels has a sample") {
  const ImageBuffer image = smoothed(
      [](int x, int y) {
        SeenSurface surface = facing(x, y);
        surface.diffuse = glm::vec3((x + y) % 2 == 0 ? 0.9f : 0.1f);
        return surface;
      },
      [](int, int) { return 2.0f; }, {4});
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x)
      CHECK(image.at(x, y, 0) == Approx((x + y) % 2 == 0 ? 1.8f : 0.2f).epsilon(1e-5));
}

TEST_CASE("light that grows linearly across a plane comes back by tents, whose samples lie evenly") {
  const Values ramp = [](int x, int y) {
    return 1.0f + 0.1f * static_cast<float>(x) + 0.03f * static_cast<float>(y);
  };
  for (const Smoothing& settings : kAll) {
    if (settings.kernel == std::string("gaussian") && settings.every > 1)
      continue;  // four of a Gaussian are uneven
    const ImageBuffer image = smoothed([](int x, int y) { return facing(x, y); }, ramp, settings);
    CAPTURE(settings.every, settings.kernel, settings.radius);
    const int border = 2 * settings.every + settings.radius;
    for (int y = border; y < 20 - border; ++y)
      for (int x = border; x < 20 - border; ++x) CHECK(image.at(x, y, 0) == Approx(ramp(x, y)).epsilon(1e-5));
  }
}

TEST_CASE("planes a metre apart in depth that meet in the picture do not mix, but bilinearly") {
  constexpr int kEdge = 10;  // the first pixel of the farther plane
  const Surfaces steps = [](int x, int y) { return facing(x, y, x < kEdge ? 1.0f : 2.0f); };
  const Values values = [](int x, int) { return x < kEdge ? 1.0f : 0.0f; };
  for (const Smoothing& settings : kAll) {
    const ImageBuffer image = smoothed(steps, values, settings);
    CAPTURE(settings.every, settings.kernel, settings.radius);
    double most = 0.0;
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x)
        most = std::max<double>(most, std::abs(image.at(x, y, 0) - values(x, y)));
    if (settings.kernel == std::string("bilinear"))
      CHECK(most > 0.2);
    else
      CHECK(most < 1e-3);
  }
}

TEST_CASE(
    "walls that meet at a right angle do not mix, though each lies near the other's plane at the edge") {
  // An edge that points at the camera, along the middle column.
  constexpr int kEdge = 10;
  const Surfaces corner = [](int x, int y) {
    const float side = x < kEdge ? -1.0f : 1.0f;
    const glm::vec3 normal = glm::normalize(glm::vec3(side, 0, 1)), edge = onPlane(kEdge, kEdge, 2.0f),
                    direction = onPlane(x, y, 1.0f);
    return SeenSurface{direction * (glm::dot(edge, normal) / glm::dot(direction, normal)), normal};
  };
  const Values values = [](int x, int) { return x < kEdge ? 1.0f : 0.0f; };
  for (const Smoothing& settings : {Smoothing{1, "tent", 3}, Smoothing{1, "gaussian", 3},
                                    Smoothing{2, "tent"}, Smoothing{2, "gaussian"}}) {
    const ImageBuffer image = smoothed(corner, values, settings);
    CAPTURE(settings.every, settings.kernel, settings.radius);
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) CHECK(std::abs(image.at(x, y, 0) - values(x, y)) < 1e-3);
  }
}

TEST_CASE("a pixel that is like none of the samples takes the most alike one's light") {
  // A card before a wall behind which is another wall; samples lie on the walls alone.
  const Surfaces surfaces = [](int x, int y) {
    return facing(x, y, x == 9 && y == 9 ? 1.5f : x < 9 ? 2.0f : 5.0f);
  };
  const Values values = [](int x, int) { return x < 9 ? 3.0f : 7.0f; };
  // Along rows and columns one after the other it sees what its own row and column saw.
  CHECK(smoothed(surfaces, values, {4, "tent"}).at(9, 9, 0) == Approx(3.0).epsilon(1e-3));
}

TEST_CASE("samples of the background count nothing, and pixels of it get none of the light") {
  const Surfaces surfaces = [](int x, int y) {
    SeenSurface surface = facing(x, y);
    surface.hit = x >= 7;
    return surface;
  };
  const Values values = [](int x, int) { return x >= 7 ? 0.25f : 100.0f; };
  for (const Smoothing& settings : kAll)
    for (const char* what : {"diffuse", "occlusion"}) {
      Smoothing one = settings;
      one.what = what;
      const ImageBuffer image = smoothed(surfaces, values, one);
      CAPTURE(settings.every, settings.kernel, what);
      for (int x = 0; x < kSize; ++x)
        CHECK(image.at(x, 5, 0) == Approx(x >= 7                             ? 0.25
                                          : what == std::string("occlusion") ? 1.0
                                                                             : 0.0)
                                       .epsilon(1e-5));
    }
}

TEST_CASE("noise keeps the share of its variance that the squared weights add up to") {
  // Tents of reach r + 1 over 2 r + 1 pixels: along each axis sum w^2 / (sum w)^2.
  std::mt19937 random(7);
  std::normal_distribution<float> normal(0.0f, 1.0f);
  constexpr int kWide = 64, kRadius = 3;
  std::vector<float> noise(kWide * kWide);
  for (float& value : noise) value = normal(random);
  Smoothing settings{1, "tent", kRadius};
  settings.size = kWide;
  const ImageBuffer image = smoothed(
      [](int x, int y) {
        return SeenSurface{onPlane(x, y, 2.0f, kWide), {0, 0, 1}};
      },
      [&](int x, int y) { return noise[static_cast<std::size_t>(y * kWide + x)]; }, settings);
  double squares = 0.0, sum = 0.0, squaredSum = 0.0;
  for (int i = -kRadius; i <= kRadius; ++i) {
    const double weight = 1.0 - std::abs(i) / (kRadius + 1.0);
    sum += weight;
    squaredSum += weight * weight;
  }
  int count = 0;
  for (int y = kRadius; y < kWide - kRadius; ++y)
    for (int x = kRadius; x < kWide - kRadius; ++x, ++count) squares += std::pow(image.at(x, y, 0), 2);
  CHECK(squares / count == Approx(std::pow(squaredSum / (sum * sum), 2)).epsilon(0.10));
}

TEST_CASE(
    "a wider radius takes more of the samples that lie apart, and a narrow one the two next to a pixel") {
  // An impulse at one sample reaches as far as the kernel.
  constexpr int kLarge = 81, kAt = 40;
  const auto reachOf = [&](const char* kernel, int radius) {
    const ImageBuffer image = smoothed(
        [](int x, int y) {
          return SeenSurface{onPlane(x, y, 2.0f, kLarge), {0, 0, 1}};
        },
        [](int x, int y) { return x == kAt + 2 && y == kAt + 2 ? 1.0f : 0.0f; },
        {.every = 4, .kernel = kernel, .radius = radius, .size = kLarge});
    int reach = 0;
    for (int x = kAt + 2; x < kLarge; ++x)
      if (image.at(x, kAt + 2, 0) > 0.0f) reach = x - kAt - 2;
    return reach;
  };
  for (const char* kernel : {"tent", "gaussian"}) {
    INFO(kernel);
    // A tent is 0 at its reach.
    for (const int radius : {0, 5, 8}) CHECK(std::abs(reachOf(kernel, radius) - 7) <= 1);
    CHECK(std::abs(reachOf(kernel, 16) - 15) <= 1);
    CHECK(std::abs(reachOf(kernel, 24) - 23) <= 1);
  }
  CHECK(reachOf("bilinear", 24) <= 4);
}

TEST_CASE("an image of no such size is refused with its size and with what was expected") {
  Smoothing settings;
  settings.samplesAcross = 9;
  CHECK_THROWS_MATCHES(
      smoothed([](int x, int y) { return facing(x, y); }, [](int, int) { return 1.0f; }, settings), Error,
      Tells("diffuse", "9 x 9", "21 x 21", "2 x 2", "4 x 4"));
}
