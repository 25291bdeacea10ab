// Light from element to element against closed forms.
#include <algorithm>
#include <cmath>
#include <random>

#include "support/element_light.h"
#include "support/surface_elements.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// Inner sides of a cube of 2 m, one albedo, which emits 1 W/(sr m^2).
Scene glowingBox(float albedo) {
  SceneBuilder builder;
  builder.box({-1, -1, -1}, {1, 1, 1}, builder.lambert(albedo, 1.0f), true);
  builder.look({0, 0, 0.5}, {0, 0, -1}, {0, 1, 0}, 1.0, 8, 8);
  return builder.scene;
}

/// The same without a glow, where each side has a lamp of its own strength: small squares just before the
/// walls.
Scene boxWithLamps(float albedo) {
  SceneBuilder builder;
  const int wall = builder.lambert(albedo);
  builder.box({-1, -1, -1}, {1, 1, 1}, wall, true);
  builder.light(LightKind::point, glm::vec3(1.0f), {0.3, 0.2, -0.4});
  builder.light(LightKind::point, glm::vec3(3.0f), {-0.7, -0.5, 0.1});
  builder.look({0, 0, 0.5}, {0, 0, -1}, {0, 1, 0}, 1.0, 8, 8);
  return builder.scene;
}

/// A square of 2 m at y = 0 that faces up, seen from above.
SceneBuilder floorSeen(const Material& material, int pixels = 16) {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.material(material));
  builder.look({0, 3, 0}, {0, 0, 0}, {0, 0, -1}, 0.3, pixels, pixels);
  return builder;
}

/// What arrives at the front of object 0, one element, of lamps over links as printed (Eq. 5), W/m^2. A large
/// floor far below takes the other elements, so that each small object has one.
double printedIrradiance(SceneBuilder builder, const std::string& fill, int bins) {
  builder.quad({-500, -50, -500}, {0, 0, 1000}, {1000, 0, 0}, builder.lambert(0.0f));
  const LinkedScene made =
      linked(builder.scene, {{{"elements", 64}}, {{"bins", static_cast<double>(bins)}}, {{"fill", fill}}});
  REQUIRE(std::count(made.tree().objectOfNode.begin(),
                     made.tree().objectOfNode.begin() + made.tree().leafCount, 0u) == 1);
  const std::vector<float> floats = LonePass("implicit_visibility.illuminate", builder.scene,
                                             {{"weight", "element"}, {"area_light", "links"}})
                                        .in("elements", made.elements)
                                        .in("links", made.links)
                                        .out<ElementLight>("light")
                                        .directIrradiance->downloadFloats(0);
  for (std::uint32_t leaf = 0; leaf < made.tree().leafCount; ++leaf)
    if (made.tree().objectOfNode[leaf] == 0) return LitElements::leafValue(floats, leaf, 0);
  return -1.0;
}

/// A square whose middle is at `middle`, in a plane of constant y.
void addSquare(SceneBuilder& builder, const glm::vec3& middle, float side, bool up, int material) {
  const glm::vec3 x(side, 0, 0), z(0, 0, side);
  builder.quad(middle - 0.5f * (x + z), up ? z : x, up ? x : z, material);
}

std::string number(const char* name, int value) {
  return std::string(name) + "=" + std::to_string(value);
}

}  // namespace

TEST_CASE(
    "in a furnace that glows with L from all sides the irradiance of every element is pi L within 0.5 %") {
  for (const int bins : {8, 12}) {
    const LitElements lit(glowingBox(0.5f), {"elements=1024", number("bins", bins)});
    const std::vector<double> irradiance = lit.directIrradiance();
    REQUIRE(irradiance.size() > 500);
    for (const double value : irradiance) CHECK(value == Approx(kPi).epsilon(0.005));
  }
}

TEST_CASE("in a closed box of albedo a, N bounces give a + ... + a^N of what it emits, within 1 %") {
  for (const double albedo : {0.5, 0.9}) {
    double expected = 0.0, power = 1.0;
    int done = 0;
    for (const int bounces : {1, 2, 8, 64}) {
      for (; done < bounces; ++done) expected += power *= albedo;
      const LitElements lit(glowingBox(static_cast<float>(albedo)),
                            {"elements=512", number("bounces", bounces)});
      CAPTURE(albedo, bounces);
      CHECK(lit.mean(lit.irradiance()) == Approx(kPi * expected).epsilon(0.01));
    }
  }
}

TEST_CASE("a plane under a sky of radiance L has the irradiance pi L, and its back has it too") {
  Material grey;
  grey.diffuse = glm::vec3(0.5f);
  SceneBuilder builder = floorSeen(grey);
  builder.scene.environment = {2.0f, 1.0f, 0.5f};
  const LitElements lit(builder.scene, {"elements=256"});
  const std::vector<float> floats = lit.light().irradiance->downloadFloats(0);
  for (std::size_t texel = 0; texel < static_cast<std::size_t>(2 * lit.elements().leafCount); ++texel)
    for (std::size_t c = 0; c < 3; ++c)
      CHECK(floats[4 * texel + c] ==
            Approx(kPi * builder.scene.environment[static_cast<int>(c)]).epsilon(1e-4));
  // Each pixel reflects albedo L.
  for (const float value : {lit.frame.outputs.at("indirect_diffuse").at(3, 4, 0)})
    CHECK(value == Approx(0.5 * 2.0).epsilon(1e-4));
}

TEST_CASE(
    "as printed a link brings L cos cos A / r^2 of the nearest element in its bin (Eq. 5), derived by hand") {
  // A lamp of 0.1 m and radiance 3, 1 m from the middle of the floor's element at (0.6, 0.8, 0): both cosines
  // are 0.8, and 3 * 0.8 * 0.8 * 0.01 / 1 arrives. It takes one bin, or several that share its weight.
  const double oneLamp = 0.0192;
  const auto scene = [](bool faceDown) {
    SceneBuilder builder;
    addSquare(builder, {0, 0, 0}, 0.2f, true, builder.lambert(0.5f));
    addSquare(builder, {0.6f, 0.8f, 0}, 0.1f, !faceDown, builder.lambert(0.0f, 3.0f));
    return builder;
  };
  for (const auto& [fill, bins] : {std::pair<std::string, int>("one", 8), {"one", 16}, {"centre", 64}}) {
    CAPTURE(fill, bins);
    CHECK(printedIrradiance(scene(true), fill, bins) == Approx(oneLamp).epsilon(1e-4));
    // Lamps shine from their fronts alone.
    CHECK(printedIrradiance(scene(false), fill, bins) == 0.0);
    // A second one in another direction, 2 m away at (-1.2, 1.6, 0), brings 5 * 0.64 * 0.01 / 4 more.
    SceneBuilder two = scene(true);
    addSquare(two, {-1.2f, 1.6f, 0}, 0.1f, false, two.lambert(0.0f, 5.0f));
    CHECK(printedIrradiance(two, fill, bins) == Approx(oneLamp + 0.008).epsilon(1e-4));
    // Where it stands behind the first one, in the same bins, nothing of it arrives: only the nearest counts.
    SceneBuilder behind = scene(true);
    addSquare(behind, {1.2f, 1.6f, 0}, 0.1f, false, behind.lambert(0.0f, 5.0f));
    CHECK(printedIrradiance(behind, fill, bins) == Approx(oneLamp).epsilon(1e-4));
  }
}

TEST_CASE(
    "an element under a point light reflects albedo / pi times I cos / r^2, with shadow maps and over one bounce") {
  Material grey;
  grey.diffuse = glm::vec3(0.5f);
  SceneBuilder builder = floorSeen(grey);
  builder.light(LightKind::point, glm::vec3(3.0f), {0.2, 1.0, 0.1});
  const LitElements lit(builder.scene, {"elements=1024"});
  const std::vector<double> radiance = lit.fronts(*lit.light().radiance);
  for (std::size_t leaf = 0; leaf < radiance.size(); ++leaf) {
    const glm::dvec3 path = glm::dvec3(0.2, 1.0, 0.1) - glm::dvec3(lit.elements().state->position[leaf]);
    const double squared = glm::dot(path, path);
    CHECK(radiance[leaf] == Approx(0.5 / kPi * 3.0 * path.y / (squared * std::sqrt(squared))).epsilon(2e-3));
  }
  // Nothing faces the floor: one bounce brings nothing.
  for (const double value : lit.irradiance()) CHECK(value == 0.0);
}

TEST_CASE("light that bounces between white walls never grows, over 1000 bounces") {
  const Scene scene = boxWithLamps(1.0f);
  const auto irradianceAfter = [&](int bounces) {
    return LitElements(scene, {"elements=100", number("bounces", bounces)}, "implicit_visibility")
        .irradiance();
  };
  // What bounce n alone brings, largest over the elements, is never above that of bounce 1.
  const std::vector<double> first = irradianceAfter(1), before = irradianceAfter(999),
                            after = irradianceAfter(1000);
  double largest = 0.0;
  for (std::size_t leaf = 0; leaf < after.size(); ++leaf)
    largest = std::max(largest, after[leaf] - before[leaf]);
  CHECK(largest > 0.0);
  CHECK(largest <= 1.001 * *std::max_element(first.begin(), first.end()));
}

TEST_CASE("in a closed box of albedo 0.999 as many bounces as the pass takes bring their geometric sum") {
  const int bounces = 4096;
  const double albedo = 0.999, sum = albedo * (1.0 - std::pow(albedo, bounces)) / (1.0 - albedo);
  const LitElements lit(glowingBox(static_cast<float>(albedo)), {"elements=64", number("bounces", bounces)});
  CHECK(lit.mean(lit.irradiance()) == Approx(kPi * sum).epsilon(0.01));
}

TEST_CASE("in a closed box of albedo a bounce n + 1 brings a times what bounce n brings, within 0.2 %") {
  const double albedo = 0.8;
  const Scene scene = boxWithLamps(static_cast<float>(albedo));
  double sums[3];
  for (int i = 0; i < 3; ++i) {
    const LitElements lit(scene, {"elements=1024", number("bounces", 10 + i)}, "implicit_visibility");
    sums[i] = lit.mean(lit.irradiance());
  }
  CHECK((sums[2] - sums[1]) / (sums[1] - sums[0]) == Approx(albedo).epsilon(0.002));
}

TEST_CASE("in a white wedge of one degree light stays bounded by what is sent into it") {
  SceneBuilder builder;
  const int white = builder.lambert(1.0f);
  const auto rise = static_cast<float>(std::tan(kPi / 180.0));
  builder.quad({0, 0, -1}, {0, 0, 2}, {2, 0, 0}, white);
  builder.quad({0, 0, -1}, {2, 2 * rise, 0}, {0, 0, 2}, white);
  builder.light(LightKind::point, glm::vec3(1.0f), {3.0, 1.5 * rise, 0.0});
  builder.look({4, 0.5, 0}, {0, 0, 0}, {0, 1, 0}, 0.6, 8, 8);
  const auto most = [&](int bounces) {
    const LitElements lit(builder.scene, {"elements=512", number("bounces", bounces)}, "implicit_visibility");
    const std::vector<float> radiance = lit.light().radiance->downloadFloats(0);
    double largest = 0.0;
    for (int texel = 0; texel < 2 * lit.elements().leafCount; ++texel)
      largest = std::max<double>(largest, radiance[4 * static_cast<std::size_t>(texel)]);
    return largest;
  };
  // Each bounce brings at most the largest of the one before.
  const double direct = most(1);
  CHECK(direct > 0.0);
  CHECK(most(8) <= 8.0 * direct);
}

TEST_CASE("lists of links to what shines bring the same bits as all links") {
  const Scene scene = loadScene(sourceDirectory() / "scenes/cornell.scene");
  const auto bits = [&](const char* lists) {
    return LitElements(scene, {"elements=1024", std::string("light_lists=") + lists})
        .light()
        .directIrradiance->downloadFloats(0);
  };
  const std::vector<float> byLists = bits("on");
  CHECK(byLists == bits("off"));
  CHECK(*std::max_element(byLists.begin(), byLists.end()) > 1.0f);
}

TEST_CASE("what is left out changes no bit of the light at elements") {
  const Scene scene = loadScene(sourceDirectory() / "scenes/cornell.scene");
  for (const char* name : {"implicit_visibility", "implicit_visibility_lights"}) {
    const LitElements lean(scene, {"elements=512", "bounces=2"}, name),
        full(scene, {"elements=512", "bounces=2"}, name, true);
    CHECK(lean.light().irradiance->downloadFloats(0) == full.light().irradiance->downloadFloats(0));
    CHECK(lean.frame.outputs.at("indirect_diffuse").values() ==
          full.frame.outputs.at("indirect_diffuse").values());
    CHECK(lean.frame.outputs.at("direct").values() == full.frame.outputs.at("direct").values());
  }
}

TEST_CASE("a disc of a tree sends the mean of its leaves by area, to each side") {
  const Scene scene = loadScene(sourceDirectory() / "scenes/cornell.scene");
  const LitElements lit(scene, {"elements=700", "bounces=2"}, "implicit_visibility");
  const ElementTree& tree = *lit.elements().tree;
  const std::vector<float> radiance = lit.light().radiance->downloadFloats(0);
  // Sums over the leaves below each node: children come before their parents.
  std::vector<glm::dvec3> sums(tree.nodeCount, glm::dvec3(0.0));  // front, back, area
  for (std::uint32_t node = 0; node < tree.firstGroup; ++node) {
    if (tree.isLeaf(node)) {
      const double area = lit.elements().state->area[node];
      sums[node] = {area * radiance[8 * node], area * radiance[8 * node + 4], area};
      continue;
    }
    for (const std::uint32_t child : tree.childrenOf(node))
      if (child != kNoElement) sums[node] += sums[child];
    CHECK(radiance[8 * node] == Approx(sums[node].x / sums[node].z).epsilon(1e-4).margin(1e-6));
    CHECK(radiance[8 * node + 4] == Approx(sums[node].y / sums[node].z).epsilon(1e-4).margin(1e-6));
  }
}

TEST_CASE("groups of separate squares send what their fronts send on average, and nothing behind") {
  // 16 x 16 squares of 1/4 m in a plane 4 m above a small floor, shining 1 and 3 in turn, or 2 all of them.
  const auto irradianceBelow = [](float one, float other, bool down, bool* hasGroups, int side = 16,
                                  float aside = 0.0f) {
    SceneBuilder builder;
    const int black = builder.lambert(0.0f), first = builder.lambert(0.0f, one),
              second = builder.lambert(0.0f, other);
    builder.quad({-0.1f, 0, -0.1f}, {0, 0, 0.2f}, {0.2f, 0, 0}, black);
    const float width = 4.0f / static_cast<float>(side);
    for (int z = 0; z < side; ++z)
      for (int x = 0; x < side; ++x) {
        const glm::vec3 corner(width * static_cast<float>(x) - 2.0f + aside, 4.0f,
                               width * static_cast<float>(z) - 2.0f + 0.5f * aside);
        const glm::vec3 right(width, 0, 0), ahead(0, 0, width);
        builder.quad(corner, down ? right : ahead, down ? ahead : right, (x + z) % 2 == 0 ? first : second);
      }
    builder.look({0, 1, 0}, {0, 0, 0}, {0, 0, -1}, 0.3, 4, 4);
    const LitElements lit(builder.scene, {"elements=300", "bins=8"});
    const ElementTree& tree = *lit.elements().tree;
    for (std::uint32_t leaf = 0; hasGroups != nullptr && leaf < tree.leafCount; ++leaf)
      if (tree.objectOfNode[leaf] == 0)
        for (const ElementLink& link : (*lit.links().seen)[leaf]) *hasGroups |= tree.isGroup(link.node);
    return lit.mean(lit.directIrradiance(), 0);
  };
  bool hasGroups = false;
  const double even = irradianceBelow(2.0f, 2.0f, true, &hasGroups);
  CHECK(hasGroups);
  // As much as one square in their place, which fills the same bins.
  CHECK(even > 0.0);
  CHECK(even == Approx(irradianceBelow(2.0f, 2.0f, true, nullptr, 1)).epsilon(0.02));
  CHECK(irradianceBelow(1.0f, 3.0f, true, nullptr) == Approx(even).epsilon(0.01));
  CHECK(irradianceBelow(2.0f, 2.0f, false, nullptr) == 0.0);
  // At a slant, too, where the direction has parts of all three axes.
  bool hasSlantedGroups = false;
  const double slanted = irradianceBelow(2.0f, 2.0f, true, &hasSlantedGroups, 16, 4.0f);
  CHECK(hasSlantedGroups);
  CHECK(slanted == Approx(irradianceBelow(2.0f, 2.0f, true, nullptr, 1, 4.0f)).epsilon(0.2));
}

TEST_CASE("an element that is partly in shadow reflects its lit part, whichever way the border runs") {
  // A screen keeps the light from what lies before 1/8 m along one axis: of a floor of 2 m 7/16 are lit.
  for (const int axis : {0, 2}) {
    SceneBuilder builder;
    builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.5f));
    glm::vec3 low(-1.5f, 0.2f, -1.5f), right(3, 0, 0), ahead(0, 0, 3);
    (axis == 0 ? right : ahead) *= 1.625f / 3.0f;
    builder.quad(low, ahead, right, builder.lambert(0.0f));
    builder.light(LightKind::directional, glm::vec3(1.0f), {}, {0, -1, 0});
    builder.look({0, 3, 0}, {0, 0, 0}, {0, 0, -1}, 0.3, 4, 4);
    const LitElements lit(builder.scene, {"elements=32"}, "implicit_visibility");
    const std::vector<double> radiance = lit.fronts(*lit.light().radiance);
    const double mean = lit.mean(radiance, 0);
    CAPTURE(axis);
    CHECK(mean == Approx(0.5 / kPi * 7.0 / 16.0).epsilon(0.04));
  }
}
