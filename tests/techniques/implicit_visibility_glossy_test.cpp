// Light that glossy elements pass on, against closed forms.
#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "support/element_light.h"
#include "support/facts.h"
#include "support/surface_elements.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// Value of a Phong lobe of albedo 1, 1/sr: (n + 2) / (2 pi) cos^n.
double lobe(double exponent, double cosMirror) {
  return cosMirror > 0.0 ? (exponent + 2.0) / (2.0 * kPi) * std::pow(cosMirror, exponent) : 0.0;
}

/// The inside of a sphere of 1 m that emits 1 W/(sr m^2): the squares of a cube, seen through its middle.
Scene glowingSphere(const Material& material) {
  constexpr int kSide = 10;
  SceneBuilder builder;
  std::vector<glm::vec3> corners;
  const DirectionBins squares(kSide, BinMapping::even);
  const auto corner = [&](int axis, double sign, int i, int j) {
    glm::dvec3 direction(0.0);
    direction[axis] = sign;
    direction[(axis + 1) % 3] = squares.border(i);
    direction[(axis + 2) % 3] = squares.border(j);
    return glm::vec3(glm::normalize(direction));
  };
  for (int face = 0; face < 6; ++face)
    for (int i = 0; i < kSide; ++i)
      for (int j = 0; j < kSide; ++j) {
        const auto at = [&](int u, int v) { return corner(face / 2, face % 2 == 0 ? 1.0 : -1.0, u, v); };
        glm::vec3 four[] = {at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)};
        if (face % 2 != 0) std::swap(four[1], four[3]);
        corners.insert(corners.end(), {four[0], four[1], four[2], four[0], four[2], four[3]});
      }
  Material shining = material;
  shining.emission = glm::vec3(1.0f);
  builder.mesh(corners, builder.material(shining));
  builder.look({0, 0, 0.3}, {0, 0, -1}, {0, 1, 0}, 1.0, 4, 4);
  return builder.scene;
}

/// Irradiance of a sphere's inside by what it reflects of its own glow of 1 W/(sr m^2), after each bounce. A
/// chord has the same angle at both of its ends: what arrives from an angle is what leaves at it.
std::vector<double> sphereIrradiance(double diffuse, double specular, double exponent, int bounces) {
  constexpr int kRings = 64, kAround = 128;
  const auto cosine = [](int ring) { return (ring + 0.5) / kRings; };
  const double ringWidth = 1.0 / kRings;
  const auto irradianceOf = [&](const std::vector<double>& radiance) {
    double sum = 0.0;
    for (int i = 0; i < kRings; ++i)
      sum += 2.0 * kPi * radiance[static_cast<std::size_t>(i)] * cosine(i) * ringWidth;
    return sum;
  };
  std::vector<std::vector<double>> passedOn(kRings, std::vector<double>(kRings));  // from ring to ring
  for (int out = 0; out < kRings; ++out)
    for (int in = 0; in < kRings; ++in) {
      const double z = cosine(out) * cosine(in),
                   side = std::sqrt((1.0 - cosine(out) * cosine(out)) * (1.0 - cosine(in) * cosine(in)));
      double mean = 0.0;
      for (int k = 0; k < kAround; ++k)
        mean += lobe(exponent, z - side * std::cos(2.0 * kPi * (k + 0.5) / kAround)) / kAround;
      passedOn[static_cast<std::size_t>(out)][static_cast<std::size_t>(in)] =
          specular * mean * 2.0 * kPi * cosine(in) * ringWidth;
    }
  std::vector<double> radiance(kRings, 1.0), sums;
  double sum = 0.0;
  for (int bounce = 0; bounce < bounces; ++bounce) {
    std::vector<double> next(kRings, diffuse / kPi * irradianceOf(radiance));
    for (std::size_t out = 0; out < kRings; ++out)
      for (std::size_t in = 0; in < kRings; ++in) next[out] += passedOn[out][in] * radiance[in];
    radiance = next;
    sums.push_back(sum += irradianceOf(radiance));
  }
  return sums;
}

Material glossyMaterial(float diffuse, float specular, float exponent) {
  Material material;
  material.diffuse = glm::vec3(diffuse), material.specular = glm::vec3(specular);
  material.exponent = exponent;
  return material;
}

std::string number(const char* name, int value) {
  return std::string(name) + "=" + std::to_string(value);
}

}  // namespace

TEST_CASE("in a glossy sphere that glows N bounces bring their sum, and never more than the albedo's") {
  for (const auto& [diffuse, specular, exponent] : {std::array{0.3f, 0.5f, 1.0f}, {0.2f, 0.6f, 20.0f}}) {
    const Scene scene = glowingSphere(glossyMaterial(diffuse, specular, exponent));
    const std::vector<double> expected = sphereIrradiance(diffuse, specular, exponent, 4);
    for (const int bounces : {1, 4}) {
      const LitElements lit(scene, {"elements=256", "bins=8", "directions=4", number("bounces", bounces)});
      const double mean = lit.mean(lit.irradiance());
      const double albedo = diffuse + specular,
                   most = kPi * albedo * (1.0 - std::pow(albedo, bounces)) / (1.0 - albedo);
      CAPTURE(diffuse, specular, exponent, bounces, most);
      // Elements of a curved wall leave bins along it empty: 256 of them lose up to 3 % a bounce, 1024 2 %.
      CHECK(mean ==
            Approx(expected[static_cast<std::size_t>(bounces - 1)]).epsilon(bounces == 1 ? 0.04 : 0.08));
      CHECK(mean <= most);
    }
  }
}

TEST_CASE(
    "light that bounces between white glossy walls never grows, however coarse bins and directions are") {
  SceneBuilder builder;
  builder.box({-1, -1, -1}, {1, 1, 1}, builder.phong(0.0f, 1.0f, 30.0f), true);
  builder.light(LightKind::point, glm::vec3(1.0f), {0.3, 0.2, -0.4});
  builder.look({0, 0, 0.5}, {0, 0, -1}, {0, 1, 0}, 1.0, 4, 4);
  for (const auto& [bins, directions] : {std::pair(1, 1), {3, 2}, {4, 1}}) {
    const auto after = [&](int bounces) {
      return LitElements(builder.scene,
                         {"elements=50", number("bins", bins), number("directions", directions),
                          number("bounces", bounces)},
                         "implicit_visibility")
          .irradiance();
    };
    const std::vector<double> first = after(1), before = after(29), last = after(30);
    double largest = 0.0;
    for (std::size_t leaf = 0; leaf < last.size(); ++leaf)
      largest = std::max(largest, last[leaf] - before[leaf]);
    CAPTURE(bins, directions);
    CHECK(largest <= 1.001 * *std::max_element(first.begin(), first.end()));
  }
}

TEST_CASE("a glossy floor throws sunlight around its mirror direction, on whichever side it is lit") {
  // A small patch 1 m above (or below) the origin, turned to the floor or to where the mirror image comes
  // from. Its irradiance is the integral over the floor of lobe x irradiance of the floor x cos cos / r^2.
  const double slant = std::sqrt(0.5);
  // Off the symmetries of the bins.
  for (const float exponent : {5.0f, 20.0f})
    for (const double side : {1.0, -1.0})
      for (const bool turned : {false, true}) {
        SceneBuilder builder;
        builder.quad({-4, 0, -3}, {0, 0, 6}, {7, 0, 0}, builder.phong(0.0f, 0.5f, exponent));
        const glm::dvec3 facing =
            turned ? glm::dvec3(-slant, -side * slant, 0.0) : glm::dvec3(0.0, -side, 0.0);
        const glm::dvec3 along(0.0, 0.0, 0.1), across = glm::cross(facing, along), middle(0.0, side, 0.0);
        builder.quad(glm::vec3(middle - 0.5 * (along + across)), glm::vec3(along), glm::vec3(across),
                     builder.lambert(0.0f));
        builder.light(LightKind::directional, glm::vec3(2.0f), {}, {0.9, -side, 0.35});
        builder.look({0, 3, 0}, {0, 0, 0}, {0, 0, -1}, 0.3, 4, 4);
        const LitElements lit(builder.scene, {"elements=1500", "bins=12", "directions=6"},
                              "implicit_visibility");
        const double found = lit.mean(lit.irradiance(), 1);
        double expected = 0.0;
        const glm::dvec3 mirror = glm::normalize(glm::dvec3(0.9, side, 0.35));
        constexpr double kStep = 0.05;
        for (double x = -4.0 + 0.5 * kStep; x < 3.0; x += kStep)
          for (double z = -3.0 + 0.5 * kStep; z < 3.0; z += kStep) {
            const glm::dvec3 path = middle - glm::dvec3(x, 0.0, z), towards = glm::normalize(path);
            const double seen = std::max(-glm::dot(facing, towards), 0.0);
            expected += 0.5 * lobe(exponent, glm::dot(towards, mirror)) * 2.0 * std::abs(mirror.y) *
                        std::abs(towards.y) * seen / glm::dot(path, path) * kStep * kStep;
          }
        CAPTURE(exponent, side, turned);
        CHECK(found == Approx(expected).epsilon(0.02));
      }
}

TEST_CASE(
    "what nodes pass on in a direction is the mean of what their leaves do, by the area that they show") {
  const Scene scene = loadScene(sourceDirectory() / "scenes/cornell_glossy.scene");
  const LitElements lit(scene, {"elements=300", "bins=6", "directions=3", "bounces=2"},
                        "implicit_visibility");
  const ElementTree& tree = *lit.elements().tree;
  const DirectionBins directions(3, BinMapping::even);
  REQUIRE(lit.light().outgoing != nullptr);
  const std::vector<float> outgoing = lit.light().outgoing->downloadFloats(0);
  const auto rows = lit.light().outgoingRows->downloadValues<std::uint32_t>();
  std::vector<glm::dvec4> shown(std::size_t{tree.nodeCount} * directions.count(), glm::dvec4(0.0));
  std::size_t compared = 0, bright = 0;
  for (std::uint32_t node = 0; node < tree.firstGroup; ++node) {
    REQUIRE((rows[node] != kNoElement) == tree.glossy[node]);
    for (std::uint32_t bin = 0; bin < directions.count(); ++bin) {
      // Front and back of a leaf: radiance times area of the one, and the area.
      glm::dvec4& own = shown[std::size_t{node} * directions.count() + bin];
      const double value =
          rows[node] == kNoElement ? 0.0 : outgoing[4 * (std::size_t{rows[node]} * directions.count() + bin)];
      if (tree.isLeaf(node)) {
        const double area = lit.elements().state->area[node] *
                            glm::dot(lit.elements().state->normal[node], directions.centre(bin));
        own = area > 0.0 ? glm::dvec4(value * area, area, 0.0, 0.0)
                         : glm::dvec4(0.0, 0.0, -value * area, -area);
        continue;
      }
      for (const std::uint32_t child : tree.childrenOf(node))
        if (child != kNoElement) own += shown[std::size_t{child} * directions.count() + bin];
      if (!tree.glossy[node]) continue;
      const double mean = own.y > 0.0 ? own.x / own.y : own.w > 0.0 ? own.z / own.w : 0.0;
      CHECK(value == Approx(mean).epsilon(1e-3).margin(1e-6));
      ++compared;
      bright += mean > 0.01;
    }
  }
  CHECK(compared > 500);
  CHECK(bright > 50);
}

TEST_CASE(
    "where nothing is glossy, or with no directions, nothing is kept by direction, and the bits are the same") {
  const auto bits = [](const char* name, const char* directions, bool keepEverything, bool expected) {
    const Scene scene = loadScene(sourceDirectory() / ("scenes/" + std::string(name) + ".scene"));
    const LitElements lit(scene, {"elements=128", "bounces=2", "bins=6", directions}, "implicit_visibility",
                          keepEverything);
    CHECK((lit.light().outgoing != nullptr) == expected);
    CHECK((lit.light().outgoingRows != nullptr) == expected);
    std::vector<float> values = lit.light().irradiance->downloadFloats(0);
    const std::span<const float> shown = lit.frame.outputs.at("indirect_glossy").values();
    values.insert(values.end(), shown.begin(), shown.end());
    return values;
  };
  const std::vector<float> diffuse = bits("cornell", "directions=2", false, false);
  CHECK(diffuse == bits("cornell", "directions=0", false, false));
  CHECK(diffuse == bits("cornell", "directions=2", true, true));
  const std::vector<float> glossy = bits("cornell_glossy", "directions=2", false, true);
  CHECK(glossy == bits("cornell_glossy", "directions=2", true, true));
  CHECK(glossy != bits("cornell_glossy", "directions=0", false, false));
}

TEST_CASE("more glossy elements and directions than a texture holds are refused, and how many fit is told") {
  SceneBuilder builder;
  builder.box({-1, -1, -1}, {1, 1, 1}, builder.phong(0.3f, 0.3f, 5.0f), true);
  LonePass elements("implicit_visibility.elements", builder.scene, {{"elements", 12000}}),
      illuminate("implicit_visibility.illuminate", builder.scene, {{"directions", 16}});
  illuminate.in("elements", elements.out<SurfaceElements>("elements")).in("links", ElementLinks{});
  CHECK_THROWS_MATCHES(illuminate.run(), Error, Tells("6 x 16 x 16", 10922));
}
