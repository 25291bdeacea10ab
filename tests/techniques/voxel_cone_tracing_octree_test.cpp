// Light in a sparse voxel octree: its bricks, its levels, and the cones through it, in closed form and beside
// the dense grid.
#include <cmath>

#include "lumivox/measure/metrics.h"
#include "support/filtered.h"
#include "support/octree.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::cones;
using namespace lumivox::test::octree;

namespace {

/// The grid and the octree of a scene under its lights, filtered alike.
std::pair<RadianceGrid, RadianceOctree> bothOf(const Scene& scene, int resolution, const char* precision,
                                               const char* opacity, int bounces = 1) {
  InjectSettings settings;
  settings.precision = precision;
  settings.bounces = bounces;
  return {filtered(injectedGrid(scene, resolution, settings), opacity),
          filteredOctree(injectedOctree(scene, resolution, settings), opacity)};
}

Scene cornell() {
  return loadScene(sourceDirectory() / "scenes/cornell.scene");
}

}  // namespace

TEST_CASE(
    "voxels of the octree are those of the dense grid, to the bit, at every level that is halved evenly") {
  const Scene scene = cornell();
  struct Way {
    const char *precision, *opacity;
  };
  for (const auto& [precision, opacity] : {Way{"float", "facing"}, Way{"half", "average"}}) {
    const auto [dense, sparse] = bothOf(scene, 32, precision, opacity);
    CHECK(dense.unit == sparse.unit);
    for (int level = 0; level <= sparse.tree.depth; ++level) {
      const glm::ivec3 size = levelResolution(dense.grid.resolution, level);
      const std::vector<float> texels = dense.radiance->downloadFloats(level);
      std::map<Cell, glm::vec4> expected;
      for (int i = 0; i < size.x * size.y * size.z; ++i) {
        const float* texel = texels.data() + 4 * static_cast<std::size_t>(i);
        if (texel[3] > 0.0f)
          expected[{i % size.x, i / size.x % size.y, i / (size.x * size.y)}] = {texel[0], texel[1], texel[2],
                                                                                texel[3]};
      }
      std::map<Cell, glm::vec4> found;
      for (const auto& [voxel, opacityThere] : sparse.voxels(level, 3))
        found[cellOf(voxel)].w = opacityThere.x;
      for (const auto& [voxel, light] : sparse.voxels(level, 0))
        found[cellOf(voxel)] = glm::vec4(light / sparse.unit, found[cellOf(voxel)].w);
      CAPTURE(precision, opacity, level, expected.size());
      CHECK((found == expected));
    }
  }
}

TEST_CASE(
    "of the pool, the texels in use are those of the bricks that there are, at the levels that are filled") {
  const auto [dense, sparse] = bothOf(cornell(), 32, "float", "facing");
  for (const int filled : {1, sparse.filledLevels}) {
    RadianceOctree octree = sparse;
    octree.filledLevels = filled;
    PortContents contents(portKind<RadianceOctree>());
    PortTraits<RadianceOctree>::contents(octree, contents);
    const auto pool = std::find_if(contents.resources().begin(), contents.resources().end(),
                                   [](const PortContents::Resource& is) { return is.texture != nullptr; });
    REQUIRE(pool != contents.resources().end());
    const std::vector<bool> inUse = pool->filled.texels();
    std::size_t bricks = 0;
    for (int level = 0; level < filled; ++level)
      bricks += OctreeBrickList::of(octree.tree, level).bricks.size();
    CAPTURE(filled, bricks, inUse.size());
    CHECK(static_cast<std::size_t>(std::count(inUse.begin(), inUse.end(), true)) == 8 * bricks);
    CHECK(8 * bricks < inUse.size());
    const std::vector<float> texels = octree.radiance->downloadFloats(0);
    REQUIRE(texels.size() == 4 * inUse.size());
    std::size_t opaque = 0, opaqueOutside = 0;
    for (std::size_t i = 0; i < inUse.size(); ++i)
      if (texels[4 * i + 3] > 0.0f) ++(inUse[i] ? opaque : opaqueOutside);
    CHECK(opaque > 0);
    if (filled == sparse.filledLevels) CHECK(opaqueOutside == 0);
  }
}

TEST_CASE("a uniform octree of opacity and radiance returns L (1 - (1-a)^(d / voxel))") {
  constexpr int kResolution = 64;
  const double voxel = 2.0 / kResolution;
  const glm::vec3 radiance(1.0f, 0.5f, 0.25f);
  for (const float opacity : {0.0625f, 0.25f}) {
    const VoxelFragments list =
        listOf(fragmentsWhere(glm::ivec3(kResolution),
                              [&](const glm::ivec3&) { return glm::vec4(radiance, opacity); }),
               glm::ivec3(kResolution));
    for (const char* filter : {"facing", "average"}) {
      const RadianceOctree octree = filteredOctree(leavesOf(list), filter);
      for (const int cones : {1, 6, 64})
        for (const double distance : {0.1, 0.25, 0.5}) {
          const double expected = 1.0 - std::pow(1.0 - opacity, distance / voxel);
          const glm::vec3 gathered = gather(emptyScene(), octree, glm::vec3(0.0f), {0, 1, 0},
                                            {cones, "cosine", 0, 0, distance, 0.25});
          CAPTURE(filter, opacity, cones, distance);
          for (int c = 0; c < 3; ++c) CHECK(gathered[c] == Approx(radiance[c] * expected).epsilon(0.01));
        }
    }
  }
}

TEST_CASE("cones see in the octree what they see in the dense grid") {
  const auto [dense, sparse] = bothOf(cornell(), 64, "float", "facing");
  for (const glm::vec3& place : {glm::vec3(0.1f, 0.1f, 0.1f), {0.0f, 0.45f, -0.1f}, {-0.15f, 0.4f, 0.05f}})
    for (const double clearance : {0.0, 0.5}) {  // the finest level alone, and wide voxels
      GatherSettings settings{16};
      settings.clearance = clearance;
      const glm::vec3 normal = glm::normalize(glm::vec3(1, -2, 0.5f));
      const glm::vec3 a = gather(emptyScene(), dense, place, normal, settings),
                      b = gather(emptyScene(), sparse, place, normal, settings);
      CAPTURE(place.x, clearance);
      CHECK(glm::length(a) > 1e-3f);
      for (int c = 0; c < 3; ++c) CHECK(b[c] == Approx(a[c]).epsilon(filtered(1e-3f)));
    }
}

TEST_CASE("cones see in the octree what they see in the dense grid at its very ends and beyond it") {
  const auto fill = [](const glm::ivec3& at) {
    const std::uint32_t hash =
        static_cast<std::uint32_t>(at.x * 73856093 ^ at.y * 19349663 ^ at.z * 83492791);
    return hash % 3 == 0 ? glm::vec4(0.1f + 0.1f * static_cast<float>(hash % 7), 0.5f, 0.25f, 0.125f)
                         : glm::vec4(0.0f);
  };
  constexpr int kSize = 16;
  for (const glm::ivec3& size : {glm::ivec3(kSize), glm::ivec3(13, kSize, 6)}) {
    const RadianceOctree sparse =
        filteredOctree(leavesOf(listOf(fragmentsWhere(size, fill), glm::ivec3(kSize))));
    const RadianceGrid dense = filtered(makeGrid(kSize, [&](int x, int y, int z) {
      const glm::ivec3 at(x, y, z);
      const glm::vec4 value = glm::any(glm::greaterThanEqual(at, size)) ? glm::vec4(0.0f) : fill(at);
      return glm::vec4(glm::vec3(value) * value.w, value.w);
    }));
    for (int i = 0; i < 24; ++i) {
      const glm::vec3 apex(-1.2f + 0.1f * static_cast<float>(i), 0.9f - 0.08f * static_cast<float>(i),
                           0.05f * static_cast<float>(i % 5) - 1.0f);
      const glm::vec3 normal = glm::normalize(glm::vec3(i % 3 - 1, i % 2 == 0 ? 1 : -1, i % 5 - 2));
      const glm::vec3 a = gather(emptyScene(), dense, apex, normal, {4}),
                      b = gather(emptyScene(), sparse, apex, normal, {4});
      CAPTURE(size.x, i);
      // A sampler filters with weights of 8 bits, and albedos are halves.
      for (int c = 0; c < 3; ++c) CHECK(b[c] == Approx(a[c]).epsilon(0.005).margin(1e-4));
    }
  }
}

TEST_CASE("a steady frame waits for no count of the octree") {
  const Scene scene = cornell();
  RenderOptions options;
  options.width = options.height = 16;
  PipelineExecutor executor(device(), techniques(), scene, pipeline("voxel_cone_tracing_octree"), options);
  executor.render(0.0);
  executor.invalidate();
  const std::uint64_t before = device().transfers().stalls;
  executor.render(0.0, 1, PipelineExecutor::Images::no);
  CHECK(device().transfers().stalls == before);
}

TEST_CASE("an octree that does not fit is refused with the bytes that it needs and the largest that fits") {
  const Scene scene = cornell();
  const Pipeline text = pipeline("voxel_cone_tracing_octree");
  const auto render = [&](std::uint64_t bytes, int resolution) {
    gpu::DeviceOptions options;
    options.memoryBytes = bytes;
    gpu::Device small(options);
    RenderOptions settings;
    settings.width = settings.height = 16;
    settings.parameters = text.settings({"resolution=" + std::to_string(resolution)});
    PipelineExecutor executor(small, techniques(), scene, text, settings);
    executor.render(0.0);
  };
  constexpr std::uint64_t kBytes = 20u << 20;
  CHECK_THROWS_WITH(render(kBytes, 128),
                    Catch::Matchers::Contains("an octree of 128 voxels") &&
                        Catch::Matchers::Contains("takes ") && Catch::Matchers::Contains("tags ") &&
                        Catch::Matchers::Contains("nodes ") && Catch::Matchers::Contains("bricks ") &&
                        Catch::Matchers::Contains("the largest that fits is 64 "));
  CHECK_NOTHROW(render(kBytes, 64));
}

TEST_CASE("tags that do not fit are refused before anything is counted") {
  // At 512 voxels there may be (8^9 - 1) / 7 nodes, of two bits with 64 bits of rank to 32 of each.
  gpu::DeviceOptions options;
  options.memoryBytes = 12u << 20;
  gpu::Device small(options);
  const Scene scene = emptyScene();
  PassHarness tree(small, techniques(), "voxel_cone_tracing", "octree", scene, snapshotOf(scene, 0.0));
  tree.setInput("fragments", listOf({fragmentAt({3, 3, 3})}, glm::ivec3(512), small));
  CHECK_THROWS_WITH(
      tree.run(),
      Catch::Matchers::Contains(
          "an octree of 512 voxels along its longest side takes at least 13.7 MiB: tags 13.7 MiB") &&
          Catch::Matchers::Contains("the largest that fits is 256 "));
}
