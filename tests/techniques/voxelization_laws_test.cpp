// What holds for every voxelizer: nothing is invented, and fragments have the surface data of their place.
#include <cmath>
#include <random>

#include "lumivox/measure/voxels.h"
#include "support/voxelizers.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr int kSide = 16;  ///< voxels along the square; one more on every side of it

/// A square of 2 m across an axis, at zero; its edges run along the two axes that follow.
SceneBuilder square(int axis, const Material& material, const std::vector<SurfaceTexture>& textures = {}) {
  SceneBuilder builder;
  glm::vec3 corner(-1.0f), edge1(0.0f), edge2(0.0f);
  corner[axis] = 0.0f;
  edge1[(axis + 1) % 3] = 2.0f;
  edge2[(axis + 2) % 3] = 2.0f;
  builder.quad(corner, edge1, edge2, builder.material(material));
  builder.scene.textures = textures;
  return builder;
}

/// Along the axes of the square, from -1 to 1.
glm::dvec3 placeOf(const Voxels& voxels, const FragmentData& fragment) {
  return glm::dvec3(voxels.grid.low) + double(voxels.grid.voxelSize) * fragment.position();
}

}  // namespace

TEST_CASE("every voxel of every voxelizer is touched by a triangle") {
  const Voxelizer by = GENERATE(from_range(kVoxelizers));
  INFO(by.name());
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  std::mt19937 generator(7);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  const auto vector = [&] { return glm::vec3(uniform(generator), uniform(generator), uniform(generator)); };
  for (const float size : {0.1f, 1.5f})
    for (int i = 0; i < 50; ++i) {
      const glm::vec3 first = vector();
      builder.mesh({first, first + size * vector(), first + size * vector()}, grey);
    }
  const Voxels voxels = voxelized(builder.scene, by, 40);
  VoxelSet found(voxels.grid.resolution);
  for (const Cell& cell : voxels.occupied) found.insert({cell[0], cell[1], cell[2]});
  const VoxelError error =
      compareVoxels(found, trueVoxels(builder.scene, snapshotOf(builder.scene, 0.0), voxels.grid));
  CHECK(error.falsePositive == 0);
  CHECK(error.recall() > 0.35);
}

TEST_CASE("nothing, points, lines and a single voxel are no special cases of any voxelizer") {
  const Voxelizer by = GENERATE(from_range(kVoxelizers));
  INFO(by.name());
  CHECK(voxelized(SceneBuilder().scene, by, 16).fragments.empty());
  for (const glm::vec3& edge : {glm::vec3(0, 0, 0), glm::vec3(1, 1, 0)}) {
    SceneBuilder builder;
    builder.mesh({{0, 0, 0}, edge, 2.0f * edge, {0, 0, 0}, edge, {0, 0, 0}}, builder.lambert(0.5f));
    const Voxels voxels = voxelized(builder.scene, by, 16);
    for (const FragmentData& fragment : voxels.fragments)
      CHECK(glm::length(fragment.unitNormal()) == Approx(1.0f));
    if (by.pass == "slicing" || by.pass == "depth_peeling" || by.pass == "msaa_opacity")
      CHECK(voxels.fragments.empty());
    if (by.pass == "points") CHECK(!voxels.fragments.empty());
  }
  for (int axis = 0; axis < 3; ++axis) CHECK(voxelized(square(axis, {}).scene, by, 1).occupied.size() == 1);
  CHECK(voxelized(square(1, {}).scene, by, {{"resolution", 3}}).occupied.size() >= 1);
}

TEST_CASE("a fragment has the albedo, the emission and the normal of its surface") {
  const Voxelizer by = GENERATE(from_range(kVoxelizers));
  INFO(by.name());
  SceneBuilder builder;
  Material material;
  material.diffuse = {0.25f, 0.5f, 0.75f};
  material.emission = {4, 2, 0};
  builder.box({-1, -1, -1}, {1, 1, 1}, builder.material(material), false);
  const Voxels voxels = voxelized(builder.scene, by, 12);
  REQUIRE(voxels.fragments.size() > 100);
  for (const FragmentData& fragment : voxels.fragments) {
    CHECK(fragment.albedo() == (by.attributes ? material.diffuse : glm::vec3(0.0f)));
    CHECK(fragment.emittedRadiance() == (by.attributes ? material.emission : glm::vec3(0.0f)));
    if (!by.sums) CHECK(fragment.coverage() == 1.0f);
    if (!by.attributes) continue;
    // Outwards, at a side of the box.
    const glm::dvec3 place = placeOf(voxels, fragment);
    CHECK(glm::dot(place, glm::dvec3(fragment.unitNormal())) == Approx(1.0).margin(0.02));
  }
}

TEST_CASE("a mask's holes leave no fragments, and a texture gives its colour to what is left") {
  const Voxelizer by = GENERATE(from_range(kVoxelizers));
  INFO(by.name());
  Material material;
  material.diffuse = glm::vec3(1.0f);
  material.diffuseTexture = 0;
  material.maskTexture = 1;
  // The left half is a hole, the right half is there; green everywhere.
  SurfaceTexture mask{"mask", 64, 1, true, std::vector<float>(64, 0.0f)};
  std::fill(mask.values.begin() + 32, mask.values.end(), 1.0f);
  const SceneBuilder builder = square(2, material, {{"green", 2, 1, false, {0, 0.5f, 0, 0, 0.5f, 0}}, mask});
  const Voxels voxels = voxelized(builder.scene, by, kSide + 2);
  std::size_t left = 0, right = 0;
  for (const Cell& cell : voxels.occupied) {
    // Away from the border: a mip of four texels reaches a voxel far.
    left += cell[0] >= 4 && cell[0] < 7;
    right += cell[0] >= 10 && cell[0] < 16;
  }
  CHECK(left == 0);
  CHECK(right == 6u * 16u);
  for (const FragmentData& fragment : voxels.fragments)
    CHECK(fragment.albedo() == glm::vec3(0, by.attributes ? 0.5f : 0.0f, 0));
}

TEST_CASE(
    "a texture is read through the mip whose texels are voxels, along either edge of a square across any axis") {
  const Voxelizer by = GENERATE(from_range(kVoxelizers));
  INFO(by.name());
  if (!by.attributes) return;
  // Eight texels a voxel along one edge and half a texel along the other: of each eight the four in the
  // middle are brighter. Their means make no simple row.
  constexpr int kTexels = 8 * kSide;
  for (const bool alongSecond : {false, true}) {
    const auto mean = [&](int block) { return 0.25 + 0.5 * (block * 7 % kSide) / (kSide - 1); };
    SurfaceTexture stripes;
    stripes.width = alongSecond ? 8 : kTexels;
    stripes.height = alongSecond ? kTexels : 8;
    for (int y = 0; y < stripes.height; ++y)
      for (int x = 0; x < stripes.width; ++x) {
        // The first row is the top one, where the second texture coordinate is 1.
        const int texel = alongSecond ? kTexels - 1 - y : x;
        const double value = mean(texel / 8) + (texel % 8 / 2 % 3 == 0 ? -0.2 : 0.2);
        stripes.values.insert(stripes.values.end(), 3, static_cast<float>(value));
      }
    Material material;
    material.diffuse = glm::vec3(1.0f);
    material.diffuseTexture = 0;
    for (int axis = by.columns ? 0 : 1; axis < (by.columns ? 3 : 2); ++axis) {
      const Voxels voxels = voxelized(square(axis, material, {stripes}).scene, by, kSide + 2);
      CAPTURE(axis, alongSecond);
      double worst = 0.0, farthest = 0.0;  // off the texture, off the square
      int looked = 0;
      for (const FragmentData& fragment : voxels.fragments) {
        const double along = placeOf(voxels, fragment)[(axis + (alongSecond ? 2 : 1)) % 3],
                     block = 0.5 * (along + 1.0) * kSide - 0.5, below = std::floor(block);
        if (below < 1.0 || below > kSide - 3) continue;
        // Of a triangle that does not cover the middle of a column another place is looked at.
        if (by.columns && std::abs(block - std::round(block)) > 0.02) continue;
        const double expected =
            glm::mix(mean(static_cast<int>(below)), mean(static_cast<int>(below) + 1), block - below);
        worst = std::max(worst, std::abs(fragment.albedo().g - expected));
        farthest = std::max(farthest, std::abs(placeOf(voxels, fragment)[axis]));
        ++looked;
      }
      CHECK(looked >= kSide * (kSide - 6));
      CHECK(worst < (by.columns ? 0.03 : 0.05));
      CHECK(farthest < 0.01 * voxels.grid.voxelSize);
    }
  }
}

TEST_CASE("a fragment's normal is that between the corners, of unit length however short their mean is") {
  const Voxelizer by = GENERATE(from_range(kVoxelizers));
  INFO(by.name());
  if (!by.attributes) return;
  // At the ends of one edge the normals lean apart, 145 degrees from each other; halfway their mean is 0.3
  // long.
  const float lean = std::sqrt(1.0f - 0.3f * 0.3f);
  SceneBuilder builder = square(2, {});
  for (std::size_t i = 0; i < 4; ++i)
    builder.scene.normals[i] = {builder.scene.positions[i].x * lean, 0.0f, 0.3f};
  const Voxels voxels = voxelized(builder.scene, by, kSide + 2);
  double worst = 0.0;
  int looked = 0;
  for (const FragmentData& fragment : voxels.fragments) {
    // Of a triangle that hardly reaches into a column the place may lie beside it, and is cut off there.
    const glm::dvec3 inside = fragment.position() - glm::dvec3(fragment.cell());
    if (std::max(std::abs(inside.x - 0.5), std::abs(inside.y - 0.5)) > 0.49) continue;
    const glm::dvec3 expected = glm::normalize(glm::dvec3(placeOf(voxels, fragment).x * lean, 0.0, 0.3));
    worst = std::max(worst, glm::length(glm::dvec3(fragment.unitNormal()) - expected));
    ++looked;
  }
  CHECK(looked >= kSide * kSide);
  CHECK(worst < 0.01);
}

TEST_CASE(
    "with a mask and no texture a fragment has the material's albedo and the mask's mean over a voxel") {
  const Voxelizer by = GENERATE(from_range(kVoxelizers));
  INFO(by.name());
  if (!by.attributes) return;
  // Each voxel sees 4 x 4 texels of the mask, of which a quarter are holes.
  SurfaceTexture holes{"holes", 4 * kSide, 4 * kSide, true, {}};
  for (int y = 0; y < holes.height; ++y)
    for (int x = 0; x < holes.width; ++x) holes.values.push_back(x % 2 + y % 2 == 0 ? 0.0f : 1.0f);
  Material material;
  material.diffuse = {0.6f, 0.4f, 0.2f};
  material.maskTexture = 0;
  const Voxels voxels = voxelized(square(1, material, {holes}).scene, by, kSide + 2);
  CHECK(voxels.fragments.size() >= kSide * kSide);
  for (const FragmentData& fragment : voxels.fragments) {
    CHECK(glm::length(fragment.albedo() - material.diffuse) < 1e-3f);
    if (!by.sums) CHECK(fragment.coverage() == Approx(0.75).margin(1e-2));
  }
}

TEST_CASE("what deforms is voxelized where it is at the time") {
  const Voxelizer by = GENERATE(from_range(kVoxelizers));
  INFO(by.name());
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
  VoxelizedFrames frames(builder.scene, by, "resolution 16");
  std::set<int> rows[2];
  for (const int half : {0, 1})
    for (const Cell& cell : frames.at(0.5 * half).occupied) rows[half].insert(cell[1]);
  // On the face between two voxels it may touch both.
  for (const std::set<int>& one : rows) CHECK((one.size() == 1 || one.size() == 2));
  CHECK(*rows[0].rbegin() < *rows[1].begin());
}
