// Every stage as printed in the thesis (Gomes 2015, Sec. 4.3): what the listings must give, derived.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "lumivox/base/error.h"
#include "support/facts.h"
#include "support/filtered.h"
#include "support/light_cells.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

// Printed numbers of Listings 4.31 and 4.32.
constexpr double kPrintedFar = 0.0318842778, kPrintedSide = 0.0336955972;
constexpr double kPrinted0 = 0.8862269262, kPrinted1 = 1.0233267079;

/// A normal in nine bits an axis behind its closeness to the nearest face, and the number of this face.
std::pair<int, std::uint32_t> packedNormal(const glm::vec3& normal) {
  const glm::vec3 faces[] = {{0.0f, -std::sqrt(1.0f / 3.0f), std::sqrt(2.0f / 3.0f)},
                             {0.0f, -std::sqrt(1.0f / 3.0f), -std::sqrt(2.0f / 3.0f)},
                             {-std::sqrt(2.0f / 3.0f), std::sqrt(1.0f / 3.0f), 0.0f},
                             {std::sqrt(2.0f / 3.0f), std::sqrt(1.0f / 3.0f), 0.0f}};
  int face = 0;
  for (int i = 1; i < 4; ++i)
    if (glm::dot(normal, faces[i]) > glm::dot(normal, faces[face])) face = i;
  std::uint32_t word = static_cast<std::uint32_t>(31.0f * glm::dot(normal, faces[face]));
  for (int axis = 0; axis < 3; ++axis) {
    const int steps = static_cast<int>(normal[axis] * 255.0f);
    word = word << 9 | (steps < 0 ? 256u : 0u) | static_cast<std::uint32_t>(std::abs(steps));
  }
  return {face, word};
}

/// Packed voxels of a grid, none with a surface.
gpu::BufferRef emptyVoxels(int n) {
  auto buffer = std::make_shared<gpu::Buffer>(device(), 5u * sizeof(std::uint32_t) * n * n * n, "voxels");
  buffer->clear();
  return buffer;
}

/// Gives one voxel a white surface with this normal.
void addSurface(gpu::Buffer& voxels, int n, const glm::ivec3& cell, const glm::vec3& normal) {
  std::vector<std::uint32_t> words = voxels.downloadValues<std::uint32_t>();
  const auto first = static_cast<std::size_t>(5 * ((cell.z * n + cell.y) * n + cell.x));
  const auto [face, word] = packedNormal(normal);
  words[first] = 0x80515151u;
  words[first + 1 + static_cast<std::size_t>(face)] = word;
  voxels.uploadValues<std::uint32_t>(words);
}

Cells oneCell(int n, const glm::ivec3& cell, double meanCosine) {
  Cells cells = empty(n);
  addLight(cells, n, cell, {0, 1, 0}, meanCosine);
  return cells;
}

/// Coefficients that grow along one axis by 1 a cell, from cell 0 on: only that of the band 0.
Cells growing(int n, int axis) {
  Cells cells = empty(n);
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) cells[at(n, x, y, z)] = static_cast<float>(glm::ivec3(x, y, z)[axis]);
  return cells;
}

/// Radiance that a white surface at a place reflects, through `gather` with these words set.
double gathered(const LitCells& light, const glm::vec3& position, const glm::vec3& normal,
                const Settings& settings) {
  return LonePass("light_propagation_volumes.gather", emptyScene().scene, settings)
      .in("gbuffer", gbufferAt({position, normal}))
      .in<ShGrid>("light", light)
      .in("faces", light.faces)
      .image("diffuse")
      .at(4, 4, 0);
}

/// Radiance in one voxel of a reflection grid of [-1,1]^3 of white surfaces everywhere.
std::vector<float> reflected(const ShGrid& light, int voxels) {
  AttributeGrid surfaces;
  surfaces.grid = {glm::vec3(-1.0f), 2.0f / static_cast<float>(voxels), glm::ivec3(voxels)};
  const gpu::TextureDescription volume = volumeOf(glm::ivec3(voxels), gpu::Format::rgba16f);
  surfaces.albedo = filled(volume, glm::vec4(1.0f));
  surfaces.normal = filled(volume, glm::vec4(0, 1, 0, 0));
  SceneBuilder builder = emptyScene();
  builder.look({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.7, 8, 8);
  return LonePass("light_propagation_volumes.reflect", builder.scene, {{"as_published", "on"}})
      .in("surfaces", surfaces)
      .in("light", light)
      .out<RadianceGrid>("radiance")
      .radiance->downloadFloats(0);
}

}  // namespace

TEST_CASE(
    "a printed step hands on a quarter of the light and keeps it: what is even grows to 5/4 every time") {
  // Listing 4.32: a face takes Omega / (4 pi) I(d), and turns it into a clamped cosine with c0 = pi Y0, so
  // its energy c0 / Y0 is pi Omega / (4 pi) I(d) = Omega I(d) / 4. The thirty solid angles of the six
  // neighbours are 4 pi together, and light that is even, I = E / (4 pi), hands on E / 4; what it makes has
  // the mean cosine (2/3) far / (2 pi / 3) = 0.13 and is negative nowhere, so that nothing is dropped later.
  CHECK(kPrintedFar == Approx(kFarFace / (4.0 * kPi)).epsilon(1e-6));
  CHECK(kPrintedSide == Approx(kSideFace / (4.0 * kPi)).epsilon(1e-6));
  constexpr int n = 19, centre = 9;  // light does not come to the border in eight steps
  const SceneBuilder builder = emptyScene();
  for (const int steps : {1, 2, 5, 8}) {
    Propagation step(builder.scene);
    step.set("transfer", "published").set("iterations", steps);
    step.run(gridOf(n, oneCell(n, glm::ivec3(centre), 0.0)));
    INFO(steps << " steps");
    CHECK(energy(step.cells("light")) == Approx(std::pow(1.25, steps)).epsilon(1e-5));
  }
  Propagation step(builder.scene);
  step.set("transfer", "published").set("iterations", 1).run(gridOf(n, oneCell(n, glm::ivec3(centre), 0.0)));
  const Cells light = step.cells("light");
  const double flux = kY0 * kY0;  // in every direction, for each unit of solid angle
  const std::size_t above = at(n, centre, centre, centre + 1);
  CHECK(light[at(n, centre, centre, centre)] == Approx(kY0).epsilon(1e-6));
  CHECK(light[above] == Approx(kPrinted0 * flux * (kPrintedFar + 4.0 * kPrintedSide)).epsilon(1e-5));
  CHECK(light[above + 2] == Approx(kPrinted1 * flux * kPrintedFar).epsilon(1e-5));
  CHECK(std::abs(light[above + 1]) + std::abs(light[above + 3]) < 1e-7);
}

TEST_CASE(
    "a printed step drops negative flux: a clamped cosine grows to 1.285 in the first and above 5/4 in each") {
  // The printed light is I = E / (4 pi) (1 + 2 cos). All thirty fluxes make up 1/4 as before; the far face
  // straight behind has 1 - 2 = -1, the four at its side 1 - 4 / sqrt 5 = -0.79, all others are positive.
  const double dropped = kPrintedFar + 4.0 * kPrintedSide * (4.0 / std::sqrt(5.0) - 1.0);
  constexpr int n = 19, centre = 9;
  const SceneBuilder builder = emptyScene();
  double before = 1.0;
  for (int steps = 1; steps <= 8; ++steps) {
    Propagation step(builder.scene);
    step.set("transfer", "published").set("iterations", steps);
    step.run(gridOf(n, oneCell(n, glm::ivec3(centre), 2.0 / 3.0)));
    const double now = energy(step.cells("light"));
    INFO("step " << steps << ": " << now / before);
    if (steps == 1) CHECK(now == Approx(1.25 + 0.25 * dropped).epsilon(1e-5));
    CHECK(now >= 1.25 * before * (1.0 - 1e-5));
    CHECK(now <= (1.25 + 0.25 * dropped) * before * (1.0 + 1e-5));
    before = now;
  }
}

TEST_CASE("the printed step without end stays finite, and the default never grows from the same light") {
  constexpr int n = 9;
  const Cells cells = oneCell(n, {4, 4, 4}, 2.0 / 3.0);
  const SceneBuilder builder = emptyScene();
  Propagation published(builder.scene);
  published.set("transfer", "published")
      .set("border", "mirror")
      .set("iterations", 1024)
      .run(gridOf(n, cells));
  for (const float value : published.cells("light")) REQUIRE(std::isfinite(value));
  CHECK(energy(published.cells("light")) > 1e15);  // 1.25^1024 is not, and is bounded
  for (const int steps : {1, 8, 1024}) {
    Propagation standard(builder.scene);
    standard.set("border", "mirror").set("iterations", steps).run(gridOf(n, cells));
    CHECK(energy(standard.cells("travelling")) == Approx(1.0).epsilon(1e-3));
    CHECK(norm(standard.cells("travelling")) <= norm(cells) * (1.0 + 1e-6));
  }
}

TEST_CASE("a printed normal holds light back by a quarter and half the cosine, its own light most of all") {
  // Listing 4.33: of the way w, 1 - clamp(C(n) . Y(w)) passes, C the clamped cosine: pi Y0^2 = 1/4 and
  // 2/3 pi Y1^2 = 1/2, so 1 - (1/4 + cos/2). Of the four normals counts the one closest to the way to the
  // receiving cell; a face without a normal counts as none, of length 0: 3/4 pass where all look away.
  constexpr int n = 11, centre = 5;
  const SceneBuilder builder = emptyScene();
  Cells cells = oneCell(n, glm::ivec3(centre), 0.0);
  LitCells light = gridOf(n, cells);
  light.faces.levels[0].packed = emptyVoxels(n);
  addSurface(*light.faces.levels[0].packed, n, glm::ivec3(centre), {1, 0, 0});
  const auto sent = [&](float amplifier) {
    Propagation step(builder.scene);
    step.set("occlusion", "normals").set("iterations", 1).set("occlusion_amplifier", amplifier).run(light);
    return step.cells("travelling");
  };
  const double side = 2.0 / std::sqrt(5.0);
  const double all = kY0 * kY0 * kY0 * (kFarFace + 4.0 * kSideFace);
  const double facing = kY0 * kY0 * kY0 * (kFarFace * (0.75 - 0.5) + 4.0 * kSideFace * (0.75 - 0.5 * side));
  const Cells held = sent(1.0f), halved = sent(0.5f), free = sent(0.0f);
  CHECK(held[at(n, centre + 1, centre, centre)] == Approx(facing).epsilon(1e-4));
  CHECK(held[at(n, centre - 1, centre, centre)] == Approx(0.75 * all).epsilon(1e-4));
  CHECK(held[at(n, centre, centre, centre - 1)] == Approx(0.75 * all).epsilon(1e-4));
  CHECK(halved[at(n, centre + 1, centre, centre)] == Approx(0.5 * (all + facing)).epsilon(1e-4));
  CHECK(free[at(n, centre + 1, centre, centre)] == Approx(all).epsilon(1e-4));
  // A surface in the cell that receives holds nothing back.
  light.faces.levels[0].packed = emptyVoxels(n);
  addSurface(*light.faces.levels[0].packed, n, {centre + 1, centre, centre}, {-1, 0, 0});
  CHECK(sent(1.0f)[at(n, centre + 1, centre, centre)] == Approx(all).epsilon(1e-4));
}

TEST_CASE("occlusion as printed is refused where the injection kept no normals") {
  const SceneBuilder builder = emptyScene();
  for (const char* word : {"occlusion", "as_published"}) {
    Propagation step(builder.scene);
    step.set(word, std::string(word) == "occlusion" ? "normals" : "on");
    CHECK_THROWS_MATCHES(step.run(gridOf(4, empty(4))), Error, Tells("level 0", "voxels packed"));
  }
}

TEST_CASE("grids that are apart get nothing from the coarser one, nor from the environment") {
  constexpr int n = 8;
  const SceneBuilder builder = emptyScene(0.5f);
  Cells lit = empty(n);
  for (int z = 0; z < n; ++z) addLight(lit, n, {1, 4, z}, {1, 0, 0}, forwardCosine());
  LitCells light = gridOf(n, empty(n));
  const LitCells coarse = gridOf(n, lit);
  light.levels[0].grid = {glm::vec3(-0.5f), 1.0f / n, glm::ivec3(n)};
  light.levels.push_back(coarse.levels[0]);
  light.faces.levels.push_back(coarse.faces.levels[0]);
  for (const char* grids : {"nested", "apart"}) {
    Propagation step(builder.scene);
    step.set("grids", grids).set("iterations", 20).run(light);
    double largest = 0.0;
    for (const float value : step.cells("light")) largest = std::max<double>(largest, std::abs(value));
    if (std::string(grids) == "apart") CHECK(largest == 0.0);
    if (std::string(grids) == "nested") CHECK(largest > 1e-3);
  }
  Propagation alone(builder.scene);
  alone.set("grids", "apart").run(gridOf(n, empty(n)));
  CHECK(norm(alone.cells("light")) == 0.0);
}

TEST_CASE(
    "a packed voxel is a Lambert surface of its face: E cos A albedo, as three listings in a row give it") {
  // Listings 4.27 to 4.31: radiance albedo / pi in bytes, times E n.l, times the clamped cosine around the
  // decoded normal; every voxel counts as one face h^2, however the surface lies in it.
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.6f));
  builder.quad({-1, -1, -1}, {0, 0, 0.001f}, {0.001f, 0, 0}, builder.lambert(0.0f));  // height
  builder.light(LightKind::directional, glm::vec3(3.0f), {}, {0.3, -1, 0.2});
  const SceneSnapshot snapshot = snapshotOf(builder.scene, 0.0);
  LonePass inject("light_propagation_volumes.inject_voxels", builder.scene,
                  {{"levels", 1}, {"as_published", "on"}});
  inject.in("fragments", fragmentsIn(builder.scene, {{"resolution", 64}}))
      .in("shadow", shadowsOf(builder.scene));
  const ShGrid::Level level = inject.out<ShGrid>("light").levels[0];
  const float h = level.grid.voxelSize;
  const float place = (-static_cast<float>(snapshot.origin.y) - level.grid.low.y) / h;
  REQUIRE(place - std::floor(place) < 0.5f);  // below the centre of its voxels: no shadow on that
  const double cosine = 1.0 / std::sqrt(1.0 + 0.09 + 0.04);
  const double radiance = std::floor(0.6 / kPi * 255.0) / 255.0 * 3.0 * cosine;
  const Cells cells = level.coefficients[0]->downloadFloats(0);
  const std::vector<std::uint32_t> words =
      inject.out<OccludedFaces>("faces").levels[0].packed->downloadValues<std::uint32_t>();
  REQUIRE(words.size() == cells.size() / 4 * 5);
  int lit = 0;
  for (std::size_t i = 0; i < cells.size(); i += 4) {
    const std::size_t word = i / 4 * 5;
    if (cells[i] == 0.0f) continue;
    ++lit;
    CHECK(words[word] >> 31 == 1u);
    CHECK(words[word + 1 + 2] == packedNormal({0, 1, 0}).second);  // as close to the face 2 as to 3
    CHECK(cells[i] == Approx(kPrinted0 * radiance * h * h).epsilon(1e-3));
    CHECK(cells[i + 1] == Approx(kPrinted1 * radiance * h * h).epsilon(1e-3));
    CHECK(std::abs(cells[i + 2]) + std::abs(cells[i + 3]) < 1e-6);
  }
  CHECK(lit > 0.9 * 4.0 / (h * h));
  CHECK(lit < 1.2 * 4.0 / (h * h));
}

TEST_CASE("the most contrasting albedo wins by its values as displayed, not by linear ones") {
  // Contrast |rrg - gbb| / (sqrt 2 + r + g + b): linear 0.073 of the dark red and 0.090 of the pale one; of
  // the displayed values, x^(1/2.2), 0.122 and 0.042.
  SceneBuilder builder;
  Material dark, pale;
  dark.diffuse = {0.1f, 0.02f, 0.02f};
  pale.diffuse = {1.0f, 0.75f, 0.75f};
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.material(dark));
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.material(pale));
  builder.quad({-1, 1, -1}, {0, 0, 0.001f}, {0.001f, 0, 0}, builder.lambert(0.0f));
  builder.light(LightKind::directional, glm::vec3(3.0f), {}, {0, -1, 0});
  for (const char* voxels : {"mean", "packed"}) {
    const ShGrid light = LonePass("light_propagation_volumes.inject_voxels", builder.scene,
                                  {{"levels", 1}, {"albedo", "contrast"}, {"voxels", voxels}})
                             .in("fragments", fragmentsIn(builder.scene))
                             .in("shadow", shadowsOf(builder.scene))
                             .out<ShGrid>("light");
    const double red = energy(light.levels[0].coefficients[0]->downloadFloats(0)),
                 blue = energy(light.levels[0].coefficients[2]->downloadFloats(0));
    INFO(voxels);
    REQUIRE(red > 0.0);
    CHECK(blue / red == Approx(0.2).margin(0.08));  // bytes of 0.1 / pi and 0.02 / pi: 8 and 1; not 0.75
  }
}

TEST_CASE(
    "the printed reflection grid shines with albedo / pi times pi Y0 c0, half a voxel off along z alone") {
  // Listing 4.34. With c0 = k in the cells of number k, a voxel whose centre lies at p cells reads p - 1/2;
  // along z it reads half a voxel lower. Around the eye, in the middle, light is gone after half a side.
  constexpr int n = 8, voxels = 32;
  const double h = 2.0 / n, size = 2.0 / voxels;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<float> values = reflected(gridOf(n, growing(n, axis)), voxels);
    for (const glm::ivec3 voxel : {glm::ivec3(16, 16, 16), glm::ivec3(10, 18, 21), glm::ivec3(23, 12, 9)}) {
      glm::dvec3 centre = (glm::dvec3(voxel) + 0.5) * size;
      const double fade = 1.0 - glm::length(centre - 1.0);
      centre.z -= 0.5 * size;
      const double expected = kPrinted0 / kPi * (centre[axis] / h - 0.5) / (h * h) * fade;
      const auto i = static_cast<std::size_t>(4 * ((voxel.z * voxels + voxel.y) * voxels + voxel.x));
      INFO("axis " << axis << ", voxel " << voxel.x << " " << voxel.y << " " << voxel.z);
      CHECK(values[i] == Approx(expected).epsilon(1e-4));
      CHECK(values[i + 3] == 1.0f);
    }
    CHECK(values[0] == 0.0f);  // a corner lies beyond half a side
  }
}

TEST_CASE(
    "the printed lookup filters at the surface, half a cell low along z, with the lobe of the normal itself") {
  // Listing 4.35: dot(c, C(n)) / pi with c per face of a cell, no step away from the surface.
  constexpr int n = 8;
  const double h = 2.0 / n;
  const Settings published{{"as_published", "on"}};
  const glm::vec3 position(0.13f, -0.21f, 0.34f);
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 place = (glm::dvec3(position) + 1.0) / h;
    place.z -= 0.5;
    for (const glm::vec3 normal : {glm::vec3(0, 1, 0), glm::vec3(0, 0, -1)})
      CHECK(gathered(gridOf(n, growing(n, axis)), position, normal, published) ==
            Approx(kPrinted0 * (place[axis] - 0.5) / (h * h) / kPi).epsilon(filtered(1e-4f)));
  }
  // Light that travels along the normal, away from the surface, counts; what comes in against it is negative
  // and cut off.
  Cells upwards = empty(n);
  for (std::size_t i = 0; i < upwards.size(); i += 4) upwards[i + 1] = 1.0f;
  CHECK(gathered(gridOf(n, upwards), position, {0, 1, 0}, published) ==
        Approx(kPrinted1 / (h * h) / kPi).epsilon(1e-4));
  CHECK(gathered(gridOf(n, upwards), position, {0, -1, 0}, published) == 0.0);
  // By default it is the other way round, and a cell shows 3/2 h^2. Light without a mean counts for nothing.
  constexpr double kMean = 0.01;
  for (std::size_t i = 0; i < upwards.size(); i += 4) upwards[i] = static_cast<float>(kMean);
  CHECK(gathered(gridOf(n, upwards), position, {0, -1, 0}, {{"negative", "clip"}}) ==
        Approx((kPrinted1 + kMean * kPrinted0) / (1.5 * h * h) / kPi).epsilon(1e-4));
  CHECK(gathered(gridOf(n, upwards), position, {0, 1, 0}, {{"negative", "clip"}}) == 0.0);
}

TEST_CASE("grids are blended as printed from 12 to 16 cells around the eye, whatever the borders") {
  // Listing 4.36, of 32 cells a side: 12/32 and 16/32 of the side of the finer grid.
  constexpr int n = 16;
  const auto even = [&](float value) {
    Cells cells = empty(n);
    for (std::size_t i = 0; i < cells.size(); i += 4) cells[i] = value;
    return gridOf(n, cells).levels[0];
  };
  ShGrid::Level fine = even(1.0f), coarse = even(0.0f);
  const glm::vec3 eye = snapshotOf(emptyScene().scene, 0.0).camera.eye;
  fine.grid = {eye - 0.5f, 1.0f / n, glm::ivec3(n)};  // 1 m around it
  coarse.grid = {eye - 1.0f, 2.0f / n, glm::ivec3(n)};
  LitCells light;
  light.levels = {fine, coarse};
  const double h = fine.grid.voxelSize, whole = kPrinted0 / (h * h) / kPi;
  const auto at = [&](float distance) {
    return gathered(light, eye + distance * glm::normalize(glm::vec3(1, 2, -1)), {0, 1, 0},
                    {{"as_published", "on"}}) /
           whole;
  };
  CHECK(at(0.0f) == Approx(1.0).epsilon(1e-4));
  CHECK(at(0.37f) == Approx(1.0).epsilon(1e-4));
  CHECK(at(13.0f / 32.0f) == Approx(0.75).epsilon(1e-3));
  CHECK(at(15.0f / 32.0f) == Approx(0.25).epsilon(1e-3));
  CHECK(at(0.51f) == 0.0);
}
