// The technique against the reference of the boxes, which knows the same bits and the same map and nothing
// else of it: what they differ by is noise.
#include "lumivox/measure/metrics.h"
#include "lumivox/reference/path_tracer.h"
#include "lumivox/reference/voxel_transport.h"
#include "support/kept_table.h"
#include "support/near_field_scene.h"
#include "support/scene_builder.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::near_field;

namespace {

struct Transported {
  Seen seen;
  std::vector<BoxLight> boxes;
  std::vector<float> arriving, open, albedo;
};

/// One bounce and occlusion by both, of a scene whose camera sees so many pixels along each side.
Transported transported(const std::string& name, int resolution, int side, int mapScale, int rays,
                        int samples) {
  Transported result{Seen(name, resolution, side), {}, {}, {}, {}};
  const Seen& seen = result.seen;
  LonePass lights("reflective_shadow_maps.render", seen.scene,
                  {{"size", 256 * mapScale}, {"area_size", 64 * mapScale}});
  const auto& map = lights.out<ReflectiveShadowMap>("map");
  LonePass gather("near_field_voxels.gather", seen.scene, {{"rays", rays}});
  gather.in("gbuffer", seen.gbuffer).in("bits", seen.bits).in("map", map);
  result.arriving = gather.floats("arriving");
  result.open = gather.floats("occlusion");
  result.albedo = seen.gbuffer.diffuse->downloadFloats(0);

  const GridPlacement& grid = seen.bits.grid;
  std::vector<glm::ivec3> voxels;
  for (const Cell& cell : cellsOf(seen.bits)) voxels.push_back({cell[0], cell[1], cell[2]});
  const std::vector<float> positions = seen.gbuffer.position->downloadFloats(0),
                           normals = seen.gbuffer.normal->downloadFloats(0),
                           geometric = seen.gbuffer.geometricNormal->downloadFloats(0);
  std::vector<BoxStart> starts(positions.size() / 4);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (positions[4 * i + 3] == 0.0f) continue;
    const auto at = [&](const std::vector<float>& values) {
      return glm::dvec3(values[4 * i], values[4 * i + 1], values[4 * i + 2]);
    };
    const glm::dvec3 normal = at(geometric), sides = glm::abs(normal);
    starts[i].place = at(positions) + grid.voxelSize * (sides.x + sides.y + sides.z + 1.0 / 16.0) * normal;
    starts[i].normal = glm::normalize(at(normals));
  }
  const MapOnHost onHost(map);
  BoxTransport transport;
  transport.environment = seen.scene.environment;
  transport.samples = samples;
  transport.occlusionDistance = ambientOcclusionDistance(seen.snapshot.bounds);
  transport.radiance = [&](const BoxHit& hit) {
    return onHost.radianceAt(hit.middle(), -hit.direction, grid.voxelSize);
  };
  result.boxes = transportThroughBoxes(VoxelBoxes(voxels, grid), starts, transport);
  return result;
}

}  // namespace

TEST_CASE("gathering differs from the reference of the boxes by noise alone") {
  for (const char* name : {"cornell", "arcade"}) {
    const Transported both = transported(name, 64, 16, 1, 4096, 4096);
    int compared = 0, within = 0, openWithin = 0;
    double sum = 0.0, right = 0.0, openSum = 0.0, openRight = 0.0;
    for (std::size_t i = 0; i < both.boxes.size(); ++i) {
      const BoxLight& box = both.boxes[i];
      for (int c = 0; c < 3; ++c) {
        const double value = both.arriving[4 * i + static_cast<std::size_t>(c)];
        sum += value, right += box.arriving[c];
        ++compared;
        // Both have the noise of as many rays: 3 standard errors of their difference; and rounding, where
        // there is no noise.
        within += std::abs(value - box.arriving[c]) <=
                  3.0 * std::sqrt(2.0 * box.variance[c]) + 1e-5 * box.arriving[c] + 1e-9;
      }
      const double open = both.open[4 * i];
      openSum += open, openRight += box.open;
      openWithin += std::abs(open - box.open) <= 3.0 * std::sqrt(2.0 * box.openVariance) + 1e-5;
    }
    CAPTURE(name, 1.0 * within / compared, sum / right, openSum / openRight);
    CHECK(within >= 0.99 * compared);
    CHECK(sum / right == Approx(1.0).epsilon(0.003));
    CHECK(3 * openWithin >= 0.99 * compared);
    CHECK(openSum / openRight == Approx(1.0).epsilon(0.003));
  }
}

// The three differences of the card; minutes.
TEST_CASE("the differences between technique, boxes and triangles", "[.]") {
  constexpr int kSide = 32;
  KeptTable table(
      "near_field_voxels.differences",
      {{"technique to boxes", 3, 0.01}, {"boxes to triangles", 3, 0.01}, {"with larger maps", 3, 0.01}});
  for (const char* name : {"cornell", "arcade"}) {
    const Scene scene = committed(name);
    ReferenceOptions options = quietly(1024, 1);
    options.width = options.height = kSide;
    options.useCache = true;
    const LayeredImage reference = cachedReference(scene, options);
    const ImageBuffer& triangles = reference.layers.at("one_bounce_diffuse");
    for (const int resolution : {32, 64, 128, 256}) {
      const auto errors = [&](int mapScale) {
        const Transported both = transported(name, resolution, kSide, mapScale, 1024, 1024);
        double none = 0.0, technique = 0.0, discretisation = 0.0;
        for (std::size_t i = 0; i < both.boxes.size(); ++i)
          for (int c = 0; c < 3; ++c) {
            const std::size_t k = 4 * i + static_cast<std::size_t>(c);
            const double truth = triangles.values()[3 * i + static_cast<std::size_t>(c)],
                         boxes = both.albedo[k] * both.boxes[i].arriving[c],
                         ours = both.albedo[k] * both.arriving[k];
            none += truth * truth;
            technique += (ours - boxes) * (ours - boxes);
            discretisation += (boxes - truth) * (boxes - truth);
          }
        return std::pair(std::sqrt(technique / none), std::sqrt(discretisation / none));
      };
      const auto [noise, boxes] = errors(1);
      const double withLargeMaps = errors(4).second;
      // Voxels make the error, neither noise nor the maps.
      CHECK(noise < boxes);
      CHECK(withLargeMaps == Approx(boxes).epsilon(0.1));
      table.row(std::string(name) + ", " + std::to_string(resolution) + " voxels",
                {noise, boxes, withLargeMaps});
    }
  }
}
