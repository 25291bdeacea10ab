// Shadows by cones to the lights.
//
// A square lamp of width w at height H lights a floor past the edge of a sheet at height h, which covers x <
// 0. The ray from the floor's point x to the lamp's point u is free where u > -x (H - h) / h: the visible
// share of the lamp rises linearly from 0 to 1 over the penumbra's width P = w h / (H - h), and the variance
// of its slope is P^2 / 12.
//
// A sheet of opacity a in one layer of voxels is read trilinearly as a (1 - |x|), x in voxels. Light that
// crosses it upright finds 1 - a of it open. Taken for a medium it lets T(a) through, with
//   ln T = 2 int_0^1 ln(1 - a x) dx = -2 ((1 - a) ln(1 - a) + a) / a.
#include <cmath>

#include "../../techniques/voxel_cone_tracing/cones/light_discs.h"
#include "lumivox/base/error.h"
#include "lumivox/toolkit/light_samples.h"
#include "support/sheets.h"

using namespace lumivox;
using namespace lumivox::test;
using Catch::Matchers::Contains;
using cones::inputOf;

namespace {

using Words = std::vector<std::pair<std::string, std::string>>;
/// Cones without a gap at their start, by steps so fine that sums are integrals.
using Numbers = std::vector<std::pair<std::string, double>>;
const Numbers kExact{{"step", 0.05}, {"offset", 0.0}, {"start", 0.0}};

LightDiscs lightsOf(const Scene& scene, int areaSamples = 16) {
  PassHarness harness(device(), techniques(), "voxel_cone_tracing", "lights", scene, snapshotOf(scene, 0.0));
  harness.setParameter("area_samples", areaSamples);
  harness.run();
  return harness.output<LightDiscs>("lights");
}

/// What a horizontal white surface point in a store sends to the eye, by one of both passes.
template <class Store>
float radianceAt(const Scene& scene, const glm::vec3& place, const Store* grid, const Words& words,
                 const Numbers& numbers) {
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  PassHarness harness(device(), techniques(), grid == nullptr ? "direct_lighting" : "voxel_cone_tracing",
                      grid == nullptr ? "shade" : "soft_shadows", scene, snapshot);
  harness.setInput("gbuffer",
                   cones::surfacePoint(place - glm::vec3(snapshot.origin), {0, 1, 0}, glm::vec3(1.0f)));
  if (grid == nullptr) {
    harness.setParameter("shadows", std::string("off"));
    PassHarness maps(device(), techniques(), "direct_lighting", "shadow_map", scene, snapshot);
    maps.run();
    harness.setInput("shadow", maps.output<ShadowMap>("depth"));
  } else {
    harness.setParameter("radius", std::string("light"));  // none: the cones read the finest voxels
    for (const auto& [name, word] : words) harness.setParameter(name, word);
    for (const auto& [name, number] : numbers) harness.setParameter(name, number);
    harness.setInput("lights", lightsOf(scene));
    harness.setInput(inputOf(*grid), *grid);
  }
  harness.run();
  return cones::pixelOf(imageOf(*harness.output<Image>("radiance").texture)).r;
}

/// Visible share of the light, or of all lights, of a scene without geometry at a point in a store over
/// [-1,1]^3.
template <class Store>
double visible(const Scene& scene, const Store& grid, const Words& words = {},
               const Numbers& numbers = kExact) {
  const glm::vec3 place(0.03f, -0.9f, 0.02f);
  const double all = radianceAt<Store>(scene, place, nullptr, {}, {});
  REQUIRE(all > 0.0);
  return radianceAt(scene, place, &grid, words, numbers) / all;
}

Scene litFrom(LightKind kind) {
  SceneBuilder builder;
  builder.scene = cones::emptyScene();
  Light& light = builder.light(kind, glm::vec3(1.0f), {0.03, 0.9, 0.02}, {0, -1, 0});
  light.innerAngle = 0.4f, light.outerAngle = 0.5f;
  return builder.scene;
}

/// A sheet in one layer of voxels.
RadianceGrid sheet(float opacity, int resolution = 32, int layer = 16) {
  return cones::filtered(cones::makeGrid(
      resolution, [=](int, int y, int) { return glm::vec4(0, 0, 0, y == layer ? opacity : 0.0f); }));
}

struct Edge {
  double lamp = 0.3, height = 0.507, lampHeight = 1.01, place = 0.0;
  double penumbra() const { return lamp * height / (lampHeight - height); }
};

/// Floor, half-plane and lamp; the camera looks down between floor and sheet, 1 m wide, or sees all of it.
Scene edgeScene(const Edge& edge) {
  constexpr int kPixels = 64;
  SceneBuilder builder;
  const auto w = static_cast<float>(edge.lamp), h = static_cast<float>(edge.height),
             top = static_cast<float>(edge.lampHeight);
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.5f));
  builder.quad({-1, h, -1}, {0, 0, 2}, {1.0f + static_cast<float>(edge.place), 0, 0}, builder.lambert(0.5f));
  builder.quad({-0.5f * w, top, -0.5f * w}, {w, 0, 0}, {0, 0, w}, builder.lambert(0.0f, 10.0f));
  builder.look({0, 0.45, 0}, {0, 0, 0}, {0, 0, 1}, 2.0 * std::atan(0.4 / 0.45), kPixels, kPixels);
  return builder.scene;
}

/// Visible shares along x in the middle row of the image, from left to right.
std::vector<double> sharesAlong(const Scene& scene, const std::vector<std::string>& settings,
                                const std::string& ofLights = {}, const std::string& ofShadows = {}) {
  const Pipeline traced = cones::pipelineWith(
      "voxel_cone_tracing_soft_shadows",
      {{"voxel_cone_tracing.lights", ofLights}, {"voxel_cone_tracing.soft_shadows", ofShadows}});
  RenderOptions options;
  options.parameters = traced.settings(settings);
  const ImageBuffer shadowed = renderOnce(scene, traced, options).outputs.at("direct");
  const Pipeline open = cones::pipelineWith("direct_lighting", {{"direct_lighting.shade", "shadows off"}});
  const ImageBuffer all = renderOnce(scene, open).outputs.at("direct");
  std::vector<double> shares;
  for (int x = 0; x < all.width(); ++x)
    shares.push_back(shadowed.at(x, all.height() / 2, 0) / all.at(x, all.height() / 2, 0));
  return shares;
}

/// A rise from a dark side at the right of the image to a bright one at the left; places in metres, positive
/// to the left, from the middle of a row that is `width` m wide. What shines through the sheet, at most 0.06,
/// is taken off.
class Profile {
 public:
  Profile(const std::vector<double>& row, double width)
      : pixel_(width / static_cast<double>(row.size())), start_(-0.5 * width) {
    constexpr double kLeak = 0.06;
    for (auto share = row.rbegin(); share != row.rend(); ++share)
      shares_.push_back(std::max(0.0, *share - kLeak) / (1.0 - kLeak));
  }
  /// Where it first reaches a level.
  double placeOf(double level) const {
    for (std::size_t i = 1; i < shares_.size(); ++i)
      if (shares_[i - 1] < level && shares_[i] >= level)
        return start_ + pixel_ * (static_cast<double>(i) - 0.5 +
                                  (level - shares_[i - 1]) / (shares_[i] - shares_[i - 1]));
    return std::nan("");
  }
  /// The width of a linear ramp whose slope has the same variance.
  double spread() const {
    double sum = 0.0, first = 0.0, second = 0.0;
    for (std::size_t i = 1; i < shares_.size(); ++i) {
      const double slope = shares_[i] - shares_[i - 1], x = static_cast<double>(i) * pixel_;
      sum += slope, first += slope * x, second += slope * x * x;
    }
    return std::sqrt(12.0 * (second / sum - first / sum * (first / sum)));
  }

 private:
  std::vector<double> shares_;
  double pixel_, start_;
};

}  // namespace

TEST_CASE(
    "penumbras of a square lamp behind an edge are as wide as their closed form, wherever voxels lie to it") {
  for (Edge edge : {Edge{0.3, 0.507, 1.01}, Edge{0.2, 0.507, 1.01}, Edge{0.4, 0.507, 1.21}}) {
    for (const double place : {0.0, 0.025, 0.05, 0.075}) {
      edge.place = place;
      CAPTURE(edge.lamp, edge.lampHeight, place);
      const Profile profile(sharesAlong(edgeScene(edge), {"resolution=128"}), 0.8);
      CHECK(profile.spread() == Approx(edge.penumbra()).epsilon(0.15));
      CHECK((profile.placeOf(0.9) - profile.placeOf(0.1)) / 0.8 == Approx(edge.penumbra()).epsilon(0.15));
      // In its place, but for voxels (2 m / 128) that the sheet covers in part: twice as large on the floor.
      CHECK(profile.placeOf(0.5) ==
            Approx(place * edge.lampHeight / (edge.lampHeight - edge.height)).margin(2.0 / 64));
    }
  }
}

TEST_CASE("one cone a light has the penumbra's width in the mean, and the published radius none") {
  double whole = 0.0;
  for (const double place : {0.0, 0.025, 0.05, 0.075}) {
    Edge edge;
    edge.place = place;
    const Profile one(sharesAlong(edgeScene(edge), {"resolution=128"}, "cones light"), 0.8);
    whole += 0.25 * (one.placeOf(0.9) - one.placeOf(0.1)) / 0.8 / edge.penumbra();
    // The eye's cone is half a pixel, 6 mm, wide here, and the voxels are 16 mm.
    const Profile hard(sharesAlong(edgeScene(edge), {"resolution=128"}, "cones light", "radius eye"), 0.8);
    CHECK((hard.placeOf(0.9) - hard.placeOf(0.1)) / 0.8 < 0.35 * edge.penumbra());
  }
  CHECK(whole == Approx(1.0).epsilon(0.2));
}

TEST_CASE("in the shadow of a closed sheet it is dark, and where nothing is in the way no bit is missing") {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.5f));
  builder.quad({-0.5f, 0.5f, -0.5f}, {0, 0, 1}, {1, 0, 0}, builder.lambert(0.5f));
  builder.quad({-0.1f, 1.0f, -0.1f}, {0.2f, 0, 0}, {0, 0, 0.2f}, builder.lambert(0.0f, 10.0f));
  builder.look({0, 0.45, 0}, {0, 0, 0}, {0, 0, 1}, 1.2, 32, 32);
  for (const double share : sharesAlong(builder.scene, {"resolution=64"})) CHECK(share < 0.06);
  // Without the sheet, from the side.
  SceneBuilder open;
  open.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, open.lambert(0.5f));
  open.quad({-0.1f, 1.0f, -0.1f}, {0.2f, 0, 0}, {0, 0, 0.2f}, open.lambert(0.0f, 10.0f));
  open.light(LightKind::point, glm::vec3(1.0f), {0.4, 0.7, 0.1});
  open.light(LightKind::directional, glm::vec3(1.0f), {}, {-0.3, -0.6, 0.2});
  open.look({0, 0.8, 1.2}, {0, 0, 0}, {0, 1, 0}, 0.8, 32, 32);
  for (const double share : sharesAlong(open.scene, {"resolution=64"})) CHECK(share == 1.0);
}

TEST_CASE(
    "a sheet of opacity a lets 1 - a of the light through, and as a medium what the thesis's steps let through") {
  for (const LightKind kind : {LightKind::directional, LightKind::point, LightKind::spot}) {
    CAPTURE(static_cast<int>(kind));
    const Scene scene = litFrom(kind);
    for (const float opacity : {0.2f, 0.5f, 0.8f, 0.95f}) {
      CAPTURE(opacity);
      const double a = static_cast<double>(opacity);
      CHECK(visible(scene, sheet(opacity)) == Approx(1.0 - a).epsilon(0.03).margin(0.03));
      const double asMedium = std::exp(-2.0 * ((1.0 - a) * std::log(1.0 - a) + a) / a);
      CHECK(visible(scene, sheet(opacity), {{"opacity", "medium"}}) == Approx(asMedium).epsilon(0.02));
    }
    CHECK(visible(scene, sheet(1.0f)) < 0.03);
    CHECK(visible(scene, sheet(1.0f), {{"opacity", "medium"}}) == Approx(std::exp(-2.0)).epsilon(0.1));
  }
}

TEST_CASE("a sheet of opacity a lets 1 - a of the light through, in every store") {
  // The opacity of a sheet is the share that it covers, however finely it is stepped through. Read filtered,
  // it is a (1 - |x|), x in voxels, whose largest value counts. Read by layers, a step of the length s voxels
  // along the normal finds 1 - (1 - a)^s, the faces across having no weight, and (1 - a)^(s / s) is what one
  // voxel leaves. Neither depends on the light.
  const float opacity = GENERATE(0.2f, 0.5f, 0.8f);
  const Scene scene = litFrom(GENERATE(LightKind::directional, LightKind::point));
  const double open = 1.0 - static_cast<double>(opacity);
  cones::forSheets(1, opacity, [&](const auto& store, const char* name) {
    CAPTURE(name, opacity, open);
    CHECK(visible(scene, store) == Approx(open).margin(0.03));
    // By the steps of the defaults too dark a filtered sheet at most: 0.123 of 0.2 is left (why is not
    // isolated).
    CHECK(visible(scene, store, {}, {}) == Approx(open).margin(0.08));
  });
}

TEST_CASE("an even medium in the voxels dims the light by its optical depth") {
  // From the point at -0.9 to the light at 0.9: 1.8 m, of voxels of 2/32 m.
  constexpr double kVoxels = 1.8 * 16.0;
  const Scene scene = litFrom(LightKind::point);
  for (const float opacity : {0.01f, 0.05f, 0.2f}) {
    CAPTURE(opacity);
    const double a = static_cast<double>(opacity);
    const RadianceGrid grid = cones::filtered(cones::uniformGrid(32, glm::vec4(0, 0, 0, opacity)));
    CHECK(visible(scene, grid, {{"opacity", "medium"}}) == Approx(std::pow(1.0 - a, kVoxels)).epsilon(0.01));
    // Taken for surfaces it is one thing that covers a share of the cone.
    CHECK(visible(scene, grid) == Approx(1.0 - a).epsilon(0.03));
  }
}

TEST_CASE("what lies behind a light casts no shadow") {
  // The light is at 0.9, in voxel 30; the cone ends there.
  CHECK(visible(litFrom(LightKind::point), sheet(1.0f, 64, 63)) == 1.0);
  CHECK(visible(litFrom(LightKind::directional), sheet(1.0f, 64, 63)) < 0.05);
}

TEST_CASE("the lights of soft shadows are those of shadow maps, without views") {
  const Scene scene = litRoom(16, 16);
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  PassHarness maps(device(), techniques(), "direct_lighting", "shadow_map", scene, snapshot);
  maps.run();
  const ShadowMap& with = maps.output<ShadowMap>("depth");
  const LightDiscs without = lightsOf(scene);
  REQUIRE(without.lightCount == with.lightCount);
  const auto a = with.lights->downloadValues<LightSampleData>(),
             b = without.lights->downloadValues<LightSampleData>();
  for (std::size_t i = 0; i < a.size(); ++i) {
    CHECK(a[i].position == b[i].position);
    CHECK(a[i].power == b[i].power);
    CHECK(a[i].patchRadiusSquared == b[i].patchRadiusSquared);
    CHECK(b[i].firstView == -1);
  }
}
