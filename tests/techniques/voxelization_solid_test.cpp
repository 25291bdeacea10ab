// The inside of closed meshes.
#include <cmath>
#include <random>

#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/pipeline/pass.h"
#include "lumivox/scene/topology.h"
#include "support/scene_builder.h"
#include "support/techniques.h"
#include "support/voxel_fragments.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// Adds an object of triangles with shared vertices.
Object& addMesh(Scene& scene, const std::string& name, const std::vector<glm::vec3>& places,
                const std::vector<std::uint32_t>& corners) {
  if (scene.materials.empty()) scene.materials.emplace_back();
  Object object;
  object.name = name;
  object.firstVertex = static_cast<std::uint32_t>(scene.positions.size());
  object.vertexCount = static_cast<std::uint32_t>(places.size());
  object.parts.push_back(
      {0, static_cast<std::uint32_t>(scene.indices.size()), static_cast<std::uint32_t>(corners.size())});
  for (const glm::vec3& place : places) {
    scene.positions.push_back(place);
    scene.normals.emplace_back(0, 1, 0);
    scene.texcoords.emplace_back(0.0f);
  }
  for (const std::uint32_t corner : corners) scene.indices.push_back(object.firstVertex + corner);
  scene.objects.push_back(object);
  return scene.objects.back();
}

struct Mesh {
  std::vector<glm::vec3> places;
  std::vector<std::uint32_t> corners;
};

/// A sphere of rings and a vertex at each pole; every vertex once.
Mesh sphere(const glm::vec3& centre, float radius, int rings, bool inwards = false) {
  Mesh mesh;
  const int around = 2 * rings;
  mesh.places.push_back(centre + glm::vec3(0, radius, 0));
  for (int i = 1; i < rings; ++i)
    for (int j = 0; j < around; ++j) {
      const double theta = kPi * i / rings, phi = 2.0 * kPi * j / around;
      mesh.places.push_back(centre + radius * glm::vec3(std::sin(theta) * std::sin(phi), std::cos(theta),
                                                        std::sin(theta) * std::cos(phi)));
    }
  mesh.places.push_back(centre - glm::vec3(0, radius, 0));
  const auto at = [&](int i, int j) {
    if (i == 0) return std::uint32_t{0};
    if (i == rings) return static_cast<std::uint32_t>(mesh.places.size() - 1);
    return static_cast<std::uint32_t>(1 + (i - 1) * around + j % around);
  };
  const auto triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (inwards) std::swap(b, c);
    mesh.corners.insert(mesh.corners.end(), {a, b, c});
  };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < around; ++j) {
      if (i > 0) triangle(at(i, j), at(i + 1, j), at(i, j + 1));
      if (i < rings - 1) triangle(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
  return mesh;
}

Mesh box(const glm::vec3& low, const glm::vec3& high) {
  Mesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.places.emplace_back((k & 1) != 0 ? high.x : low.x, (k & 2) != 0 ? high.y : low.y,
                             (k & 4) != 0 ? high.z : low.z);
  mesh.corners = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                  2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
  return mesh;
}

Mesh operator+(Mesh a, const Mesh& b) {
  for (const std::uint32_t corner : b.corners)
    a.corners.push_back(corner + static_cast<std::uint32_t>(a.places.size()));
  a.places.insert(a.places.end(), b.places.begin(), b.places.end());
  return a;
}

Scene emptyScene() {
  return SceneBuilder().scene;
}

Scene sceneOf(const std::vector<Mesh>& meshes) {
  Scene scene = emptyScene();
  for (const Mesh& mesh : meshes)
    addMesh(scene, "mesh " + std::to_string(scene.objects.size()), mesh.places, mesh.corners);
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

Solid solidOf(const Scene& scene, int resolution,
              const std::function<void(PassHarness&)>& configure = nullptr) {
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  PassHarness harness(device(), techniques(), "voxelization", "solid", scene, snapshot);
  harness.setParameter("resolution", resolution);
  if (configure) configure(harness);
  harness.run();
  const auto& bits = harness.output<BinaryGrid>("bits");
  return {bits.grid, cellsOf(bits), snapshot.origin};
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
  const Scene scene = sceneOf({sphere({0.3f, -0.2f, 0.1f}, 1.0f, 128)});
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
  Scene scene = emptyScene();
  std::vector<std::pair<glm::dvec3, glm::dvec3>> boxes;
  for (int i = 0; i < 12; ++i) {
    const glm::vec3 a(uniform(generator), uniform(generator), uniform(generator)),
        b(uniform(generator), uniform(generator), uniform(generator));
    boxes.emplace_back(glm::min(a, b), glm::max(a, b));
    const Mesh mesh = box(glm::min(a, b), glm::max(a, b));
    addMesh(scene, "box " + std::to_string(i), mesh.places, mesh.corners);
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
  Scene scene = emptyScene();
  std::vector<std::array<glm::dvec3, 4>> tetrahedra;
  for (int i = 0; i < 300; ++i) {
    const glm::vec3 place = vector();
    std::vector<glm::vec3> corners;
    for (int k = 0; k < 4; ++k) corners.push_back(place + (i < 20 ? 0.5f : 0.1f) * vector());
    std::vector<std::uint32_t> faces{0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    const glm::vec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    if (glm::dot(normal, corners[3] - corners[0]) < 0.0f)
      for (std::size_t f = 0; f < faces.size(); f += 3) std::swap(faces[f + 1], faces[f + 2]);
    addMesh(scene, "tetrahedron", corners, faces);
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
  const Mesh outer = sphere({0, 0, 0}, 1.0f, 48), inner = sphere({0, 0, 0}, 0.5f, 48, true);
  const Solid cavity = solidOf(sceneOf({outer + inner}), 48);
  CHECK(cavity.volume() == Approx(4.0 / 3.0 * kPi * (1.0 - 0.125)).epsilon(0.01));
  forEachVoxel(cavity, [&](const Cell& cell, const glm::dvec3& centre) {
    if (glm::length(centre) < 0.45) CHECK(cavity.cells.count(cell) == 0);
  });
  const Solid whole = solidOf(sceneOf({outer, sphere({0, 0, 0}, 0.5f, 48)}), 48);
  CHECK(whole.volume() == Approx(4.0 / 3.0 * kPi).epsilon(0.01));
  CHECK(whole.cells == solidOf(sceneOf({outer}), 48).cells);
}

TEST_CASE("inside a mesh larger than the grid around the camera everything is solid") {
  Scene scene = sceneOf({sphere({0, 0, 0}, 10.0f, 64)});
  scene.cameras.front().eye = {1, 2, 3};
  const auto around = [](PassHarness& harness) {
    harness.setParameter("around", std::string("camera"));
    harness.setParameter("extent", 4.0);
  };
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
  Mesh open = sphere({3, 0, 0}, 1.0f, 16);
  open.corners.resize(open.corners.size() - 3);
  Scene scene = sceneOf({sphere({0, 0, 0}, 1.0f, 16), open});
  const LogCapture log;
  const Solid solid = solidOf(scene, 32);
  CHECK(log.text().find("'mesh 1' (3 open edges)") != std::string::npos);
  CHECK(log.text().find("mesh 0") == std::string::npos);
  CHECK(!solid.cells.empty());
  for (const Cell& cell : solid.cells) CHECK(solid.centre({cell[0], cell[1], cell[2]}).x < 1.0);
}

TEST_CASE("a closed room that faces inwards holds air, unless it is asked to be filled") {
  const Scene scene = sceneOf({sphere({0, 0, 0}, 2.0f, 24, true), sphere({0, 0, 0}, 0.5f, 24)});
  const LogCapture log;
  const Solid furnished = solidOf(scene, 48);
  CHECK(log.text().find("'mesh 0'") != std::string::npos);
  // A radius of six voxels: lattice points say the volume to a tenth.
  CHECK(furnished.volume() == Approx(4.0 / 3.0 * kPi * 0.125).epsilon(0.1));
  const Solid filled =
      solidOf(scene, 48, [](PassHarness& harness) { harness.setParameter("inwards", std::string("fill")); });
  CHECK(filled.volume() == Approx(4.0 / 3.0 * kPi * 8.0).epsilon(0.02));
}

TEST_CASE("faces that are there twice, and boxes that share a face, are filled once") {
  const Mesh one = box({0, 0, 0}, {1, 1, 1});
  Mesh twice = one;
  twice.corners.insert(twice.corners.end(), one.corners.begin(), one.corners.end());
  Mesh twiceSplit = one + one;
  const std::set<Cell> expected = solidOf(sceneOf({one}), 18).cells;
  CHECK(expected.size() == 16u * 16u * 16u);
  CHECK(solidOf(sceneOf({twice}), 18).cells == expected);
  CHECK(solidOf(sceneOf({twiceSplit}), 18).cells == expected);
  CHECK(solidOf(sceneOf({one, one}), 18).cells == expected);
  // Two boxes with a common face, as one object and as two, are the long box.
  const Mesh left = box({0, 0, 0}, {1, 1, 1}), right = box({1, 0, 0}, {2, 1, 1});
  const std::set<Cell> row = solidOf(sceneOf({box({0, 0, 0}, {2, 1, 1})}), 34).cells;
  CHECK(row.size() == 32u * 16u * 16u);
  CHECK(solidOf(sceneOf({left, right}), 34).cells == row);
  CHECK(solidOf(sceneOf({left + right}), 34).cells == row);
}

TEST_CASE(
    "a mesh on the border of a grid without margin fills it, and each level of the stacks is the union") {
  const Solid full = solidOf(sceneOf({box({0, 0, 0}, {1, 1, 1})}), 7);
  CHECK(full.cells.size() == 7u * 7u * 7u);

  const Scene scene = sceneOf({sphere({0, 0, 0}, 1.0f, 32), sphere({1.2f, 0.4f, 0.3f}, 0.4f, 32)});
  PassHarness harness(device(), techniques(), "voxelization", "solid", scene, snapshotOf(scene, 0.0));
  harness.setParameter("resolution", 150);  // more than one layer of stacks, odd sizes on the way down
  harness.run();
  const auto& bits = harness.output<BinaryGrid>("bits");
  const gpu::TextureDescription& description = bits.stacks->description();
  std::set<Cell> finer = cellsOf(bits);
  for (int level = 1; level < description.levels; ++level) {
    const int width = std::max(description.width >> level, 1),
              height = std::max(description.height >> level, 1);
    std::set<Cell> expected;
    for (const Cell& cell : finer)
      expected.insert({std::min(cell[0] / 2, width - 1), std::min(cell[1] / 2, height - 1), cell[2]});
    const std::set<Cell> found = cellsOf(bits, level);
    CHECK(found == expected);
    finer = found;
  }
}

TEST_CASE(
    "opacity and fragments say the same as the bits, and surface samples keep their voxels to themselves") {
  const Scene scene = sceneOf({sphere({0, 0, 0}, 1.0f, 32)});
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  PassHarness surface(device(), techniques(), "voxelization", "conservative", scene, snapshot);
  surface.setParameter("resolution", 24);
  surface.run();
  const Voxels shell = voxelsOf(surface.output<VoxelFragments>("fragments"));

  PassHarness harness(device(), techniques(), "voxelization", "solid", scene, snapshot);
  harness.setInput("fragments", surface.output<VoxelFragments>("fragments"));
  harness.run();
  const std::set<Cell> inside = solidOf(scene, 24).cells;
  std::set<Cell> expected = inside;
  expected.insert(shell.occupied.begin(), shell.occupied.end());
  CHECK(cellsOf(harness.output<BinaryGrid>("bits")) == expected);

  const Voxels all = voxelsOf(harness.output<VoxelFragments>("fragments"));
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

  const auto& opacity = harness.output<OccupancyGrid>("opacity");
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
  Scene scene = sceneOf({sphere({0, 0, 0}, 1.0f, 24), box({-1, -1.5f, -1}, {1, -1.2f, 1})});
  scene.objects[0].motion = RigidMotion{{0, 1, 0}, 1.0, {0.5, 0, 0}, {0, 0, 0}};
  const Pipeline text = Pipeline::parse(R"(pipeline "solid" {
  pass gbuffer direct_lighting.gbuffer { }
  pass direct direct_lighting.shade { gbuffer gbuffer }
  pass voxels voxelization.solid { resolution 32 }
  output direct direct.radiance
})",
                                        "solid.pipeline");
  RenderOptions options;
  options.width = options.height = 8;
  const auto at = [&](PipelineExecutor& executor, double time) {
    executor.render(time, 0, PipelineExecutor::Images::no);
    return cellsOf(static_cast<const Out<BinaryGrid>&>(*executor.output("voxels", "bits")).value());
  };
  PipelineExecutor executor(device(), techniques(), scene, text, options);
  executor.keepOutput("voxels", "bits");
  std::set<Cell> before;
  for (const double time : {0.0, 0.7, 0.3, 100.0}) {
    const std::set<Cell> cells = at(executor, time);
    for (const bool everything : {false, true}) {
      RenderOptions fresh = options;
      fresh.keepEverything = everything;
      PipelineExecutor alone(device(), techniques(), scene, text, fresh);
      alone.keepOutput("voxels", "bits");
      CHECK(cells == at(alone, time));
    }
    CHECK(cells != before);
    before = cells;
  }
}

TEST_CASE("the inside of what deforms is that of its shape at the time") {
  Scene scene = sceneOf({sphere({0, 0, 0}, 1.0f, 32)});
  VertexSequence sequence;
  sequence.framesPerSecond = 1.0;
  for (const float radius : {1.0f, 0.5f}) {
    sequence.positions.push_back(scene.positions);
    for (glm::vec3& place : sequence.positions.back()) place *= radius;
    sequence.normals.push_back(scene.normals);
  }
  scene.objects[0].sequence = sequence;
  const SceneSnapshot snapshot = snapshotOf(scene, 0.5);  // half way: a radius of 0.75
  PassHarness harness(device(), techniques(), "voxelization", "solid", scene, snapshot);
  harness.setParameter("resolution", 64);
  harness.run();
  const auto& bits = harness.output<BinaryGrid>("bits");
  const Solid solid{bits.grid, cellsOf(bits), snapshot.origin};
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

TEST_CASE("the view shows cubes where voxels are, and the cut lays their inside open") {
  // A box of 2 m seen from 4 m away: its front, at 3 m, fills 2 / (2 * 3 * tan(fov / 2)) of the image's
  // side.
  Scene scene = sceneOf({box({-1, -1, -1}, {1, 1, 1})});
  Camera& camera = scene.cameras.front();
  camera.eye = {0, 0, 4};
  camera.fov = 1.0;
  camera.width = camera.height = 64;
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  PassHarness solid(device(), techniques(), "voxelization", "solid", scene, snapshot);
  solid.setParameter("resolution", 34);
  solid.run();
  const auto brightPixels = [&](double cut, float brightness) {
    PassHarness view(device(), techniques(), "voxelization", "view", scene, snapshot);
    view.setInput("fragments", solid.output<VoxelFragments>("fragments"));
    view.setParameter("cut", cut);
    view.run();
    const std::vector<float> values = view.output<Image>("image").texture->downloadFloats();
    int count = 0;
    for (std::size_t i = 0; i < values.size(); i += 4) count += std::abs(values[i] - brightness) < 1e-4f;
    return count;
  };
  const auto sidePixels = [](double distance) { return 64.0 * 2.0 / (2.0 * distance * std::tan(0.5)); };
  constexpr float kCut = 0.95f, kBackground = 0.02f;
  CHECK(brightPixels(0.0, kCut) == 0);
  CHECK(std::sqrt(64.0 * 64.0 - brightPixels(0.0, kBackground)) == Approx(sidePixels(3.0)).margin(1.5));
  // Cut in its middle the box is white to its rim.
  CHECK(std::sqrt(brightPixels(4.0, kCut)) == Approx(sidePixels(4.0)).margin(1.5));
  CHECK(brightPixels(6.0, kBackground) == 64 * 64);
}

TEST_CASE("nothing has no inside") {
  CHECK(solidOf(emptyScene(), 16).cells.empty());
  Mesh line = box({0, 0, 0}, {1, 0, 0});
  CHECK(solidOf(sceneOf({line}), 16).cells.empty());
}
