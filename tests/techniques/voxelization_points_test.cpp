// Random points on triangles, and what the camera sees, as voxels.
#include <algorithm>
#include <cmath>

#include "lumivox/pipeline/pass.h"
#include "support/scene_builder.h"
#include "support/techniques.h"
#include "support/voxel_fragments.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

struct Setting {
  const char* name;
  double value;
};

Voxels pointsOf(const Scene& scene, const std::vector<Setting>& settings, std::uint64_t seed = 1) {
  PassHarness harness(device(), techniques(), "voxelization", "points", scene, snapshotOf(scene, 0.0));
  for (const Setting& setting : settings) {
    if (std::string(setting.name) == "adaptive")
      harness.setParameter("adaptive", std::string(setting.value != 0.0 ? "on" : "off"));
    else
      harness.setParameter(setting.name, setting.value);
  }
  harness.run(seed);
  return voxelsOf(harness.output<VoxelFragments>("fragments"));
}

/// One triangle: the half of a quad.
Scene oneTriangle(const glm::vec3& edge1, const glm::vec3& edge2) {
  SceneBuilder builder;
  Object& object = builder.quad({0, 0, 0}, edge1, edge2, builder.lambert(0.5f, 3.0f));
  object.parts.front().indexCount = 3;
  builder.scene.indices.resize(builder.scene.indices.size() - 3);
  return builder.scene;
}

/// A level square of `side` metres.
Scene floorOf(float side, const Material& material = {}) {
  SceneBuilder builder;
  builder.quad({0, 0, 0}, {0, 0, side}, {side, 0, 0}, builder.material(material));
  return builder.scene;
}

/// A texture of alternating texels of two values.
SurfaceTexture checkers(int size, bool mask) {
  SurfaceTexture texture;
  texture.name = "checkers";
  texture.width = texture.height = size;
  texture.mask = mask;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      for (int c = 0; c < (mask ? 1 : 3); ++c) texture.values.push_back((x + y) % 2 == 0 ? 1.0f : 0.0f);
  return texture;
}

}  // namespace

TEST_CASE("the points of a triangle are uniform over its area") {
  // The triangle (0,0), (3,0), (3,2) as the quad's first half, in sixteen congruent parts.
  constexpr int kPoints = 8000;
  const Scene scene = oneTriangle({3, 0, 0}, {0, 2, 0});
  const Voxels voxels = pointsOf(scene, {{"points", kPoints}, {"resolution", 64}});
  REQUIRE(voxels.fragments.size() == kPoints);
  std::array<int, 16> counts{};
  glm::dvec2 mean(0.0);
  for (const FragmentData& fragment : voxels.fragments) {
    const glm::dvec3 posWorld = fragment.position() * static_cast<double>(voxels.grid.voxelSize) +
                                glm::dvec3(voxels.grid.low) + glm::dvec3(snapshotOf(scene, 0.0).origin);
    // p = a (3,0) + b (3,2): a + b is x / 3, b is y / 2.
    const double b = posWorld.y / 2.0, a = posWorld.x / 3.0 - b;
    mean += glm::dvec2(a, b) / static_cast<double>(kPoints);
    CHECK(a >= -2e-4);
    CHECK(b >= -2e-4);
    CHECK(a + b <= 1.0 + 2e-4);
    // Row by b; within a row upright and turned triangles alternate.
    const int row = std::clamp(static_cast<int>(b * 4.0), 0, 3);
    const double u = a * 4.0, v = b * 4.0 - row;
    const int column = std::clamp(static_cast<int>(u), 0, 3 - row);
    const bool turned = u - column + v > 1.0 && column < 3 - row;
    const int before = row == 0 ? 0 : row == 1 ? 7 : row == 2 ? 12 : 15;
    ++counts[static_cast<std::size_t>(before + 2 * column + (turned ? 1 : 0))];
  }
  // A barycentric coordinate has mean 1/3 and variance 1/18.
  const double deviation = std::sqrt(1.0 / 18.0 / kPoints);
  CHECK(std::abs(mean.x - 1.0 / 3.0) < 4.0 * deviation);
  CHECK(std::abs(mean.y - 1.0 / 3.0) < 4.0 * deviation);
  double chiSquared = 0.0;
  const double expected = kPoints / 16.0;
  for (const int count : counts) chiSquared += (count - expected) * (count - expected) / expected;
  CHECK(chiSquared < 37.7);  // 15 degrees of freedom: exceeded once in a thousand
}

TEST_CASE("the same seed gives the same points and another seed others") {
  const Scene scene = litRoom(64, 64);
  const Voxels first = pointsOf(scene, {}, 7), again = pointsOf(scene, {}, 7), other = pointsOf(scene, {}, 8);
  const Voxels high = pointsOf(scene, {}, 7 + (std::uint64_t{1} << 32));
  CHECK(first.fragments == again.fragments);
  CHECK(first.fragments != other.fragments);
  CHECK(first.fragments != high.fragments);
}

TEST_CASE("each triangle gets exactly N points, and more points only add to them") {
  const Scene scene = litRoom(64, 64);
  const Voxels few = pointsOf(scene, {{"points", 40}}), many = pointsOf(scene, {{"points", 300}});
  CHECK(few.fragments.size() == 40 * scene.triangleCount());
  CHECK(many.fragments.size() == 300 * scene.triangleCount());
  CHECK(std::includes(many.fragments.begin(), many.fragments.end(), few.fragments.begin(),
                      few.fragments.end()));
}

TEST_CASE("regular points are the middles of the equal parts of a triangle, the next square number of them") {
  // 7 points ask for 9: each edge in 3 parts. The parts' middles, in units of a third of the edges: two
  // thirds of a row further for those that point to the first corner, one third for the others. Their mean is
  // the triangle's middle, and of the 9 parts none holds two.
  const Scene scene = oneTriangle({3, 0, 0}, {0, 3, 0});  // (0,0), (3,0), (3,3): parts of edge 1
  PassHarness harness(device(), techniques(), "voxelization", "points", scene, snapshotOf(scene, 0.0));
  harness.setParameter("resolution", 200);
  harness.setParameter("points", 7);
  harness.setParameter("spread", "regular");
  harness.run();
  const Voxels voxels = voxelsOf(harness.output<VoxelFragments>("fragments"));
  std::multiset<std::pair<long, long>> found, expected;
  for (const FragmentData& fragment : voxels.fragments) {
    const glm::dvec3 posWorld = fragment.position() * static_cast<double>(voxels.grid.voxelSize) +
                                glm::dvec3(voxels.grid.low) + glm::dvec3(snapshotOf(scene, 0.0).origin);
    found.insert(
        {std::lround(300.0 * posWorld.x), std::lround(300.0 * posWorld.y)});  // hundredths of a third
  }
  // First corner (0,0); a row is a step in x. Towards it: x = row + 2/3, y = i + 1/3; away: x = row + 1/3,
  // y = i + 2/3.
  for (int row = 0; row < 3; ++row) {
    for (int i = 0; i <= row; ++i) expected.insert({100 * (3 * row + 2), 100 * (3 * i + 1)});
    for (int i = 0; i < row; ++i) expected.insert({100 * (3 * row + 1), 100 * (3 * i + 2)});
  }
  CHECK(found == expected);
}

TEST_CASE(
    "regular points leave no voxel of a plane out from two on a voxel on, where random ones miss some") {
  // Parts of a voxel's half: their middles are at most 0.75 voxels apart, so that every voxel holds one.
  const Scene scene = floorOf(1.0f);
  const auto inner = [&](const char* spread) {
    PassHarness harness(device(), techniques(), "voxelization", "points", scene, snapshotOf(scene, 0.0));
    harness.setParameter("resolution", 64);
    harness.setParameter("adaptive", "on");
    harness.setParameter("density", 2.2);
    harness.setParameter("spread", spread);
    harness.run();
    std::set<Cell> cells;
    for (const Cell& cell : voxelsOf(harness.output<VoxelFragments>("fragments")).occupied)
      if (cell[0] >= 2 && cell[0] < 62 && cell[2] >= 2 && cell[2] < 62) cells.insert({cell[0], 0, cell[2]});
    return cells.size();
  };
  CHECK(inner("regular") == 3600);
  CHECK(inner("random") < 3400);
}

TEST_CASE("adaptive points follow the area, and a plane's voxel is missed with probability exp(-density)") {
  // 62 of 64 voxels span the floor: the area of one triangle is 62^2 / 2 voxels, up to the slack of the grid.
  const Scene scene = floorOf(1.0f);
  for (const double density : {0.5, 1.0, 2.0, 4.0}) {
    const Voxels voxels = pointsOf(scene, {{"adaptive", 1}, {"density", density}, {"resolution", 64}});
    const double side = 1.0 / voxels.grid.voxelSize;
    CHECK(voxels.fragments.size() == 2 * static_cast<std::size_t>(std::ceil(density * side * side / 2.0)));
    // Of columns that the floor covers as a whole; those on its rim are covered for 49 parts of 50 or so.
    std::set<Cell> inner;
    for (const Cell& cell : voxels.occupied)
      if (cell[0] >= 2 && cell[0] < 62 && cell[2] >= 2 && cell[2] < 62) inner.insert({cell[0], 0, cell[2]});
    const double cells = 60.0 * 60.0, missed = std::exp(-density);
    const double deviation = std::sqrt(cells * missed * (1.0 - missed));
    INFO("density " << density << ", voxels " << inner.size());
    CHECK(std::abs(static_cast<double>(inner.size()) - cells * (1.0 - missed)) < 4.0 * deviation);
  }
}

TEST_CASE("a point keeps albedo, normal and emission of its triangle") {
  const Voxels voxels = pointsOf(oneTriangle({1, 0, 0}, {0, 1, 0}), {});
  REQUIRE(voxels.fragments.size() == 19);
  for (const FragmentData& fragment : voxels.fragments) {
    CHECK(fragment.albedo() == glm::vec3(0.5f));
    CHECK(fragment.coverage() == 1.0f);
    CHECK(glm::length(fragment.unitNormal() - glm::vec3(0, 0, 1)) < 1e-4f);
    CHECK(fragment.emittedRadiance() == glm::vec3(3.0f));
  }
}

TEST_CASE("points see textures and masks through the mip that averages over a voxel") {
  Material material;
  material.diffuse = glm::vec3(1.0f);
  material.diffuseTexture = 0;
  material.maskTexture = 1;
  Scene scene = floorOf(1.0f, material);
  scene.textures = {checkers(256, false), checkers(256, true)};
  // 16 texels a voxel: every mean is 1/2, up to the half floats of the mips.
  const Voxels voxels = pointsOf(scene, {{"points", 200}, {"resolution", 16}});
  REQUIRE(voxels.fragments.size() == 400);
  for (const FragmentData& fragment : voxels.fragments) {
    CHECK(fragment.albedo().g == Approx(0.5f).margin(2e-3));
    CHECK(fragment.coverage() == Approx(0.5f).margin(2e-3));
  }
}

TEST_CASE("a surface that a mask takes away leaves no points") {
  Material material;
  material.diffuse = glm::vec3(1.0f);
  material.maskTexture = 0;
  Scene scene = floorOf(1.0f, material);
  SurfaceTexture hole = checkers(4, true);
  hole.values.assign(hole.values.size(), 0.0f);
  scene.textures = {hole};
  CHECK(pointsOf(scene, {}).fragments.empty());
}

TEST_CASE("points outside a grid around the camera are left out, whatever size the triangle has") {
  SceneBuilder builder;
  builder.quad({0, 0, 0}, {0, 0, 100}, {100, 0, 0}, builder.lambert(0.5f));
  // Grids count from the middle of the scene: 1.75 m below it the floor lies between two faces of voxels.
  builder.quad({0, 3.5f, 0}, {0, 0, 1}, {1, 0, 0}, builder.lambert(0.5f));
  Scene scene = builder.scene;
  scene.cameras.front().eye = {50, 0.5, 50};
  PassHarness harness(device(), techniques(), "voxelization", "points", scene, snapshotOf(scene, 0.0));
  harness.setParameter("around", std::string("camera"));
  harness.setParameter("extent", 8.0);
  harness.setParameter("resolution", 16);
  harness.setParameter("adaptive", std::string("on"));
  harness.run();
  const std::set<Cell> cells = cellsOf(fragmentsOf(harness.output<VoxelFragments>("fragments")));
  CHECK(cells.size() == 16 * 16);  // each is missed once in 3000
}

TEST_CASE("points of nothing, of a point and of a line are no special cases") {
  SceneBuilder empty;
  CHECK(pointsOf(empty.scene, {}).fragments.empty());
  for (const glm::vec3& edge : {glm::vec3(0, 0, 0), glm::vec3(1, 1, 0)}) {
    SceneBuilder builder;
    builder.quad({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, builder.lambert(0.5f));
    Scene scene = builder.scene;
    scene.positions[1] = scene.positions[0] + edge;
    scene.positions[2] = scene.positions[0] + 2.0f * edge;
    for (const double adaptive : {0.0, 1.0}) {
      const Voxels voxels = pointsOf(scene, {{"adaptive", adaptive}});
      CHECK(!voxels.fragments.empty());
      for (const FragmentData& fragment : voxels.fragments)
        CHECK(glm::length(fragment.unitNormal()) == Approx(1.0f));
    }
  }
}

namespace {

const char* const kReprojected = R"(pipeline "reprojected" {
  pass gbuffer direct_lighting.gbuffer { }
  pass points voxelization.points { resolution 32 }
  pass alone voxelization.reproject { gbuffer gbuffer resolution 32 }
  pass both voxelization.reproject { gbuffer gbuffer fragments points.fragments }
  pass direct direct_lighting.shade { gbuffer gbuffer }
  output direct direct.radiance
})";

const VoxelFragments& listOf(const PipelineExecutor& executor, const char* pass) {
  return static_cast<const Out<VoxelFragments>&>(*executor.output(pass, "fragments")).value();
}

}  // namespace

TEST_CASE("every pixel that sees a surface becomes one fragment in the voxel of what it sees") {
  const Scene scene = litRoom(48, 40);
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  PassHarness camera(device(), techniques(), "direct_lighting", "gbuffer", scene, snapshot);
  camera.run();
  const auto& gbuffer = camera.output<GBuffer>("gbuffer");
  PassHarness harness(device(), techniques(), "voxelization", "reproject", scene, snapshot);
  harness.setInput("gbuffer", gbuffer);
  harness.setParameter("resolution", 32);
  harness.run();
  const auto& list = harness.output<VoxelFragments>("fragments");
  const std::vector<FragmentData> fragments = fragmentsOf(list);

  const std::vector<float> positions = gbuffer.position->downloadFloats();
  const std::vector<float> emission = gbuffer.emission->downloadFloats();
  std::multiset<Cell> expected;
  std::size_t shining = 0;
  for (std::size_t pixel = 0; pixel < positions.size() / 4; ++pixel) {
    if (positions[4 * pixel + 3] == 0.0f) continue;
    Cell cell;
    for (int axis = 0; axis < 3; ++axis)
      cell[static_cast<std::size_t>(axis)] = static_cast<int>(
          std::floor((positions[4 * pixel + static_cast<std::size_t>(axis)] - list.grid.low[axis]) /
                     list.grid.voxelSize));
    expected.insert(cell);
    shining += emission[4 * pixel] > 0.0f;
  }
  std::multiset<Cell> found;
  std::size_t bright = 0;
  for (const FragmentData& fragment : fragments) {
    const glm::ivec3 cell = fragment.cell();
    found.insert({cell.x, cell.y, cell.z});
    bright += fragment.emittedRadiance().r > 0.0f;
  }
  CHECK(expected.size() > 500);
  CHECK(found == expected);
  CHECK(shining > 0);
  CHECK(bright == shining);
}

TEST_CASE("what the camera sees stands behind the fragments of another list, and none of either is lost") {
  const Scene scene = litRoom(48, 40);
  const Pipeline pipeline = Pipeline::parse(kReprojected, "reprojected.pipeline");
  PipelineExecutor executor(device(), techniques(), scene, pipeline, {});
  for (const char* pass : {"points", "alone", "both"}) executor.keepOutput(pass, "fragments");
  executor.render(0.0, 0, PipelineExecutor::Images::no);
  const std::vector<FragmentData> points = fragmentsOf(listOf(executor, "points")),
                                  alone = fragmentsOf(listOf(executor, "alone")),
                                  both = fragmentsOf(listOf(executor, "both"));
  std::vector<FragmentData> merged;
  std::merge(points.begin(), points.end(), alone.begin(), alone.end(), std::back_inserter(merged));
  CHECK(both == merged);
  // The first ones of the list are those of the input.
  std::vector<FragmentData> first = listOf(executor, "both").fragments->downloadValues<FragmentData>();
  first.resize(points.size());
  std::sort(first.begin(), first.end());
  CHECK(first == points);
  CHECK(listOf(executor, "both").grid == listOf(executor, "points").grid);
}

TEST_CASE(
    "all of a list stands before what the camera sees, in however many rows of groups it is dispatched") {
  const Scene scene = litRoom(8, 8);
  GBuffer nothing;
  gpu::TextureDescription description;
  description.format = gpu::Format::rgba32f;
  description.width = description.height = 8;
  const auto empty = std::make_shared<gpu::Texture>(device(), description, "nothing seen");
  empty->clear(glm::vec4(0.0f));
  nothing.position = nothing.normal = nothing.geometricNormal = nothing.diffuse = nothing.emission = empty;
  std::vector<FragmentData> fragments(300);
  for (std::size_t i = 0; i < fragments.size(); ++i)
    fragments[i].voxel = static_cast<std::uint32_t>(i % 8 | i / 8 % 8 << 10 | i / 64 << 20);
  std::sort(fragments.begin(), fragments.end());
  for (const glm::uvec2 groups : {glm::uvec2(5, 1), {3, 2}, {2, 3}, {1, 5}}) {
    CAPTURE(groups.x, groups.y);
    VoxelFragments list;
    list.grid = {glm::vec3(0.0f), 0.1f, glm::ivec3(8)};
    list.capacity = fragments.size();
    list.fragments = std::make_shared<gpu::Buffer>(device(), list.capacity * sizeof(FragmentData), "list");
    list.fragments->uploadValues(std::span<const FragmentData>(fragments));
    const std::array<std::uint32_t, 4> words{300, groups.x, groups.y, 1};
    list.count = std::make_shared<gpu::Buffer>(device(), sizeof(words), "count");
    list.count->uploadValues(std::span<const std::uint32_t>(words));
    PassHarness harness(device(), techniques(), "voxelization", "reproject", scene, snapshotOf(scene, 0.0));
    harness.setInput("gbuffer", nothing);
    harness.setInput("fragments", list);
    harness.run();
    CHECK(fragmentsOf(harness.output<VoxelFragments>("fragments")) == fragments);
  }
}

TEST_CASE("a seen back side keeps the normal of its front and does not shine") {
  SceneBuilder builder;
  builder.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, builder.lambert(0.5f, 2.0f));  // faces +z
  builder.look({0.5, 0.5, -2}, {0.5, 0.5, 0}, {0, 1, 0}, 0.8, 32, 32);
  const SceneSnapshot snapshot = snapshotOf(builder.scene, 0.0);
  PassHarness camera(device(), techniques(), "direct_lighting", "gbuffer", builder.scene, snapshot);
  camera.run();
  PassHarness harness(device(), techniques(), "voxelization", "reproject", builder.scene, snapshot);
  harness.setInput("gbuffer", camera.output<GBuffer>("gbuffer"));
  harness.run();
  const std::vector<FragmentData> fragments = fragmentsOf(harness.output<VoxelFragments>("fragments"));
  REQUIRE(!fragments.empty());
  for (const FragmentData& fragment : fragments) {
    CHECK(glm::length(fragment.unitNormal() - glm::vec3(0, 0, 1)) < 1e-4f);
    CHECK(fragment.emittedRadiance() == glm::vec3(0.0f));
  }
}

TEST_CASE("leaving out nothing gives the same points and the same seen voxels to the bit") {
  const Scene scene = litRoom(32, 32);
  const Pipeline pipeline = Pipeline::parse(kReprojected, "reprojected.pipeline");
  RenderOptions everything;
  everything.keepEverything = true;
  PipelineExecutor pruned(device(), techniques(), scene, pipeline, {}),
      whole(device(), techniques(), scene, pipeline, everything);
  for (PipelineExecutor* executor : {&pruned, &whole}) {
    executor->keepOutput("both", "fragments");
    executor->render(0.0, 0, PipelineExecutor::Images::no);
  }
  CHECK(fragmentsOf(listOf(pruned, "both")) == fragmentsOf(listOf(whole, "both")));
}

namespace {

/// Direct light that comes along with fragments, in the order of the list.
std::vector<std::uint32_t> reflectedBy(const VoxelFragments& list) {
  REQUIRE(list.reflected != nullptr);
  std::vector<std::uint32_t> words = list.reflected->downloadValues<std::uint32_t>();
  words.resize(list.count->downloadValues<std::uint32_t>()[0]);
  return words;
}

glm::vec3 unpackedRadiance(std::uint32_t word) {
  FragmentData fragment{};
  fragment.emission = word;
  return fragment.emittedRadiance();
}

/// The lit room without its glossy box: all that it reflects is diffuse.
Scene diffuseRoom(int width, int height) {
  Scene scene = litRoom(width, height);
  for (Material& material : scene.materials) material.specular = glm::vec3(0.0f);
  return scene;
}

const char* const kLit = R"(pipeline "lit" {
  pass gbuffer direct_lighting.gbuffer { }
  pass shadow direct_lighting.shadow_map { size 256 }
  pass direct direct_lighting.shade { gbuffer gbuffer shadow shadow.depth }
  pass points voxelization.points { resolution 16 points 3 }
  pass known voxelization.reproject { gbuffer gbuffer fragments points.fragments direct direct.radiance }
  pass seen voxelization.reproject { gbuffer gbuffer resolution 16 direct direct.radiance }
  pass unlit voxelization.reproject { gbuffer gbuffer resolution 16 }
  pass from_image voxel_cone_tracing.inject { fragments seen.fragments shadow shadow.depth precision float }
  pass from_lights voxel_cone_tracing.inject { fragments unlit.fragments shadow shadow.depth precision float }
  output direct direct.radiance
})";

}  // namespace

TEST_CASE("points of the image bring the direct light along that was computed there, and no others do") {
  const Scene scene = diffuseRoom(48, 40);
  const Pipeline pipeline = Pipeline::parse(kLit, "lit.pipeline");
  PipelineExecutor executor(device(), techniques(), scene, pipeline, {});
  for (const char* pass : {"points", "known", "seen"}) executor.keepOutput(pass, "fragments");
  executor.keepOutput("gbuffer", "gbuffer");
  const FrameResult frame = executor.render(0.0);
  const std::vector<std::uint32_t> known = reflectedBy(listOf(executor, "known"));
  const std::size_t points = listOf(executor, "points").count->downloadValues<std::uint32_t>()[0];
  REQUIRE(known.size() > points + 500);
  for (std::size_t i = 0; i < points; ++i) CHECK(known[i] == VoxelFragments::kNotKnown);
  // All pixels: what they show without what they emit. A packed radiance is right to 1/256 of its largest
  // component.
  const ImageBuffer& direct = frame.outputs.at("direct");
  const GBuffer& gbuffer = static_cast<const Out<GBuffer>&>(*executor.output("gbuffer", "gbuffer")).value();
  const std::vector<float> positions = gbuffer.position->downloadFloats(),
                           emission = gbuffer.emission->downloadFloats();
  std::vector<float> expected, found;
  for (int y = 0; y < direct.height(); ++y)
    for (int x = 0; x < direct.width(); ++x) {
      const std::size_t texel = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(direct.width()) +
                                     static_cast<std::size_t>(x));
      if (positions[texel + 3] != 0.0f) expected.push_back(direct.at(x, y, 0) - emission[texel]);
    }
  for (std::size_t i = points; i < known.size(); ++i) {
    REQUIRE(known[i] != VoxelFragments::kNotKnown);
    found.push_back(unpackedRadiance(known[i]).r);
  }
  std::sort(expected.begin(), expected.end());
  std::sort(found.begin(), found.end());
  REQUIRE(found.size() == expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    CHECK(found[i] == Approx(expected[i]).epsilon(0.01).margin(0.002));
  CHECK(found.back() > 0.3f);
}

TEST_CASE("light that came along by reprojection is the light that the voxels would have been given anew") {
  // Both light the same points of the same diffuse surfaces: one with the image's light, the other with the
  // lights and their shadow maps once more, from places rounded to 1/1023 of a voxel.
  const Scene scene = diffuseRoom(64, 64);
  const Pipeline pipeline = Pipeline::parse(kLit, "lit.pipeline");
  PipelineExecutor executor(device(), techniques(), scene, pipeline, {});
  for (const char* pass : {"from_image", "from_lights"}) executor.keepOutput(pass, "radiance");
  executor.render(0.0, 0, PipelineExecutor::Images::no);
  const auto sumOf = [&](const char* pass) {
    const auto& grid = static_cast<const Out<RadianceGrid>&>(*executor.output(pass, "radiance")).value();
    const std::vector<float> values = grid.radiance->downloadFloats();
    glm::dvec4 sum(0.0);
    for (std::size_t i = 0; i < values.size(); i += 4)
      sum += glm::dvec4(values[i], values[i + 1], values[i + 2], values[i + 3]) *
             glm::dvec4(glm::dvec3(grid.unit), 1.0);
    return sum;
  };
  const glm::dvec4 image = sumOf("from_image"), lights = sumOf("from_lights");
  CHECK(lights.r > 10.0);
  for (int channel = 0; channel < 3; ++channel)
    CHECK(image[channel] == Approx(lights[channel]).epsilon(0.03));
  CHECK(image.a == lights.a);
}

TEST_CASE("a fragment whose direct light is known reflects just that, whatever shines on it") {
  SceneBuilder builder;
  builder.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, builder.lambert(0.5f));
  builder.light(LightKind::point, glm::vec3(1e4f), {0, 0, 2});
  builder.look({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 0.9, 64, 64);
  const SceneSnapshot snapshot = snapshotOf(builder.scene, 0.0);
  PassHarness camera(device(), techniques(), "direct_lighting", "gbuffer", builder.scene, snapshot);
  camera.run();
  const GBuffer gbuffer = camera.output<GBuffer>("gbuffer");
  gpu::TextureDescription description;
  description.format = gpu::Format::rgba32f;
  description.width = description.height = 64;
  const auto painted = std::make_shared<gpu::Texture>(device(), description, "light");
  painted->clear(glm::vec4(7.0f, 3.5f, 1.75f, 1.0f));  // what eight bits hold exactly
  PassHarness reproject(device(), techniques(), "voxelization", "reproject", builder.scene, snapshot);
  reproject.setParameter("resolution", 8);
  reproject.setInput("gbuffer", gbuffer);
  reproject.setInput("direct", Image{painted});
  reproject.run();
  const VoxelFragments list = reproject.output<VoxelFragments>("fragments");
  PassHarness shadows(device(), techniques(), "direct_lighting", "shadow_map", builder.scene, snapshot);
  shadows.run();
  PassHarness inject(device(), techniques(), "voxel_cone_tracing", "inject", builder.scene, snapshot);
  inject.setParameter("precision", "float");
  inject.setInput("fragments", list);
  inject.setInput("shadow", shadows.output<ShadowMap>("depth"));
  inject.run();
  const auto& grid = inject.output<RadianceGrid>("radiance");
  const std::vector<float> values = grid.radiance->downloadFloats();
  int occupied = 0;
  for (std::size_t i = 0; i < values.size(); i += 4) {
    if (values[i + 3] == 0.0f) continue;
    ++occupied;
    CHECK(values[i] * grid.unit / values[i + 3] == Approx(7.0).epsilon(1e-4));
    CHECK(values[i + 1] * grid.unit / values[i + 3] == Approx(3.5).epsilon(1e-4));
    CHECK(values[i + 2] * grid.unit / values[i + 3] == Approx(1.75).epsilon(1e-4));
  }
  CHECK(occupied == 36);
  // A list that brings light along is not given light a second time.
  reproject.setInput("fragments", list);
  CHECK_THROWS_WITH(reproject.run(), Catch::Matchers::Contains("already contains direct light"));
  // An image of another size has no light for these pixels.
  description.width = 32;
  PassHarness wrong(device(), techniques(), "voxelization", "reproject", builder.scene, snapshot);
  wrong.setInput("gbuffer", gbuffer);
  wrong.setInput("direct", Image{std::make_shared<gpu::Texture>(device(), description, "light")});
  CHECK_THROWS_WITH(wrong.run(), Catch::Matchers::Contains("expected 64 x 64"));
}
