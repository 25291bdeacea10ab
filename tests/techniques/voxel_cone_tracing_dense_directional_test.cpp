// Six directional grids and octrees of six faces: their levels, their injection and the cones through them,
// in closed form.
#include <algorithm>
#include <cmath>

#include "support/stores.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::cones;
using Catch::Matchers::Contains;

namespace {

constexpr int kHigherX = 0, kLowerX = 1, kHigherY = 2, kLowerY = 3, kHigherZ = 4;

void checkNear(const glm::vec4& value, const glm::vec4& expected, double tolerance = 1e-5) {
  for (int c = 0; c < 4; ++c) CHECK(value[c] == Approx(expected[c]).margin(tolerance));
}

/// Walls of one voxel around everything but an empty margin; opaque along the axes that a wall faces, or
/// along all of them.
glm::vec3 wallOpacity(int resolution, int x, int y, int z, bool alongAll) {
  const glm::ivec3 at(x, y, z);
  glm::vec3 opacity(0.0f);
  for (int axis = 0; axis < 3; ++axis)
    if (at[axis] < 1 || at[axis] > resolution - 2) return glm::vec3(0.0f);
  for (int axis = 0; axis < 3; ++axis)
    if (at[axis] == 1 || at[axis] == resolution - 2) opacity[axis] = 1.0f;
  return alongAll && opacity != glm::vec3(0.0f) ? glm::vec3(1.0f) : opacity;
}

}  // namespace

TEST_CASE("children of a column are composited as seen from each side, and the four columns are averaged") {
  // One coarse voxel. Along x the column at y = z = 0 holds (red, half opaque) before (green, opaque); a
  // second one green alone; the other two are empty.
  const auto fill = [](int, int x, int y, int z) -> glm::vec4 {
    if (z != 0 || x > 1 || y > 1) return glm::vec4(0.0f);
    if (y == 0) return x == 0 ? glm::vec4(0.5f, 0, 0, 0.5f) : glm::vec4(0, 1, 0, 1);
    return x == 1 ? glm::vec4(0, 1, 0, 1) : glm::vec4(0.0f);
  };
  const auto check = [](const auto& store, const char* name) {
    CAPTURE(name);
    const auto at = [&](int face) { return voxelsOf(store, face, 1).at({0, 0, 0}); };
    // From below: 0.5 red, then half of green; from above: green alone. The mean with the second column, / 4.
    checkNear(at(kLowerX), {0.125f, 0.375f, 0, 0.5f});
    checkNear(at(kHigherX), {0, 0.5f, 0, 0.5f});
    // Along y: the column of red has 0.5, that of green is green twice; from both sides alike.
    checkNear(at(kLowerY), {0.125f, 0.25f, 0, 0.375f});
    checkNear(at(kHigherY), {0.125f, 0.25f, 0, 0.375f});
    // Along z: red 0.5, green, nothing, green in four columns.
    checkNear(at(kHigherZ), {0.125f, 0.5f, 0, 0.625f});
  };
  const DirectionalRadianceGrid six = filteredDirections(makeDirections(2, fill));
  CHECK(six.filledLevels == 2);
  check(six, "six grids");
  check(filteredDirections(makeGrid(2, [&](int x, int y, int z) { return fill(0, x, y, z); })), "coarse");
  check(octree::octreeOf(4, fill), "octree");
}

TEST_CASE("each side of a wall with two coats of paint keeps its colour and closes at every level") {
  // The red-green wall of thesis Sec. 3.1.3: two layers of voxels in one coarser one. A mean of the children
  // is half of each colour.
  constexpr int kResolution = 32;
  const auto paint = [](int, int x, int, int) {
    return x == 16 ? glm::vec4(1, 0, 0, 1) : x == 17 ? glm::vec4(0, 1, 0, 1) : glm::vec4(0.0f);
  };
  const auto check = [](const auto& store, const char* name) {
    for (int level = 1; level < 5; ++level) {
      CAPTURE(name, level);
      const auto lower = voxelsOf(store, kLowerX, level), higher = voxelsOf(store, kHigherX, level);
      const auto side = static_cast<std::size_t>(kResolution >> level);
      CHECK(lower.size() == side * side);
      for (const auto& [voxel, value] : lower) {
        CHECK(voxel[0] == 16 >> level);
        checkNear(value, {1, 0, 0, 1});
        checkNear(higher.at(voxel), {0, 1, 0, 1});
      }
    }
    if (name == std::string("coarse")) return;
    // Narrow cones from either side see one coat.
    for (const float from : {-1.0f, 1.0f})
      for (const float tilt : {0.0f, 1.0f}) {
        const glm::vec3 seen =
            alongNormal(store, {0.03f + 0.4f * from, 0, 0}, {-from, tilt, 0.3f * tilt}, 400.0f, {});
        CAPTURE(name, from, tilt);
        CHECK((from < 0 ? seen.r : seen.g) == Approx(1.0).epsilon(1e-3));
        CHECK((from < 0 ? seen.g : seen.r) < 1e-3f);
      }
  };
  const auto one = [&](int x, int y, int z) { return paint(0, x, y, z); };
  check(filteredDirections(makeDirections(kResolution, paint)), "six grids");
  check(filteredDirections(makeGrid(kResolution, one)), "coarse");
  check(octree::octreeOf(kResolution, paint), "octree");
  const std::vector<float> mixed = filtered(makeGrid(kResolution, one)).radiance->downloadFloats(1);
  CHECK(mixed[4 * 8] == Approx(0.5).epsilon(1e-5));
  CHECK(mixed[4 * 8 + 1] == Approx(0.5).epsilon(1e-5));
}

TEST_CASE("one wall of one sheet, lit on one side, shines to that side alone") {
  SceneBuilder builder;
  const int grey = builder.lambert(0.6f);
  builder.quad({0.02f, -1, -1}, {0, 2, 0}, {0, 0, 2}, grey);       // normal +x
  builder.quad({-1, -1, -1}, {0, 0, 0.01f}, {0, 0.01f, 0}, grey);  // gives the grid its depth
  builder.quad({1, 1, 1}, {0, 0, -0.01f}, {0, -0.01f, 0}, grey);
  for (const float side : {-1.0f, 1.0f}) {
    SceneBuilder lit = builder;
    lit.light(LightKind::directional, {3, 3, 3}, {}, {-side, 0, 0});
    const DirectionalRadianceGrid grid = injectedDirections(lit.scene, 16);
    const glm::ivec3 size = grid.grid.resolution;
    const int x = static_cast<int>((0.02f - grid.grid.low.x) / grid.grid.voxelSize);
    const glm::ivec3 voxel(x, size.y / 2 - 2, size.z / 2 - 2);
    const float bright = static_cast<float>(0.6 / kPi * 3.0);
    INFO("lit from side " << side);
    checkNear(faceAt(grid, kHigherX, 0, voxel), {glm::vec3(side > 0 ? bright : 0.0f), 1.0f}, 2e-3);
    checkNear(faceAt(grid, kLowerX, 0, voxel), {glm::vec3(side < 0 ? bright : 0.0f), 1.0f}, 2e-3);
    // Along the sheet nothing is in the way.
    CHECK(faceAt(grid, kHigherY, 0, voxel).a < 1e-3f);
    CHECK(faceAt(grid, kHigherZ, 0, voxel).a < 1e-3f);
    // A sheet's back is dark where backs have no weight.
    InjectSettings fronts;
    fronts.backWeight = 0.0;
    const DirectionalRadianceGrid oneSided = injectedDirections(lit.scene, 16, fronts);
    CHECK((faceAt(oneSided, kLowerX, 0, voxel).r > 0.0f) == false);
    CHECK((faceAt(oneSided, kHigherX, 0, voxel).r > 0.0f) == (side > 0));
    // As published, light on the back of a triangle does not count.
    InjectSettings front;
    front.twoSided = false;
    const DirectionalRadianceGrid published = injectedDirections(lit.scene, 16, front);
    CHECK((faceAt(published, kLowerX, 0, voxel).r > 0.0f) == false);
    CHECK((faceAt(published, kHigherX, 0, voxel).r > 0.0f) == (side > 0));
  }
}

TEST_CASE("the two faces of a thin wall in one voxel keep what each reflects, and their insides stay dark") {
  // Half a voxel thick. The insides are in the shadow of the faces; they may take 1/256 of the weight.
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  constexpr float kThick = 0.06f;
  builder.box({0.01f, -1, -1}, {0.01f + kThick, 1, 1}, grey, false);
  builder.quad({-1, -1, -1}, {0, 0, 0.01f}, {0, 0.01f, 0}, grey);
  builder.quad({1, 1, 1}, {0, 0, -0.01f}, {0, -0.01f, 0}, grey);
  builder.light(LightKind::directional, {4, 4, 4}, {}, {-1, 0, 0});
  builder.light(LightKind::directional, {1, 1, 1}, {}, {1, 0, 0});
  const DirectionalRadianceGrid grid = injectedDirections(builder.scene, 16);
  const float where = (0.01f - grid.grid.low.x) / grid.grid.voxelSize,
              end = (0.01f + kThick - grid.grid.low.x) / grid.grid.voxelSize;
  REQUIRE(std::floor(where) == std::floor(end));
  const glm::ivec3 voxel(static_cast<int>(where), 6, 6);
  CHECK(faceAt(grid, kHigherX, 0, voxel).r == Approx(0.5 / kPi * 4.0).epsilon(0.006));
  CHECK(faceAt(grid, kLowerX, 0, voxel).r == Approx(0.5 / kPi * 1.0).epsilon(0.006));
  CHECK(faceAt(grid, kHigherX, 0, voxel).a == 1.0f);
  // Where backs count as much as fronts, half of what a face reflects is that of a dark inside.
  InjectSettings alike;
  alike.backWeight = 1.0;
  const DirectionalRadianceGrid mixed = injectedDirections(builder.scene, 16, alike);
  CHECK(faceAt(mixed, kHigherX, 0, voxel).r == Approx(0.25 / kPi * 4.0).epsilon(0.006));
  CHECK(faceAt(mixed, kLowerX, 0, voxel).r == Approx(0.25 / kPi * 1.0).epsilon(0.006));
  // Along the wall it is open; closed along all axes it is not.
  CHECK(faceAt(grid, kHigherY, 0, voxel).a < 1e-3f);
  alike.opaqueAlong = "all";
  CHECK(faceAt(injectedDirections(builder.scene, 16, alike), kHigherY, 0, voxel).a == 1.0f);
}

TEST_CASE("a closed box of uniform radiance gives it back, by whatever cones and at whatever resolution") {
  for (const bool alongAll : {false, true})
    for (const int resolution : {32, 64, 128}) {
      const DirectionalRadianceGrid grid =
          filteredDirections(makeDirections(resolution, [&](int face, int x, int y, int z) {
            return glm::vec4(wallOpacity(resolution, x, y, z, alongAll)[face / 2]);
          }));
      for (const int cones : {6, 64}) {
        double sum = 0.0;
        constexpr int kPlaces = 4;  // along the diagonal of the floor, and on its edge
        for (int place = 0; place < kPlaces; ++place) {
          const float along = -0.8f + 0.4f * static_cast<float>(place);
          const glm::vec3 position(along, -1.0f + 3.0f / static_cast<float>(resolution), 0.5f * along);
          GatherSettings settings{cones, "cosine", 1, 1, 0, 0.5};
          settings.refinement = 0;
          sum += gather(emptyScene(), grid, position, {0, 1, 0}, settings).r / kPlaces;
        }
        INFO(resolution << " voxels, " << cones << " cones, opaque along all axes: " << alongAll << ": "
                        << sum);
        CHECK(sum > 0.999);
        CHECK(sum < 1.00001);
      }
    }
}

TEST_CASE("a wall lets nothing through by layers, and exp(-2) straight on filtered along all axes") {
  // By fine steps du across it the opacity that is read is 1 - |u|, and 2 int_0^1 -ln u du = 2.
  const DirectionalRadianceGrid grid = filteredDirections(makeDirections(64, [](int face, int x, int, int) {
    return glm::vec4(0, 0, 0, x == 40 && face / 2 == 0 ? 1.0f : 0.0f);
  }));
  const glm::vec3 behind(1.0f);
  GatherSettings settings;
  for (const double step : {0.05, 0.5})
    for (const float tilt : {0.0f, 0.5f, 1.0f})
      for (const float exponent : {100.0f, 1e5f}) {
        settings.step = step;
        INFO("step " << step << ", tilt " << tilt << ", exponent " << exponent);
        CHECK(alongNormal(grid, glm::vec3(0.0f), {1, tilt, 0}, exponent, settings, behind).r < 1e-3f);
      }
  settings.reading = "interpolated";
  settings.step = 0.05;
  CHECK(alongNormal(grid, glm::vec3(0.0f), {1, 0, 0}, 1e5f, settings, behind).r ==
        Approx(std::exp(-2.0)).epsilon(0.1));
}

TEST_CASE("a single lit voxel down narrow cones brings its solid angle over that of the cones") {
  // A face of one voxel, 24 voxels away, and cones whose discs there are wider. Filtering spreads the face,
  // and one axis sees more of it than another; over axes one voxel apart the shares sum to the face's area
  // over the voxel's, which is 1, when each share is that of the face in a kernel whose mean is its solid
  // angle over that of the cone.
  constexpr int kResolution = 64, kAxes = 14;
  const DirectionalRadianceGrid grid =
      filteredDirections(makeDirections(kResolution, [](int face, int x, int y, int z) {
        return glm::vec4(x == 56 && y == 32 && z == 32 && face / 2 == 0 ? 1.0f : 0.0f);
      }));
  const float voxel = 2.0f / kResolution;
  for (const double radius : {1.0, 2.0}) {  // voxels
    const double cosine = 24.5 / std::hypot(24.5, radius), exponent = 1.0 / (1.0 - cosine) - 1.0;
    GatherSettings settings;
    settings.clearance = 1000;
    settings.step = 0.1;
    double sum = 0.0;
    for (int i = 0; i < kAxes; ++i)
      for (int j = 0; j < kAxes; ++j) {
        const glm::vec3 apex(0.0f, (static_cast<float>(i) - 6.3f) * voxel,
                             (static_cast<float>(j) - 6.3f) * voxel);
        sum += alongNormal(grid, apex, {1, 0, 0}, static_cast<float>(exponent), settings).r;
      }
    INFO("disc of " << radius << " voxels: sum over the axes " << sum);
    CHECK(sum == Approx(1.0).epsilon(0.10));
  }
}

TEST_CASE("opacity is the same from both sides of an axis at every level") {
  SceneBuilder builder;
  builder.box({-1, -1, -1}, {1, 1, 1}, builder.lambert(0.6f), true);
  builder.quad({-0.5f, -0.5f, 0}, {1, 0.3f, 0.2f}, {0.1f, 0.2f, 0.9f}, builder.lambert(0.3f));
  const DirectionalRadianceGrid grid = filteredDirections(injectedDirections(builder.scene, 24));
  for (int axis = 0; axis < 3; ++axis)
    for (int level = 0; level < grid.filledLevels; ++level) {
      const auto face = static_cast<std::size_t>(2 * axis);
      const std::vector<float> higher = grid.faces[face]->downloadFloats(level),
                               lower = grid.faces[face + 1]->downloadFloats(level);
      for (std::size_t i = 3; i < higher.size(); i += 4) CHECK(higher[i] == Approx(lower[i]).margin(1e-5));
    }
}

TEST_CASE("cones take exactly one store, and say which are there") {
  const Scene scene = emptyScene();
  const auto message = [&](bool grid, bool directions) {
    PassHarness harness(device(), techniques(), "voxel_cone_tracing", "gather", scene,
                        snapshotOf(scene, 0.0));
    harness.setInput("gbuffer", surfacePoint(glm::vec3(0.0f), {0, 1, 0}, glm::vec3(1.0f)));
    if (grid) harness.setInput("grid", uniformGrid(4, glm::vec4(0.0f)));
    if (directions)
      harness.setInput("directions", makeDirections(4, [](int, int, int, int) { return glm::vec4(0.0f); }));
    try {
      harness.run();
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK_THAT(message(false, false), Contains("no store"));
  CHECK_THAT(message(true, true), Contains("several stores") && Contains("'directions'"));
  CHECK(message(true, false).empty());

  PassHarness filter(device(), techniques(), "voxel_cone_tracing", "filter_directional", scene,
                     snapshotOf(scene, 0.0));
  CHECK_THROWS_WITH(filter.run(), Contains("no finest level"));
}
