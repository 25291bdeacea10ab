// The inside of closed meshes.
#include <cmath>
#include <random>

#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/scene/topology.h"
#include "support/meshes.h"
#include "support/voxelizers.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

Mesh operator+(Mesh a, const Mesh& b) {
  for (const std::uint32_t corner : b.corners)
    a.corners.push_back(corner + static_cast<std::uint32_t>(a.places.size()));
  a.places.insert(a.places.end(), b.places.begin(), b.places.end());
  return a;
}

Scene sceneOf(const std::vector<Mesh>& meshes) {
  Scene scene = SceneBuilder().scene;
  for (const Mesh& mesh : meshes) addMesh(scene, mesh);
  return scene;
}

struct Solid {
  GridPlacement grid;
  std::set<Cell> cells;
  glm::dvec3 origin{0};  ///< of the snapshot
  double volume() const { return static_cast<double>(cells.size()) * std::pow(grid.voxelSize, 3.0); }
  /// World position of a voxel's centre.
  glm::dvec3 centre(const glm::ivec3& cell) const {
    return origin + glm::dvec3(grid.low) + (glm::dvec3(cell) + 0.5) * static_cast<double>(grid.voxelSize);
  }
};

Solid solidOf(const Scene& scene, int resolution, const Settings& settings = {}, double time = 0.0) {
  LonePass pass("voxelization.solid", scene, {{"resolution", resolution}}, time);
  const auto& bits = pass.with(settings).out<BinaryGrid>("bits");
  return {bits.grid, cellsOf(bits), snapshotOf(scene, time).origin};
}

/// Calls `check(cell, centre)` for every voxel of the grid.
template <class Check>
void forEachVoxel(const Solid& solid, Check&& check) {
  for (int z = 0; z < solid.grid.resolution.z; ++z)
    for (int y = 0; y < solid.grid.resolution.y; ++y)
      for (int x = 0; x < solid.grid.resolution.x; ++x) check(Cell{x, y, z}, solid.centre({x, y, z}));
}

}  // namespace

TEST_CASE("the solid volume of a sphere converges to 4/3 pi r^3") {
  const Scene scene = sceneOf({sphereMesh({0.3f, -0.2f, 0.1f}, 1.0f, 128)});
  // The polyhedron itself is smaller by about 2 / 3 (pi / rings)^2 of the volume, 0.04 %.
  const double exact = 4.0 / 3.0 * kPi;
  for (const int resolution : {16, 32, 64, 128}) {
    const Solid solid = solidOf(scene, resolution);
    const double radius = 1.0 / static_cast<double>(solid.grid.voxelSize);
    // Centres inside: the error of lattice points in a ball stays below a few radii^1.5 of them.
    const double bound = 5e-4 + 4.0 * std::pow(radius, 1.5) / (exact * radius * radius * radius);
    INFO("resolution " << resolution << ": volume " << solid.volume() << ", exact " << exact);
    CHECK(std::abs(solid.volume() / exact - 1.0) < bound);
  }
}

TEST_CASE("a voxel is solid where its centre lies inside, for boxes to the last voxel") {
  std::mt19937 generator(5);
  std::uniform_real_distribution<float> uniform(0.05f, 0.95f);
  Scene scene = SceneBuilder().scene;
  std::vector<std::pair<glm::dvec3, glm::dvec3>> boxes;
  for (int i = 0; i < 12; ++i) {
    const glm::vec3 a(uniform(generator), uniform(generator), uniform(generator)),
        b(uniform(generator), uniform(generator), uniform(generator));
    boxes.emplace_back(glm::min(a, b), glm::max(a, b));
    addMesh(scene, boxMesh(glm::min(a, b), glm::max(a, b)));
  }
  const Solid solid = solidOf(scene, 40);
  std::size_t wrong = 0, undecided = 0;
  forEachVoxel(solid, [&](const Cell& cell, const glm::dvec3& centre) {
    // Farthest inside any of the boxes: negative outside of all.
    double depth = -1.0;
    for (const auto& [low, high] : boxes) {
      const glm::dvec3 inside = glm::min(centre - low, high - centre);
      depth = std::max(depth, std::min({inside.x, inside.y, inside.z}));
    }
    if (std::abs(depth) < 1e-5)
      ++undecided;
    else
      wrong += (depth > 0.0) != (solid.cells.count(cell) == 1);
  });
  CHECK(solid.cells.size() > 1000);
  CHECK(undecided < 5);
  CHECK(wrong == 0);
}

TEST_CASE("thousands of tetrahedra agree with a point-in-tetrahedron test and no column leaks") {
  std::mt19937 generator(11);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  const auto vector = [&] { return glm::vec3(uniform(generator), uniform(generator), uniform(generator)); };
  Scene scene = SceneBuilder().scene;
  std::vector<std::array<glm::dvec3, 4>> tetrahedra;
  for (int i = 0; i < 300; ++i) {
    const glm::vec3 place = vector();
    std::vector<glm::vec3> corners;
    for (int k = 0; k < 4; ++k) corners.push_back(place + (i < 20 ? 0.5f : 0.1f) * vector());
    std::vector<std::uint32_t> faces{0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    const glm::vec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    if (glm::dot(normal, corners[3] - corners[0]) < 0.0f)
      for (std::size_t f = 0; f < faces.size(); f += 3) std::swap(faces[f + 1], faces[f + 2]);
    addMesh(scene, {corners, faces});
    tetrahedra.push_back({corners[0], corners[1], corners[2], corners[3]});
  }
  const Solid solid = solidOf(scene, 48);
  std::size_t wrong = 0, undecided = 0;
  forEachVoxel(solid, [&](const Cell& cell, const glm::dvec3& centre) {
    bool inside = false, near = false;
    for (const auto& t : tetrahedra) {
      double nearest = 1e300;  // signed distance to the faces' planes, positive inside
      for (int k = 0; k < 4; ++k) {
        const glm::dvec3 &a = t[(k + 1) % 4], &b = t[(k + 2) % 4], &c = t[(k + 3) % 4], &d = t[k];
        glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
        if (glm::dot(normal, d - a) < 0.0) normal = -normal;
        nearest = std::min(nearest, glm::dot(normal, centre - a));
      }
      inside |= nearest > 1e-5;
      near |= std::abs(nearest) <= 1e-5;
    }
    if (near && !inside)
      ++undecided;
    else
      wrong += inside != (solid.cells.count(cell) == 1);
  });
  CHECK(solid.cells.size() > 1000);
  CHECK(undecided < 20);
  CHECK(wrong == 0);
}

TEST_CASE("a closed surface inside another of its object is a cavity, objects inside each other are one") {
  const Mesh outer = sphereMesh({0, 0, 0}, 1.0f, 48), inner = sphereMesh({0, 0, 0}, 0.5f, 48, true);
  const Solid cavity = solidOf(sceneOf({outer + inner}), 48);
  CHECK(cavity.volume() == Approx(4.0 / 3.0 * kPi * (1.0 - 0.125)).epsilon(0.01));
  forEachVoxel(cavity, [&](const Cell& cell, const glm::dvec3& centre) {
    if (glm::length(centre) < 0.45) CHECK(cavity.cells.count(cell) == 0);
  });
  const Solid whole = solidOf(sceneOf({outer, sphereMesh({0, 0, 0}, 0.5f, 48)}), 48);
  CHECK(whole.volume() == Approx(4.0 / 3.0 * kPi).epsilon(0.01));
  CHECK(whole.cells == solidOf(sceneOf({outer}), 48).cells);
}

TEST_CASE("inside a mesh larger than the grid around the camera everything is solid") {
  Scene scene = sceneOf({sphereMesh({0, 0, 0}, 10.0f, 64)});
  scene.cameras.front().eye = {1, 2, 3};
  const Settings around{{"around", "camera"}, {"extent", 4}};
  // The last word of bits of a column may be used in part.
  for (const std::size_t side : {16u, 32u, 72u})
    CHECK(solidOf(scene, static_cast<int>(side), around).cells.size() == side * side * side);
  // At the surface the grid is cut; what lies before it, behind it and beside it counts all the same.
  for (const glm::dvec3& eye : {glm::dvec3(0, 0, 10), glm::dvec3(0, 0, -10), glm::dvec3(-7, 7, 0)}) {
    scene.cameras.front().eye = eye;
    const Solid solid = solidOf(scene, 16, around);
    std::size_t wrong = 0;
    forEachVoxel(solid, [&](const Cell& cell, const glm::dvec3& centre) {
      // The polyhedron lies up to r (1 - cos (pi / rings)), 0.012, within the sphere.
      const double radius = glm::length(centre);
      if (radius < 9.98 || radius > 10.0) wrong += (radius < 9.99) != (solid.cells.count(cell) == 1);
    });
    CHECK(wrong == 0);
    CHECK(solid.cells.size() > 1000);
    CHECK(solid.cells.size() < 3000);
  }
}

TEST_CASE("an open mesh is named with its open edges and has no inside, and closed ones beside it have") {
  Mesh open = sphereMesh({3, 0, 0}, 1.0f, 16);
  open.corners.resize(open.corners.size() - 3);
  Scene scene = sceneOf({sphereMesh({0, 0, 0}, 1.0f, 16), open});
  const LogCapture log;
  const Solid solid = solidOf(scene, 32);
  CHECK(log.text().find("'mesh 1' (3 open edges)") != std::string::npos);
  CHECK(log.text().find("mesh 0") == std::string::npos);
  CHECK(!solid.cells.empty());
  for (const Cell& cell : solid.cells) CHECK(solid.centre({cell[0], cell[1], cell[2]}).x < 1.0);
}

TEST_CASE("a closed room that faces inwards holds air, unless it is asked to be filled") {
  const Scene scene = sceneOf({sphereMesh({0, 0, 0}, 2.0f, 24, true), sphereMesh({0, 0, 0}, 0.5f, 24)});
  const LogCapture log;
  const Solid furnished = solidOf(scene, 48);
  CHECK(log.text().find("'mesh 0'") != std::string::npos);
  // A radius of six voxels: lattice points say the volume to a tenth.
  CHECK(furnished.volume() == Approx(4.0 / 3.0 * kPi * 0.125).epsilon(0.1));
  const Solid filled = solidOf(scene, 48, {{"inwards", "fill"}});
  CHECK(filled.volume() == Approx(4.0 / 3.0 * kPi * 8.0).epsilon(0.02));
}

TEST_CASE("faces that are there twice, and boxes that share a face, are filled once") {
  const Mesh one = boxMesh({0, 0, 0}, {1, 1, 1});
  Mesh twice = one;
  twice.corners.insert(twice.corners.end(), one.corners.begin(), one.corners.end());
  Mesh twiceSplit = one + one;
  const std::set<Cell> expected = solidOf(sceneOf({one}), 18).cells;
  CHECK(expected.size() == 16u * 16u * 16u);
  CHECK(solidOf(sceneOf({twice}), 18).cells == expected);
  CHECK(solidOf(sceneOf({twiceSplit}), 18).cells == expected);
  CHECK(solidOf(sceneOf({one, one}), 18).cells == expected);
  // Two boxes with a common face, as one object and as two, are the long box.
  const Mesh left = boxMesh({0, 0, 0}, {1, 1, 1}), right = boxMesh({1, 0, 0}, {2, 1, 1});
  const std::set<Cell> row = solidOf(sceneOf({boxMesh({0, 0, 0}, {2, 1, 1})}), 34).cells;
  CHECK(row.size() == 32u * 16u * 16u);
  CHECK(solidOf(sceneOf({left, right}), 34).cells == row);
  CHECK(solidOf(sceneOf({left + right}), 34).cells == row);
}

TEST_CASE(
    "a mesh on the border of a grid without margin fills it, and each level of the stacks is the union") {
  const Solid full = solidOf(sceneOf({boxMesh({0, 0, 0}, {1, 1, 1})}), 7);
  CHECK(full.cells.size() == 7u * 7u * 7u);

  const Scene scene = sceneOf({sphereMesh({0, 0, 0}, 1.0f, 32), sphereMesh({1.2f, 0.4f, 0.3f}, 0.4f, 32)});
  // More than one layer of stacks, odd sizes on the way down.
  LonePass pass("voxelization.solid", scene, {{"resolution", 150}});
  const auto& bits = pass.out<BinaryGrid>("bits");
  checkLevelsAreUnions(bits);
}

TEST_CASE(
    "opacity and fragments say the same as the bits, and surface samples keep their voxels to themselves") {
  const Scene scene = sceneOf({sphereMesh({0, 0, 0}, 1.0f, 32)});
  const VoxelFragments surface = fragmentsIn(scene, {{"resolution", 24}});
  const Voxels shell = voxelsOf(surface);
  LonePass pass("voxelization.solid", scene);
  pass.in("fragments", surface);
  const std::set<Cell> inside = solidOf(scene, 24).cells;
  std::set<Cell> expected = inside;
  expected.insert(shell.occupied.begin(), shell.occupied.end());
  CHECK(cellsOf(pass.out<BinaryGrid>("bits")) == expected);

  const Voxels all = voxelsOf(pass.out<VoxelFragments>("fragments"));
  CHECK(all.occupied == expected);
  std::size_t hidden = 0;
  for (const Cell& cell : inside) hidden += shell.occupied.count(cell) == 0;
  CHECK(hidden > 100);
  CHECK(all.fragments.size() == shell.fragments.size() + hidden);
  CHECK(std::includes(all.fragments.begin(), all.fragments.end(), shell.fragments.begin(),
                      shell.fragments.end()));
  for (const FragmentData& fragment : all.fragments) {
    const glm::ivec3 cell = fragment.cell();
    if (shell.occupied.count({cell.x, cell.y, cell.z}) == 1) continue;
    CHECK(fragment.albedo() == glm::vec3(0.0f));
    CHECK(fragment.coverage() == 1.0f);
    CHECK(fragment.emission == 0);
  }

  const auto& opacity = pass.out<OccupancyGrid>("opacity");
  const std::vector<float> values = opacity.opacity->downloadFloats();
  const glm::ivec3 size = opacity.grid.resolution;
  std::set<Cell> opaque;
  for (std::size_t i = 0; i < values.size(); ++i) {
    CHECK((values[i] == 0.0f || values[i] == 1.0f));
    const int at = static_cast<int>(i);
    if (values[i] == 1.0f) opaque.insert({at % size.x, at / size.x % size.y, at / (size.x * size.y)});
  }
  CHECK(opaque == expected);
}

TEST_CASE("a solid that moves leaves nothing behind, and static geometry is filled once") {
  Scene scene = sceneOf({sphereMesh({0, 0, 0}, 1.0f, 24), boxMesh({-1, -1.5f, -1}, {1, -1.2f, 1})});
  scene.objects[0].motion = RigidMotion{{0, 1, 0}, 1.0, {0.5, 0, 0}, {0, 0, 0}};
  const Voxelizer solid{"solid"};
  RenderOptions everything;
  everything.keepEverything = true;
  VoxelizedFrames frames(scene, solid, "resolution 32");
  Voxels before;
  for (const double time : {0.0, 0.7, 0.3, 100.0}) {
    const Voxels voxels = frames.at(time);
    CHECK(voxels.fragments == VoxelizedFrames(scene, solid, "resolution 32").at(time).fragments);
    CHECK(voxels.fragments == VoxelizedFrames(scene, solid, "resolution 32", everything).at(time).fragments);
    CHECK(voxels.fragments != before.fragments);
    before = voxels;
  }
  CHECK(frames.reusesStill());
}

TEST_CASE("the inside of what deforms is that of its shape at the time") {
  Scene scene = sceneOf({sphereMesh({0, 0, 0}, 1.0f, 32)});
  VertexSequence sequence;
  sequence.framesPerSecond = 1.0;
  for (const float radius : {1.0f, 0.5f}) {
    sequence.positions.push_back(scene.positions);
    for (glm::vec3& place : sequence.positions.back()) place *= radius;
    sequence.normals.push_back(scene.normals);
  }
  scene.objects[0].sequence = sequence;
  const Solid solid = solidOf(scene, 64, {}, 0.5);  // half way: a radius of 0.75
  CHECK(solid.volume() == Approx(4.0 / 3.0 * kPi * std::pow(0.75, 3.0)).epsilon(0.01));
}

TEST_CASE("the solid volume of a scanned model is that of its mesh") {
  Scene model;
  try {
    const LogCapture quiet;
    model = loadScene(sourceDirectory() / "scenes/dragon.scene");
  } catch (const AbsentError& absent) {
    return skip(absent.what());
  }
  // The scan alone: its first object, without floor and area light.
  model.objects.resize(1);
  double volume = 0.0;
  for (const SurfaceComponent& component : surfaceComponents(weld(model, model.objects[0]))) {
    CHECK(component.closed());
    volume += component.volume * std::abs(glm::determinant(glm::dmat3(model.objects[0].placement)));
  }
  const Solid solid = solidOf(model, 128);
  CHECK(solid.volume() == Approx(volume).epsilon(0.005));
}

TEST_CASE("nothing has no inside") {
  CHECK(solidOf(SceneBuilder().scene, 16).cells.empty());
  Mesh line = boxMesh({0, 0, 0}, {1, 0, 0});
  CHECK(solidOf(sceneOf({line}), 16).cells.empty());
}
