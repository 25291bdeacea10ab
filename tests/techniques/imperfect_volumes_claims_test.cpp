// How near the pictures come to the path-traced reference.
#include <fmt/format.h>

#include <cmath>

#include "support/against_reference.h"
#include "support/imperfect_volumes_scene.h"
#include "support/kept_table.h"

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

const std::string kOwn = "    voxels own\n", kAll = "    blend all\n", kHarmonics = "    source harmonics\n";

}  // namespace

TEST_CASE("imperfect volumes err on the Cornell box and the arcade by less than what is asked of them") {
  const Claim cornell("cornell", {64, 64, 256});
  const auto inRange = [](const Against& found) {
    CHECK(found.ratio > 0.88);
    CHECK(found.ratio < 1.1);
  };
  const Found coarse = cornell.found({}, {"resolution=32"}), fine = cornell.found({}, {"resolution=64"}),
              exact = cornell.found({}, {"resolution=32", "rays=1024", "walk=exact"}),
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
  struct Row {
    const char* what;
    Made made;
    std::vector<std::string> settings;
  };
  KeptTable table("imperfect_volumes.errors", {{"light", 3, 0.02},
                                               {"ratio of light", 2, 0.015},
                                               {"occlusion", 3, 0.02, 0.02},
                                               {"ratio of openness", 2, 0.015}});
  const Made printed{.ofReading = kAll, .ofLight = kHarmonics}, own{.ofReading = kOwn};
  const std::vector<Row> rows{{"32 voxels", {}, {"resolution=32"}},
                              {"64 voxels", {}, {"resolution=64"}},
                              {"128 voxels", {}, {"resolution=128"}},
                              {"32, exact", {}, {"resolution=32", "rays=1024", "walk=exact"}},
                              {"64, exact", {}, {"resolution=64", "rays=1024", "walk=exact"}},
                              {"32, as printed", printed, {"resolution=32"}},
                              {"64, as printed", printed, {"resolution=64"}},
                              {"32, own", own, {"resolution=32"}},
                              {"64, own", own, {"resolution=64"}}};
  for (const auto& [name, picture] :
       {std::pair<const char*, Picture>("cornell", {64, 64, 1024}), {"arcade", {80, 45, 1024}}}) {
    const Claim claim(name, picture);
    for (const Row& row : rows) {
      const Found found = claim.found(row.made, row.settings);
      table.row(fmt::format("{}, {}", name, row.what),
                {found.light.rmse, found.light.ratio, found.occlusion.rmse, found.occlusion.ratio});
      CAPTURE(name, row.what, found.light.ratio);
      CHECK(found.light.rmse < 0.65);
      CHECK((found.light.ratio > 0.55 && found.light.ratio < 1.1));
      CHECK((found.occlusion.ratio > 0.4 && found.occlusion.ratio < 1.05));
    }
    const Against propagated = claim.lightOf("imperfect_volumes_propagation", {});
    table.row(fmt::format("{}, propagated", name), {propagated.rmse, propagated.ratio, NAN, NAN});
    CHECK(propagated.rmse < 0.8);
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
  KeptTable table("imperfect_volumes.steps_and_bounces", {{"error", 3, 0.02}, {"ratio", 3, 0.015}});
  const auto made = [&](const char* name, const std::string& setting, const char* layer) {
    const Against found =
        against(reference, pictured(scene, picture, pipeline(name), {setting}).outputs.at("indirect_diffuse"),
                layer, 0.0f);
    table.row(fmt::format("{}, {}", name, setting), {found.rmse, found.ratio});
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
