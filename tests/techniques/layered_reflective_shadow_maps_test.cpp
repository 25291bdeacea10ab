// Layered reflective shadow maps: what the layers of a map hold, and what cones find of it, in closed form.
#include <algorithm>
#include <cmath>
#include <map>

#include "lumivox/base/error.h"
#include "lumivox/toolkit/light_samples.h"
#include "support/cones.h"
#include "support/facts.h"
#include "support/layered_maps.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::layered;

namespace {

/// A room of surfaces at several depths and slants, under lights of three kinds.
Scene roomUnderLights() {
  SceneBuilder builder;
  builder.box({-2, -2, -2}, {2, 2, 2}, builder.lambert(0.6f), true);
  builder.box({-1, -2, -1}, {0, -0.5f, 0.25f}, builder.lambert(0.3f), false);
  builder.quad({0.5f, -1.5f, -1}, {1, 1, 0}, {0, 0.5f, 1}, builder.lambert(0.8f));
  builder.light(LightKind::point, glm::vec3(3.0f, 2.0f, 1.0f), {0.2, 1.1, 0.3});
  Light& spot = builder.light(LightKind::spot, glm::vec3(5.0f), {-1, 1.5, 1}, {0.5, -1, -0.6});
  spot.innerAngle = 0.4, spot.outerAngle = 0.6;
  builder.light(LightKind::directional, glm::vec3(2.0f), {}, {0.3, -1, 0.2});
  return builder.scene;
}

/// What a texel of a map or of all layers of a view holds: radiance, cover, normal, depth and its square.
using Sums = std::array<double, 9>;

/// Texel-major, for each view, of one level.
struct Level {
  glm::ivec2 size{0};
  std::vector<Sums> texels;
};

/// Depth along the view, m, as docs of the port say.
double depthOf(const LightSampleData& light, const glm::mat4& view, const glm::vec3& place) {
  if (light.kind == LightSampleKind::directional)
    return glm::dot(glm::dvec3(place), glm::dvec3(light.direction));
  return static_cast<double>((view * glm::vec4(place, 1.0f)).w);
}

Level finestOf(const ReflectiveShadowMap& map) {
  const std::vector<float> positions = map.position->downloadFloats(0),
                           normals = map.normal->downloadFloats(0), flux = map.flux->downloadFloats(0);
  const auto lights = map.lights->downloadValues<LightSampleData>();
  const auto views = map.views->downloadValues<glm::mat4>();
  const gpu::TextureDescription& size = map.position->description();
  Level result{{size.width, size.height}, std::vector<Sums>(positions.size() / 4, Sums{})};
  for (std::size_t i = 0; i < result.texels.size(); ++i) {
    const std::size_t at = 4 * i;
    if (positions[at + 3] == 0.0f || !(normals[at + 3] > 0.0f)) continue;
    Sums& sums = result.texels[i];
    for (std::size_t c = 0; c < 3; ++c) {
      sums[c] = flux[at + c] / (kPi * static_cast<double>(normals[at + 3]));
      sums[4 + c] = normals[at + c];
    }
    sums[3] = 1.0;
    const std::size_t view = i / static_cast<std::size_t>(size.width * size.height);
    sums[7] = depthOf(lights[static_cast<std::size_t>(flux[at + 3])], views[view],
                      {positions[at], positions[at + 1], positions[at + 2]});
    sums[8] = sums[7] * sums[7];
  }
  return result;
}

/// Means over squares of four texels.
Level coarser(const Level& fine, int views) {
  Level result{fine.size / 2, {}};
  for (int view = 0; view < views; ++view)
    for (int y = 0; y < result.size.y; ++y)
      for (int x = 0; x < result.size.x; ++x) {
        Sums sums{};
        for (int i = 0; i < 4; ++i) {
          const int texel = (view * fine.size.y + 2 * y + i / 2) * fine.size.x + 2 * x + i % 2;
          for (std::size_t k = 0; k < sums.size(); ++k)
            sums[k] += 0.25 * fine.texels[static_cast<std::size_t>(texel)][k];
        }
        result.texels.push_back(sums);
      }
  return result;
}

/// The layers of each view, added up.
Level sumOf(const LayeredReflectiveShadowMap& map, int level) {
  const gpu::TextureDescription& size = map.radiance->description();
  const int width = std::max(size.width >> level, 1), height = std::max(size.height >> level, 1);
  const auto texels = static_cast<std::size_t>(width * height);
  const std::vector<float> radiance = map.radiance->downloadFloats(level),
                           normal = map.normal->downloadFloats(level),
                           depth = map.depth->downloadFloats(level);
  const auto layers = map.layers->downloadValues<LayeredReflectiveShadowMap::Layer>();
  Level result{{width, height}, std::vector<Sums>(texels * static_cast<std::size_t>(map.viewCount), Sums{})};
  for (std::size_t layer = 0; layer < static_cast<std::size_t>(map.layerCount); ++layer) {
    const double middle = layers[layer].middle, half = layers[layer].halfWidth;
    for (std::size_t i = 0; i < texels; ++i) {
      const std::size_t at = layer * texels + i;
      Sums& sums = result.texels[static_cast<std::size_t>(layers[layer].view) * texels + i];
      for (std::size_t c = 0; c < 3; ++c) {
        sums[c] += static_cast<double>(map.unit) * radiance[4 * at + c];
        sums[4 + c] += normal[4 * at + c];
      }
      const double cover = radiance[4 * at + 3], first = depth[2 * at], second = depth[2 * at + 1];
      sums[3] += cover;
      sums[7] += middle * cover + half * first;
      sums[8] += middle * middle * cover + 2.0 * middle * half * first + half * half * second;
    }
  }
  return result;
}

/// The largest difference, over the largest of what is compared: radiance, cover, normals, depths, squares.
double largestDifference(const Level& a, const Level& b) {
  REQUIRE(a.texels.size() == b.texels.size());
  constexpr std::size_t kEnds[] = {0, 3, 4, 7, 8, 9};
  double worst = 0.0;
  for (std::size_t part = 0; part + 1 < std::size(kEnds); ++part) {
    double most = 0.0, off = 0.0;
    for (std::size_t i = 0; i < a.texels.size(); ++i)
      for (std::size_t k = kEnds[part]; k < kEnds[part + 1]; ++k) {
        most = std::max(most, std::abs(b.texels[i][k]));
        off = std::max(off, std::abs(a.texels[i][k] - b.texels[i][k]));
      }
    worst = std::max(worst, off / most);
  }
  return worst;
}

}  // namespace

TEST_CASE("covers, radiance, normals and moments of all layers sum to those of the map at every mip") {
  const Scene scene = roomUnderLights();
  const ReflectiveShadowMap map = mapOf(scene, 32);
  const auto [precision, limit] = GENERATE(table<const char*, double>({{"float", 1e-4}, {"half", 2e-3}}));
  const char* intervals = GENERATE("equal", "population");
  const auto [depths, normals] = GENERATE(table<int, int>({{1, 1}, {4, 1}, {3, 6}}));
  const LayeredReflectiveShadowMap layers = layersOf(scene, map,
                                                     {{"precision", precision},
                                                      {"intervals", intervals},
                                                      {"depth_layers", depths},
                                                      {"normal_layers", normals}});
  REQUIRE(layers.viewCount == 8);
  CHECK(layers.layerCount > layers.viewCount / 2);
  CHECK(layers.layerCount <= layers.viewCount * depths * normals);
  Level right = finestOf(map);
  for (int level = 0; level < layers.radiance->description().levels; ++level) {
    if (level > 0) right = coarser(right, layers.viewCount);
    CAPTURE(precision, intervals, depths, normals, level);
    CHECK(largestDifference(sumOf(layers, level), right) < limit);
  }
}

TEST_CASE("a map of an odd size keeps its means at every mip") {
  const Scene scene = roomUnderLights();
  const LayeredReflectiveShadowMap layers =
      layersOf(scene, mapOf(scene, 27), {{"precision", "float"}, {"normal_layers", 6}});
  const auto meansOf = [&](int level) {
    const Level all = sumOf(layers, level);
    Sums means{};
    for (const Sums& texel : all.texels)
      for (std::size_t k = 0; k < means.size(); ++k)
        means[k] += texel[k] / static_cast<double>(all.texels.size());
    return means;
  };
  const Sums finest = meansOf(0);
  for (int level = 1; level < layers.radiance->description().levels; ++level) {
    const Sums means = meansOf(level);
    for (std::size_t k = 0; k < means.size(); ++k) {
      CAPTURE(level, k);
      CHECK(means[k] == Approx(finest[k]).epsilon(1e-4).margin(1e-5));
    }
  }
}

TEST_CASE("each layer has a texel, and its texels lie in its interval and look to its side") {
  const Scene scene = roomUnderLights();
  const char* intervals = GENERATE("equal", "population");
  const LayeredReflectiveShadowMap map = layersOf(
      scene, mapOf(scene, 64), {{"precision", "float"}, {"normal_layers", 6}, {"intervals", intervals}});
  const auto layers = map.layers->downloadValues<LayeredReflectiveShadowMap::Layer>();
  const auto ofViews = map.viewLayers->downloadValues<glm::uvec2>();
  const std::vector<float> radiance = map.radiance->downloadFloats(0), normal = map.normal->downloadFloats(0),
                           depth = map.depth->downloadFloats(0);
  const std::size_t texels = 64 * 64;
  std::map<int, int> layersOfView;
  for (std::size_t layer = 0; layer < static_cast<std::size_t>(map.layerCount); ++layer) {
    const LayeredReflectiveShadowMap::Layer& own = layers[layer];
    ++layersOfView[own.view];
    if (layer > 0) CHECK(own.slot > layers[layer - 1].slot);
    int covered = 0;
    bool inInterval = true, looks = true;
    for (std::size_t i = 0; i < texels; ++i) {
      const std::size_t at = layer * texels + i;
      if (radiance[4 * at + 3] == 0.0f) continue;
      ++covered;
      inInterval = inInterval && std::abs(depth[2 * at]) <= 1.0f;
      const glm::vec3 n(normal[4 * at], normal[4 * at + 1], normal[4 * at + 2]);
      const float along = n[own.facing / 2] * (own.facing % 2 == 0 ? 1.0f : -1.0f);
      looks = looks && along >= std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}) - 1e-6f;
    }
    CAPTURE(layer, own.view, own.facing);
    CHECK(covered > 0);
    CHECK(inInterval);
    CHECK(looks);
  }
  unsigned first = 0;
  for (int view = 0; view < map.viewCount; ++view) {
    const glm::uvec2& range = ofViews[static_cast<std::size_t>(view)];
    CHECK(range.x == first);
    CHECK(static_cast<int>(range.y) == layersOfView[view]);
    first += range.y;
  }
  CHECK(static_cast<int>(first) == map.layerCount);
}

TEST_CASE(
    "intervals of population have a quarter of the texels each, and equal ones a quarter of the depths") {
  // A slanted floor: its depths are spread evenly.
  SceneBuilder builder;
  builder.quad({-8, 0, -8}, {16, 0, 0}, {0, -8, 16}, builder.lambert(0.5f));
  builder.light(LightKind::directional, glm::vec3(1.0f), {}, {0, -1, 0});
  const ReflectiveShadowMap map = mapOf(builder.scene, 128);
  const auto coversOf = [&](const char* intervals) {
    const LayeredReflectiveShadowMap layers = layersOf(builder.scene, map, {{"intervals", intervals}});
    const std::vector<float> top = layers.radiance->downloadFloats(layers.radiance->description().levels - 1);
    std::vector<double> covers;
    for (std::size_t i = 3; i < top.size(); i += 4) covers.push_back(top[i]);
    return covers;
  };
  for (const char* intervals : {"equal", "population"}) {
    const std::vector<double> covers = coversOf(intervals);
    REQUIRE(covers.size() == 4);
    double sum = 0.0;
    for (const double cover : covers) sum += cover;
    for (const double cover : covers) CHECK(cover == Approx(sum / 4.0).epsilon(0.05));
  }
  // One half of the floor is three times as steep as the other: equal intervals have unequal shares of it.
  SceneBuilder bent;
  bent.quad({-8, 0, -8}, {8, -2, 0}, {0, 0, 16}, bent.lambert(0.5f));
  bent.quad({0, -2, -8}, {8, -6, 0}, {0, 0, 16}, bent.lambert(0.5f));
  bent.light(LightKind::directional, glm::vec3(1.0f), {}, {0, -1, 0});
  const ReflectiveShadowMap ofBent = mapOf(bent.scene, 128);
  const auto sharesOf = [&](const char* intervals) {
    const LayeredReflectiveShadowMap layers = layersOf(bent.scene, ofBent, {{"intervals", intervals}});
    const std::vector<float> top = layers.radiance->downloadFloats(layers.radiance->description().levels - 1);
    double sum = 0.0;
    std::vector<double> shares;
    for (std::size_t i = 3; i < top.size(); i += 4) sum += top[i];
    for (std::size_t i = 3; i < top.size(); i += 4) shares.push_back(top[i] / sum);
    return shares;
  };
  const std::vector<double> equal = sharesOf("equal"), population = sharesOf("population");
  REQUIRE(equal.size() == 4);
  REQUIRE(population.size() == 4);
  CHECK(equal[0] == Approx(0.5).epsilon(0.05));
  for (int i = 1; i < 4; ++i) CHECK(equal[static_cast<std::size_t>(i)] == Approx(1.0 / 6.0).epsilon(0.05));
  for (const double share : population) CHECK(share == Approx(0.25).epsilon(0.05));
}

namespace {

/// A wall across y of 24 m a side that a sun from above lights, and what stands over it.
constexpr float kAlbedo = 0.5f, kIrradiance = 4.0f;
const double kLit = kAlbedo * kIrradiance / kPi;

SceneBuilder litWall() {
  SceneBuilder builder;
  builder.quad({-12, 0, -12}, {0, 0, 24}, {24, 0, 0}, builder.lambert(kAlbedo));
  builder.light(LightKind::directional, glm::vec3(kIrradiance), {}, {0, -1, 0});
  return builder;
}
/// Looks down on the middle of the wall.
SeenSurface above(float height, const glm::vec4& specular = glm::vec4(0.0f)) {
  return {{0.0f, height, 0.0f}, {0, -1, 0}, glm::vec3(0.5f), specular};
}
/// The share of a hemisphere that a square of half side a takes at a distance.
double shareOfSquare(double a, double distance) {
  const double x = a / distance, root = std::sqrt(1.0 + x * x);
  return 4.0 * x / root * std::atan(x / root) / kPi;
}

}  // namespace

TEST_CASE("a wide lit wall brings its radiance, one half in shadow the half of it") {
  const int resolution = GENERATE(32, 64);
  SceneBuilder open = litWall();
  CAPTURE(resolution);
  const Settings many{{"cones", 48}};
  CHECK(gathererOf(open.scene, resolution, 128, above(3.0f), many).mean() ==
        Approx(kLit * shareOfSquare(12.0, 3.0)).epsilon(0.1));
  // Above the place that looks, so that it takes light from the wall and from nothing else.
  SceneBuilder shadowed = litWall();
  shadowed.quad({-12, 9, -12}, {0, 0, 24}, {12, 0, 0}, shadowed.lambert(kAlbedo));
  CHECK(gathererOf(shadowed.scene, resolution, 128, above(3.0f), many).mean() ==
        Approx(0.5 * kLit * shareOfSquare(12.0, 3.0)).epsilon(0.1));
  // Wholly in shadow.
  SceneBuilder dark = litWall();
  dark.quad({-12, 9, -12}, {0, 0, 24}, {24, 0, 0}, dark.lambert(kAlbedo));
  CHECK(gathererOf(dark.scene, resolution, 128, above(3.0f), many).mean() < 1e-3 * kLit);
}

TEST_CASE("a slanted wall brings its radiance too, and less of it where the slab lies along the view") {
  SceneBuilder builder;
  builder.quad({-12, 0, -12}, {0, 0, 24}, {24, 0, 0}, builder.lambert(kAlbedo));
  builder.light(LightKind::directional, glm::vec3(kIrradiance), {}, {1.5, -1, 0});
  const double lit = kLit / std::sqrt(1.0 + 1.5 * 1.5);
  const auto share = [&](const Settings& settings) {
    Settings all{{"cones", 48}};
    all.insert(all.end(), settings.begin(), settings.end());
    return gathererOf(builder.scene, 32, 128, above(3.0f), all).mean() / (lit * shareOfSquare(12.0, 3.0));
  };
  CHECK(share({}) == Approx(1.0).epsilon(0.1));
  const double alongView = share({{"slant", "off"}}),
               byChebyshev = share({{"slant", "off"}, {"share", "chebyshev"}});
  CAPTURE(alongView, byChebyshev);
  CHECK(alongView < 0.97);
  CHECK(byChebyshev < alongView);
}

TEST_CASE("a wall far off the axis of a light's view brings its radiance with a slab of its own thickness") {
  // 40 degrees off the axis of a face of the point light's map, square to that axis.
  SceneBuilder builder;
  builder.quad({-12, 0, -12}, {0, 0, 24}, {24, 0, 0}, builder.lambert(kAlbedo));
  const glm::dvec3 light(-5, 6, 0);
  builder.light(LightKind::point, glm::vec3(400.0f), light);
  builder.look({0, -9, 0}, {0, 0, 0}, {0, 0, 1}, 0.7, 8, 8);  // whose mirror direction is down
  // Radiance of the wall below the place that looks: albedo / pi of the irradiance there.
  const auto seen = [&](double slab) {
    return gathererOf(builder.scene, 64, 256, above(2.0f, {1, 1, 1, 400.0f}),
                      {{"glossy_cones", 1}, {"slab", slab}, {"step", 0.05}})
        .mean("glossy");
  };
  const double whole = seen(100.0), own = seen(3.0), half = seen(0.5);
  CAPTURE(whole, own, half);
  CHECK(whole > 0.01);
  CHECK(own == Approx(whole).epsilon(0.05));
  // A thin slab loses the same share of a wall on the axis, where ray and axis are one.
  SceneBuilder onAxis;
  onAxis.quad({-12, 0, -12}, {0, 0, 24}, {24, 0, 0}, onAxis.lambert(kAlbedo));
  onAxis.light(LightKind::point, glm::vec3(400.0f), {0, 6, 0});
  onAxis.look({0, -9, 0}, {0, 0, 0}, {0, 0, 1}, 0.7, 8, 8);
  const auto seenOnAxis = [&](double slab) {
    return gathererOf(onAxis.scene, 64, 256, above(2.0f, {1, 1, 1, 400.0f}),
                      {{"glossy_cones", 1}, {"slab", slab}, {"step", 0.05}})
        .mean("glossy");
  };
  const double share = seenOnAxis(0.5) / seenOnAxis(100.0);
  CAPTURE(share);
  CHECK(half / whole == Approx(share).epsilon(0.1));
}

TEST_CASE("floats keep radiance that half floats cannot") {
  SceneBuilder builder;
  builder.quad({-12, 0, -12}, {0, 0, 24}, {24, 0, 0}, builder.lambert(kAlbedo));
  builder.light(LightKind::directional, glm::vec3(1e7f), {}, {0, -1, 0});
  const LayeredReflectiveShadowMap layers =
      layersOf(builder.scene, mapOf(builder.scene, 16), {{"precision", "float"}});
  const std::vector<float> radiance = layers.radiance->downloadFloats(0);
  CHECK(*std::max_element(radiance.begin(), radiance.end()) == Approx(kAlbedo * 1e7 / kPi).epsilon(1e-3));
}

TEST_CASE("stripes finer than a voxel bring their mean, whatever lies under the middle of a cone") {
  for (const float phase : {0.0f, 0.25f, 0.5f, 0.75f}) {
    SceneBuilder builder;
    constexpr float kWidth = 0.2f;  // of a stripe; a voxel is 0.77
    const int white = builder.lambert(0.8f), black = builder.lambert(0.0f);
    for (int i = 0; i < 120; ++i)
      builder.quad({-12 + kWidth * (static_cast<float>(i) + 2.0f * phase), 0, -12}, {0, 0, 24},
                   {kWidth, 0, 0}, i % 2 == 0 ? white : black);
    builder.light(LightKind::directional, glm::vec3(kIrradiance), {}, {0, -1, 0});
    builder.look({0, -9, 0}, {0, 0, 0}, {0, 0, 1}, 0.7, 8, 8);
    CAPTURE(phase);
    CHECK(gathererOf(builder.scene, 32, 256, above(3.0f, {1, 1, 1, 100.0f}), {{"glossy_cones", 1}})
              .mean("glossy") == Approx(0.4 * kIrradiance / kPi).epsilon(0.15));
  }
}

TEST_CASE("layers that no dispatch can ask together bring what all of them bring at once") {
  SceneBuilder builder;
  builder.quad({-12, 0, -12}, {0, 0, 24}, {24, 0, 0}, builder.lambert(kAlbedo));
  // Boxes of all heights aside, whose tops and sides are layers before that of the floor.
  for (int i = 0; i < 16; ++i) {
    const float x = -11.0f + 1.4f * static_cast<float>(i);
    builder.box({x, 0, 6}, {x + 0.9f, 0.4f * static_cast<float>(i + 1), 7}, builder.lambert(kAlbedo), false);
  }
  builder.light(LightKind::directional, glm::vec3(kIrradiance), {}, {-0.3, -1, -0.2});
  builder.look({0, -9, 0}, {0, 0, 0}, {0, 0, 1}, 0.7, 8, 8);
  const Settings ofLayers{{"depth_layers", 16}, {"normal_layers", 6}};
  REQUIRE(layersOf(builder.scene, mapOf(builder.scene, 128), ofLayers).layerCount > 24);
  const auto seen = [&](double reach) {
    return gathererOf(builder.scene, 32, 128, above(3.0f, {1, 1, 1, 400.0f}),
                      {{"glossy_cones", 1}, {"step", 0.05}, {"reach", reach}}, ofLayers)
        .mean("glossy");
  };
  // Behind the floor there is nothing, so that a short cone sees the same; its loops are short enough for all
  // layers.
  const double atOnce = seen(5.0);
  CHECK(atOnce > 0.1);
  CHECK(seen(0.0) == Approx(atOnce).epsilon(1e-4));
}

TEST_CASE("behind an occluder there is no light, the less the thicker it is") {
  double before = 1.0;
  for (const int voxels : {1, 2, 3}) {
    SceneBuilder builder;
    builder.quad({-12, 0, -12}, {0, 0, 24}, {24, 0, 0}, builder.lambert(kAlbedo));
    // Between the light, which stands under it, and the place that looks.
    const float voxel = 24.0f / 62.0f;
    for (int i = 0; i < voxels; ++i)
      builder.quad({-6, 3.0f + voxel * static_cast<float>(i), -6}, {0, 0, 12}, {12, 0, 0},
                   builder.lambert(0.0f));
    builder.light(LightKind::point, glm::vec3(20.0f), {0.7, 1.5, 0});
    builder.look({0, -9, 0}, {0, 0, 0}, {0, 0, 1}, 0.7, 8, 8);  // whose mirror direction is down
    const auto seenFrom = [&](float height) {
      return gathererOf(builder.scene, 64, 128, above(height, {1, 1, 1, 400.0f}), {{"glossy_cones", 1}})
          .mean("glossy");
    };
    const double open = seenFrom(2.0f), behind = seenFrom(7.0f) / open;
    CAPTURE(voxels, open, behind);
    CHECK(open > 0.1);
    // A sheet of one voxel lets exp(-2) through, as every cone does between filtered voxels.
    CHECK(behind < (voxels == 1 ? 0.15 : 1e-3));
    CHECK(behind <= before);
    before = behind;
  }
}

TEST_CASE("a wall that is lit from its other side is dark, unless normals are not looked at") {
  SceneBuilder builder;
  builder.quad({-12, 0, -12}, {0, 0, 24}, {24, 0, 0}, builder.lambert(kAlbedo));
  builder.light(LightKind::directional, glm::vec3(kIrradiance), {}, {0, 1, 0});
  const auto seen = [&](const char* facing) {
    return gathererOf(builder.scene, 32, 128, above(3.0f), {{"facing", facing}}).mean();
  };
  CHECK(seen("on") == 0.0);
  CHECK(seen("off") > 0.5 * kLit);
}

TEST_CASE("lights add up, also where no dispatch can ask all of them") {
  const auto underSpots = [](int count, float power) {
    SceneBuilder builder;
    builder.quad({-12, 0, -12}, {0, 0, 24}, {24, 0, 0}, builder.lambert(kAlbedo));
    for (int i = 0; i < count; ++i) {
      Light& spot = builder.light(LightKind::spot, glm::vec3(power), {1, 8, 0.5}, {0, -1, 0});
      spot.innerAngle = 0.8, spot.outerAngle = 1.0;
    }
    return builder.scene;
  };
  const auto mean = [&](int count, float power) {
    return gathererOf(underSpots(count, power), 32, 32, above(3.0f), {{"step", 0.05}},
                      {{"normal_layers", 6}, {"depth_layers", 4}, {"precision", "float"}})
        .mean();
  };
  const double one = mean(1, 64.0f);
  CHECK(one > 0.01);
  CHECK(mean(64, 1.0f) == Approx(one).epsilon(1e-4));
}

TEST_CASE("without lights only the environment arrives, all of it where nothing is in the way") {
  SceneBuilder builder;
  builder.scene.environment = glm::vec3(2.0f);
  OccupancyGrid grid{{glm::vec3(-4.0f), 1.0f, glm::ivec3(8)},
                     filled(volumeOf(glm::ivec3(8), gpu::Format::r8), glm::vec4(0.0f))};
  const auto mean = [&] {
    return Gatherer(builder.scene, levelsOf(builder.scene, grid), {{0, 0, 0}, {0, 1, 0}}).mean();
  };
  CHECK(mean() == Approx(2.0).epsilon(1e-6));
  grid.opacity->clear(glm::vec4(1.0f));
  CHECK(mean() < 1e-2);
  builder.scene.environment = glm::vec3(0.0f);
  CHECK(mean() == 0.0);
}

TEST_CASE("a lit wall and the environment fill the hemisphere together") {
  SceneBuilder builder = litWall();
  builder.scene.environment = glm::vec3(static_cast<float>(kLit));
  CHECK(gathererOf(builder.scene, 32, 128, above(3.0f), {{"cones", 48}}).mean() == Approx(kLit).epsilon(0.1));
}

TEST_CASE("levels of opacity are those that the cone tracer's filter makes of the same voxels") {
  const char* rule = GENERATE("facing", "average");
  constexpr int kSide = 16;
  const auto opacityAt = [](int x, int y, int z) {
    return y == 5 || (x == 3 && z > 7) ? 1.0f : (x + 3 * y + 5 * z) % 11 == 0 ? 51.0f / 255.0f : 0.0f;
  };
  const RadianceGrid right = cones::filtered(
      cones::makeGrid(kSide, [&](int x, int y, int z) { return glm::vec4(opacityAt(x, y, z)); }), rule);
  std::vector<float> values;
  for (int z = 0; z < kSide; ++z)
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) values.push_back(opacityAt(x, y, z));
  const OpacityLevels levels =
      levelsOf(cones::emptyScene(),
               {right.grid, textureOf(volumeOf(glm::ivec3(kSide), gpu::Format::r8), values)}, rule);
  REQUIRE(levels.filledLevels == 5);
  for (int level = 0; level < levels.filledLevels; ++level) {
    const std::vector<float> ours = levels.opacity->downloadFloats(level),
                             theirs = right.radiance->downloadFloats(level);
    REQUIRE(4 * ours.size() == theirs.size());
    double worst = 0.0;
    for (std::size_t i = 0; i < ours.size(); ++i)
      worst =
          std::max(worst, std::abs(static_cast<double>(ours[i]) - static_cast<double>(theirs[4 * i + 3])));
    CAPTURE(rule, level);
    // A byte rounds by half a step at every level, and a level passes on at most what two of its voxels lack.
    CHECK(worst < (level + 1) * 1.0 / 255.0);
  }
}

TEST_CASE("a grid that cannot be halved gets empty voxels at its high ends") {
  const glm::ivec3 size(11, 7, 3);
  const OpacityLevels levels =
      levelsOf(cones::emptyScene(),
               {{glm::vec3(0.0f), 1.0f, size}, filled(volumeOf(size, gpu::Format::r8), glm::vec4(1.0f))});
  CHECK(levels.grid.resolution == glm::ivec3(12, 8, 4));
  const std::vector<float> finest = levels.opacity->downloadFloats(0);
  CHECK(sumOf(std::span<const float>(finest)) == Approx(11.0 * 7.0 * 3.0));
}

TEST_CASE("what does not belong together, or does not fit, is refused with what was expected") {
  const Scene scene = roomUnderLights();
  ReflectiveShadowMap map = mapOf(scene, 16);
  CHECK_THROWS_MATCHES(layersOf(scene, map, {{"normal_layers", 3}}), Error, Tells("'normal_layers'", 1, 6));
  ReflectiveShadowMap torn = map;
  torn.layerCount += 1;
  CHECK_THROWS_MATCHES(layersOf(scene, torn), Error, Tells("'map'", map.layerCount + 1, map.layerCount));
  // Steps of a twentieth of a voxel through a long grid.
  const OccupancyGrid grid{{glm::vec3(-4.0f), 8.0f / 1024.0f, glm::ivec3(1024, 4, 4)},
                           filled(volumeOf({1024, 4, 4}, gpu::Format::r8), glm::vec4(0.0f))};
  Gatherer pass(scene, levelsOf(scene, grid), {{0, 0, 0}, {0, 1, 0}}, {{"step", 0.05}});
  pass.in("layers", layersOf(scene, map, {{"depth_layers", 16}, {"normal_layers", 6}}));
  CHECK_THROWS_MATCHES(pass.run(), Error, Tells("gather", 60000, "'step'"));
}

TEST_CASE("a map that nothing is seen in has no layers, and is dark") {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(kAlbedo));
  Light& spot = builder.light(LightKind::spot, glm::vec3(1.0f), {0, 1, 0}, {0, 1, 0});
  spot.innerAngle = 0.2, spot.outerAngle = 0.3;
  const LayeredReflectiveShadowMap layers = layersOf(builder.scene, mapOf(builder.scene, 16));
  CHECK(layers.layerCount == 0);
  CHECK(gathererOf(builder.scene, 16, 16, above(1.0f)).mean() == 0.0);
}
