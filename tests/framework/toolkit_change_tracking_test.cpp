// Which voxels what moves can change: those that it lies in, those that it left, and those that light reaches
// past it.
#include <array>
#include <set>

#include "lumivox/toolkit/bit_tree.h"
#include "lumivox/toolkit/change_tracking.h"
#include "lumivox/toolkit/counts.h"
#include "pipeline_toys.h"
#include "support/scene_builder.h"
#include "support/techniques.h"
#include "support/voxel_fragments.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr int kSide = 32, kCellSide = 4;  // voxels

/// A pass that follows what moves.
class Follower : public Toy {
 public:
  using Toy::Toy;
  In<ShadowMap> shadow{this, "shadow", Presence::optional, "lights and their visibility"};
  ChangeTracking changes;
  void run(PassContext&) override {}
};

/// A floor and a plate 0.3 m above it that moves along x by a metre a second, below the sun. The snapshot has
/// its origin in the middle of the floor.
Scene floorAndPlate(float plateEmits = 0.0f) {
  SceneBuilder builder;
  builder.quad({-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.5f));
  builder.quad({-0.95f, -0.7f, -0.15f}, {0, 0, 0.3f}, {0.3f, 0, 0}, builder.lambert(0.5f, plateEmits))
      .motion = RigidMotion{{0, 1, 0}, 0.0, {0, 0, 0}, {1, 0, 0}};
  builder.light(LightKind::directional, glm::vec3(3.0f), {0, 0, 0}, {0, -1, 0});
  builder.look({0, 0, 0.9}, {0, 0, 0}, {0, 1, 0}, 0.7, 8, 8);
  return builder.scene;
}

const GridPlacement kGrid{glm::vec3(-1.0f), 2.0f / kSide, glm::ivec3(kSide)};

/// A frame of the scene, in which the pass reads a shadow map where there is one.
struct Moment {
  TestTechniques techniques;
  Scene scene;
  SceneSnapshot snapshot;
  PassHarness harness;

  explicit Moment(Scene of, double time = 0.0)
      : scene(std::move(of)),
        snapshot(snapshotOf(scene, time)),
        harness(device(), withFollower(techniques), "toy", "follower", scene, snapshot) {}
  static TestTechniques& withFollower(TestTechniques& techniques) {
    techniques.add<Follower>("toy", "follower");
    return techniques;
  }
  PassContext& frame() { return harness.context(); }
  Follower& pass() { return static_cast<Follower&>(harness.pass()); }

  gpu::BufferRef counted(std::size_t count) {
    const auto word = static_cast<std::uint32_t>(count);
    const gpu::BufferRef result = countBuffer(frame(), "count");
    result->uploadValues(std::span<const std::uint32_t>(&word, 1));
    finishCount(frame(), result, count);
    return result;
  }
  /// Fragments in these voxels. `still`: the count of static ones, kept from another list.
  VoxelFragments list(const std::vector<glm::ivec3>& staticVoxels,
                      const std::vector<glm::ivec3>& movingVoxels, gpu::BufferRef still = nullptr) {
    std::vector<FragmentData> fragments;
    for (const auto& voxels : {staticVoxels, movingVoxels})
      for (const glm::ivec3& voxel : voxels) {
        fragments.push_back({});
        fragments.back().voxel = static_cast<std::uint32_t>(voxel.x | voxel.y << 10 | voxel.z << 20);
      }
    VoxelFragments result;
    result.grid = kGrid;
    result.capacity = fragments.size();
    result.fragments = frame().uploaded(fragments, "fragments");
    result.count = counted(fragments.size());
    result.still = still != nullptr ? still : counted(staticVoxels.size());
    result.moving = counted(movingVoxels.size());
    return result;
  }
  LitMoment all(const VoxelFragments& of) { return pass().changes.momentOfAll(frame(), of); }
  ChangedCells since(const VoxelFragments& of, LitMoment& moment) {
    return pass().changes.since(frame(), of, pass().shadow, moment);
  }
};

Cell cellOf(const glm::ivec3& voxel) {
  return {voxel.x / kCellSide, voxel.y / kCellSide, voxel.z / kCellSide};
}
std::set<Cell> cellsOf(const std::vector<glm::ivec3>& voxels) {
  std::set<Cell> result;
  for (const glm::ivec3& voxel : voxels) result.insert(cellOf(voxel));
  return result;
}

/// Cells with a bit, after a look at what lies above them: a bit for each that holds one of them.
std::set<Cell> markedCells(const ChangedCells& changed) {
  REQUIRE(changed.voxelDepth == 5);
  REQUIRE(changed.cellDepth == 3);
  const auto words = changed.bits->downloadValues<std::uint32_t>();
  std::vector<std::set<Cell>> byDepth(4);
  for (int depth = 0; depth <= 3; ++depth)
    for (int z = 0; z < 1 << depth; ++z)
      for (int y = 0; y < 1 << depth; ++y)
        for (int x = 0; x < 1 << depth; ++x) {
          std::uint32_t morton = 0;
          for (int bit = 0; bit < depth; ++bit)
            morton |= static_cast<std::uint32_t>((x >> bit & 1) | (y >> bit & 1) << 1 | (z >> bit & 1) << 2)
                      << (3 * bit);
          if (words.at(wordsBeforeDepth(depth) + morton / 32) >> (morton % 32) & 1)
            byDepth[static_cast<std::size_t>(depth)].insert({x, y, z});
        }
  for (std::size_t depth = 0; depth < 3; ++depth) {
    std::set<Cell> above;
    for (const Cell& cell : byDepth[depth + 1]) above.insert({cell[0] / 2, cell[1] / 2, cell[2] / 2});
    CHECK(byDepth[depth] == above);
  }
  return byDepth[3];
}

/// Places in the list of the fragments that are taken, each once.
std::set<std::uint32_t> takenFragments(const ChangedCells& changed) {
  const std::uint32_t count = changed.count->downloadValues<std::uint32_t>().at(0);
  auto places = changed.fragments->downloadValues<std::uint32_t>();
  REQUIRE(places.size() >= count);
  places.resize(count);
  const std::set<std::uint32_t> result(places.begin(), places.end());
  CHECK(result.size() == count);
  return result;
}

/// Of the fragments of a list those that must be taken: what moves, and all in these cells.
std::set<std::uint32_t> expectedFragments(const std::vector<glm::ivec3>& staticVoxels, std::size_t moving,
                                          const std::set<Cell>& cells) {
  std::set<std::uint32_t> result;
  for (std::size_t i = 0; i < staticVoxels.size(); ++i)
    if (cells.contains(cellOf(staticVoxels[i]))) result.insert(static_cast<std::uint32_t>(i));
  for (std::size_t i = 0; i < moving; ++i) result.insert(static_cast<std::uint32_t>(staticVoxels.size() + i));
  return result;
}

std::set<Cell> together(std::set<Cell> a, const std::set<Cell>& b) {
  a.insert(b.begin(), b.end());
  return a;
}

// Static fragments, several in a cell and far from each other; and three places of what moves.
const std::vector<glm::ivec3> kStatic{{0, 0, 0},    {3, 3, 3},    {4, 0, 0},
                                      {31, 31, 31}, {28, 31, 30}, {16, 2, 9}},
    kHere{{1, 2, 0}, {17, 20, 5}}, kThere{{5, 1, 1}, {20, 20, 5}}, kElsewhere{{30, 30, 29}};

}  // namespace

TEST_CASE("without shadows the cells of what moves have changed since static geometry was taken alone") {
  Moment f(floorAndPlate());
  const VoxelFragments list = f.list(kStatic, kHere);
  LitMoment moment = f.pass().changes.momentOfStatic(f.frame(), list);
  const ChangedCells changed = f.since(list, moment);
  CHECK(markedCells(changed) == cellsOf(kHere));
  CHECK(takenFragments(changed) == expectedFragments(kStatic, kHere.size(), cellsOf(kHere)));
  // Static geometry stays what the next frame is compared with.
  CHECK(markedCells(f.since(f.list(kStatic, kThere, list.still), moment)) == cellsOf(kThere));
}

TEST_CASE("cells that something has left have changed as well, and each frame is compared with the last") {
  Moment f(floorAndPlate());
  const VoxelFragments first = f.list(kStatic, kHere), second = f.list(kStatic, kThere, first.still),
                       third = f.list(kStatic, kElsewhere, first.still);
  LitMoment moment = f.all(first);
  std::set<Cell> expected = together(cellsOf(kHere), cellsOf(kThere));
  const ChangedCells once = f.since(second, moment);
  CHECK(markedCells(once) == expected);
  CHECK(takenFragments(once) == expectedFragments(kStatic, kThere.size(), expected));
  expected = together(cellsOf(kThere), cellsOf(kElsewhere));
  const ChangedCells twice = f.since(third, moment);
  CHECK(markedCells(twice) == expected);
  CHECK(takenFragments(twice) == expectedFragments(kStatic, kElsewhere.size(), expected));
}

TEST_CASE(
    "an invocation runs for each fragment in changed cells: none of another is listed twice or left out") {
  Moment f(floorAndPlate());
  // A whole cell of fragments, more than a work group has invocations, and one beside it.
  std::vector<glm::ivec3> voxels{{31, 0, 0}};
  for (int i = 0; i < 200; ++i) voxels.push_back({i % 4, i / 4 % 4, i / 16 % 4});
  const VoxelFragments list = f.list(voxels, {{0, 0, 0}});
  LitMoment moment = f.pass().changes.momentOfStatic(f.frame(), list);
  const ChangedCells changed = f.since(list, moment);
  CHECK(takenFragments(changed) == expectedFragments(voxels, 1, {{0, 0, 0}}));
  CHECK(changed.count->downloadValues<std::uint32_t>().at(1) == 4);  // groups of 64
}

TEST_CASE("static cells below a plate in the sun have changed, now and where its shadow was, and no others") {
  // Static fragments in every voxel of the floor, and some above the plate, which no shadow reaches.
  std::vector<glm::ivec3> voxels;
  for (int x = 0; x < kSide; ++x)
    for (int z = 0; z < kSide; ++z) {
      voxels.push_back({x, 16, z});
      voxels.push_back({x, 28, z});
    }
  const Scene scene = floorAndPlate();
  LitMoment moment;
  std::vector<std::set<Cell>> found;
  for (const double time : {0.0, 1.5}) {
    Moment f(scene, time);
    PassHarness lights(device(), test::techniques(), "direct_lighting", "shadow_map", f.scene, f.snapshot);
    lights.run();
    f.harness.setInput<ShadowMap>("shadow", lights.output<ShadowMap>("depth"));
    const VoxelFragments list = f.list(voxels, {});
    if (time == 0.0) moment = f.pass().changes.momentOfStatic(f.frame(), list);
    moment.still = {};  // of the list of this frame
    found.push_back(markedCells(f.since(list, moment)));
  }
  // Cells are 0.25 m wide. The plate reaches from -0.95 m to -0.65 m, 1.5 s later from 0.55 m to 0.85 m.
  const auto holds = [](const std::set<Cell>& cells, int x) { return cells.contains({x, 4, 3}); };
  CHECK(holds(found[0], 0));
  CHECK(holds(found[0], 1));
  CHECK(!holds(found[0], 6));
  for (const int x : {0, 1, 6, 7}) CHECK(holds(found[1], x));
  CHECK(!holds(found[1], 4));
  for (const std::set<Cell>& cells : found)
    for (const Cell& cell : cells) CHECK(cell[1] == 4);
}

TEST_CASE("changes can be told only where static fragments are known apart and what moves emits nothing") {
  Moment f(floorAndPlate());
  VoxelFragments list = f.list(kStatic, kHere);
  const auto told = [&](const VoxelFragments& of, float brightest = 1.0f) {
    return f.pass().changes.staticLight(f.frame(), of, f.pass().shadow, brightest);
  };
  const std::optional<StaticLight> known = told(list);
  REQUIRE(known);
  CHECK(told(list) == known);
  CHECK(told(list, 2.0f) != known);
  CHECK(told(f.list(kStatic, kHere)) != known);
  list.reflected = list.count;
  CHECK(!told(list));
  list.reflected = nullptr;
  list.still = nullptr;
  CHECK(!told(list));

  Moment emitting(floorAndPlate(1.0f));
  CHECK(!emitting.pass().changes.moving(emitting.frame()));
  CHECK(!emitting.pass().changes.staticLight(emitting.frame(), emitting.list(kStatic, kHere),
                                             emitting.pass().shadow, 1.0f));
  // A lamp at another place is another light.
  Scene moved = floorAndPlate();
  moved.lights.front().direction = glm::normalize(glm::dvec3(1, -1, 0));
  Moment otherwise(moved);
  const auto other = otherwise.pass().changes.staticLight(
      otherwise.frame(), f.list(kStatic, kHere, known->still), otherwise.pass().shadow, 1.0f);
  REQUIRE(other);
  CHECK(other->still == known->still);
  CHECK(other != known);
}

TEST_CASE("bounds of two moments are one box where they lie near each other, and two where they do not") {
  const auto box = [](float x) {
    Bounds result;
    result.grow({x, 0, 0});
    result.grow({x + 1, 1, 1});
    return result;
  };
  const std::vector<Bounds> near = boundsAtEither({box(0)}, {box(0.5f)});
  REQUIRE(near.size() == 1);
  CHECK(near[0].low.x == 0.0f);
  CHECK(near[0].high.x == 1.5f);
  const std::vector<Bounds> far = boundsAtEither({box(0)}, {box(5)});
  REQUIRE(far.size() == 2);
  CHECK(far[0].high.x == 1.0f);
  CHECK(far[1].low.x == 5.0f);
  // What there was and is no more counts too.
  CHECK(boundsAtEither({}, {box(0), box(5)}).size() == 2);
  CHECK(boundsAtEither({box(0), box(5)}, {}).size() == 2);
}
