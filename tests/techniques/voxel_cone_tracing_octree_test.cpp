// Light in a sparse voxel octree: its bricks, its levels, and the cones through it, in closed form and beside
// the dense grid.
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <random>

#include "lumivox/measure/metrics.h"
#include "support/octree.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::cones;
using namespace lumivox::test::octree;

namespace {

void checkNear(const glm::vec4& value, const glm::vec4& expected, double tolerance) {
  for (int c = 0; c < 4; ++c) CHECK(value[c] == Approx(expected[c]).margin(tolerance));
}

/// The grid and the octree of a scene under its lights, filtered alike.
std::pair<RadianceGrid, RadianceOctree> bothOf(const Scene& scene, int resolution, const char* precision,
                                               const char* opacity, const char* bricks = "own",
                                               int bounces = 1) {
  InjectSettings settings;
  settings.precision = precision;
  settings.bounces = bounces;
  return {filtered(injectedGrid(scene, resolution, settings), opacity),
          filteredOctree(injectedOctree(scene, resolution, settings, "one", bricks), opacity)};
}

Scene cornell() {
  return loadScene(sourceDirectory() / "scenes/cornell.scene");
}

}  // namespace

TEST_CASE(
    "voxels of the octree are those of the dense grid, to the bit, at every level that is halved evenly") {
  const Scene scene = cornell();
  struct Way {
    const char *precision, *opacity, *bricks;
  };
  for (const auto& [precision, opacity, bricks] :
       {Way{"float", "facing", "own"}, Way{"half", "average", "own"}, Way{"float", "facing", "published"},
        Way{"half", "average", "published"}}) {
    const auto [dense, sparse] = bothOf(scene, 32, precision, opacity, bricks);
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
      CAPTURE(precision, opacity, bricks, level, expected.size());
      CHECK((found == expected));
    }
  }
}

TEST_CASE(
    "of the pool, the texels in use are those of the bricks that there are, at the levels that are filled") {
  const auto [dense, sparse] = bothOf(cornell(), 32, "float", "facing", "published");
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
    CHECK(static_cast<std::size_t>(std::count(inUse.begin(), inUse.end(), true)) == 27 * bricks);
    CHECK(27 * bricks < inUse.size());
    const std::vector<float> texels = octree.radiance->downloadFloats(0);
    REQUIRE(texels.size() == 4 * inUse.size());
    std::size_t opaque = 0, opaqueOutside = 0;
    for (std::size_t i = 0; i < inUse.size(); ++i)
      if (texels[4 * i + 3] > 0.0f) ++(inUse[i] ? opaque : opaqueOutside);
    CHECK(opaque > 0);
    if (filled == sparse.filledLevels) CHECK(opaqueOutside == 0);
  }
}

TEST_CASE("what bricks share with their neighbours is the same in both, and nothing where there is none") {
  const auto [dense, sparse] = bothOf(cornell(), 32, "float", "facing", "published");
  for (int level = 0; level < sparse.tree.depth; ++level) {
    const auto bricks = bricksOf(sparse, level);
    std::size_t wrong = 0, shared = 0;
    for (const auto& [place, values] : bricks)
      for (int i = 0; i < 27; ++i) {
        const glm::ivec3 local(i % 3, i / 3 % 3, i / 9);
        if (local.x < 2 && local.y < 2 && local.z < 2) continue;
        const glm::ivec3 up = local / 2, there = local - 2 * up;
        const auto owner = bricks.find({place[0] + up.x, place[1] + up.y, place[2] + up.z});
        const glm::vec4 expected =
            owner == bricks.end()
                ? glm::vec4(0.0f)
                : owner->second[static_cast<std::size_t>(there.x + 3 * there.y + 9 * there.z)];
        wrong += values[static_cast<std::size_t>(i)] != expected ? 1u : 0u;
        ++shared;
      }
    CAPTURE(level);
    CHECK(shared > 0);
    CHECK(wrong == 0);
  }
}

TEST_CASE("in leaves, the corners of bricks are means of the voxels around them as far as there are leaves") {
  // Two leaves side by side along x, of 2 x 2 x 2 voxels each, all filled with values of their own. Inside,
  // and between them, a vertex is the mean of the 8, 4 or 2 voxels around it; at the outside of those that
  // there are, since an average is taken only with a neighbour that exists.
  const auto value = [](const glm::ivec3& at) {
    return 0.125f * static_cast<float>(1 + at.x % 4 + 2 * (at.y % 2)) / (1.0f + static_cast<float>(at.z % 2));
  };
  const glm::ivec3 low(4, 2, 6), size(4, 2, 2);
  const auto fill = [&](const glm::ivec3& at) {
    const glm::ivec3 in = at - low;
    const bool inside =
        in.x >= 0 && in.y >= 0 && in.z >= 0 && in.x < size.x && in.y < size.y && in.z < size.z;
    return inside ? glm::vec4(glm::vec3(value(at)), 1.0f) : glm::vec4(0.0f);
  };
  const RadianceOctree octree =
      leavesOf(listOf(fragmentsWhere(glm::ivec3(16), fill), glm::ivec3(16)), "in_leaves");
  const auto bricks = bricksOf(octree, 0);
  REQUIRE(bricks.size() == 2);
  for (const auto& [place, values] : bricks)
    for (int i = 0; i < 27; ++i) {
      const glm::ivec3 vertex =
          2 * glm::ivec3(place[0], place[1], place[2]) + glm::ivec3(i % 3, i / 3 % 3, i / 9);
      double sum = 0, count = 0;
      for (int corner = 0; corner < 8; ++corner) {
        const glm::ivec3 at = vertex - glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2);
        if (fill(at).w == 0.0f) continue;
        sum += value(at);
        ++count;
      }
      CAPTURE(vertex.x, vertex.y, vertex.z);
      CHECK(values[static_cast<std::size_t>(i)].x ==
            Approx(sum / count).epsilon(1e-3));  // albedos are halves
      CHECK(values[static_cast<std::size_t>(i)].w == Approx(1.0).epsilon(1e-5));
    }
}

TEST_CASE("at corners, coarse voxels are means by the weights 1, 2, 1 along each axis") {
  // Of random voxels in the middle of a grid; what a mean misses of them is 0. Parts that are added say so
  // everywhere; parts that are averaged do where all neighbours are there, as in a filled block.
  constexpr int kSize = 16;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  std::map<Cell, float> values;
  for (const float share : {0.08f, 1.0f}) {
    values.clear();
    const auto fill = [&](const glm::ivec3& at) {
      if (uniform(random) > share) return glm::vec4(0.0f);
      const float value = 0.25f * std::round(1.0f + 3.0f * uniform(random));
      values[cellOf(at)] = value;
      return glm::vec4(glm::vec3(value), 1.0f);
    };
    const RadianceOctree leaves =
        leavesOf(listOf(fragmentsWhere(glm::ivec3(kSize), fill), glm::ivec3(kSize)), "at_corners");
    for (const char* borders : {"added", "averaged"}) {
      const bool averaged = std::string(borders) == "averaged";
      if (averaged && share < 1.0f) continue;
      const RadianceOctree octree = filteredOctree(leaves, "average", borders);
      std::map<Cell, float> level = values;
      for (int l = 1; l <= 2; ++l) {
        std::map<Cell, double> coarse;
        for (const auto& [at, value] : level)
          for (int step = 0; step < 27; ++step) {
            const glm::ivec3 d(step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1);
            const glm::ivec3 to(at[0] + d.x, at[1] + d.y, at[2] + d.z);
            if ((to.x & 1) != 0 || (to.y & 1) != 0 || (to.z & 1) != 0) continue;
            coarse[cellOf(to / 2)] +=
                value * (2 - std::abs(d.x)) * (2 - std::abs(d.y)) * (2 - std::abs(d.z)) / 64.0;
          }
        level.clear();
        for (const auto& [at, value] : coarse) level[at] = static_cast<float>(value);
        std::size_t compared = 0;
        for (const auto& [place, brick] : bricksOf(octree, l))
          for (int i = 0; i < 27; ++i) {
            const glm::ivec3 at =
                2 * glm::ivec3(place[0], place[1], place[2]) + glm::ivec3(i % 3, i / 3 % 3, i / 9);
            // At the border of the grid there is no neighbour to average with.
            if (averaged &&
                (at.x % (kSize >> l) == 0 || at.y % (kSize >> l) == 0 || at.z % (kSize >> l) == 0 ||
                 at.x + 1 >= kSize >> l || at.y + 1 >= kSize >> l || at.z + 1 >= kSize >> l))
              continue;
            const auto expected = level.find(cellOf(at));
            CAPTURE(share, borders, l, at.x, at.y, at.z);
            CHECK(brick[static_cast<std::size_t>(i)].x ==
                  Approx(expected == level.end() ? 0.0 : expected->second).margin(2e-4));
            ++compared;
          }
        CHECK(compared > 0);
      }
    }
  }
}

TEST_CASE("parts that are averaged count twice along each axis along which a neighbour is missing") {
  // One voxel in the first brick of all: coarse voxel 0 lies on the border of the grid, where there is no
  // neighbour. Of a voxel at 1 a quarter along each axis belongs to it; as a mean of its own that is a half.
  const VoxelFragments list = listOf({fragmentAt({1, 1, 1}, glm::vec3(1.0f))}, glm::ivec3(8));
  for (const bool averaged : {false, true}) {
    const RadianceOctree octree =
        filteredOctree(leavesOf(list, "at_corners"), "average", averaged ? "averaged" : "added");
    const double axis = averaged ? 0.5 : 0.25;
    checkNear(bricksOf(octree, 1).at({0, 0, 0})[0], glm::vec4(axis * axis * axis), 1e-4);
  }
}

TEST_CASE("a uniform octree of opacity and radiance returns L (1 - (1-a)^(d / voxel)) wherever voxels lie") {
  constexpr int kResolution = 64;
  const double voxel = 2.0 / kResolution;
  const glm::vec3 radiance(1.0f, 0.5f, 0.25f);
  struct Way {
    const char *voxels, *opacity, *borders;
  };
  for (const float opacity : {0.0625f, 0.25f}) {
    const VoxelFragments list =
        listOf(fragmentsWhere(glm::ivec3(kResolution),
                              [&](const glm::ivec3&) { return glm::vec4(radiance, opacity); }),
               glm::ivec3(kResolution));
    for (const Way& way : {Way{"at_corners", "average", "added"}, Way{"in_leaves", "average", "averaged"}}) {
      const RadianceOctree octree = filteredOctree(leavesOf(list, way.voxels), way.opacity, way.borders);
      for (const int cones : {1, 6, 64})
        for (const double distance : {0.1, 0.25, 0.5}) {
          const double expected = 1.0 - std::pow(1.0 - opacity, distance / voxel);
          const glm::vec3 gathered = gather(emptyScene(), octree, glm::vec3(0.0f), {0, 1, 0},
                                            {cones, "cosine", 0, 0, distance, 0.25});
          CAPTURE(way.voxels, way.opacity, opacity, cones, distance);
          for (int c = 0; c < 3; ++c) CHECK(gathered[c] == Approx(radiance[c] * expected).epsilon(0.01));
        }
    }
  }
}

TEST_CASE("cones see in the octree what they see in the dense grid, however its bricks are looked up") {
  struct Way {
    const char *bricks, *lookUp;
  };
  for (const auto& [bricks, lookUp] :
       {Way{"own", "ranks"}, Way{"published", "ranks"}, Way{"published", "descent"}}) {
    const auto [dense, sparse] = bothOf(cornell(), 64, "float", "facing", bricks);
    for (const glm::vec3& place : {glm::vec3(0.1f, 0.1f, 0.1f), {0.0f, 0.45f, -0.1f}, {-0.15f, 0.4f, 0.05f}})
      for (const double clearance : {0.0, 0.5}) {  // the finest level alone, and wide voxels
        GatherSettings settings{16};
        settings.clearance = clearance;
        settings.lookUp = lookUp;
        const glm::vec3 normal = glm::normalize(glm::vec3(1, -2, 0.5f));
        const glm::vec3 a = gather(emptyScene(), dense, place, normal, settings),
                        b = gather(emptyScene(), sparse, place, normal, settings);
        CAPTURE(bricks, place.x, clearance, lookUp);
        CHECK(glm::length(a) > 1e-3f);
        for (int c = 0; c < 3; ++c) CHECK(b[c] == Approx(a[c]).epsilon(1e-3));
      }
  }
}

TEST_CASE("cones see the same in bricks of their own voxels and in those that hold their neighbours' too") {
  // Everywhere in the grid and beyond it, also where voxels lie at its very ends.
  const auto fill = [](const glm::ivec3& at) {
    const std::uint32_t hash =
        static_cast<std::uint32_t>(at.x * 73856093 ^ at.y * 19349663 ^ at.z * 83492791);
    return hash % 3 == 0 ? glm::vec4(0.1f + 0.1f * static_cast<float>(hash % 7), 0.5f, 0.25f, 0.125f)
                         : glm::vec4(0.0f);
  };
  for (const glm::ivec3& size : {glm::ivec3(16), glm::ivec3(13, 16, 6)}) {
    const VoxelFragments list = listOf(fragmentsWhere(size, fill), size);
    const RadianceOctree own = filteredOctree(leavesOf(list)),
                         published = filteredOctree(leavesOf(list, "as_grid", "float", "published"));
    REQUIRE(own.tree.nodes == nullptr);
    REQUIRE(published.tree.nodes != nullptr);
    for (int i = 0; i < 24; ++i) {
      const glm::vec3 apex(-1.2f + 0.1f * static_cast<float>(i), 0.9f - 0.08f * static_cast<float>(i),
                           0.05f * static_cast<float>(i % 5) - 1.0f);
      const glm::vec3 normal = glm::normalize(glm::vec3(i % 3 - 1, i % 2 == 0 ? 1 : -1, i % 5 - 2));
      const glm::vec3 a = gather(emptyScene(), published, apex, normal, {4}),
                      b = gather(emptyScene(), own, apex, normal, {4});
      CAPTURE(size.x, i);
      for (int c = 0; c < 3; ++c) CHECK(b[c] == Approx(a[c]).epsilon(1e-5).margin(1e-7));
    }
  }
}

TEST_CASE("as published, a sample between two levels is blended the other way round") {
  // One sample for each of the printed cones, of 2.8 voxels at a distance of 2: its level is log2 2.8
  // = 1.485. Opacities of voxels of the levels 1 and 2 of a uniform medium are 1 - (1-a)^2 and 1 - (1-a)^4;
  // the printed blend gives 0.515 to the coarser, where 0.485 is right. The printed exponent is 1.4 / 2.8.
  constexpr int kResolution = 64;
  constexpr double kOpacity = 0.25, kDiameter = 2.8, kWeights = 1.0 + 4.0 * 0.707;
  const VoxelFragments list =
      listOf(fragmentsWhere(glm::ivec3(kResolution),
                            [&](const glm::ivec3&) { return glm::vec4(1.0f, 1.0f, 1.0f, kOpacity); }),
             glm::ivec3(kResolution));
  const RadianceOctree octree = filteredOctree(leavesOf(list));
  GatherSettings settings;
  settings.asPublished = true;
  settings.coneRatio = kDiameter / 2.0;
  settings.reach = 2.5 * 2.0 / kResolution;
  const double share = 1.0 - (std::log2(kDiameter) - 1.0);
  const double fine = 1.0 - std::pow(1.0 - kOpacity, 2), coarse = 1.0 - std::pow(1.0 - kOpacity, 4),
               value = (1.0 - share) * fine + share * coarse;
  const double expected = kWeights * (1.0 - std::sqrt(1.0 - value)) * value;
  CHECK(gather(emptyScene(), octree, glm::vec3(0.0f), {0, 1, 0}, settings).x ==
        Approx(expected).epsilon(1e-3));
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

TEST_CASE("rules that need the voxels elsewhere are refused with what would do") {
  {
    const Scene scene = emptyScene();
    const VoxelFragments one = listOf({fragmentAt({3, 3, 3})}, glm::ivec3(8));
    PassHarness inject(device(), techniques(), "voxel_cone_tracing", "octree_inject", scene,
                       snapshotOf(scene, 0.0));
    inject.setParameter("bounces", 2);
    inject.setInput("fragments", one);
    inject.setInput("tree", treeOf(one, "at_corners"));
    CHECK_THROWS_WITH(inject.run(), Catch::Matchers::Contains("expected 'voxels as_grid'"));
  }
  const VoxelFragments list = listOf({fragmentAt({3, 3, 3})}, glm::ivec3(8));
  const RadianceOctree leaves = leavesOf(list, "at_corners");
  CHECK_THROWS_WITH(filteredOctree(leaves, "facing"),
                    Catch::Matchers::Contains("expected 'opacity average'"));
  GatherSettings descent;
  descent.lookUp = "descent";
  CHECK_THROWS_WITH(gather(emptyScene(), filteredOctree(leavesOf(list)), glm::vec3(0.0f), {0, 1, 0}, descent),
                    Catch::Matchers::Contains("'bricks published'"));
}

TEST_CASE("an octree that does not fit is refused with the bytes that it needs and the largest that fits") {
  const Scene scene = cornell();
  const Pipeline text = pipeline("voxel_cone_tracing_octree");
  const auto render = [&](std::uint64_t bytes, int resolution, bool published) {
    gpu::DeviceOptions options;
    options.memoryBytes = bytes;
    gpu::Device small(options);
    RenderOptions settings;
    settings.width = settings.height = 16;
    settings.parameters = text.settings({"resolution=" + std::to_string(resolution)});
    Pipeline pipelineOf = text;
    if (published) {
      std::ifstream file(sourceDirectory() / "scenes/pipelines/voxel_cone_tracing_octree.pipeline");
      std::string words((std::istreambuf_iterator<char>(file)), {});
      const std::string tree = "voxel_cone_tracing.octree { ";
      words.insert(words.find(tree) + tree.size(), "bricks published ");
      pipelineOf = Pipeline::parse(words, "made_by_a_test.pipeline");
    }
    PipelineExecutor executor(small, techniques(), scene, pipelineOf, settings);
    executor.render(0.0);
  };
  struct Limit {
    std::uint64_t bytes;
    int resolution, fits;
    bool published;
    const char* what;
  };
  for (const Limit& limit : {Limit{24u << 20, 128, 64, true, "takes "}}) {
    CAPTURE(limit.bytes, limit.resolution, limit.published);
    CHECK_THROWS_WITH(render(limit.bytes, limit.resolution, limit.published),
                      Catch::Matchers::Contains(fmt::format("an octree of {} voxels", limit.resolution)) &&
                          Catch::Matchers::Contains(limit.what) && Catch::Matchers::Contains("tags ") &&
                          Catch::Matchers::Contains("nodes ") && Catch::Matchers::Contains("bricks ") &&
                          Catch::Matchers::Contains(fmt::format("the largest that fits is {} ", limit.fits)));
    CHECK_NOTHROW(render(limit.bytes, limit.fits, limit.published));
  }
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
