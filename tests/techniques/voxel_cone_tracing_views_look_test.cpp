// Looking at grids: rays and cones through voxels that emit and absorb.
//
// A ray through n voxels of opacity a whose emission is L a sees L (1 - (1 - a)^n), and lets (1 - a)^n of the
// background through.
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/pipeline/ports.h"
#include "support/cones.h"
#include "support/marching.h"

using namespace lumivox;
using namespace lumivox::test;
using Catch::Matchers::Contains;

namespace {

constexpr int kSide = 32;  // pixels along both sides

using Words = std::vector<std::pair<std::string, std::string>>;
using Numbers = std::vector<std::pair<std::string, double>>;

/// A camera that looks along -z at [-1,1]^3 from so far away that its rays are nearly parallel; pixels are
/// 1/16 m.
Scene farView() {
  SceneBuilder builder;
  constexpr double kDistance = 1000.0;
  builder.look({0, 0, kDistance}, {0, 0, 0}, {0, 1, 0}, 2.0 * std::atan(1.0 / kDistance), kSide, kSide);
  return builder.scene;
}

template <class Port>
ImageBuffer lookAt(const Scene& scene, const Port& port, const Words& words = {},
                   const Numbers& numbers = {}) {
  PassHarness harness(device(), techniques(), "voxel_cone_tracing", "look", scene, snapshotOf(scene, 0.0));
  for (const auto& [name, word] : words) harness.setParameter(name, word);
  for (const auto& [name, number] : numbers) harness.setParameter(name, number);
  harness.setInput("voxels", port);
  harness.run();
  return imageOf(*harness.output<Image>("radiance").texture);
}

template <class Port>
std::string refusal(const Port& port, const Words& words = {}, const Numbers& numbers = {}) {
  return messageOf<Error>([&] { lookAt(farView(), port, words, numbers); });
}

/// Pixels that see anything.
int litPixels(const ImageBuffer& image) {
  int lit = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      lit += image.at(x, y, 0) + image.at(x, y, 1) + image.at(x, y, 2) > 0.0f ? 1 : 0;
  return lit;
}

}  // namespace

TEST_CASE("rays and cones through even voxels see their depth, and the background behind them") {
  const float a = 0.05f;
  const RadianceGrid grid = cones::filtered(cones::uniformGrid(16, glm::vec4(glm::vec3(2.0f * a), a)));
  const double left = std::pow(1.0 - static_cast<double>(a), 16.0);
  for (const auto& [filter, cast] : Words{{"nearest", "ray"}, {"trilinear", "ray"}, {"trilinear", "cone"}}) {
    CAPTURE(filter, cast);
    const ImageBuffer image = lookAt(
        farView(), grid, {{"filter", filter}, {"cast", cast}, {"multiplied", "on"}}, {{"background", 0.5}});
    CHECK(image.at(kSide / 2, kSide / 2, 0) ==
          Approx(2.0 * (1.0 - left) + 0.5 * left).epsilon(filter == "nearest" ? 1e-3 : 0.01));
  }
}

TEST_CASE("cones read means of the voxels that a pixel is wide") {
  // A pixel is 1/16 m wide, and voxels 1/64 m: 128 of them along the ray.
  const float a = 0.006f;
  const RadianceGrid grid = cones::uniformGrid(128, glm::vec4(glm::vec3(2.0f * a), a));
  const ImageBuffer image =
      lookAt(farView(), grid, {{"filter", "trilinear"}, {"cast", "cone"}, {"multiplied", "on"}});
  const double left = std::pow(1.0 - static_cast<double>(a), 128.0);
  CHECK(image.at(kSide / 2, kSide / 2, 0) == Approx(2.0 * (1.0 - left)).epsilon(0.01));
}

TEST_CASE("a slanted ray is in each cell by its length there") {
  // One layer of opacity 1/2 across z, seen at 45 degrees: by a length of sqrt 2 voxels.
  const RadianceGrid grid =
      cones::makeGrid(16, [](int, int, int z) { return z == 7 ? glm::vec4(0.5f) : glm::vec4(0.0f); });
  SceneBuilder builder;
  constexpr double kDistance = 1000.0;
  builder.look({kDistance, 0, kDistance}, {0, 0, 0}, {0, 1, 0}, 0.5 / kDistance, kSide, kSide);
  const ImageBuffer image = lookAt(builder.scene, grid, {{"multiplied", "on"}});
  for (const int x : {8, 16, 24})
    CHECK(image.at(x, 16, 0) == Approx(1.0 - std::pow(0.5, std::sqrt(2.0))).epsilon(2e-3));
}

TEST_CASE("nearest voxels are seen as cells of one colour, trilinear ones blended") {
  // Two pixels a voxel. The voxel (5, 9) is opaque and red, and nothing else is there.
  const RadianceGrid grid = cones::makeGrid(16, [](int x, int y, int z) {
    return x == 5 && y == 9 && z == 3 ? glm::vec4(0.7f, 0, 0, 1) : glm::vec4(0.0f);
  });
  const ImageBuffer cells = lookAt(farView(), grid);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      CAPTURE(x, y);
      const bool inside = x / 2 == 5 && (kSide - 1 - y) / 2 == 9;
      CHECK(cells.at(x, y, 0) == Approx(inside ? 0.7f : 0.0f).margin(1e-5));
    }
  CHECK(litPixels(lookAt(farView(), grid, {{"filter", "trilinear"}})) > 4);
}

TEST_CASE("a level is looked at alone, and its voxels are as large as they are") {
  RadianceGrid grid = cones::filtered(cones::makeGrid(
      16, [](int x, int y, int) { return x < 2 && y < 2 ? glm::vec4(1.0f) : glm::vec4(0.0f); }));
  CHECK(litPixels(lookAt(farView(), grid)) == 4 * 4);
  CHECK(litPixels(lookAt(farView(), grid, {}, {{"level", 3}})) == 16 * 16);
  CHECK_THAT(refusal(grid, {}, {{"level", 9}}), Contains("has no level 9") && Contains("expected 0..4"));
  CHECK_THAT(refusal(grid, {}, {{"field", 2}}),
             Contains("has no field 2") && Contains("0 (radiance), 1 (opacity)"));
}

TEST_CASE("a density absorbs by its extinction and shows on the ramp") {
  const ScatteringGrid smoke =
      varyingMedium(1.0f, 0.5f, 0.0f, {-1, -1, -1}, 0.25f, {8, 8, 8}, [](const glm::vec3&) { return 0.5f; });
  const ImageBuffer image = lookAt(farView(), smoke, {{"emission", "ramp"}},
                                   {{"absorption", 0.8}, {"high", 0.5}, {"background", 3.0}});
  // 2 m of density 0.5, which is the ramp's white.
  const double left = std::exp(-0.8 * 0.5 * 2.0);
  CHECK(image.at(16, 16, 1) == Approx(1.0 - left + 3.0 * left).epsilon(2e-3));
}

TEST_CASE("voxels of every kind are seen: lists, bits, attributes, harmonics") {
  SceneBuilder builder;
  builder.box({-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}, builder.lambert(0.25f), false);
  builder.look({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 0.6, kSide, kSide);
  const Scene& scene = builder.scene;
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  PassHarness list(device(), techniques(), "voxelization", "conservative", scene, snapshot);
  list.setParameter("resolution", 16);
  list.run();
  const auto& fragments = list.output<VoxelFragments>("fragments");
  const ImageBuffer occupied = lookAt(scene, fragments);
  CHECK(litPixels(occupied) > 100);
  CHECK(occupied.at(16, 16, 0) == 1.0f);
  CHECK(lookAt(scene, fragments, {}, {{"field", 1}}).at(16, 16, 0) >= 1.0f);  // their number

  AttributeGrid attributes;
  attributes.grid = {glm::vec3(-1.0f), 0.125f, glm::ivec3(16)};
  attributes.albedo = cones::makeGrid(16, [](int, int, int z) {
                        return z == 8 ? glm::vec4(0.3f, 0.6f, 0.9f, 1) : glm::vec4(0.0f);
                      }).radiance;
  attributes.normal = cones::makeGrid(16, [](int, int, int z) {
                        return z == 8 ? glm::vec4(0, 0, 1, 1) : glm::vec4(0.0f);
                      }).radiance;
  const ImageBuffer albedo = lookAt(farView(), attributes),
                    normal = lookAt(farView(), attributes, {}, {{"field", 2}});
  for (int channel = 0; channel < 3; ++channel) {
    CHECK(albedo.at(9, 9, channel) == Approx(0.3 * (channel + 1)).epsilon(1e-3));
    CHECK(normal.at(9, 9, channel) == Approx(channel == 2 ? 1.0 : 0.5).epsilon(1e-3));
  }

  ShGrid light;
  light.unit = 2.0f;
  light.levels.push_back({attributes.grid, {attributes.albedo, attributes.normal, nullptr}});
  // Y00 of red, green and blue; blue is as red.
  const ImageBuffer harmonic = lookAt(farView(), light);
  CHECK(harmonic.at(9, 9, 0) == Approx(0.6).epsilon(1e-3));
  CHECK(harmonic.at(9, 9, 1) == Approx(0.0).margin(1e-5));
  CHECK(harmonic.at(9, 9, 2) == Approx(0.6).epsilon(1e-3));
}

TEST_CASE("bits and a list of the same voxels look the same") {
  SceneBuilder builder;
  builder.box({-0.5f, -0.5f, -0.5f}, {0.5f, 0.4f, 0.3f}, builder.lambert(0.25f), false);
  builder.look({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 0.6, kSide, kSide);
  const Scene& scene = builder.scene;
  const auto made = [&](const char* pass) {
    auto harness = std::make_unique<PassHarness>(device(), techniques(), "voxelization", pass, scene,
                                                 snapshotOf(scene, 0.0));
    return harness;
  };
  auto list = made("conservative");
  list->setParameter("resolution", 32);
  list->run();
  const auto& fragments = list->output<VoxelFragments>("fragments");
  BinaryGrid bits;
  bits.grid = fragments.grid;
  gpu::TextureDescription description;
  description.kind = gpu::TextureKind::d2Array;
  description.format = gpu::Format::rgba32ui;
  description.width = bits.grid.resolution.x, description.height = bits.grid.resolution.y;
  bits.stacks = std::make_shared<gpu::Texture>(device(), description, "test bits");
  std::vector<std::uint32_t> words(static_cast<std::size_t>(4 * description.width * description.height));
  const auto count = fragments.count->downloadValues<std::uint32_t>().front();
  const auto items = fragments.fragments->downloadValues<std::uint32_t>();
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t packed = items[i * VoxelFragments::kFragmentBytes / 4], x = packed & 1023u,
                        y = packed >> 10 & 1023u, z = packed >> 20 & 1023u;
    words[4 * (y * static_cast<std::uint32_t>(description.width) + x) + z / 32] |= 1u << (z % 32);
  }
  bits.stacks->upload(0, std::as_bytes(std::span(words)));
  CHECK(lookAt(scene, bits).values() == lookAt(scene, fragments).values());
}

TEST_CASE("faces are told apart where they are shaded") {
  const RadianceGrid grid = cones::makeGrid(16, [](int, int, int) { return glm::vec4(1.0f); });
  CHECK(lookAt(farView(), grid).at(9, 9, 0) == Approx(1.0));
  CHECK(lookAt(farView(), grid, {{"faces", "on"}}).at(9, 9, 0) == Approx(0.65));  // those across z
}

TEST_CASE("what a kind cannot give is refused with what it can") {
  ShGrid light;
  light.levels.push_back({{glm::vec3(-1.0f), 0.125f, glm::ivec3(16)},
                          {cones::uniformGrid(16, glm::vec4(1.0f)).radiance, nullptr, nullptr}});
  CHECK_THAT(refusal(light, {{"opacity", "field"}}),
             Contains("a ShGrid has no field of opacity") && Contains("opacity solid"));
  CHECK_THAT(refusal(ScatteringGrid{}), Contains("holds nothing in this scene"));
  CHECK_THAT(refusal(light, {}, {{"low", 2.0}}), Contains("'low' is not below 'high'"));
  const auto check = [](const std::string& connected) {
    return messageOf<DiagnosticsError>([&] {
      checkPipeline(
          Pipeline::parse(
              "pipeline \"x\" {\npass g direct_lighting.gbuffer { }\npass l voxel_cone_tracing.look { " +
                  connected + " }\noutput o l.radiance\n}\n",
              "x.pipeline"),
          techniques());
    });
  };
  CHECK_THAT(check("voxels g.gbuffer"),
             Contains("is of kind GBuffer, but input 'voxels' of pass 'l' takes any voxels"));
  CHECK_THAT(check(""), Contains("lacks its required input 'voxels'"));
}
