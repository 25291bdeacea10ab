// Random points on triangles, and what the camera sees, as voxels.
#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "support/facts.h"
#include "support/passes.h"
#include "support/voxel_fragments.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

Voxels pointsOf(const Scene& scene, const Settings& settings, std::uint64_t seed = 1) {
  return voxelsOf(
      LonePass("voxelization.points", scene, settings).run(seed).out<VoxelFragments>("fragments"));
}
/// In the world, m.
glm::dvec3 placeOf(const Scene& scene, const Voxels& voxels, const FragmentData& fragment) {
  return fragment.position() * double(voxels.grid.voxelSize) + glm::dvec3(voxels.grid.low) +
         snapshotOf(scene, 0.0).origin;
}
/// Columns that a level floor of 64 voxels covers as a whole; those on its rim are covered in part.
std::size_t innerColumns(const Voxels& voxels) {
  std::set<Cell> columns;
  for (const Cell& cell : voxels.occupied)
    if (cell[0] >= 2 && cell[0] < 62 && cell[2] >= 2 && cell[2] < 62) columns.insert({cell[0], 0, cell[2]});
  return columns.size();
}

/// The triangle of the origin, `edge1` and `edge1 + edge2`.
Scene oneTriangle(const glm::vec3& edge1, const glm::vec3& edge2) {
  SceneBuilder builder;
  builder.mesh({{0, 0, 0}, edge1, edge1 + edge2}, builder.lambert(0.5f, 3.0f));
  return builder.scene;
}

/// A level square of a metre.
Scene levelFloor() {
  SceneBuilder builder;
  builder.quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, builder.lambert(0.5f));
  return builder.scene;
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
    const glm::dvec3 posWorld = placeOf(scene, voxels, fragment);
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
  const Voxels voxels = pointsOf(scene, {{"resolution", 200}, {"points", 7}, {"spread", "regular"}});
  std::multiset<std::pair<long, long>> found, expected;
  for (const FragmentData& fragment : voxels.fragments) {
    const glm::dvec3 posWorld = placeOf(scene, voxels, fragment);
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
  const auto inner = [](const char* spread) {
    return innerColumns(pointsOf(
        levelFloor(), {{"resolution", 64}, {"adaptive", "on"}, {"density", 2.2}, {"spread", spread}}));
  };
  CHECK(inner("regular") == 3600);
  CHECK(inner("random") < 3400);
}

TEST_CASE("adaptive points follow the area, and a plane's voxel is missed with probability exp(-density)") {
  // 62 of 64 voxels span the floor: the area of one triangle is 62^2 / 2 voxels, up to the slack of the grid.
  const Scene scene = levelFloor();
  for (const double density : {0.5, 1.0, 2.0, 4.0}) {
    const Voxels voxels = pointsOf(scene, {{"adaptive", "on"}, {"density", density}, {"resolution", 64}});
    const double side = 1.0 / voxels.grid.voxelSize;
    CHECK(voxels.fragments.size() == 2 * static_cast<std::size_t>(std::ceil(density * side * side / 2.0)));
    const auto inner = static_cast<double>(innerColumns(voxels));
    const double cells = 60.0 * 60.0, missed = std::exp(-density);
    const double deviation = std::sqrt(cells * missed * (1.0 - missed));
    CAPTURE(density, inner);
    CHECK(std::abs(inner - cells * (1.0 - missed)) < 4.0 * deviation);
  }
}

TEST_CASE("points outside a grid around the camera are left out, whatever size the triangle has") {
  SceneBuilder builder;
  builder.quad({0, 0, 0}, {0, 0, 100}, {100, 0, 0}, builder.lambert(0.5f));
  // Grids count from the middle of the scene: 1.75 m below it the floor lies between two faces of voxels.
  builder.quad({0, 3.5f, 0}, {0, 0, 1}, {1, 0, 0}, builder.lambert(0.5f));
  Scene scene = builder.scene;
  scene.cameras.front().eye = {50, 0.5, 50};
  const std::set<Cell> cells =
      pointsOf(scene, {{"around", "camera"}, {"extent", 8}, {"resolution", 16}, {"adaptive", "on"}}).occupied;
  CHECK(cells.size() == 16 * 16);  // each is missed once in 3000
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
  return kept<VoxelFragments>(executor, pass, "fragments");
}

}  // namespace

TEST_CASE("every pixel that sees a surface becomes one fragment in the voxel of what it sees") {
  const Scene scene = litRoom(48, 40);
  const GBuffer gbuffer = gbufferOf(scene);
  const VoxelFragments list = LonePass("voxelization.reproject", scene, {{"resolution", 32}})
                                  .in("gbuffer", gbuffer)
                                  .out<VoxelFragments>("fragments");
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
  const GBuffer nothing = gbufferAt({.hit = false});
  std::vector<FragmentData> fragments(300);
  for (std::size_t i = 0; i < fragments.size(); ++i)
    fragments[i].voxel = static_cast<std::uint32_t>(i % 8 | i / 8 % 8 << 10 | i / 64 << 20);
  std::sort(fragments.begin(), fragments.end());
  for (const glm::uvec2 groups : {glm::uvec2(5, 1), {3, 2}, {2, 3}, {1, 5}}) {
    CAPTURE(groups.x, groups.y);
    VoxelFragments list;
    list.grid = {glm::vec3(0.0f), 0.1f, glm::ivec3(8)};
    list.capacity = fragments.size();
    list.fragments = bufferOf(fragments);
    list.count = bufferOf<std::uint32_t>({300, groups.x, groups.y, 1});
    LonePass reproject("voxelization.reproject", scene);
    reproject.in("gbuffer", nothing).in("fragments", list);
    CHECK(fragmentsOf(reproject.out<VoxelFragments>("fragments")) == fragments);
  }
}

TEST_CASE("a seen back side keeps the normal of its front and does not shine") {
  SceneBuilder builder;
  builder.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, builder.lambert(0.5f, 2.0f));  // faces +z
  builder.look({0.5, 0.5, -2}, {0.5, 0.5, 0}, {0, 1, 0}, 0.8, 32, 32);
  const std::vector<FragmentData> fragments = fragmentsOf(LonePass("voxelization.reproject", builder.scene)
                                                              .in("gbuffer", gbufferOf(builder.scene))
                                                              .out<VoxelFragments>("fragments"));
  REQUIRE(!fragments.empty());
  for (const FragmentData& fragment : fragments) {
    CHECK(glm::length(fragment.unitNormal() - glm::vec3(0, 0, 1)) < 1e-4f);
    CHECK(fragment.emittedRadiance() == glm::vec3(0.0f));
  }
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
  const GBuffer& gbuffer = kept<GBuffer>(executor, "gbuffer", "gbuffer");
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
    const auto& grid = kept<RadianceGrid>(executor, pass, "radiance");
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
  LonePass reproject("voxelization.reproject", builder.scene, {{"resolution", 8}});
  reproject.in("gbuffer", gbufferOf(builder.scene));
  // What eight bits hold exactly.
  reproject.in("direct", Image{filled(pixels(64, 64), {7.0f, 3.5f, 1.75f, 1.0f})});
  const VoxelFragments list = reproject.out<VoxelFragments>("fragments");
  const RadianceGrid grid = LonePass("voxel_cone_tracing.inject", builder.scene, {{"precision", "float"}})
                                .in("fragments", list)
                                .in("shadow", shadowsOf(builder.scene))
                                .out<RadianceGrid>("radiance");
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
  CHECK_THROWS_MATCHES(reproject.in("fragments", list).run(), Error, Tells("fragments", "direct"));
  // An image of another size has no light for these pixels.
  LonePass wrong("voxelization.reproject", builder.scene);
  wrong.in("gbuffer", gbufferOf(builder.scene)).in("direct", Image{filled(pixels(32, 64), glm::vec4(1.0f))});
  CHECK_THROWS_MATCHES(wrong.run(), Error, Tells("direct", 32, 64, 64, 64));
}
