// The surface data of fragments at their place, whichever voxelizer made them: its texture, its normal.
#include <array>
#include <cmath>

#include "lumivox/pipeline/pass.h"
#include "support/scene_builder.h"
#include "support/techniques.h"
#include "support/voxel_fragments.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

struct Voxelizer {
  const char* pass;
  const char* method;  ///< empty: it has one only
  bool columns;        ///< looks at the middle of a column; else at points anywhere
};
constexpr std::array<Voxelizer, 7> kVoxelizers{{{"conservative", "raster", true},
                                                {"conservative", "compute", true},
                                                {"slicing", "", true},
                                                {"depth_peeling", "", true},
                                                {"msaa_opacity", "", true},
                                                {"points", "", false},
                                                {"atlas_attributes", "", false}}};

constexpr int kSide = 16;  ///< voxels along the square; one more on every side of it

/// A square of 2 m across an axis, at zero; its edges run along the two axes that follow.
SceneBuilder square(int axis, const Material& material) {
  SceneBuilder builder;
  glm::vec3 corner(-1.0f), edge1(0.0f), edge2(0.0f);
  corner[axis] = 0.0f;
  edge1[(axis + 1) % 3] = 2.0f;
  edge2[(axis + 2) % 3] = 2.0f;
  builder.quad(corner, edge1, edge2, builder.material(material));
  return builder;
}

struct Fragments {
  std::vector<FragmentData> all;
  GridPlacement grid;
  /// From -1 to 1 along the axes of the square.
  glm::dvec3 place(const FragmentData& fragment) const {
    return glm::dvec3(grid.low) + double(grid.voxelSize) * fragment.position();
  }
};

Fragments voxelized(const Scene& scene, const Voxelizer& by) {
  PassHarness harness(device(), techniques(), "voxelization", by.pass, scene, snapshotOf(scene, 0.0));
  harness.setParameter("resolution", kSide + 2);
  if (*by.method != 0) harness.setParameter("method", std::string(by.method));
  if (std::string(by.pass) == "slicing") harness.setParameter("axes", 3);
  if (std::string(by.pass) == "points") harness.setParameter("points", 500);
  harness.run();
  const auto& list = harness.output<VoxelFragments>("fragments");
  return {fragmentsOf(list), list.grid};
}

}  // namespace

TEST_CASE(
    "a texture is read through the mip whose texels are voxels, along either edge of a square across any axis") {
  // Eight texels a voxel along one edge and half a texel along the other: of each eight the four in the
  // middle are brighter. Their means make no simple row.
  constexpr int kTexels = 8 * kSide;
  for (const bool columns : {true, false})
    for (const bool alongSecond : {false, true}) {
      const auto mean = [&](int block) { return 0.25 + 0.5 * (block * 7 % kSide) / (kSide - 1); };
      SurfaceTexture stripes;
      stripes.name = "stripes";
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
      for (int axis = 0; axis < 3; ++axis) {
        SceneBuilder builder = square(axis, material);
        builder.scene.textures = {stripes};
        for (const Voxelizer& by : kVoxelizers) {
          if (by.columns != columns || (!columns && axis != 1)) continue;
          const Fragments fragments = voxelized(builder.scene, by);
          CAPTURE(by.pass, by.method, axis, alongSecond);
          double worst = 0.0, farthest = 0.0;  // off the texture, off the square
          int looked = 0;
          for (const FragmentData& fragment : fragments.all) {
            const double along = fragments.place(fragment)[(axis + (alongSecond ? 2 : 1)) % 3];
            const double block = 0.5 * (along + 1.0) * kSide - 0.5, below = std::floor(block);
            if (below < 1.0 || below > kSide - 3) continue;
            // Of a triangle that does not cover the middle of a column another place is looked at.
            if (columns && std::abs(block - std::round(block)) > 0.02) continue;
            const double expected =
                glm::mix(mean(static_cast<int>(below)), mean(static_cast<int>(below) + 1), block - below);
            worst = std::max(worst, std::abs(fragment.albedo().g - expected));
            if (std::string(by.pass) != "msaa_opacity") REQUIRE(fragment.coverage() == 1.0f);
            farthest = std::max(farthest, std::abs(fragments.place(fragment)[axis]));
            ++looked;
          }
          CHECK(looked >= kSide * (kSide - 6));
          CHECK(worst < (columns ? 0.03 : 0.05));
          CHECK(farthest < 0.01 * fragments.grid.voxelSize);
        }
      }
    }
}

TEST_CASE("a fragment's normal is that between the corners, of unit length however short their mean is") {
  // At the ends of one edge the normals lean apart, 145 degrees from each other; halfway their mean is 0.3
  // long.
  const float lean = std::sqrt(1.0f - 0.3f * 0.3f);
  SceneBuilder builder = square(2, {});
  for (std::size_t i = 0; i < 4; ++i)
    builder.scene.normals[i] = {builder.scene.positions[i].x * lean, 0.0f, 0.3f};
  for (const Voxelizer& by : kVoxelizers) {
    CAPTURE(by.pass, by.method);
    const Fragments fragments = voxelized(builder.scene, by);
    double worst = 0.0;
    int looked = 0;
    for (const FragmentData& fragment : fragments.all) {
      // Of a triangle that hardly reaches into a column the place may lie beside it, and is cut off there.
      const glm::dvec3 inside = fragment.position() - glm::dvec3(fragment.cell());
      if (std::max(std::abs(inside.x - 0.5), std::abs(inside.y - 0.5)) > 0.49) continue;
      const glm::dvec3 expected = glm::normalize(glm::dvec3(fragments.place(fragment).x * lean, 0.0, 0.3));
      worst = std::max(worst, glm::length(glm::dvec3(fragment.unitNormal()) - expected));
      if (std::string(by.pass) != "msaa_opacity") REQUIRE(fragment.coverage() == 1.0f);
      ++looked;
    }
    CHECK(looked >= kSide * kSide);
    CHECK(worst < 0.01);
  }
}

TEST_CASE(
    "with a mask and no texture a fragment has the material's albedo and the mask's mean over a voxel") {
  // Each voxel sees 4 x 4 texels of the mask, of which a quarter are holes.
  SurfaceTexture holes;
  holes.name = "holes";
  holes.width = holes.height = 4 * kSide;
  holes.mask = true;
  for (int y = 0; y < holes.height; ++y)
    for (int x = 0; x < holes.width; ++x) holes.values.push_back(x % 2 + y % 2 == 0 ? 0.0f : 1.0f);
  Material material;
  material.diffuse = {0.6f, 0.4f, 0.2f};
  material.maskTexture = 0;
  SceneBuilder builder = square(1, material);
  builder.scene.textures = {holes};
  for (const Voxelizer& by : kVoxelizers) {
    CAPTURE(by.pass, by.method);
    const Fragments fragments = voxelized(builder.scene, by);
    CHECK(fragments.all.size() >= kSide * kSide);
    double offAlbedo = 0.0, offCoverage = 0.0;
    for (const FragmentData& fragment : fragments.all) {
      offAlbedo =
          std::max(offAlbedo, glm::length(glm::dvec3(fragment.albedo()) - glm::dvec3(material.diffuse)));
      if (std::string(by.pass) != "msaa_opacity")
        offCoverage = std::max(offCoverage, std::abs(double{fragment.coverage()} - 0.75));
    }
    CHECK(offAlbedo < 1e-3);
    CHECK(offCoverage < 1e-2);
  }
}
