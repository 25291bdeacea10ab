// How near the pictures come to the path-traced reference.
#include <fmt/format.h>

#include <cmath>

#include "support/against_reference.h"
#include "support/imperfect_volumes_scene.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::volumes;

namespace {

struct Found {
  Against light, occlusion;
};

/// A scene with what is true of it.
class Claim {
 public:
  Claim(const char* name, const Picture& picture)
      : scene_(committed(name)), picture_(picture), reference_(referenceOf(scene_, picture)) {}
  Found found(const Made& made, const std::vector<std::string>& settings) const {
    const FrameResult frame = pictured(scene_, picture_, volumePipeline(made), settings);
    return {lightAgainst(reference_, frame.outputs.at("indirect_diffuse")),
            occlusionAgainst(reference_, frame.outputs.at("ambient_occlusion"))};
  }
  Against lightOf(const char* name, const std::vector<std::string>& settings) const {
    return lightAgainst(reference_,
                        pictured(scene_, picture_, pipeline(name), settings).outputs.at("indirect_diffuse"));
  }

 private:
  Scene scene_;
  Picture picture_;
  LayeredImage reference_;
};

const std::string kExact = "    walk exact\n    bits average.bits\n", kOwn = "    voxels own\n",
                  kAll = "    blend all\n", kHarmonics = "    source harmonics\n";

}  // namespace

TEST_CASE("imperfect volumes err on the Cornell box and the arcade by less than what is asked of them") {
  const Claim cornell("cornell", {64, 64, 256});
  const auto inRange = [](const Against& found) {
    CHECK(found.ratio > 0.88);
    CHECK(found.ratio < 1.1);
  };
  const Found coarse = cornell.found({}, {"resolution=32"}), fine = cornell.found({}, {"resolution=64"}),
              exact = cornell.found({.ofRays = kExact}, {"resolution=32", "rays=1024"}),
              own = cornell.found({.ofReading = kOwn}, {"resolution=32"});
  CAPTURE(coarse.light.rmse, fine.light.rmse, exact.light.rmse, own.light.rmse, fine.occlusion.rmse,
          own.occlusion.rmse);
  CHECK(coarse.light.rmse < 0.22);
  CHECK(fine.light.rmse < 0.22);
  CHECK(exact.light.rmse < 0.16);
  inRange(coarse.light);
  inRange(fine.light);
  inRange(exact.light);
  // Fig. 3: voxels within the wall shade it.
  CHECK(own.light.rmse > 1.6 * coarse.light.rmse);
  CHECK(own.occlusion.rmse > 2.0);
  CHECK(fine.occlusion.rmse < 0.45);
  CHECK(Claim("arcade", {80, 45, 256}).found({}, {"resolution=32"}).light.rmse < 0.55);
}

TEST_CASE("three bounces bring as much light as the reference of three bounces") {
  const Scene scene = committed("cornell");
  const Picture picture{48, 48};
  ReferenceOptions options = quietly(256, 3);
  options.width = picture.width;
  options.height = picture.height;
  options.useCache = true;
  options.bounceLayers = {3};
  const LayeredImage reference = cachedReference(scene, options);
  const Against found =
      against(reference,
              pictured(scene, picture, pipeline("imperfect_volumes"), {"bounces=3", "resolution=32"})
                  .outputs.at("indirect_diffuse"),
              "bounces_3_diffuse", 0.0f);
  CAPTURE(found.rmse, found.ratio);
  CHECK(found.ratio > 0.85);
  CHECK(found.ratio < 1.15);
}

// The numbers of the card; minutes.
TEST_CASE("errors of imperfect volumes by voxels, rays and reading", "[.]") {
  struct Expected {
    double light, ratio, occlusion, openRatio;
  };
  struct Row {
    const char* what;
    Made made;
    std::vector<std::string> settings;
    Expected cornell, arcade;
  };
  const Made exact{.ofRays = kExact}, printed{.ofReading = kAll, .ofLight = kHarmonics},
      own{.ofReading = kOwn};
  const std::vector<Row> rows{
      {"32 voxels", {}, {"resolution=32"}, {0.147, 0.98, 0.412, 0.96}, {0.377, 0.95, 0.588, 0.93}},
      {"64 voxels", {}, {"resolution=64"}, {0.135, 0.97, 0.171, 0.98}, {0.368, 0.96, 0.628, 0.91}},
      {"128 voxels", {}, {"resolution=128"}, {0.129, 0.96, 0.123, 0.99}, {0.325, 0.92, 0.431, 0.94}},
      {"32, exact",
       exact,
       {"resolution=32", "rays=1024"},
       {0.127, 0.99, 0.501, 0.94},
       {0.385, 0.95, 1.034, 0.78}},
      {"64, exact",
       exact,
       {"resolution=64", "rays=1024"},
       {0.108, 0.97, 0.259, 0.97},
       {0.371, 0.95, 0.673, 0.89}},
      {"32, as printed", printed, {"resolution=32"}, {0.184, 0.89, 1.405, 0.72}, {0.351, 0.88, 0.859, 0.79}},
      {"64, as printed", printed, {"resolution=64"}, {0.193, 0.87, 1.314, 0.73}, {0.328, 0.85, 0.900, 0.76}},
      {"32, own", own, {"resolution=32"}, {0.392, 0.73, 2.607, 0.46}, {0.564, 0.66, 1.838, 0.45}},
      {"64, own", own, {"resolution=64"}, {0.383, 0.74, 2.655, 0.45}, {0.486, 0.64, 1.660, 0.50}}};
  for (const auto& [name, picture] :
       {std::pair<const char*, Picture>("cornell", {64, 64, 1024}), {"arcade", {80, 45, 1024}}}) {
    const Claim claim(name, picture);
    const bool closed = std::string(name) == "cornell";
    for (const Row& row : rows) {
      const Found found = claim.found(row.made, row.settings);
      WARN(fmt::format("{}, {}: light {:.3f}, ratio {:.2f}; occlusion {:.3f}, ratio {:.2f}", name, row.what,
                       found.light.rmse, found.light.ratio, found.occlusion.rmse, found.occlusion.ratio));
      const Expected& expected = closed ? row.cornell : row.arcade;
      CHECK(found.light.rmse == Approx(expected.light).margin(0.02));
      CHECK(found.light.ratio == Approx(expected.ratio).margin(0.015));
      CHECK(found.occlusion.rmse == Approx(expected.occlusion).epsilon(0.02).margin(0.02));
      CHECK(found.occlusion.ratio == Approx(expected.openRatio).margin(0.015));
    }
    const Against propagated = claim.lightOf("imperfect_volumes_propagation", {});
    WARN(fmt::format("{}, propagated: light {:.3f}, ratio {:.2f}", name, propagated.rmse, propagated.ratio));
    CHECK(propagated.rmse == Approx(closed ? 0.364 : 0.696).margin(0.02));
    CHECK(propagated.ratio == Approx(closed ? 1.09 : 1.22).margin(0.02));
  }
}

// The numbers of the card. A step of propagation carries light from cell to cell and must keep it; a bounce
// of the march brings what the walls reflect of the bounce before.
TEST_CASE("light by steps of propagation and by bounces of rays, beside the reference", "[.]") {
  const Scene scene = committed("cornell");
  const Picture picture{48, 48};
  ReferenceOptions truth = quietly(1024, 3);
  truth.width = picture.width;
  truth.height = picture.height;
  truth.useCache = true;
  truth.bounceLayers = {2, 3};
  const LayeredImage reference = cachedReference(scene, truth);
  const auto made = [&](const char* name, const std::string& setting, const char* layer) {
    const Against found =
        against(reference, pictured(scene, picture, pipeline(name), {setting}).outputs.at("indirect_diffuse"),
                layer, 0.0f);
    WARN(fmt::format("{} {} against {}: error {:.3f}, ratio {:.3f}", name, setting, layer, found.rmse,
                     found.ratio));
    return found;
  };
  const auto after = [&](int steps) {
    return made("imperfect_volumes_propagation", fmt::format("iterations={}", steps), "one_bounce_diffuse")
        .ratio;
  };
  // Light arrives until it has crossed the grid, and stays.
  double before = 0.0;
  for (const int steps : {4, 8, 16, 32}) {
    const double found = after(steps);
    CHECK(found > before);
    before = found;
  }
  for (const int steps : {64, 128, 256}) CHECK(std::abs(after(steps) / before - 1.0) < 0.03);
  for (const auto& [bounces, layer] : {std::pair<int, const char*>(1, "one_bounce_diffuse"),
                                       {2, "bounces_2_diffuse"},
                                       {3, "bounces_3_diffuse"}}) {
    const Against found = made("imperfect_volumes", fmt::format("bounces={}", bounces), layer);
    CHECK(found.ratio > 0.9);
    CHECK(found.ratio < 1.1);
  }
}
