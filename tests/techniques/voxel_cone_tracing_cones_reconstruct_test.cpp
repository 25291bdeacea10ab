// What the cones of some pixels saw, filtered for all of them: patterns, lower resolutions, edges and
// textures.
#include "support/cones.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::cones;

namespace {

constexpr int kSide = 32;  // pixels

struct SurfaceOfPixel {
  glm::vec3 position{0.0f}, normal{1, 0, 0}, albedo{1.0f};
  glm::vec4 specular{0.0f};
};
using Surfaces = std::function<SurfaceOfPixel(int x, int y)>;

GBuffer gbufferOf(const Surfaces& surfaces) {
  std::vector<float> values[4];
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const SurfaceOfPixel one = surfaces(x, y);
      const glm::vec4 texels[] = {glm::vec4(one.position, 1.0f), glm::vec4(one.normal, 0.0f),
                                  glm::vec4(one.albedo, 1.0f), one.specular};
      for (int i = 0; i < 4; ++i)
        values[i].insert(values[i].end(), {texels[i].x, texels[i].y, texels[i].z, texels[i].w});
    }
  const auto image = [](const std::vector<float>& texels) {
    auto texture = std::make_shared<gpu::Texture>(
        device(), gpu::TextureDescription{.format = gpu::Format::rgba32f, .width = kSide, .height = kSide},
        "test g-buffer");
    texture->uploadFloats(0, texels);
    return texture;
  };
  GBuffer result;
  result.position = image(values[0]);
  result.normal = result.geometricNormal = image(values[1]);
  result.diffuse = image(values[2]);
  result.specular = image(values[3]);
  return result;
}

Scene sized(const glm::vec3& environment) {
  SceneBuilder builder;
  builder.look({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 0.7, kSide, kSide);
  builder.scene.environment = environment;
  return builder.scene;
}

/// A bright, opaque wall on the positive side of x, the half of it above y = 0.
RadianceGrid wallToTheRight() {
  return filtered(
      makeGrid(16, [](int x, int y, int) { return x >= 14 && y >= 8 ? glm::vec4(1.0f) : glm::vec4(0.0f); }));
}

ImageBuffer diffuseOf(const RadianceGrid& grid, const Surfaces& surfaces, const GatherSettings& settings,
                      const glm::vec3& environment = glm::vec3(0.0f)) {
  return gatherWith(sized(environment), grid, gbufferOf(surfaces), settings,
                    [](PassHarness& harness) { return imageOf(*harness.output<Image>("diffuse").texture); });
}

GatherSettings with(int pattern, const char* resolution) {
  GatherSettings settings;
  settings.pattern = pattern;
  settings.resolution = resolution;
  return settings;
}

SurfaceOfPixel flat(int, int) {
  return {};
}

}  // namespace

TEST_CASE("where a surface goes on, every place of the pattern counts as much in every pixel") {
  const RadianceGrid grid = wallToTheRight();
  const double single = diffuseOf(grid, flat, with(1, "full")).at(16, 16, 0);
  for (const int pattern : {2, 3, 4, 5}) {
    double full = 0.0;
    for (const char* resolution : {"full", "half", "quarter"}) {
      CAPTURE(resolution, pattern);
      const ImageBuffer image = diffuseOf(grid, flat, with(pattern, resolution));
      // Away from the image's borders, where half of the box lies outside: at quarter 8 samples a side.
      const double middle = image.at(16, 16, 0);
      for (int y = 12; y < 20; ++y)
        for (int x = 12; x < 20; ++x) CHECK(image.at(x, y, 0) == Approx(middle).epsilon(1e-5));
      // The same cones are in the mean at every resolution, and not those of one pixel alone.
      if (full == 0.0) full = middle;
      CHECK(middle == Approx(full).epsilon(1e-5));
      CHECK(std::abs(middle / single - 1.0) > 0.02);
    }
  }
}

TEST_CASE("filtered light stays on its side of an edge between surfaces") {
  // The left half of the image faces the wall, the right half looks the other way, the lower half of both
  // lies far in front of it.
  const Surfaces edge = [](int x, int y) {
    SurfaceOfPixel one;
    if (x >= 16) one.normal = {-1, 0, 0};
    if (y >= 16) one.position.x = -0.5f;
    return one;
  };
  const RadianceGrid grid = wallToTheRight();
  const auto alone = [&](int x, int y) {
    return diffuseOf(
               grid, [&](int, int) { return edge(x, y); }, with(1, "full"))
        .at(16, 16, 0);
  };
  const double near = alone(0, 0), far = alone(0, 31);
  REQUIRE(near > 1.3 * far);
  for (const char* resolution : {"full", "half", "quarter"}) {
    CAPTURE(resolution);
    const ImageBuffer image = diffuseOf(grid, edge, with(1, resolution));
    const ImageBuffer patterned = diffuseOf(grid, edge, with(4, resolution));
    for (int i = 0; i < kSide; ++i) {
      CHECK(image.at(16, i, 0) < 0.002 * near);
      CHECK(patterned.at(16, i, 0) < 0.002 * near);
      if (i < 16) {
        CHECK(image.at(i, 15, 0) == Approx(near).epsilon(0.01));
        CHECK(image.at(i, 16, 0) == Approx(far).epsilon(0.01));
      }
    }
  }
}

TEST_CASE("a surface's own colours are not filtered, at whatever resolution its light is gathered") {
  const auto albedo = [](int x, int y) { return (x + y) % 2 == 0 ? 0.9f : 0.2f; };
  const Surfaces board = [&](int x, int y) {
    SurfaceOfPixel one;
    one.albedo = glm::vec3(albedo(x, y));
    return one;
  };
  const RadianceGrid empty = makeGrid(16, [](int, int, int) { return glm::vec4(0.0f); });
  for (const char* resolution : {"full", "half", "quarter"})
    for (const int pattern : {1, 4}) {
      CAPTURE(resolution, pattern);
      const ImageBuffer image = diffuseOf(empty, board, with(pattern, resolution), glm::vec3(2.0f));
      for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) CHECK(image.at(x, y, 0) == Approx(2.0 * albedo(x, y)).epsilon(1e-5));
    }
}

TEST_CASE("glossy light of lower resolution comes from pixels that mirror alone") {
  // Stripes of eight pixels without a specular albedo lie between those with one.
  const Surfaces stripes = [](int x, int) {
    SurfaceOfPixel one;
    one.normal = {0, 0, 1};
    one.specular = x / 8 % 2 == 0 ? glm::vec4(glm::vec3(0.5f), 1000.0f) : glm::vec4(0.0f);
    return one;
  };
  const RadianceGrid empty = makeGrid(16, [](int, int, int) { return glm::vec4(0.0f); });
  for (const char* resolution : {"full", "half", "quarter"}) {
    CAPTURE(resolution);
    const ImageBuffer image =
        gatherWith(sized(glm::vec3(2.0f)), empty, gbufferOf(stripes), with(4, resolution),
                   [](PassHarness& harness) { return imageOf(*harness.output<Image>("glossy").texture); });
    for (int x = 0; x < kSide; ++x)
      CHECK(image.at(x, 16, 0) == Approx(x / 8 % 2 == 0 ? 1.0 : 0.0).epsilon(1e-3).margin(1e-6));
  }
}
