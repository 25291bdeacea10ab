// What holds for every store alike: closed forms of dense grids beside those that the stores' own files test,
// and cameras where none is expected.
#include <algorithm>
#include <cmath>

#include "lumivox/measure/metrics.h"
#include "support/cones.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::cones;

namespace {

using Value = std::function<glm::vec4(const glm::ivec3&)>;

/// Calls `check` with one grid, one whose coarser levels have faces, and six, of the same voxels on all
/// sides.
template <class Check>
void forDenseStores(int resolution, const Value& value, const Check& check) {
  const RadianceGrid one =
      makeGrid(resolution, [&](int x, int y, int z) { return value(glm::ivec3(x, y, z)); });
  check(filtered(one), "one grid");
  check(filteredDirections(one), "coarse directional");
  check(filteredDirections(
            makeDirections(resolution, [&](int, int x, int y, int z) { return value(glm::ivec3(x, y, z)); })),
        "six grids");
}

const char* const kPipelines[] = {"voxel_cone_tracing",
                                  "voxel_cone_tracing_lobes",
                                  "voxel_cone_tracing_coarse_directional",
                                  "voxel_cone_tracing_directional",
                                  "voxel_cone_tracing_octree",
                                  "voxel_cone_tracing_octree_directional",
                                  "voxel_cone_tracing_clipmap"};

ImageBuffer indirectLight(const Scene& scene, const char* name) {
  RenderOptions options;
  options.width = options.height = 16;
  const Pipeline text = pipeline(name);
  options.parameters = text.settings({"resolution=32"});
  return renderOnce(scene, text, options).outputs.at("indirect_diffuse");
}

/// A pipeline through one grid, through another store.
struct Store {
  const char *name, *finest, *filled, *input;
};
const Store kStores[] = {
    {"six grids", "voxel_cone_tracing.inject_directional { fragments voxels.fragments $ }",
     "voxel_cone_tracing.filter_directional { radiance finest.radiance }", "directions"},
    {"coarse directional", "voxel_cone_tracing.inject { fragments voxels.fragments $ }",
     "voxel_cone_tracing.filter_directional { finest finest.radiance }", "directions"},
    {"octree", "voxel_cone_tracing.octree_inject { fragments voxels.fragments tree tree.tree $ }",
     "voxel_cone_tracing.octree_filter { radiance finest.radiance }", "octree"},
    {"octree of six faces",
     "voxel_cone_tracing.octree_inject { fragments voxels.fragments tree tree.tree faces six $ }",
     "voxel_cone_tracing.octree_filter { radiance finest.radiance }", "octree"},
    {"clipmap", "voxel_cone_tracing.clipmap { resolution 64 levels 1 $ }",
     "voxel_cone_tracing.clipmap_filter { radiance finest.radiance }", "clipmap"}};

ImageBuffer directLight(const Scene& scene, const std::string& tracing, const std::string& injecting,
                        const Store* store) {
  const Store one{"one grid", "voxel_cone_tracing.inject { fragments voxels.fragments $ }",
                  "voxel_cone_tracing.filter { radiance finest.radiance }", "grid"};
  if (store == nullptr) store = &one;
  std::string finest = store->finest;
  finest.replace(finest.find('$'), 1, injecting);
  const std::string source =
      "pipeline \"p\" {\n  pass gbuffer direct_lighting.gbuffer { }\n"
      "  pass shadow direct_lighting.shadow_map { }\n  pass lights voxel_cone_tracing.lights { }\n"
      "  pass voxels voxelization.conservative { resolution 64 }\n"
      "  pass tree voxel_cone_tracing.octree { fragments voxels.fragments }\n"
      "  pass finest " +
      finest + "\n  pass grid " + store->filled + "\n  pass direct " + tracing + " " + store->input +
      " grid.mips }\n  output direct direct.radiance\n}\n";
  RenderOptions options;
  options.width = options.height = 32;
  return renderOnce(scene, Pipeline::parse(source, "p.pipeline"), options).outputs.at("direct");
}

}  // namespace

TEST_CASE("narrow cones all around a single lit voxel bring its solid angle, in every dense store") {
  // Through the points of a plane in the middle of the voxel: each stands for the solid angle of its part of
  // the plane. A face of s^2 at a distance d subtends s^2 / d^2.
  constexpr int kResolution = 64, kSide = 11;
  const double size = 2.0 / kResolution, reach = 2.5 * size;
  const glm::dvec3 middle = (glm::dvec3(52, 32, 32) + 0.5) * size - 1.0;
  const Value value = [](const glm::ivec3& at) {
    return glm::vec4(at == glm::ivec3(52, 32, 32) ? 1.0f : 0.0f);
  };
  forDenseStores(kResolution, value, [&](const auto& store, const char* name) {
    double sum = 0.0;
    for (int i = 0; i < kSide * kSide; ++i) {
      const glm::dvec2 plane = (glm::dvec2(i % kSide, i / kSide) + 0.5) * (2.0 * reach / kSide) - reach;
      const glm::dvec3 to(middle.x, middle.y + plane.x, middle.z + plane.y);
      const glm::vec3 seen =
          alongNormal(store, glm::vec3(0.0f), glm::vec3(to), 4000.0f, {1, "cosine", 0, 0, 0, 0.25});
      const double distance = glm::length(to), cosine = to.x / distance;
      sum += seen.x * std::pow(2.0 * reach / kSide, 2) * cosine / (distance * distance);
    }
    CAPTURE(name);
    CHECK(sum == Approx(size * size / (middle.x * middle.x)).epsilon(0.10));
  });
}

TEST_CASE("a closed box of thick walls of uniform radiance gives it back within 3 %, in every dense store") {
  // Walls of an eighth of the grid: as thick as the voxels that 64 cones read across it. Sheets of one voxel
  // let exp(-2 / cos) through one grid.
  constexpr int kThick = 8;
  for (const int resolution : {32, 64}) {
    const Value wall = [&](const glm::ivec3& at) {
      const glm::ivec3 inner = glm::min(at, resolution - 1 - at);
      const int depth = std::min({inner.x, inner.y, inner.z});
      return depth >= 1 && depth <= resolution / kThick ? glm::vec4(0.5f, 0.5f, 0.5f, 1.0f) : glm::vec4(0.0f);
    };
    forDenseStores(resolution, wall, [&](const auto& store, const char* name) {
      for (const double refinement : {0.0, 0.5, 1.0})
        for (const int cones : {6, 64})
          for (const float along : {-0.5f, 0.0f, 0.4f}) {
            const glm::vec3 position(along, -1.0f + 2.0f / kThick + 2.5f / static_cast<float>(resolution),
                                     0.5f * along);
            GatherSettings settings{cones, "cosine", 1, 1, 0, 0.5};
            settings.refinement = refinement;
            const glm::vec3 radiance = gather(emptyScene(), store, position, {0, 1, 0}, settings);
            CAPTURE(name, resolution, refinement, cones, along);
            CHECK(radiance.x == Approx(0.5).epsilon(cones == 64 ? 0.03 : 0.05));
          }
    });
  }
}

TEST_CASE(
    "light is finite and smooth with the camera outside of a store, in a surface's voxels and far away") {
  const auto look = [](const glm::dvec3& eye) {
    SceneBuilder builder;
    builder.scene = litRoom(16, 16);
    const glm::dvec3 target(0.5, 0.6, 0.2);
    builder.look(eye, target, {0, 1, 0}, std::min(0.7, 1.2 / glm::length(eye - target)), 16, 16);
    return builder.scene;
  };
  const auto meanOf = [](const ImageBuffer& image) {
    double sum = 0.0;
    for (const float value : image.values()) {
      REQUIRE(std::isfinite(value));
      REQUIRE(value >= 0.0f);
      sum += value;
    }
    return sum / static_cast<double>(image.values().size());
  };
  for (const char* name : kPipelines)
    for (const glm::dvec3& eye :
         {glm::dvec3(0.7, 3, 50), glm::dvec3(0.5, 0.005, 0.5), glm::dvec3(300, 200, 400)}) {
      CAPTURE(name, eye.x, eye.y);
      const ImageBuffer here = indirectLight(look(eye), name),
                        moved = indirectLight(look(eye * (1.0 + 1e-6)), name);
      const double mean = meanOf(here);
      meanOf(moved);
      double difference = 0.0;
      for (std::size_t i = 0; i < here.values().size(); ++i)
        difference += std::abs(here.values()[i] - moved.values()[i]);
      difference /= static_cast<double>(here.values().size());
      // A step whose middle lies on the border of two layers of voxels falls to either side.
      CHECK(difference < 0.005 * mean);
    }
}

TEST_CASE("light far from the world's origin is that of the same scene at the origin, in every store") {
  const Scene here = loadScene(sourceDirectory() / "scenes/cornell.scene"),
              there = loadScene(sourceDirectory() / "scenes/stress/far_away.scene");
  for (const char* name : kPipelines) {
    CAPTURE(name);
    CHECK(compare(indirectLight(there, name), indirectLight(here, name)).flip < 0.003);
  }
}

TEST_CASE("soft shadows, and what a lens sees, are through every store what they are through one grid") {
  const Scene scene = loadScene(sourceDirectory() / "scenes/cornell.scene");
  const auto mean = [](const ImageBuffer& image) {
    double sum = 0.0;
    for (const float value : image.values()) sum += value;
    return sum / static_cast<double>(image.values().size());
  };
  struct Way {
    const char *tracing, *injecting;
    double energy,
        error;  // of the mean, for other stores than the octree, whose voxels are those of the grid
  };
  // A lamp in six grids shines to the side that it faces alone, and voxels have edges: of its light, which is
  // nearly all that the lens sees, a tenth lies elsewhere (of the octree's of six faces 0.107).
  for (const Way& way :
       {Way{"voxel_cone_tracing.soft_shadows { gbuffer gbuffer  lights lights.lights ", "", 0.003, 0.02},
        Way{"voxel_cone_tracing.lens { ", "shadow shadow.depth  emission on", 0.12, 1.0}}) {
    const ImageBuffer one = directLight(scene, way.tracing, way.injecting, nullptr);
    for (const Store& store : kStores) {
      CAPTURE(way.tracing, store.name);
      const ImageBuffer other = directLight(scene, way.tracing, way.injecting, &store);
      const bool same = store.name == std::string("octree");
      CHECK(mean(other) == Approx(mean(one)).epsilon(same ? 1e-5 : way.energy));
      CHECK(compare(other, one).rmse.value <= (same ? 1e-5 : way.error) * mean(one));
    }
  }
}
