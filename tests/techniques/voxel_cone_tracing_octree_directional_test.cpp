// Bricks of six faces in a sparse voxel octree, beside the six directional grids and in closed form.
#include <cmath>

#include "lumivox/measure/metrics.h"
#include "support/octree.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::cones;
using namespace lumivox::test::octree;

namespace {

constexpr int kHigherX = 0, kLowerX = 1, kHigherY = 2, kLowerY = 3, kHigherZ = 4;

void checkNear(const glm::vec4& value, const glm::vec4& expected, double tolerance = 1e-5) {
  for (int c = 0; c < 4; ++c) CHECK(value[c] == Approx(expected[c]).margin(tolerance));
}

Scene cornell() {
  return loadScene(sourceDirectory() / "scenes/cornell.scene");
}

/// The voxels of a face at a level that have opacity.
std::map<Cell, glm::vec4> voxelsOf(const DirectionalRadianceGrid& grid, int face, int level) {
  const glm::ivec3 size = levelResolution(grid.grid.resolution, level);
  const std::vector<float> texels = grid.faces[static_cast<std::size_t>(face)]->downloadFloats(level);
  std::map<Cell, glm::vec4> result;
  for (int i = 0; i < size.x * size.y * size.z; ++i) {
    const float* texel = texels.data() + 4 * static_cast<std::size_t>(i);
    if (texel[3] > 0.0f)
      result[{i % size.x, i / size.x % size.y, i / (size.x * size.y)}] = {texel[0], texel[1], texel[2],
                                                                          texel[3]};
  }
  return result;
}
std::map<Cell, glm::vec4> voxelsOf(const RadianceOctree& octree, int face, int level) {
  std::map<Cell, glm::vec4> result;
  for (const auto& [place, voxels] : bricksOf(octree, level, face))
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 local(corner & 1, corner >> 1 & 1, corner >> 2);
      const glm::vec4& value = voxels[static_cast<std::size_t>(corner)];
      if (value.w > 0.0f) result[cellOf(2 * glm::ivec3(place[0], place[1], place[2]) + local)] = value;
    }
  return result;
}

/// An octree over a grid of [-1,1]^3 with all levels, whose finest voxels `fill` gives by face and voxel, as
/// makeDirections takes them; only where it is above 0 for some face there are leaves.
RadianceOctree octreeOf(int resolution, const std::function<glm::vec4(int, int, int, int)>& fill) {
  const auto isSomething = [&](const glm::ivec3& at) {
    bool found = false;
    for (int face = 0; face < 6; ++face) found = found || fill(face, at.x, at.y, at.z).w > 0.0f;
    return glm::vec4(found ? 1.0f : 0.0f);
  };
  const glm::ivec3 size(resolution);
  RadianceOctree octree = leavesOf(listOf(fragmentsWhere(size, isSomething), size), "float", "six");
  const gpu::TextureDescription& pool = octree.radiance->description();
  std::vector<float> texels = octree.radiance->downloadFloats(0);
  for (const auto& brick : OctreeBrickList::of(octree.tree, 0).bricks)
    for (int i = 0; i < 6 * VoxelOctree::kBrickVoxels; ++i) {
      const int face = i / VoxelOctree::kBrickVoxels;
      const glm::ivec3 local(i & 1, i >> 1 & 1, i >> 2 & 1), at = octree.texelOf(brick.index, face) + local,
                                                             voxel = 2 * brick.place + local;
      const glm::vec4 value = glm::any(glm::greaterThanEqual(voxel, size))
                                  ? glm::vec4(0.0f)
                                  : fill(face, voxel.x, voxel.y, voxel.z);
      for (int c = 0; c < 4; ++c)
        texels[4 * static_cast<std::size_t>((at.z * pool.height + at.y) * pool.width + at.x) +
               static_cast<std::size_t>(c)] = value[c];
    }
  octree.radiance->uploadFloats(0, texels);
  return filteredOctree(octree);
}

/// What one narrow cone along a direction sees.
template <class Store>
glm::vec3 along(const Store& store, const glm::vec3& position, const glm::vec3& direction, float exponent,
                const GatherSettings& settings) {
  const glm::vec3 d = glm::normalize(direction);
  Scene scene = emptyScene();
  scene.cameras.front().eye =
      glm::dvec3(position) + 2.0 * glm::dvec3(d);  // the mirror direction is the normal
  return gatherGlossy(scene, store, position, d, glm::vec4(1, 1, 1, exponent), settings);
}

}  // namespace

TEST_CASE("faces of the octree's voxels are those of six directional grids, at every level halved evenly") {
  for (const Scene& scene : {cornell(), loadScene(sourceDirectory() / "scenes/untuned/room.scene")})
    for (const char* precision : {"float", "half"}) {
      InjectSettings settings;
      settings.precision = precision;
      const DirectionalRadianceGrid dense = filteredDirections(injectedDirections(scene, 32, settings));
      const RadianceOctree sparse = filteredOctree(injectedOctree(scene, 32, settings, "six"));
      CHECK(dense.unit == sparse.unit);
      std::size_t compared = 0;
      for (int level = 0; level <= sparse.tree.depth; ++level) {
        const glm::ivec3 size = levelResolution(dense.grid.resolution, level);
        if (size * (1 << level) != dense.grid.resolution) break;
        for (int face = 0; face < 6; ++face) {
          const auto expected = voxelsOf(dense, face, level), found = voxelsOf(sparse, face, level);
          CAPTURE(precision, level, face, expected.size(), found.size());
          CHECK((found == expected));
          compared += expected.size();
        }
      }
      CHECK(compared > 6 * 1000);
    }
}

TEST_CASE("children of a column in a brick are composited as seen from each side, and columns are averaged") {
  // As in the six grids: along x the column at y = z = 0 holds (red, half opaque) before (green, opaque); a
  // second one green alone; the other two are empty.
  const auto fill = [](int, int x, int y, int z) -> glm::vec4 {
    if (z != 0 || x > 1 || y > 1) return glm::vec4(0.0f);
    if (y == 0) return x == 0 ? glm::vec4(0.5f, 0, 0, 0.5f) : glm::vec4(0, 1, 0, 1);
    return x == 1 ? glm::vec4(0, 1, 0, 1) : glm::vec4(0.0f);
  };
  const RadianceOctree octree = octreeOf(4, fill);
  const auto at = [&](int face) { return bricksOf(octree, 1, face).at({0, 0, 0})[0]; };
  checkNear(at(kLowerX), {0.125f, 0.375f, 0, 0.5f});
  checkNear(at(kHigherX), {0, 0.5f, 0, 0.5f});
  checkNear(at(kLowerY), {0.125f, 0.25f, 0, 0.375f});
  checkNear(at(kHigherY), {0.125f, 0.25f, 0, 0.375f});
  checkNear(at(kHigherZ), {0.125f, 0.5f, 0, 0.625f});
}

TEST_CASE(
    "in an octree each side of a wall with two coats of paint keeps its colour and closes at every level") {
  // The red-green wall of thesis Sec. 3.1.3: two layers of voxels in one coarser one, over the whole grid.
  constexpr int kResolution = 32;
  const auto paint = [](int, int x, int, int) {
    return x == 16 ? glm::vec4(1, 0, 0, 1) : x == 17 ? glm::vec4(0, 1, 0, 1) : glm::vec4(0.0f);
  };
  const RadianceOctree octree = octreeOf(kResolution, paint);
  for (int level = 1; level <= octree.tree.depth; ++level) {
    std::size_t seen = 0;
    const auto lower = voxelsOf(octree, kLowerX, level), higher = voxelsOf(octree, kHigherX, level);
    for (const auto& [voxel, value] : lower) {
      CAPTURE(level, voxel[0], voxel[1]);
      CHECK(voxel[0] == 16 >> level);
      checkNear(value, {1, 0, 0, 1});
      checkNear(higher.at(voxel), {0, 1, 0, 1});
      ++seen;
    }
    const auto side = static_cast<std::size_t>(kResolution >> level);
    CHECK(seen == side * side);
  }
  for (const float side : {-1.0f, 1.0f})
    for (const float tilt : {0.0f, 1.0f}) {
      const glm::vec3 seen =
          along(octree, {0.03f + 0.4f * side, 0, 0}, {-side, tilt, 0.3f * tilt}, 400.0f, {});
      CAPTURE(side, tilt);
      CHECK((side < 0 ? seen.r : seen.g) == Approx(1.0).epsilon(1e-3));
      CHECK((side < 0 ? seen.g : seen.r) < 1e-3f);
    }
}

TEST_CASE("a uniform octree of six faces returns L (1 - (1-a)^(d / voxel)) by either reading") {
  constexpr int kResolution = 32;
  const double voxel = 2.0 / kResolution;
  for (const float opacity : {0.02f, 0.3f}) {
    const RadianceOctree octree = octreeOf(kResolution, [&](int, int, int, int) {
      return glm::vec4(opacity * 1.0f, opacity * 2.0f, opacity * 0.5f, opacity);
    });
    for (const char* reading : {"layers", "interpolated"})
      for (const int cones : {1, 6, 64}) {
        const double distance = 0.5;
        GatherSettings settings{cones, "cosine", 0, 0, distance, 0.25};
        settings.reading = reading;
        const glm::vec3 gathered = gather(emptyScene(), octree, glm::vec3(0.0f), {0, 1, 0}, settings);
        const double expected = 1.0 - std::pow(1.0 - opacity, distance / voxel);
        CAPTURE(reading, opacity, cones);
        CHECK(gathered.r == Approx(expected).epsilon(0.01));
        CHECK(gathered.g == Approx(2.0 * expected).epsilon(0.01));
      }
  }
}

TEST_CASE("a voxel of the octree shows its three faces by the shares of the direction") {
  // Listing 4.15: weights |d| / sum |d|, of opaque voxels whose faces shine 1, 10, 2, 20, 4 and 40.
  const std::array<float, 6> shine{1, 10, 2, 20, 4, 40};
  const RadianceOctree octree = octreeOf(16, [&](int face, int, int, int) {
    return glm::vec4(glm::vec3(shine[static_cast<std::size_t>(face)]), 1.0f);
  });
  for (const char* reading : {"layers", "interpolated"})
    for (const glm::vec3 direction : {glm::vec3(-1, -2, -3), glm::vec3(3, -1, 1), glm::vec3(0, 0, 1)}) {
      GatherSettings settings;
      settings.reading = reading;
      const glm::vec3 d = glm::normalize(direction),
                      weights = glm::abs(d) / (std::abs(d.x) + std::abs(d.y) + std::abs(d.z));
      double expected = 0.0;
      for (int axis = 0; axis < 3; ++axis)
        expected += weights[axis] * shine[static_cast<std::size_t>(2 * axis + (d[axis] < 0.0f ? 0 : 1))];
      CAPTURE(reading, d.x, d.y, d.z);
      CHECK(along(octree, glm::vec3(0.0f), d, 1e5f, settings).r == Approx(expected).epsilon(1e-3));
    }
}

TEST_CASE("cones see in an octree of six faces what they see in six grids, in and beyond the grid") {
  // Random voxels up to the very ends of the grid, each face its own.
  constexpr int kResolution = 16;
  const auto fill = [](int face, int x, int y, int z) {
    const auto hash = static_cast<std::uint32_t>(x * 73856093 ^ y * 19349663 ^ z * 83492791);
    if (hash % 3 != 0) return glm::vec4(0.0f);
    const float opacity =
        0.125f + 0.125f * static_cast<float>((hash >> 3 ^ static_cast<unsigned>(face / 2)) % 5);
    return glm::vec4(opacity * glm::vec3(0.1f + 0.2f * static_cast<float>(face), 0.5f, 0.25f), opacity);
  };
  const DirectionalRadianceGrid dense = filteredDirections(makeDirections(kResolution, fill));
  const RadianceOctree octree = octreeOf(kResolution, fill);
  for (const char* reading : {"layers", "interpolated"})
    for (int i = 0; i < 24; ++i) {
      const glm::vec3 apex(-1.2f + 0.1f * static_cast<float>(i), 0.9f - 0.08f * static_cast<float>(i),
                           0.05f * static_cast<float>(i % 5) - 1.0f);
      const glm::vec3 normal = glm::normalize(glm::vec3(i % 3 - 1, i % 2 == 0 ? 1 : -1, i % 5 - 2));
      GatherSettings settings{4};
      settings.reading = reading;
      settings.clearance = i % 2 == 0 ? 0.5 : 0.25;
      const glm::vec3 a = gather(emptyScene(), dense, apex, normal, settings),
                      b = gather(emptyScene(), octree, apex, normal, settings);
      CAPTURE(reading, i);
      // A sampler filters with weights of 8 bits.
      for (int c = 0; c < 3; ++c) CHECK(b[c] == Approx(a[c]).epsilon(0.005).margin(1e-4));
    }
}

TEST_CASE("six faces in the octree and in grids differ by a FLIP under 0.03, in grids of any shape") {
  RenderOptions options;
  options.width = options.height = 64;
  for (const char* name : {"cornell", "untuned/room"}) {
    const Scene scene = loadScene(sourceDirectory() / "scenes" / (std::string(name) + ".scene"));
    CAPTURE(name);
    const FrameResult dense = renderOnce(scene, pipeline("voxel_cone_tracing_directional"), options),
                      sparse = renderOnce(scene, pipeline("voxel_cone_tracing_octree_directional"), options);
    for (const char* output : {"indirect_diffuse", "final"}) {
      const ImageError error = compare(sparse.outputs.at(output), dense.outputs.at(output));
      INFO(output << ": FLIP " << error.flip);
      CHECK(error.flip < 0.03);
      CHECK(error.meanRatio.value == Approx(1.0).epsilon(0.002));
    }
  }
}

TEST_CASE("further bounces in an octree of six faces are those of six grids") {
  InjectSettings settings;
  settings.bounces = 3;
  const DirectionalRadianceGrid dense = injectedDirections(cornell(), 32, settings);
  const RadianceOctree sparse = injectedOctree(cornell(), 32, settings, "six"),
                       once = injectedOctree(cornell(), 32, {}, "six");
  const auto lightOf = [](const auto& store) {
    double sum = 0.0;
    for (int face = 0; face < 6; ++face)
      for (const auto& [voxel, value] : voxelsOf(store, face, 0)) sum += value.x + value.y + value.z;
    return sum;
  };
  CAPTURE(lightOf(sparse), lightOf(once));
  CHECK(lightOf(sparse) == Approx(lightOf(dense)).epsilon(0.005));
  CHECK(lightOf(sparse) > 1.2 * lightOf(once));
}

TEST_CASE("what is exported of an octree of six faces is what six grids export") {
  const Scene scene = cornell();
  const DirectionalRadianceGrid dense = filteredDirections(injectedDirections(scene, 16));
  const RadianceOctree sparse = filteredOctree(injectedOctree(scene, 16, {}, "six"));
  PortContents contents(portKind<RadianceOctree>());
  PortTraits<RadianceOctree>::contents(sparse, contents);
  REQUIRE(contents.fields().size() == 7u * static_cast<std::size_t>(sparse.tree.depth + 1));
  for (const PortContents::Field& field : contents.fields()) {
    const auto found = std::get<VoxelsRead>(field.source).read();
    std::map<Cell, glm::vec3> expected;
    if (field.name == "opacity_along") {
      for (int axis = 0; axis < 3; ++axis)
        for (const auto& [voxel, value] : voxelsOf(dense, 2 * axis, field.level))
          expected[voxel][axis] = value.w;
    } else {
      for (int face = 0; face < 6; ++face)
        if (field.name == std::string("radiance_") +
                              PortTraits<DirectionalRadianceGrid>::kFaces[static_cast<std::size_t>(face)])
          for (const auto& [voxel, value] : voxelsOf(dense, face, field.level))
            expected[voxel] = dense.unit * glm::vec3(value);
    }
    CAPTURE(field.name, field.level);
    REQUIRE(!expected.empty());
    CHECK(found.size() == expected.size());
    for (const auto& [voxel, value] : found) CHECK(expected.at(cellOf(voxel)) == value);
  }
}

TEST_CASE("six faces are refused by rules that have no sides") {
  const VoxelFragments list = listOf({fragmentAt({3, 3, 3})}, glm::ivec3(8));
  CHECK_THROWS_WITH(filteredOctree(leavesOf(list, "float", "six"), "average"),
                    Catch::Matchers::Contains("expected 'opacity facing'"));
}

TEST_CASE("an octree of six faces that does not fit is refused with what it takes, all faces counted") {
  const Scene scene = cornell();
  const auto message = [&](const char* name, std::uint64_t bytes, int resolution) {
    gpu::DeviceOptions options;
    options.memoryBytes = bytes;
    gpu::Device small(options);
    const Pipeline text = pipeline(name);
    RenderOptions settings;
    settings.width = settings.height = 16;
    settings.parameters = text.settings({"resolution=" + std::to_string(resolution)});
    PipelineExecutor executor(small, techniques(), scene, text, settings);
    try {
      executor.render(0.0);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  constexpr std::uint64_t kBytes = 40u << 20;
  CHECK(message("voxel_cone_tracing_octree", kBytes, 128).empty());
  const std::string refused = message("voxel_cone_tracing_octree_directional", kBytes, 128);
  CHECK_THAT(refused, Catch::Matchers::Contains("an octree of 128 voxels along its longest side takes") &&
                          Catch::Matchers::Contains("the largest that fits is 64 "));
  CHECK(message("voxel_cone_tracing_octree_directional", kBytes, 64).empty());
}
