// All bounces over frames in turns: each voxel gathers the light of the frame before once in as many frames,
// and reflects meanwhile what it did.
#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "support/facts.h"
#include "support/moving_room.h"
#include "support/octree.h"
#include "support/passes.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::cones;

namespace {

constexpr int kSide = 16;
constexpr std::uint64_t kRoom = 4 * kSide * kSide;  // voxels that lists and trees have room for
constexpr float kAlbedo = 0.5f;

/// Radiance of each occupied voxel, over its albedo.
using Seen = std::map<Cell, double>;

void see(Seen& seen, const gpu::TextureRef& texture, const glm::ivec3& size) {
  const std::vector<float> texels = texture->downloadFloats(0);
  for (int i = 0; i < size.x * size.y * size.z; ++i) {
    const float* texel = texels.data() + 4 * static_cast<std::size_t>(i);
    if (texel[3] <= 0.0f) continue;
    double& value = seen[{i % size.x, i / size.x % size.y, i / (size.x * size.y)}];
    value = std::max(value, static_cast<double>(texel[0] / texel[3] / kAlbedo));
  }
}

/// A store that holds this radiance everywhere, what the pass that fills such a store is called, and what
/// each voxel of one reflects.
template <class Store>
struct Kind;
template <>
struct Kind<RadianceGrid> {
  static constexpr const char* kPass = "inject";
  static RadianceGrid filledWith(float radiance) {
    return filtered(uniformGrid(kSide, glm::vec4(glm::vec3(radiance), 1.0f)));
  }
  static Seen seenIn(const RadianceGrid& grid) {
    Seen seen;
    see(seen, grid.radiance, grid.grid.resolution);
    return seen;
  }
};
template <>
struct Kind<DirectionalRadianceGrid> {
  static constexpr const char* kPass = "inject_directional";
  static DirectionalRadianceGrid filledWith(float radiance) {
    return filteredDirections(
        makeDirections(kSide, [&](int, int, int, int) { return glm::vec4(glm::vec3(radiance), 1.0f); }));
  }
  static Seen seenIn(const DirectionalRadianceGrid& grid) {
    Seen seen;
    for (const gpu::TextureRef& face : grid.faces) see(seen, face, grid.grid.resolution);
    return seen;
  }
};
template <>
struct Kind<octree::RadianceOctree> {
  static constexpr const char* kPass = "octree_inject";
  static octree::RadianceOctree filledWith(float radiance) {
    std::vector<FragmentData> all;
    for (int i = 0; i < kSide * kSide * kSide; ++i)
      all.push_back(
          octree::fragmentAt({i % kSide, i / kSide % kSide, i / (kSide * kSide)}, glm::vec3(radiance)));
    return octree::filteredOctree(octree::leavesOf(octree::listOf(all, glm::ivec3(kSide))));
  }
  static Seen seenIn(const octree::RadianceOctree& octree) {
    Seen seen;
    for (const VoxelsRead::Voxel& one : octree.voxels(0, 0))
      seen[octree::cellOf(one.voxel)] = static_cast<double>(one.value.x / kAlbedo);
    return seen;
  }
};

/// Frames in a row that find the light `radiance` everywhere in the frame before.
template <class Store>
class Frames {
 public:
  explicit Frames(int turns) { inject_.setParameter("turns", turns), inject_.accumulate(); }
  Seen next(const VoxelFragments& list, float radiance) {
    inject_.setInput("fragments", list);
    if constexpr (std::is_same_v<Store, octree::RadianceOctree>) {
      octree::VoxelOctree tree = octree::treeOf(list);
      tree.leafRoom = kRoom;  // as in a run, where there is as much as any frame wanted
      inject_.setInput("tree", tree);
    }
    inject_.setInput("before", Kind<Store>::filledWith(radiance));
    inject_.run();
    return Kind<Store>::seenIn(inject_.template output<Store>("radiance"));
  }

 private:
  Scene scene_ = emptyScene();
  PassHarness inject_{device(),           techniques(), "voxel_cone_tracing",
                      Kind<Store>::kPass, scene_,       snapshotOf(scene_, 0.0)};
};

/// All cells of walls across the axes, within the store that the frames find, and room for more walls.
VoxelFragments wallsAt(const std::vector<std::pair<int, int>>& axisAndPlace) {
  std::set<Cell> cells;
  for (const auto& [axis, place] : axisAndPlace)
    for (int i = 0; i < kSide * kSide; ++i) {
      Cell cell{};
      cell[static_cast<std::size_t>(axis)] = place;
      cell[static_cast<std::size_t>((axis + 1) % 3)] = i % kSide;
      cell[static_cast<std::size_t>((axis + 2) % 3)] = i / kSide;
      cells.insert(cell);
    }
  std::vector<FragmentData> fragments;
  for (const Cell& cell : cells)
    fragments.push_back(octree::fragmentAt({cell[0], cell[1], cell[2]}, glm::vec3(kAlbedo)));
  VoxelFragments list = octree::listOf(fragments, glm::ivec3(kSide));
  list.grid = {glm::vec3(-0.5f), 1.0f / kSide, glm::ivec3(kSide)};
  list.capacity = kRoom;
  return list;
}

/// The voxels of a wall that reflect this radiance.
int reflecting(const Seen& seen, int axis, int place, double radiance) {
  return static_cast<int>(std::ranges::count_if(seen, [&](const auto& one) {
    return one.first[static_cast<std::size_t>(axis)] == place && one.second == Approx(radiance).epsilon(1e-3);
  }));
}

}  // namespace

TEMPLATE_TEST_CASE("each voxel gathers light once in as many frames as there are turns, and walls evenly", "",
                   RadianceGrid, DirectionalRadianceGrid, octree::RadianceOctree) {
  for (const int turns : {1, 2, 4, 8}) {
    Frames<TestType> frames(turns);
    const std::vector<std::pair<int, int>> walls{{0, 4}, {1, 7}, {2, 10}};
    const VoxelFragments list = wallsAt(walls);
    constexpr int kWall = kSide * kSide;
    const Seen first = frames.next(list, 0.1f);
    for (const auto& [axis, place] : walls) REQUIRE(reflecting(first, axis, place, 0.1) == kWall);
    std::map<Cell, int> gathered;
    for (int frame = 0; frame < turns; ++frame) {
      const float radiance = 0.1f * static_cast<float>(frame + 2);
      const Seen seen = frames.next(list, radiance);
      for (const auto& [cell, value] : seen)
        if (value == Approx(radiance).epsilon(1e-3)) ++gathered[cell];
      CAPTURE(turns, frame);
      // A wall has as many voxels of each turn.
      for (const auto& [axis, place] : walls) CHECK(reflecting(seen, axis, place, radiance) == kWall / turns);
    }
    CHECK(std::ranges::all_of(gathered, [](const auto& one) { return one.second == 1; }));
    CHECK(gathered.size() == first.size());
  }
}

TEMPLATE_TEST_CASE("a voxel that was empty gathers light at once, and what it reflected earlier is forgotten",
                   "", RadianceGrid, octree::RadianceOctree) {
  Frames<TestType> frames(8);
  const VoxelFragments one = wallsAt({{2, 5}}), both = wallsAt({{2, 5}, {2, 9}});
  constexpr int kWall = kSide * kSide, kTurn = kWall / 8;
  CHECK(reflecting(frames.next(one, 0.1f), 2, 5, 0.1) == kWall);
  const Seen second = frames.next(both, 0.2f);
  CHECK(reflecting(second, 2, 9, 0.2) == kWall);
  CHECK(reflecting(second, 2, 5, 0.2) == kTurn);
  CHECK(reflecting(second, 2, 5, 0.1) == kWall - kTurn);
  const Seen third = frames.next(one, 0.3f);
  CHECK(third.size() == kWall);
  CHECK(reflecting(third, 2, 5, 0.3) == kTurn);
  CHECK(reflecting(third, 2, 5, 0.2) == kTurn);
  const Seen fourth = frames.next(both, 0.4f);
  CHECK(reflecting(fourth, 2, 9, 0.4) == kWall);
  CHECK(reflecting(fourth, 2, 5, 0.1) == kWall - 3 * kTurn);
}

TEST_CASE("a grid that has moved gathers all light anew") {
  Frames<RadianceGrid> frames(8);
  VoxelFragments list = wallsAt({{2, 5}});
  frames.next(list, 0.1f);
  list.grid.low.x += 0.25f;
  CHECK(reflecting(frames.next(list, 0.2f), 2, 5, 0.2) == kSide * kSide);
}

TEST_CASE("octrees and a clipmap of one level hold the light of six grids in every frame, whatever moves") {
  const Scene scene = movingRoom(lamp);
  const auto run = [&](const std::string& name, const std::vector<std::string>& settings) {
    const Pipeline text = pipeline(name);
    RenderOptions options = sized(16, 16);
    options.accumulate = true;
    options.parameters = text.settings(settings);
    PipelineExecutor executor(device(), techniques(), scene, text, options);
    std::vector<ImageBuffer> frames;
    for (int frame = 0; frame < 10; ++frame)
      frames.push_back(executor.render(0.3 * frame, frame).outputs.at("indirect_diffuse"));
    return frames;
  };
  const auto grids = run("voxel_cone_tracing_directional_all_bounces", {"resolution=24"}),
             octrees = run("voxel_cone_tracing_octree_directional_all_bounces", {"resolution=24"}),
             clipmaps = run("voxel_cone_tracing_clipmap_all_bounces", {"resolution=24", "levels=1"});
  for (std::size_t frame = 0; frame < grids.size(); ++frame) {
    const double mean = meanOf(grids[frame]);
    CAPTURE(frame, mean);
    CHECK(rmsBetween(octrees[frame], grids[frame]) < 0.02 * mean);
    CHECK(rmsBetween(clipmaps[frame], grids[frame]) < 0.02 * mean);
  }
  CHECK(meanOf(grids.back()) > 1.2 * meanOf(grids.front()));
}

TEST_CASE(
    "the levels of a clipmap gather all light anew where the camera has moved them, and keep it where not") {
  const auto run = [](double speed, int turns) {
    Scene scene = movingRoom(lamp);
    for (Object& object : scene.objects) object.motion.reset();
    scene.cameras.front().motion = RigidMotion{{0, 1, 0}, 0.0, {0, 0, 0}, {speed, 0, 0}};
    const Pipeline text = pipeline("voxel_cone_tracing_clipmap_all_bounces");
    RenderOptions options = sized(16, 16);
    options.accumulate = true;
    options.parameters = text.settings({"resolution=16", "levels=2", "turns=" + std::to_string(turns)});
    PipelineExecutor executor(device(), techniques(), scene, text, options);
    ImageBuffer last;
    for (int frame = 0; frame < 4; ++frame)
      last = executor.render(frame, frame).outputs.at("indirect_diffuse");
    return last;
  };
  // The camera goes more than a voxel of the finest level from frame to frame, or stands.
  CHECK(run(0.14, 8).values() == run(0.14, 1).values());
  CHECK(run(0.0, 8).values() != run(0.0, 1).values());
}

TEST_CASE("a clipmap whose voxels cover more than their fragments is refused bounces") {
  const Scene scene = movingRoom(lamp);
  const Pipeline text = pipelineWith("voxel_cone_tracing_clipmap_all_bounces",
                                     {{"voxel_cone_tracing.clipmap", "coverage samples"}});
  RenderOptions options = sized(8, 8);
  options.accumulate = true;
  options.parameters = text.settings({"resolution=8"});
  PipelineExecutor executor(device(), techniques(), scene, text, options);
  executor.render(0.0, 0);
  CHECK_THROWS_MATCHES(executor.render(0.1, 1), Error,
                       Tells("coverage samples", "before", "coverage touched"));
}

TEST_CASE("numbers of turns that places do not divide into are refused") {
  const Scene scene = emptyScene();
  const Pipeline text =
      pipelineWith("voxel_cone_tracing_directional", {{"voxel_cone_tracing.inject_directional", "turns 3"}});
  CHECK_THROWS_MATCHES(PipelineExecutor(device(), techniques(), scene, text, {}), Error,
                       Tells("light", "turns", "1, 2, 4 or 8"));
}
