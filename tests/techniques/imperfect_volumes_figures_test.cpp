// What the paper's Fig. 5 and 7 show, in numbers: both sides of a thin vase, contact shadows of what the
// camera does not see, and light that stays as it is when the camera turns.
#include "support/against_reference.h"
#include "support/floor_patch.h"
#include "support/imperfect_volumes_scene.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::volumes;

namespace {

GBuffer gbufferOf(Scene scene, const Picture& picture) {
  scene.cameras.front().width = picture.width;
  scene.cameras.front().height = picture.height;
  return test::gbufferOf(scene);
}

/// Mean indirect light of both sides of the vase, as a camera above its rim sees them.
struct VaseSides {
  double inside = 0.0, outside = 0.0;
  int insidePixels = 0, outsidePixels = 0;
  double ratio() const { return inside / outside; }
};
VaseSides sidesOf(const Scene& scene, const Picture& picture, const ImageBuffer& image) {
  const GBuffer gbuffer = gbufferOf(scene, picture);
  const glm::vec3 origin = glm::vec3(snapshotOf(scene, 0.0).origin);
  const std::vector<float> places = gbuffer.position->downloadFloats(0),
                           normals = gbuffer.geometricNormal->downloadFloats(0);
  VaseSides sides;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const auto i = static_cast<std::size_t>(4 * (y * image.width() + x));
      const glm::vec3 place = glm::vec3(places[i], places[i + 1], places[i + 2]) + origin,
                      normal(normals[i], normals[i + 1], normals[i + 2]);
      const double away = std::hypot(place.x, place.z);
      // Walls alone: neither table, rim nor bottom.
      if (places[i + 3] == 0.0f || place.y < 0.02f || place.y > 0.42f || away > 0.16) continue;
      const double outwards = (normal.x * place.x + normal.z * place.z) / away;
      if (std::abs(outwards) < 0.5) continue;
      const double light = (image.at(x, y, 0) + image.at(x, y, 1) + image.at(x, y, 2)) / 3.0;
      (outwards < 0.0 ? sides.inside : sides.outside) += light;
      ++(outwards < 0.0 ? sides.insidePixels : sides.outsidePixels);
    }
  sides.inside /= sides.insidePixels;
  sides.outside /= sides.outsidePixels;
  return sides;
}

/// A square of quads, each of two triangles, as the paper's models have them: about as large as a voxel.
void tessellatedQuad(SceneBuilder& builder, const glm::vec3& corner, const glm::vec3& edge1,
                     const glm::vec3& edge2, int parts, int material) {
  std::vector<glm::vec3> corners;
  const float part = 1.0f / static_cast<float>(parts);
  for (int j = 0; j < parts; ++j)
    for (int i = 0; i < parts; ++i) {
      const auto at = [&](int x, int y) {
        return corner + static_cast<float>(x) * part * edge1 + static_cast<float>(y) * part * edge2;
      };
      for (const glm::vec3& place :
           {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1)})
        corners.push_back(place);
    }
  builder.mesh(corners, material);
}

/// A floor that the camera looks down at; a box stands on it below and behind the camera, just out of view.
Scene boxBehindCamera() {
  SceneBuilder builder;
  const int grey = builder.lambert(0.6f);
  tessellatedQuad(builder, {-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, 32, grey);
  constexpr int kParts = 8;
  const glm::vec3 low(-0.3f, 0.0f, -0.095f), size(0.6f, 0.2f, 0.4f);
  tessellatedQuad(builder, low, {0, size.y, 0}, {size.x, 0, 0}, kParts,
                  grey);  // towards -z, the floor in view
  tessellatedQuad(builder, low + glm::vec3(0, 0, size.z), {size.x, 0, 0}, {0, size.y, 0}, kParts, grey);
  tessellatedQuad(builder, low, {0, 0, size.z}, {0, size.y, 0}, kParts, grey);
  tessellatedQuad(builder, low + glm::vec3(size.x, 0, 0), {0, size.y, 0}, {0, 0, size.z}, kParts, grey);
  tessellatedQuad(builder, low + glm::vec3(0, size.y, 0), {0, 0, size.z}, {size.x, 0, 0}, kParts, grey);
  builder.light(LightKind::directional, glm::vec3(2.0f), {}, {0.3, -1.0, -0.2});
  builder.look({0, 0.6, 0}, {0, 0, -0.45}, {0, 1, 0}, 0.8, 48, 48);
  return builder.scene;
}

/// Mean openness of a square of the floor: of the reference, by reprojection alone, and with points.
struct Openness {
  double truth, reprojected, threePoints, adaptive;
};
Openness opennessOf(const Scene& scene, const Picture& picture, const FloorSquare& square) {
  const GBuffer gbuffer = gbufferOf(scene, picture);
  const auto mean = [&](const ImageBuffer& image) {
    const Patch patch = patchOf(gbuffer, snapshotOf(scene, 0.0), image, square);
    REQUIRE(patch.pixels > 20);
    return patch.mean;
  };
  const auto found = [&](const Made& made, std::vector<std::string> settings) {
    settings.push_back("resolution=64");
    settings.push_back("rays=400");
    return mean(pictured(scene, picture, volumePipeline(made), settings).outputs.at("ambient_occlusion"));
  };
  return {mean(referenceOf(scene, picture).layers.at("ambient_occlusion")), found({.points = false}, {}),
          found({}, {"adaptive=off", "points=3"}), found({}, {})};
}

}  // namespace

TEST_CASE(
    "a thin vase that is lit from one side is dark inside, with 32 voxels and with 64 as in the reference") {
  const Picture picture{96, 96, 256};
  const Scene scene = committed("vase");
  const LayeredImage reference = referenceOf(scene, picture);
  const VaseSides direct = sidesOf(scene, picture, reference.layers.at("direct")),
                  truth = sidesOf(scene, picture, reference.layers.at("one_bounce_diffuse"));
  REQUIRE(truth.insidePixels > 100);
  REQUIRE(truth.outsidePixels > 100);
  CHECK(direct.inside < 0.002 * direct.outside);  // pixels of the rim's edge
  CHECK(direct.outside > 0.01);
  CHECK(truth.ratio() < 0.6);
  for (const char* resolution : {"resolution=32", "resolution=64"}) {
    const VaseSides found =
        sidesOf(scene, picture,
                pictured(scene, picture, pipeline("imperfect_volumes"), {resolution, "rays=400"})
                    .outputs.at("indirect_diffuse"));
    CAPTURE(resolution, truth.inside, truth.outside, truth.ratio(), found.inside, found.outside,
            found.ratio());
    CHECK(found.ratio() < 1.5 * truth.ratio());
    CHECK(found.ratio() > truth.ratio() / 1.5);
  }
}

TEST_CASE("contact shadows of a box behind the camera need points: reprojection alone has none") {
  const Openness found = opennessOf(boxBehindCamera(), {48, 48, 256}, {{0.0, 0.0, -0.21}, 0.06f});
  CAPTURE(found.truth, found.reprojected, found.threePoints, found.adaptive);
  CHECK(found.truth < 0.85);
  CHECK(found.reprojected > 0.97);
  CHECK(std::abs(found.threePoints - found.truth) < 0.3 * (1.0 - found.truth));
  CHECK(std::abs(found.adaptive - found.truth) < 0.3 * (1.0 - found.truth));
}

TEST_CASE("beside a hidden sender of twelve triangles three points of each leave most of the shadow out") {
  const Openness found = opennessOf(committed("hidden_sender"), {128, 128, 256}, {{0.5, 0.0, -0.8}, 0.15f});
  CAPTURE(found.truth, found.reprojected, found.threePoints, found.adaptive);
  CHECK(found.truth < 0.94);
  CHECK(1.0 - found.reprojected < 0.3 * (1.0 - found.truth));
  CHECK(found.threePoints <= found.reprojected);
  CHECK(std::abs(found.adaptive - found.truth) < 0.3 * (1.0 - found.truth));
}

TEST_CASE("a camera that turns leaves the light where it is, unless the volume holds only what it sees") {
  const Picture picture{96, 96};
  // The floor before both blocks, in red: a part of the red wall leaves the view.
  const FloorSquare square{{0.34, 0.0, 0.12}, 0.05f};
  const auto lightOf = [&](const Made& made, double degrees) {
    Scene scene = committed("cornell");
    turnCamera(scene, degrees);
    const ImageBuffer image = pictured(scene, picture, volumePipeline(made), {"resolution=32", "rays=100"})
                                  .outputs.at("indirect_diffuse");
    const Patch patch = patchOf(gbufferOf(scene, picture), snapshotOf(scene, 0.0), image, square);
    REQUIRE(patch.pixels > 20);
    return patch.mean;
  };
  const auto change = [&](const Made& made, double degrees) {
    return std::abs(lightOf(made, degrees) / lightOf(made, 0.0) - 1.0);
  };
  for (const double degrees : {-10.0, 10.0}) {
    const double both = change({}, degrees), reprojected = change({.points = false}, degrees);
    CAPTURE(degrees, both, reprojected);
    CHECK(both < 0.02);
    CHECK(reprojected > 0.1);
  }
}
