// Voxels from a texture atlas of the surface, as bits and with attributes.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "lumivox/base/error.h"
#include "lumivox/pipeline/pass.h"
#include "support/scene_builder.h"
#include "support/techniques.h"
#include "support/voxel_fragments.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// One frame of one atlas pass alone.
class Atlas {
 public:
  Atlas(const Scene& scene, const char* pass, int resolution, double texelsPerVoxel = 2.0,
        double pointSize = 1.0)
      : harness_(device(), techniques(), "voxelization", pass, scene, snapshotOf(scene, 0.0)) {
    harness_.setParameter("resolution", resolution);
    harness_.setParameter("texels_per_voxel", texelsPerVoxel);
    if (pointSize != 1.0) harness_.setParameter("point_size", pointSize);
    harness_.run();
  }
  Voxels fragments() { return voxelsOf(harness_.output<VoxelFragments>("fragments")); }
  std::set<Cell> bits(int level = 0) { return cellsOf(harness_.output<BinaryGrid>("bits"), level); }

 private:
  PassHarness harness_;
};

std::set<Cell> conservative(const Scene& scene, int resolution) {
  PassHarness harness(device(), techniques(), "voxelization", "conservative", scene, snapshotOf(scene, 0.0));
  harness.setParameter("resolution", resolution);
  harness.run();
  return voxelsOf(harness.output<VoxelFragments>("fragments")).occupied;
}

/// A box and a tilted plate.
Scene still() {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f, 2.0f);
  builder.box({-0.9f, -0.9f, -0.9f}, {-0.3f, 0.1f, 0.2f}, grey, false);
  builder.quad({0.9f, -0.9f, -0.8f}, {-0.5f, 1.4f, 0.3f}, {0.1f, 0.2f, 1.5f}, grey);
  return builder.scene;
}

/// The same, and a box that turns and travels.
Scene moving() {
  SceneBuilder builder;
  builder.scene = still();
  const std::size_t first = builder.scene.objects.size();
  builder.box({0.1f, 0.1f, -0.3f}, {0.5f, 0.4f, 0.2f}, 0, false);
  for (std::size_t o = first; o < builder.scene.objects.size(); ++o)
    builder.scene.objects[o].motion = RigidMotion{{1, 2, 0.5}, 0.9, {0.3, 0.2, 0}, {0.01, 0, 0}};
  return builder.scene;
}

const char* const kBoth = R"(pipeline "atlas" {
  pass gbuffer direct_lighting.gbuffer { }
  pass direct direct_lighting.shade { gbuffer gbuffer }
  pass binary voxelization.atlas_binary { resolution 24 }
  pass attributes voxelization.atlas_attributes { resolution 24 }
  output direct direct.radiance
})";

struct Run {
  Run(const Scene& scene, bool keepEverything = false)
      : executor(device(), techniques(), scene, Pipeline::parse(kBoth, "atlas.pipeline"),
                 options(keepEverything)) {
    executor.keepOutput("binary", "bits");
    executor.keepOutput("attributes", "fragments");
  }
  static RenderOptions options(bool keepEverything) {
    RenderOptions options;
    options.width = options.height = 8;
    options.keepEverything = keepEverything;
    return options;
  }
  std::pair<std::set<Cell>, Voxels> at(double time) {
    executor.render(time, 0, PipelineExecutor::Images::no);
    return {
        cellsOf(static_cast<const Out<BinaryGrid>&>(*executor.output("binary", "bits")).value()),
        voxelsOf(
            static_cast<const Out<VoxelFragments>&>(*executor.output("attributes", "fragments")).value())};
  }
  PipelineExecutor executor;
};

}  // namespace

TEST_CASE("bits and fragments of an atlas are in the same voxels, and all of them touch the surface") {
  for (const int resolution : {16, 48}) {
    const Scene scene = still();
    const std::set<Cell> bits = Atlas(scene, "atlas_binary", resolution).bits(),
                         exact = conservative(scene, resolution);
    CHECK(bits == Atlas(scene, "atlas_attributes", resolution).fragments().occupied);
    CHECK(std::includes(exact.begin(), exact.end(), bits.begin(), bits.end()));
    // Voxels that the surface only grazes are missed.
    CHECK(static_cast<double>(bits.size()) > 0.75 * static_cast<double>(exact.size()));
  }
}

TEST_CASE(
    "at the default density no line along an axis slips through a tilted plane, at a third of it some do") {
  // The plane crosses every column (x, z) of its extent: with texels 0.71 voxels apart at most, each column
  // whose middle lies well inside has a bit.
  SceneBuilder builder;
  builder.quad({-1, -0.3f, -1}, {0, 0.25f, 2}, {2, 0.35f, 0}, builder.lambert(0.5f));
  const auto emptyColumns = [&](double texelsPerVoxel) {
    const std::set<Cell> bits = Atlas(builder.scene, "atlas_binary", 64, texelsPerVoxel).bits();
    std::set<std::pair<int, int>> columns;
    for (const Cell& cell : bits) columns.insert({cell[0], cell[2]});
    int empty = 0;
    for (int x = 2; x < 62; ++x)
      for (int z = 2; z < 62; ++z) empty += columns.count({x, z}) == 0;
    return empty;
  };
  CHECK(emptyColumns(2.0) == 0);
  CHECK(emptyColumns(0.7) > 100);
}

TEST_CASE("no line along an axis passes a sphere without meeting its voxels where it crosses the sphere") {
  // Flat quads of a sphere of radius 1, finer than the voxels.
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  constexpr int kRings = 96;
  const auto at = [](int i, int j) {
    const double theta = kPi * i / kRings, phi = kPi * j / kRings;
    return glm::vec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
  };
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < 2 * kRings; ++j) {
      // Two triangles: the halves of parallelograms over three of the four corners.
      const glm::vec3 a = at(i, j), b = at(i, j + 1), c = at(i + 1, j + 1), d = at(i + 1, j);
      for (const auto& [corner, edge1, edge2] : {std::tuple{b, a - b, c - b}, std::tuple{d, c - d, a - d}}) {
        builder.quad(corner, edge1, edge2, grey).parts.front().indexCount = 3;
        builder.scene.indices.resize(builder.scene.indices.size() - 3);
      }
    }
  builder.scene.normals.assign(builder.scene.normals.size(), glm::vec3(0, 1, 0));
  Object whole;
  whole.name = "sphere";
  whole.vertexCount = static_cast<std::uint32_t>(builder.scene.positions.size());
  whole.parts.push_back({grey, 0, static_cast<std::uint32_t>(builder.scene.indices.size())});
  std::vector<std::uint32_t> indices;
  for (const Object& object : builder.scene.objects)
    for (std::uint32_t k = 0; k < 3; ++k)
      indices.push_back(builder.scene.indices[object.parts.front().firstIndex + k]);
  builder.scene.indices = indices;
  whole.parts.front().indexCount = static_cast<std::uint32_t>(indices.size());
  builder.scene.objects = {whole};

  PassHarness harness(device(), techniques(), "voxelization", "atlas_binary", builder.scene,
                      snapshotOf(builder.scene, 0.0));
  harness.setParameter("resolution", 64);
  harness.run();
  const auto& grid = harness.output<BinaryGrid>("bits");
  const std::set<Cell> bits = cellsOf(grid);
  const glm::dvec3 low = glm::dvec3(grid.grid.low) + snapshotOf(builder.scene, 0.0).origin;
  const double voxel = grid.grid.voxelSize;
  std::size_t crossings = 0, missed = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 64; ++i)
      for (int j = 0; j < 64; ++j) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        const double x = low[u] + (i + 0.5) * voxel, y = low[v] + (j + 0.5) * voxel;
        if (x * x + y * y >= 1.0 - 1.0 / 64.0) continue;  // farther in than the facets reach
        for (const double side : {-1.0, 1.0}) {
          const double depth = (side * std::sqrt(1.0 - x * x - y * y) - low[axis]) / voxel;
          bool met = false;
          for (int k = static_cast<int>(std::floor(depth - 1.5)); k <= static_cast<int>(depth + 1.5); ++k) {
            Cell cell{};
            cell[static_cast<std::size_t>(axis)] = k;
            cell[static_cast<std::size_t>(u)] = i;
            cell[static_cast<std::size_t>(v)] = j;
            met = met || bits.count(cell) == 1;
          }
          ++crossings;
          missed += !met;
        }
      }
  CHECK(crossings > 15000);
  CHECK(missed == 0);
}

TEST_CASE("each level of the stacks is the union of the finer one and keeps the depth") {
  const Scene scene = still();
  PassHarness harness(device(), techniques(), "voxelization", "atlas_binary", scene, snapshotOf(scene, 0.0));
  harness.setParameter("resolution", 37);
  harness.run();
  const auto& grid = harness.output<BinaryGrid>("bits");
  const gpu::TextureDescription& description = grid.stacks->description();
  CHECK(description.levels == gpu::fullLevelCount(grid.grid.resolution.x, grid.grid.resolution.y));
  std::set<Cell> finer = cellsOf(grid);
  CHECK(!finer.empty());
  for (int level = 1; level < description.levels; ++level) {
    std::set<Cell> expected;
    for (const Cell& cell : finer)
      expected.insert({std::min(cell[0] / 2, std::max(description.width >> level, 1) - 1),
                       std::min(cell[1] / 2, std::max(description.height >> level, 1) - 1), cell[2]});
    CHECK(cellsOf(grid, level) == expected);
    finer = expected;
  }
}

TEST_CASE("a fragment of the atlas has the attributes of its place") {
  SceneBuilder builder;
  Material material;
  material.diffuse = {0.25f, 0.5f, 0.75f};
  material.emission = {4, 2, 0};
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.material(material));
  const Voxels voxels = Atlas(builder.scene, "atlas_attributes", 16).fragments();
  REQUIRE(!voxels.fragments.empty());
  for (const FragmentData& fragment : voxels.fragments) {
    CHECK(fragment.albedo() == material.diffuse);
    CHECK(fragment.coverage() == 1.0f);
    CHECK(glm::length(fragment.unitNormal() - glm::vec3(0, 1, 0)) < 1e-4f);
    CHECK(fragment.emittedRadiance() == material.emission);
  }
}

TEST_CASE("masks take bits and fragments away, and textures are averaged over a voxel") {
  SceneBuilder builder;
  Material material;
  material.diffuse = glm::vec3(1.0f);
  material.diffuseTexture = 0;
  material.maskTexture = 1;
  builder.quad({0, 0.1f, 0}, {0, 0, 1}, {1, 0, 0}, builder.material(material));
  // Texels of alternating brightness; a mask that is a hole on one half.
  SurfaceTexture checkers, half;
  checkers.width = checkers.height = 256;
  half.width = half.height = 16;
  half.mask = true;
  for (int i = 0; i < 256 * 256; ++i)
    checkers.values.insert(checkers.values.end(), 3, (i + i / 256) % 2 == 0 ? 1.0f : 0.0f);
  for (int i = 0; i < 16 * 16; ++i) half.values.push_back(i % 16 < 8 ? 1.0f : 0.0f);
  builder.scene.textures = {checkers, half};
  const Scene& scene = builder.scene;
  const Voxels voxels = Atlas(scene, "atlas_attributes", 18).fragments();
  const std::set<Cell> bits = Atlas(scene, "atlas_binary", 18).bits();
  CHECK(bits == voxels.occupied);
  // 16 voxels a side; one half and a voxel of its blurred border on either side of it and of the quad.
  CHECK(bits.size() >= 16u * 8u);
  CHECK(bits.size() <= 18u * 11u);
  for (const FragmentData& fragment : voxels.fragments)
    CHECK(fragment.albedo().g == Approx(0.5f).margin(3e-3));
}

TEST_CASE("the atlas follows what turns, travels and deforms, and each frame is that of a fresh run") {
  const Scene scene = moving();
  Run run(scene);
  std::set<Cell> before;
  for (const double time : {0.0, 0.8, 0.4, 50.0}) {
    const auto [bits, voxels] = run.at(time);
    const auto [freshBits, freshVoxels] = Run(scene).at(time);
    CHECK(bits == freshBits);
    CHECK(voxels.fragments == freshVoxels.fragments);
    const auto [wholeBits, wholeVoxels] = Run(scene, true).at(time);
    CHECK(bits == wholeBits);
    CHECK(voxels.fragments == wholeVoxels.fragments);
    CHECK(bits == voxels.occupied);
    CHECK(bits != before);
    before = bits;
  }

  SceneBuilder builder;
  Object& sheet = builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.5f));
  VertexSequence sequence;
  sequence.framesPerSecond = 1.0;
  for (const float height : {0.0f, 1.0f}) {
    sequence.positions.push_back(builder.scene.positions);
    for (glm::vec3& place : sequence.positions.back()) place.y = height;
    sequence.normals.push_back(builder.scene.normals);
  }
  sheet.sequence = sequence;
  Run deforming(builder.scene);
  std::set<int> heights;
  for (const double time : {0.0, 0.5}) {
    std::set<int> rows;
    for (const Cell& cell : deforming.at(time).first) rows.insert(cell[1]);
    CHECK(rows.size() == 1);
    heights.insert(rows.begin(), rows.end());
  }
  CHECK(heights.size() == 2);
}

TEST_CASE("the fragments of bits are black and opaque, one for every voxel") {
  const Scene scene = still();
  Atlas atlas(scene, "atlas_binary", 24);
  const Voxels voxels = atlas.fragments();
  CHECK(voxels.occupied == atlas.bits());
  CHECK(voxels.fragments.size() == voxels.occupied.size());
  for (const FragmentData& fragment : voxels.fragments) {
    CHECK(fragment.albedo() == glm::vec3(0.0f));
    CHECK(fragment.coverage() == 1.0f);
    CHECK(fragment.emission == 0);
  }
}

TEST_CASE("an atlas of nothing has no voxels, and one that is too fine says how large it would be") {
  const Scene nothing = SceneBuilder().scene, scene = still();
  CHECK(Atlas(nothing, "atlas_binary", 16).bits().empty());
  CHECK(Atlas(nothing, "atlas_attributes", 16).fragments().fragments.empty());
  CHECK(messageOf<Error>([&] { Atlas(scene, "atlas_binary", 1024, 16.0); }).find("the atlas would have") !=
        std::string::npos);
}

TEST_CASE(
    "larger points close a wall across the stacks whose atlas is too small, and thicken one along them") {
  // 0.7 texels along a voxel are 1.43 voxels apart: whole rows and columns are missed. A point of side s
  // reaches the centres of voxels within s / 2 of it in x and y: 1.5 is enough where 1 is not. Along the
  // stacks, z, it reaches nothing (thesis 004, Listing 4.41: what grows is a point in the image of stacks).
  for (const int axis : {0, 2}) {
    INFO("a wall across "
         << "xyz"[axis]);
    SceneBuilder builder;
    glm::vec3 corner(-1.0f), edge1(0.0f), edge2(0.0f);
    corner[axis] = 0.013f;
    edge1[(axis + 1) % 3] = edge2[(axis + 2) % 3] = 2.0f;
    builder.quad(corner, edge1, edge2, builder.lambert(0.5f));
    const std::set<Cell> exact = conservative(builder.scene, 34),
                         one = Atlas(builder.scene, "atlas_binary", 34, 0.7).bits(),
                         larger = Atlas(builder.scene, "atlas_binary", 34, 0.7, axis == 2 ? 1.5 : 2.5).bits();
    const auto closed = [&](const std::set<Cell>& bits) {
      return std::count_if(exact.begin(), exact.end(),
                           [&](const Cell& cell) { return bits.count(cell) == 1; });
    };
    std::set<int> layers;
    for (const Cell& cell : larger) layers.insert(cell[static_cast<std::size_t>(axis)]);
    CHECK(one.size() < 0.6 * static_cast<double>(exact.size()));
    CHECK(std::includes(larger.begin(), larger.end(), one.begin(), one.end()));
    if (axis == 2) {
      CHECK(closed(larger) == static_cast<std::ptrdiff_t>(exact.size()));
      CHECK(layers.size() == 1);
    } else {
      // Rows along y are closed, whole rows along z stay missing: 0.7 of them are met.
      CHECK(static_cast<double>(closed(larger)) ==
            Approx(0.7 * static_cast<double>(exact.size())).epsilon(0.1));
      CHECK(layers.size() == 3);
    }
  }
}

TEST_CASE("a point of one voxel is the voxel that it lies in, for any place") {
  const Scene scene = still();
  CHECK(Atlas(scene, "atlas_binary", 37).bits() == Atlas(scene, "atlas_attributes", 37).fragments().occupied);
}
