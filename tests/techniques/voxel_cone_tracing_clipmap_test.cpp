// Levels of voxels around the camera: where they lie, what is in them, and the cones through them, in closed
// form and beside the dense grid.
#include <cmath>
#include <set>

#include "lumivox/measure/metrics.h"
#include "support/clipmap.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::cones;
using namespace lumivox::test::clipmap;
using Catch::Matchers::Contains;

namespace {

Scene cornell() {
  return loadScene(sourceDirectory() / "scenes/cornell.scene");
}

/// Levels of [-1,1]^3 in all and of less around the middle, finest voxels of 1/32.
const ClipmapSettings kThree{.resolution = 32, .levels = 3, .extent = 0.5};

}  // namespace

TEST_CASE("the example of a 6 x 6 clipmap that moves by (2,2): new voxels take the places of those left") {
  // Thesis Fig. 53: from the centre (3,3) to (5,5). In the third direction it stays.
  const VoxelRange before{{0, 0, 0}, {6, 6, 6}}, after{{2, 2, 0}, {8, 8, 6}};
  std::set<Cell> left, taken;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      const glm::ivec3 voxel(x, y, 0), address = VoxelRange::addressOf(voxel, 6);
      CHECK(address == glm::ivec3(x % 6, y % 6, 0));
      const Cell cell{address.x, address.y, address.z};
      if (before.contains(voxel) && !after.contains(voxel)) left.insert(cell);
      if (after.contains(voxel) && !before.contains(voxel)) taken.insert(cell);
    }
  CHECK(left.size() == 20);  // 36 - 16
  CHECK(left == taken);
  // The slabs are what is new, each voxel once.
  std::size_t voxels = 0;
  for (const VoxelRange& slab : after.without(before)) {
    CHECK_FALSE(slab.empty());
    for (int y = slab.first.y; y < slab.end.y; ++y)
      for (int x = slab.first.x; x < slab.end.x; ++x) {
        CHECK(after.contains({x, y, 0}));
        CHECK_FALSE(before.contains({x, y, 0}));
        ++voxels;
      }
    CHECK(slab.size().z == 6);
  }
  CHECK(voxels == 20);
  // Below 0 addresses go on.
  for (int i = -13; i < 13; ++i) CHECK(VoxelRange::addressOf(glm::ivec3(i), 6).x == ((i + 18) % 6));
  CHECK(after.without({{20, 20, 20}, {26, 26, 26}}) == std::vector<VoxelRange>{after});
  CHECK(after.without(after).empty());
}

TEST_CASE("one level over the whole scene is the dense directional grid, voxel by voxel, at every level") {
  const Scene scene = cornell();
  for (const char* precision : {"float", "half"})
    for (const int resolution : {32, 64}) {
      if (precision != std::string("float") && resolution != 32) continue;
      InjectSettings settings;
      settings.precision = precision;
      const DirectionalRadianceGrid dense =
          filteredDirections(injectedDirections(scene, resolution, settings));
      ClipmapSettings one{.resolution = resolution, .levels = 1};
      one.precision = precision;
      const RadianceClipmap clipmap = filtered(voxelized(scene, one));
      CHECK(clipmap.unit == dense.unit);
      CHECK(clipmap.voxelSize == dense.grid.voxelSize);
      for (int level = 0; (resolution >> level) >= 4; ++level)
        for (int face = 0; face < 6; ++face) {
          const glm::ivec3 size = levelResolution(dense.grid.resolution, level);
          const std::vector<float> texels =
              dense.faces[static_cast<std::size_t>(face)]->downloadFloats(level);
          std::map<Cell, glm::vec3> expected;
          for (int i = 0; i < size.x * size.y * size.z; ++i) {
            const float* texel = texels.data() + 4 * static_cast<std::size_t>(i);
            if (texel[3] > 0.0f)
              expected[{i % size.x, i / size.x % size.y, i / (size.x * size.y)}] =
                  dense.unit * glm::vec3(texel[0], texel[1], texel[2]);
          }
          CAPTURE(precision, resolution, level, face, expected.size());
          CHECK(expected.size() > 10);
          CHECK((voxelsOf(clipmap, level, face) == expected));
        }
    }
}

TEST_CASE("each level of several is the dense grid of its voxels where the finer ones do not reach") {
  // The coarsest level is the dense grid of 32 voxels, the next one a part of that of 64, and so on.
  Scene scene = cornell();
  scene.cameras.front().eye = {0.2, 0.3, 0.25};
  const RadianceClipmap clipmap = voxelized(scene, {.resolution = 32, .levels = 3});
  for (int level = 0; level < 3; ++level) {
    // Grids of one size in voxels are placed otherwise in finer ones: fragments are compared in the scene.
    const VoxelRange& range = clipmap.levels[static_cast<std::size_t>(level)].own.voxels;
    CHECK(range.size() == glm::ivec3(32));
    if (level > 0) {
      const VoxelRange& finer = clipmap.levels[static_cast<std::size_t>(level) - 1].own.voxels;
      CHECK(glm::all(glm::greaterThanEqual(finer.first, 2 * range.first)));
      CHECK(glm::all(glm::lessThanEqual(finer.end, 2 * range.end)));
    }
    CHECK(voxelsOf(clipmap, level, 6).size() > 200);
  }
  const DirectionalRadianceGrid dense = injectedDirections(scene, 32);
  const auto coarsest = voxelsOf(clipmap, 2, 2);
  std::size_t compared = 0;
  for (const auto& [cell, value] : coarsest) {
    const glm::vec4 expected = faceAt(dense, 2, 0, {cell[0], cell[1], cell[2]});
    CHECK(value == glm::vec3(expected) * dense.unit);
    ++compared;
  }
  CHECK(compared > 500);
}

TEST_CASE("a closed box whose walls all radiate L gives L back within 3 %, through all levels") {
  // A wall one coarsest voxel thick where all levels lie in it, and boxes in finer levels.
  for (const double wall : {0.9, 0.4, 0.2}) {
    const RadianceClipmap box =
        madeClipmap(kThree, glm::vec3(0.0f), [&](int level, const glm::vec3& at, int) {
          const double size = 0.5 / 32 * (1 << level);
          const glm::vec3 away = glm::abs(at);
          const double most = std::max({away.x, away.y, away.z});
          // The voxels that the shell from `wall` on, a coarsest voxel thick, touches.
          return most + 0.5 * size > wall && most - 0.5 * size < wall + 0.0625
                     ? glm::vec4(0.5f, 0.5f, 0.5f, 1.0f)
                     : glm::vec4(0.0f);
        });
    for (const int cones : {6, 64})
      for (const float along : {-0.5f, 0.0f, 0.4f}) {
        const auto height = static_cast<float>(-wall + 0.1);
        const glm::vec3 position(along * static_cast<float>(wall), height, 0.3f * static_cast<float>(wall));
        GatherSettings settings{cones, "cosine", 0, 0, 0, 0.5};
        settings.refinement = 0.0;
        const glm::vec3 radiance = gather(emptyScene(), box, position, {0, 1, 0}, settings);
        CAPTURE(wall, cones, along);
        CHECK(radiance.x == Approx(0.5).epsilon(0.03));
      }
  }
}

TEST_CASE("a coarse voxel is what its finer ones make of it in the middle, and as voxelized at the border") {
  // Finer voxels are red, coarser ones as voxelized green, all closed: the ramp is the share of red.
  const RadianceClipmap mixed =
      madeClipmap({.resolution = 32, .levels = 2, .extent = 1.0, .ramp = 0.5}, glm::vec3(0.0f),
                  [](int level, const glm::vec3&, int) {
                    return level == 0 ? glm::vec4(1, 0, 0, 1) : glm::vec4(0, 1, 0, 1);
                  });
  const auto voxels = voxelsOf(mixed, 1, 0);
  const VoxelRange& range = mixed.levels[1].own.voxels;
  // Half of the way from the border of the finer level, 8 coarse voxels, to its middle is 4 voxels.
  CHECK(mixed.ramp == 4.0f);
  for (int i = 0; i < 16; ++i) {
    const glm::ivec3 cell = glm::ivec3(i, 0, 0) - range.first;  // from the middle to the border along x
    const glm::vec3 value = voxels.at({cell.x, cell.y, cell.z});
    const double fromBorder = 8.0 - (i + 0.5), expected = std::clamp((fromBorder - 1.0) / 4.0, 0.0, 1.0);
    CAPTURE(i);
    CHECK(value.r == Approx(expected).margin(1e-5));
    CHECK(value.g == Approx(1.0 - expected).margin(1e-5));
  }
  // Without a ramp it is one or the other.
  const RadianceClipmap leap =
      madeClipmap({.resolution = 32, .levels = 2, .extent = 1.0, .ramp = 0.0}, glm::vec3(0.0f),
                  [](int level, const glm::vec3&, int) {
                    return level == 0 ? glm::vec4(1, 0, 0, 1) : glm::vec4(0, 1, 0, 1);
                  });
  const auto leaps = voxelsOf(leap, 1, 0);
  for (const auto& [cell, value] : leaps) CHECK((value.r == 0.0f || value.r == 1.0f));
}

TEST_CASE("what cones see changes without a leap from level to level") {
  // A wall of the light of its place, far away; the apex goes through the borders of two levels.
  const RadianceClipmap wall = madeClipmap(kThree, glm::vec3(0.0f), [](int level, const glm::vec3& at, int) {
    const float size = 0.5f / 32 * static_cast<float>(1 << level);
    return std::abs(at.y + 0.125f) < 0.5f * size + 0.03f ? glm::vec4(1.0f) : glm::vec4(0.0f);
  });
  double before = -1.0;
  for (int i = 0; i <= 120; ++i) {
    const float x = -0.9f + 0.01f * static_cast<float>(i);
    const glm::vec3 seen =
        gather(emptyScene(), wall, {x, 0.05f, 0.01f}, {0, 1, 0}, {9, "cosine", 1, 1, 0, 0.25});
    const glm::vec3 down =
        gather(emptyScene(), wall, {x, 0.1f, 0.01f}, {0, -1, 0}, {9, "cosine", 1, 1, 0, 0.25});
    CAPTURE(x);
    CHECK(seen.x < 0.05f);
    if (before >= 0.0) CHECK(std::abs(down.x - before) < 0.06);
    before = down.x;
  }
}

TEST_CASE("sizes that are no powers of two, and few voxels, give the light of the others") {
  RenderOptions options;
  options.width = options.height = 32;
  const Scene scene = cornell();
  const Pipeline levels = pipeline("voxel_cone_tracing_clipmap");
  const auto meanAt = [&](const std::string& resolution, const std::string& count) {
    options.parameters = levels.settings({"resolution=" + resolution, "levels=" + count});
    double sum = 0.0;
    const FrameResult frame = renderOnce(scene, levels, options);
    for (const float value : frame.outputs.at("indirect_diffuse").values()) {
      CHECK(std::isfinite(value));
      sum += value;
    }
    return sum;
  };
  const double expected = meanAt("64", "1");
  for (const auto& [resolution, count] :
       {std::pair{"33", "3"}, {"50", "2"}, {"47", "1"}, {"24", "4"}, {"20", "3"}}) {
    CAPTURE(resolution, count);
    CHECK(meanAt(resolution, count) == Approx(expected).epsilon(0.1));
  }
  CHECK(meanAt("8", "1") == Approx(expected).epsilon(0.5));
}

TEST_CASE(
    "cameras outside of the scene, inside geometry and far away, and levels that reach nothing, are fine") {
  RenderOptions options;
  options.width = options.height = 16;
  const Pipeline levels = pipeline("voxel_cone_tracing_clipmap");
  const auto text = [](const std::string& extent) {
    Pipeline result = pipeline("voxel_cone_tracing_clipmap");
    std::string source = result.document->source;
    const std::string before = "levels $levels\n";
    source.insert(source.find(before), "extent " + extent + "\n    ");
    return Pipeline::parse(source, result.file);
  };
  for (const glm::dvec3 eye :
       {glm::dvec3(0.0, 0.3, 20.0), {0.1, 1e-9, 0.1}, {1e8, 1e7, -1e8}, {0.3, 0.3, 0.3}})
    for (const char* extent : {"", "0.2 m", "100 m"}) {
      Scene scene = cornell();
      scene.cameras.front().eye = eye;
      scene.cameras.front().target = {0.28, 0.27, 0.28};
      if (eye == scene.cameras.front().target) scene.cameras.front().target.z -= 1.0;
      const FrameResult frame = renderOnce(scene, *extent == '\0' ? levels : text(extent), options);
      CAPTURE(eye.x, extent);
      for (const float value : frame.outputs.at("indirect_diffuse").values()) {
        CHECK(std::isfinite(value));
        CHECK(value >= 0.0f);
        CHECK(value < 10.0f);
      }
    }
}

TEST_CASE("more levels than a list of fragments can number are refused with how many it can") {
  const Scene scene = emptyScene();
  PassHarness many(device(), techniques(), "voxel_cone_tracing", "clipmap", scene, snapshotOf(scene, 0.0));
  many.setParameter("resolution", 400);
  many.setParameter("levels", 5);
  CHECK_THAT(messageOf<Error>([&] { many.run(); }),
             Contains("5 levels of 400 voxels") && Contains("at most 4 levels"));
}

TEST_CASE("what is exported of a clipmap are its levels, each voxel once, where it lies in the scene") {
  Scene scene = cornell();
  scene.cameras.front().eye = {0.2, 0.3, 0.25};
  const RadianceClipmap clipmap = filtered(voxelized(scene, {.resolution = 16, .levels = 2}));
  PortContents contents(portKind<RadianceClipmap>());
  PortTraits<RadianceClipmap>::contents(clipmap, contents);
  REQUIRE(contents.fields().size() == 7u * clipmap.levels.size());
  for (const PortContents::Field& field : contents.fields()) {
    const VoxelRange& range = clipmap.levels.at(static_cast<std::size_t>(field.level)).own.voxels;
    CHECK(field.box.resolution == range.size());
    CHECK(field.box.resolution.x <= 16);
    CHECK(field.box.voxelSize.x == Approx(clipmap.sizeOf(field.level)));
    CHECK(glm::distance(field.box.low,
                        glm::dvec3(clipmap.origin) + static_cast<double>(clipmap.sizeOf(field.level)) *
                                                         glm::dvec3(range.first)) < 1e-6);
    std::set<Cell> seen;
    for (const auto& [voxel, value] : std::get<VoxelsRead>(field.source).read()) {
      CHECK(seen.insert({voxel.x, voxel.y, voxel.z}).second);
      CHECK(glm::all(glm::greaterThanEqual(voxel, glm::ivec3(0))));
      CHECK(glm::all(glm::lessThan(voxel, field.box.resolution)));
    }
    CHECK_FALSE(seen.empty());
  }
}
