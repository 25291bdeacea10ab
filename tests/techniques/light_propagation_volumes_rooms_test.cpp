#include <algorithm>
#include <cmath>

#include "support/light_cells.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// One grid of 32 cells before the propagation, from surface samples with this many voxels along a side.
LitCells injected(const Scene& scene, const std::string& pass, int voxelResolution = 0) {
  LonePass inject("light_propagation_volumes." + pass, scene, {{"levels", 1}, {"resolution", 32}});
  inject.in("fragments",
            fragmentsIn(scene, voxelResolution > 0 ? Settings{{"resolution", voxelResolution}} : Settings{}));
  if (pass == "inject_rsm")
    inject.in(
        "map",
        LonePass("reflective_shadow_maps.render", scene, {{"size", 512}}).out<ReflectiveShadowMap>("map"));
  else
    inject.in("shadow", shadowsOf(scene));
  return {inject.out<ShGrid>("light"), inject.out<OccludedFaces>("faces")};
}

/// The red coefficients.
Cells injectedLight(const Scene& scene, const std::string& pass) {
  return injected(scene, pass).levels[0].coefficients[0]->downloadFloats(0);
}

/// A closed box, anywhere in a larger grid.
struct ClosedRoom {
  explicit ClosedRoom(float shift)
      : low(-0.4f + shift, -0.37f + shift, -0.41f - shift), high(0.41f - shift, 0.39f + shift, 0.36f) {
    builder.box(low, high, builder.lambert(0.8f), true);
    // Gives the grid room around the box.
    for (const float corner : {-1.5f, 1.5f})
      builder.quad(glm::vec3(corner), {0, 0, 0.001f}, {0.001f, 0, 0}, builder.lambert(0.0f));
  }
  glm::vec3 middle() const { return 0.5f * (low + high); }

  /// Sums of the first coefficients of the cells with their centres inside, and of the others.
  std::pair<double, double> insideAndOutside(const ShGrid::Level& level) const {
    const Cells cells = level.coefficients[0]->downloadFloats(0);
    const glm::vec3 origin(snapshotOf(builder.scene, 0.0).origin);
    const glm::ivec3 size = level.grid.resolution;
    double inside = 0.0, outside = 0.0;
    std::size_t i = 0;
    for (int z = 0; z < size.z; ++z)
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x, i += 4) {
          const glm::vec3 centre =
              origin + level.grid.low + (glm::vec3(x, y, z) + 0.5f) * level.grid.voxelSize;
          const bool within =
              glm::all(glm::greaterThan(centre, low)) && glm::all(glm::lessThan(centre, high));
          (within ? inside : outside) += std::abs(static_cast<double>(cells[i]));
        }
    return {inside, outside};
  }

  SceneBuilder builder;
  glm::vec3 low, high;
};

/// Walls anywhere in their cells, so that each is moved by up to half a cell, and ends where the others truly
/// are.
constexpr float kShifts[] = {0.0f, 0.011f, 0.023f, 0.037f, 0.049f};

}  // namespace

TEST_CASE("both injections give a lit plane the flux albedo E cos A, in integers: the same bits twice") {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.6f));
  builder.quad({-1, 1, -1}, {0, 0, 0.001f}, {0.001f, 0, 0},
               builder.lambert(0.0f));  // gives the grid its height
  builder.light(LightKind::directional, glm::vec3(3.0f), {}, {0.3, -1, 0.2});
  const double cosine = 1.0 / std::sqrt(1.0 + 0.09 + 0.04);
  for (const char* name : {"inject_rsm", "inject_voxels"}) {
    INFO(name);
    const Cells light = injectedLight(builder.scene, name);
    CHECK(energy(light) == Approx(0.6 * 3.0 * cosine * 4.0).epsilon(0.03));
    CHECK(light == injectedLight(builder.scene, name));
  }
}

TEST_CASE("light in the middle of a closed room stays in it, wherever its walls lie between the cells") {
  for (const float shift : kShifts) {
    INFO("shift " << shift);
    const ClosedRoom room(shift);
    LitCells light = injected(room.builder.scene, "inject_rsm", 64);
    ShGrid::Level& level = light.levels[0];
    const SceneSnapshot snapshot = snapshotOf(room.builder.scene, 0.0);
    const glm::ivec3 size = level.grid.resolution,
                     middle((room.middle() - glm::vec3(snapshot.origin) - level.grid.low) /
                            level.grid.voxelSize);
    Cells cells(static_cast<std::size_t>(4 * size.x * size.y * size.z), 0.0f);
    cells[static_cast<std::size_t>(4 * ((middle.z * size.y + middle.y) * size.x + middle.x))] = 1.0f;
    for (const gpu::TextureRef& texture : level.coefficients) texture->uploadFloats(0, cells);
    const auto [inside, outside] =
        room.insideAndOutside(Propagation(room.builder.scene).run(light).grid("light").levels[0]);
    CHECK(inside > 1.0);
    CHECK(outside <= 1e-6 * inside);
  }
}

TEST_CASE("what the walls of a closed room reflect starts inside of it, along its edges too") {
  for (const char* pass : {"inject_rsm", "inject_voxels"})
    for (const float shift : kShifts) {
      INFO(pass << ", shift " << shift);
      ClosedRoom room(shift);
      room.builder.light(LightKind::point, glm::vec3(1.0f), glm::dvec3(room.middle()));
      const auto [inside, outside] = room.insideAndOutside(injected(room.builder.scene, pass, 64).levels[0]);
      CHECK(inside > 1.0);
      CHECK(outside <= 1e-6 * inside);
    }
}

TEST_CASE("cells that a dim area light lights keep their light beside an area light 10^6 times as bright") {
  const auto scene = [](float bright) {
    SceneBuilder builder = floorUnderTwoSpots(bright);
    // Gives the grid its height.
    builder.quad({-1, 1, -1}, {0, 0, 0.001f}, {0.001f, 0, 0}, builder.lambert(0.0f));
    return builder.scene;
  };
  for (const char* name : {"inject_rsm", "inject_voxels"}) {
    INFO(name);
    const Cells alone = injectedLight(scene(0.0f), name), both = injectedLight(scene(1e6f), name);
    REQUIRE(alone.size() == both.size());
    const float brightest = *std::max_element(alone.begin(), alone.end());
    int lit = 0;
    for (std::size_t i = 0; i < alone.size(); i += 4) {
      if (alone[i] < 1e-3f * brightest) continue;
      ++lit;
      CHECK(both[i] == Approx(alone[i]).epsilon(1e-5));
    }
    CHECK(lit > 8);
    CHECK(*std::max_element(both.begin(), both.end()) > 1e5f * brightest);
  }
}

TEST_CASE(
    "light on a wall at a slant has no jumps where the wall goes from cell to cell, and no dark rim at its edges") {
  const float slope = GENERATE(0.06f, 0.25f, 0.4f);
  INFO("slope " << slope);
  SceneBuilder builder;
  builder.box({-1, -1, -1}, {1, 1, 1}, builder.lambert(0.7f), true);
  builder.quad({-1, -1, -0.7f}, {2, 0, 2.0f * slope}, {0, 2, 0}, builder.lambert(0.7f));
  builder.light(LightKind::point, glm::vec3(1.0f), {0.3, 0.6, 0.6});
  // One row of pixels, two milliradians each, from wall to wall: a cell of 9 cm is some thirty pixels wide.
  constexpr int kWidth = 800;
  builder.look({0, 0.1, 0.9}, {0, 0.1, -1}, {0, 1, 0}, 0.002, kWidth, 1);
  for (const char* name : {"light_propagation_volumes", "light_propagation_volumes_voxels"}) {
    const Pipeline text = pipeline(name);
    const ImageBuffer row = rendered(builder.scene, text, {"levels=1", "resolution=24", "surfaces=48"})
                                .outputs.at("indirect_diffuse");
    std::vector<float> values;
    for (int x = 0; x < kWidth; ++x) values.push_back(row.at(x, 0, 0));
    std::vector<float> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    const float median = sorted[sorted.size() / 2];
    float jump = 0.0f;
    for (std::size_t x = 101; x < 700; ++x) jump = std::max(jump, std::abs(values[x] - values[x - 1]));
    INFO(name << ": largest jump " << jump / median << " of the median, darkest " << sorted.front() / median);
    CHECK(median > 0.0f);
    CHECK(jump < 0.05f * median);
    // At the steepest wall a strip of a third of a cell in its acute corner is darker: what lies between two
    // walls that were both moved is known for one of them alone.
    CHECK(sorted.front() > (slope < 0.3f ? 0.3f : 0.1f) * median);
  }
}
