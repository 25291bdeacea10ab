// Rays from voxels that end at the surface within a voxel: openness in front of a slanted wall against its
// closed form, closed rooms, and what is left as it is.
#include <fmt/format.h>

#include <cmath>

#include "support/against_reference.h"
#include "support/facts.h"
#include "support/imperfect_volumes_scene.h"
#include "support/kept_table.h"
#include "support/voxel_fragments.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::volumes;

namespace {

const Settings kBoxes{{"walk", "exact"}}, kPlanes{{"walk", "exact"}, {"stop", "plane"}, {"guard", 0}};

/// Surfaces alone in their voxels.
class Voxelized {
 public:
  Voxelized(const SceneBuilder& builder, int resolution)
      : scene(builder.scene), snapshot(snapshotOf(scene, 0.0)) {
    fragments = fragmentsIn(scene, {{"resolution", resolution}});
    LonePass average("voxelization.average", scene);
    average.in("fragments", fragments);
    opacity = average.out<OccupancyGrid>("opacity");
    bits = average.out<BinaryGrid>("bits");
    occupied = opacity.opacity->downloadFloats(0);
  }

  /// Share of the directions from each voxel that are free within a distance, m.
  std::vector<double> openness(double distance, const Settings& settings) const {
    LonePass occlude("imperfect_volumes.occlude", scene, {{"rays", 1024}, {"distance", distance}});
    occlude.in("opacity", opacity).in("bits", bits).in("fragments", fragments).with(settings);
    const std::vector<float> bands =
        occlude.out<ShGrid>("visibility").levels[0].coefficients[0]->downloadFloats(0);
    std::vector<double> result;
    for (std::size_t i = 0; i < bands.size(); i += 4) result.push_back(bands[i] / (4.0 * kPi * kY0));
    return result;
  }

  /// Work on each free voxel: its number and its centre in the scene.
  template <class Work>
  void forEachFree(const Work& work) const {
    const glm::ivec3 size = opacity.grid.resolution;
    for (int z = 0, i = 0; z < size.z; ++z)
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x, ++i)
          if (occupied[static_cast<std::size_t>(i)] == 0.0f)
            work(static_cast<std::size_t>(i),
                 snapshot.origin + glm::dvec3(opacity.grid.low) +
                     double{opacity.grid.voxelSize} * (glm::dvec3(x, y, z) + 0.5));
  }

  Scene scene;
  SceneSnapshot snapshot;
  VoxelFragments fragments;
  OccupancyGrid opacity;
  BinaryGrid bits;
  std::vector<float> occupied;
};

const glm::dvec3 kAlong{1, 2, 16}, kAcross{16, 4, -1};

Voxelized slantedWall() {
  SceneBuilder builder;
  builder.quad({-8, -3, -8}, kAlong, kAcross, builder.lambert(0.5f));
  return {builder, 32};
}

}  // namespace

TEST_CASE("a slanted wall takes of the directions what its plane takes, where boxes take more") {
  const Voxelized wall = slantedWall();
  const glm::dvec3 normal = glm::normalize(glm::cross(kAlong, kAcross));
  const double reach = 3.0;
  const std::vector<double> boxes = wall.openness(reach, kBoxes), planes = wall.openness(reach, kPlanes);
  double ofBoxes = 0.0, ofPlanes = 0.0, bias = 0.0;
  int count = 0;
  wall.forEachFree([&](std::size_t i, const glm::dvec3& centre) {
    const double away = std::abs(glm::dot(centre - glm::dvec3(-8, -3, -8), normal));
    // All of what is within the reach lies on the wall.
    if (away > 2.0 || std::abs(centre.x - 0.5) > 4.5 || std::abs(centre.z + 0.5) > 4.5) return;
    // A cap of the sphere: cos from away / reach on.
    const double expected = 0.5 + 0.5 * away / reach;
    ofBoxes += std::abs(boxes[i] - expected);
    ofPlanes += std::abs(planes[i] - expected);
    bias += planes[i] - expected;
    ++count;
  });
  REQUIRE(count > 300);
  CAPTURE(count, ofBoxes / count, ofPlanes / count, bias / count);
  CHECK(ofPlanes / count < 0.01);
  CHECK(std::abs(bias / count) < 0.003);
  CHECK(ofPlanes < 0.25 * ofBoxes);
}

TEST_CASE("a closed slanted room stays closed to one ray in a thousand that end at planes") {
  SceneBuilder builder;
  const glm::dvec3 a = 10.0 * glm::normalize(glm::dvec3(3, 1, 0.5)),
                   b = 10.0 * glm::normalize(glm::cross(glm::dvec3(0.2, 0.3, 1), a)),
                   c = 10.0 * glm::normalize(glm::cross(a, b)), low = -0.5 * (a + b + c);
  const int white = builder.lambert(0.5f);
  builder.quad(low, a, b, white);
  builder.quad(low + c, b, a, white);
  builder.quad(low, b, c, white);
  builder.quad(low + a, c, b, white);
  builder.quad(low, c, a, white);
  builder.quad(low + b, a, c, white);
  const Voxelized room(builder, 24);
  const std::vector<double> boxes = room.openness(100.0, kBoxes), planes = room.openness(100.0, kPlanes);
  double ofBoxes = 0.0, ofPlanes = 0.0;
  int count = 0;
  room.forEachFree([&](std::size_t i, const glm::dvec3& centre) {
    for (const glm::dvec3& side : {a, b, c})
      if (std::abs(glm::dot(centre, side)) > 50.0) return;
    ofBoxes += boxes[i];
    ofPlanes += planes[i];
    ++count;
  });
  REQUIRE(count > 500);
  CAPTURE(count, ofBoxes / count, ofPlanes / count);
  CHECK(ofBoxes == 0.0);
  CHECK(ofPlanes / count < 0.001);
}

TEST_CASE("rays that end at boxes are the same to the bit with fragments connected and without") {
  const Voxelized wall = slantedWall();
  const auto open = [&](bool connected, const Settings& settings) {
    LonePass occlude("imperfect_volumes.occlude", wall.scene, {{"rays", 64}, {"walk", "exact"}});
    occlude.in("opacity", wall.opacity).in("bits", wall.bits).with(settings);
    if (connected) occlude.in("fragments", wall.fragments);
    return occlude.out<ShGrid>("visibility").levels[0].coefficients[0]->downloadFloats(0);
  };
  const std::vector<float> boxes = open(false, {});
  CHECK(open(true, {{"stop", "box"}}) == boxes);
  CHECK(open(true, {{"stop", "plane"}}) != boxes);
}

TEST_CASE("planes without a walk to them, without fragments or on another grid are refused by name") {
  const Voxelized wall = slantedWall();
  const auto refusal = [&](const Settings& settings, const VoxelFragments* fragments) {
    return messageOf<Error>([&] {
      LonePass occlude("imperfect_volumes.occlude", wall.scene, settings);
      occlude.in("opacity", wall.opacity).in("bits", wall.bits);
      if (fragments) occlude.in("fragments", *fragments);
      occlude.run();
    });
  };
  CHECK_THAT(refusal({{"stop", "plane"}}, &wall.fragments), Tells("stop plane", "walk steps", "stop box"));
  CHECK_THAT(refusal(kPlanes, nullptr), Tells("occlude", "stop plane", "fragments"));
  const VoxelFragments coarse = fragmentsIn(wall.scene, {{"resolution", 8}});
  CHECK_THAT(refusal(kPlanes, &coarse), Tells("occlude", "bits", "fragments", "one grid"));
}

TEST_CASE("rays that end at planes occlude an arcade and a Cornell box better than steps and boxes do") {
  for (const auto& [name, picture] :
       {std::pair<const char*, Picture>("cornell", {64, 64}), {"arcade", {80, 45}}}) {
    const Scene scene = committed(name);
    const LayeredImage reference = referenceOf(scene, picture);
    const auto found = [&](const std::vector<std::string>& settings) {
      return occlusionAgainst(reference,
                              pictured(scene, picture, pipeline("imperfect_volumes_occlusion"), settings)
                                  .outputs.at("ambient_occlusion"))
          .rmse;
    };
    const double steps = found({}), boxes = found({"walk=exact"}),
                 planes = found({"walk=exact", "stop=plane", "guard=0"});
    CAPTURE(name, steps, boxes, planes);
    CHECK(planes < 0.9 * steps);
    CHECK(planes < 0.7 * boxes);
  }
}

// The table of the figures; seconds where the references are cached.
TEST_CASE("errors of occlusion by steps, boxes and planes within the voxels of imperfect volumes", "[.]") {
  KeptTable table("imperfect_volumes.planes", {{"steps", 3, 0.02},
                                               {"box", 3, 0.02},
                                               {"plane", 3, 0.02},
                                               {"ratio, steps", 2, 0.015},
                                               {"ratio, box", 2, 0.015},
                                               {"ratio, plane", 2, 0.015}});
  const std::vector<std::string> ways[] = {{}, {"walk=exact"}, {"walk=exact", "stop=plane", "guard=0"}};
  for (const char* name : {"cornell", "cornell_glossy", "corridor", "arcade", "spinning_box", "sibenik",
                           "untuned/court", "untuned/room"}) {
    const Scene scene = committed(name);
    const Picture picture = name == std::string("arcade") ? Picture{80, 45, 1024} : Picture{64, 64, 1024};
    const LayeredImage reference = referenceOf(scene, picture);
    std::vector<Against> found;
    for (const auto& settings : ways)
      found.push_back(occlusionAgainst(
          reference, pictured(scene, picture, pipeline("imperfect_volumes_occlusion"), settings)
                         .outputs.at("ambient_occlusion")));
    table.row(name,
              {found[0].rmse, found[1].rmse, found[2].rmse, found[0].ratio, found[1].ratio, found[2].ratio});
    CAPTURE(name);
    CHECK(found[2].rmse < found[1].rmse);
  }
}
