// How near the pictures come to the path-traced reference.
#include <fmt/format.h>

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
  for (const auto& [name, picture] :
       {std::pair<const char*, Picture>("cornell", {64, 64, 1024}), {"arcade", {80, 45, 1024}}}) {
    const Claim claim(name, picture);
    const auto tell = [&](const std::string& what, const Found& found) {
      WARN(fmt::format("{}, {}: light {:.3f}, ratio {:.2f}; occlusion {:.3f}, ratio {:.2f}", name, what,
                       found.light.rmse, found.light.ratio, found.occlusion.rmse, found.occlusion.ratio));
    };
    for (const char* resolution : {"resolution=32", "resolution=64", "resolution=128"})
      tell(resolution, claim.found({}, {resolution}));
    for (const char* resolution : {"resolution=32", "resolution=64"}) {
      tell(std::string(resolution) + " exact 1024",
           claim.found({.ofRays = kExact}, {resolution, "rays=1024"}));
      tell(std::string(resolution) + " as printed",
           claim.found({.ofReading = kAll, .ofLight = kHarmonics}, {resolution}));
      tell(std::string(resolution) + " own", claim.found({.ofReading = kOwn}, {resolution}));
    }
    const Against propagated = claim.lightOf("imperfect_volumes_propagation", {});
    WARN(fmt::format("{}, propagated: light {:.3f}, ratio {:.2f}", name, propagated.rmse, propagated.ratio));
  }
}
