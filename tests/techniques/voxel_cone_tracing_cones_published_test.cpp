// Listings 4.12 and 4.13 of the thesis and its mipmap, run as printed: what they must give is derived here
// from the printed formulas. All lengths are in finest voxels.
#include <cmath>

#include "support/cones.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::cones;

namespace {

constexpr int kResolution = 128;
constexpr double kVoxel = 2.0 / kResolution;       // m
constexpr double kSumOfWeights = 1.0 + 4 * 0.707;  // Listing 4.12, not normalised

/// The light that a point in the middle gathers as printed, from samples no further than `reach` voxels.
double gatheredAsPublished(const RadianceGrid& grid, double environment, double coneRatio, double reach) {
  GatherSettings settings;
  settings.asPublished = true;
  settings.coneRatio = coneRatio;
  settings.reach = reach * kVoxel;
  return gather(emptyScene(glm::vec3(static_cast<float>(environment))), grid, glm::vec3(0.0f), {0, 1, 0},
                settings)
      .r;
}

/// Distance of sample n of a cone as printed: the first at 2, each next one half a diameter, of 2 at least,
/// behind.
double sampleDistance(double coneRatio, int n) {
  double distance = 2.0;
  for (int i = 0; i < n; ++i) distance += 0.5 * std::max(2.0, coneRatio * distance);
  return distance;
}

}  // namespace

TEST_CASE("as published the five cones weigh 1 and 0.707 and a constant environment comes in 3.828 times") {
  const RadianceGrid empty = filtered(uniformGrid(16, glm::vec4(0.0f)), "average");
  for (const double ratio : {0.5, 1.1547, 4.0}) {
    GatherSettings settings;
    settings.asPublished = true;
    settings.coneRatio = ratio;
    const glm::vec3 radiance =
        gather(emptyScene({0.5f, 1.0f, 2.0f}), empty, glm::vec3(0.1f), glm::vec3(0, 1, 0), settings);
    CHECK(radiance.g == Approx(kSumOfWeights).epsilon(1e-5));
    CHECK(radiance.b == Approx(2.0 * kSumOfWeights).epsilon(1e-5));
  }
}

TEST_CASE(
    "as published a uniform medium absorbs 0.76 where a sample is 16 voxels wide and 0.94 would be exact, and ours "
    "absorbs 0.94 with both filters") {
  // Plain means keep the opacity a = 0.3 of a finest voxel at all levels. The step of a sample of diameter D
  // is D / 2 long: exact is 1 - 0.7^(D / 2), 0.942 for D = 16. The printed exponent is (D / 2) over the
  // diameter of the first sample, which is 2 for ratios up to 1: 1 - 0.7^(D / 4), 0.760. (With d'/d of the
  // prose, 1/2, it would be 0.163.)
  constexpr double kOpacity = 0.3;
  const glm::vec4 dark(0, 0, 0, kOpacity);
  // The ratio for which the sample number 6 has the diameter 16.
  constexpr int kSample = 6;
  double low = 0.5, high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (middle * sampleDistance(middle, kSample) < 16.0 ? low : high) = middle;
  }
  const double distance = sampleDistance(low, kSample);
  REQUIRE(low * distance == Approx(16.0).epsilon(1e-6));
  REQUIRE(low < 0.999);
  // A medium without light in front of an environment of 1: what is left of the environment is what passed.
  const RadianceGrid grid = filtered(uniformGrid(kResolution, dark), "average");
  const double before = gatheredAsPublished(grid, 1.0, low, distance - 0.1),
               behind = gatheredAsPublished(grid, 1.0, low, distance + 0.1);
  CHECK(1.0 - behind / before == Approx(1.0 - std::pow(0.7, 4.0)).epsilon(0.001));
  CHECK(1.0 - behind / before == Approx(0.76).margin(0.001));
  // All steps before it: their exponents are half of the way in voxels, from 2 to this sample.
  CHECK(before == Approx(kSumOfWeights * std::pow(0.7, 0.5 * (distance - 2.0))).epsilon(0.001));

  for (const char* filter : {"facing", "average"}) {
    const RadianceGrid ours = filtered(uniformGrid(kResolution, dark), filter);
    const auto passed = [&](double reach) {
      GatherSettings settings{5, "published"};
      settings.reach = reach * kVoxel;
      settings.footprint = 1.0;
      settings.clearance = 1000.0;
      settings.step = 0.5;
      return gather(emptyScene(glm::vec3(1.0f)), ours, glm::vec3(0.0f), {0, 1, 0}, settings).r;
    };
    INFO(filter);
    CHECK(1.0 - passed(16.0) / passed(8.0) == Approx(1.0 - std::pow(0.7, 8.0)).epsilon(0.002));
  }
}

TEST_CASE("as published the exponent is fixed by the first sample, as wide as the cone there") {
  // With a ratio of 3 the first sample, 2 voxels away, is 6 wide: exponents are D / 12, and steps D / 2.
  const RadianceGrid grid = filtered(uniformGrid(kResolution, glm::vec4(0, 0, 0, 0.1)), "average");
  const double second = 2.0 + 0.5 * 6.0, third = second + 0.5 * 3.0 * second;
  CHECK(gatheredAsPublished(grid, 1.0, 3.0, 2.1) == Approx(kSumOfWeights * std::pow(0.9, 0.5)).epsilon(1e-4));
  CHECK(gatheredAsPublished(grid, 1.0, 3.0, third - 0.1) ==
        Approx(kSumOfWeights * std::pow(0.9, 0.5 + 3.0 * second / 12.0)).epsilon(1e-4));
}

TEST_CASE(
    "as published light is multiplied by opacity twice, and what was gathered by it anew at every step") {
  // Voxels hold a L = 0.3 at L = 1. For a ratio of 1 the samples are 2, 3 and 4.5 wide and away; their
  // opacities are 1 - 0.7^(1/2), 1 - 0.7^(3/4) and 1 - 0.7^(9/8). accum.rgb is multiplied by accum.a, then (1
  // - accum.a) times the new opacity times the value, which has the opacity in it, is added.
  const RadianceGrid grid = filtered(uniformGrid(kResolution, glm::vec4(0.3f)), "average");
  const double first = 1.0 - std::pow(0.7, 0.5), second = 1.0 - std::pow(0.7, 0.75),
               third = 1.0 - std::pow(0.7, 1.125);
  const double one = first * 0.3;
  const double opacityOfTwo = 1.0 - std::pow(0.7, 0.5 + 0.75);
  const double two = one * first + (1.0 - first) * second * 0.3;
  const double three = two * opacityOfTwo + (1.0 - opacityOfTwo) * third * 0.3;
  CHECK(gatheredAsPublished(grid, 0.0, 1.0, 2.5) == Approx(kSumOfWeights * one).epsilon(1e-4));
  CHECK(gatheredAsPublished(grid, 0.0, 1.0, 3.5) == Approx(kSumOfWeights * two).epsilon(1e-4));
  CHECK(gatheredAsPublished(grid, 0.0, 1.0, 5.0) == Approx(kSumOfWeights * three).epsilon(1e-4));
  // In empty space too. A sharp mirror looks up through 6 voxels of the medium: samples are 2 wide and one
  // apart, their exponents 1/2. Level 1 reads 0.3 up to the fifth voxel, half of it at the sixth and nothing
  // from the seventh on, so that the opacity stays 1 - (0.7^4 0.85)^(1/2), and every further sample
  // multiplies by it.
  const RadianceGrid slab = filtered(
      makeGrid(kResolution,
               [](int, int, int z) {
                 return z >= kResolution / 2 && z < kResolution / 2 + 6 ? glm::vec4(0.3f) : glm::vec4(0.0f);
               }),
      "average");
  const auto mirrored = [&](double reach) {
    GatherSettings settings;
    settings.asPublished = true;
    settings.reach = reach * kVoxel;
    return gatherGlossy(emptyScene(), slab, glm::vec3(0.0f), {0, 0, 1}, glm::vec4(1, 1, 1, 1e6f), settings).r;
  };
  const double opacity = 1.0 - std::sqrt(std::pow(0.7, 4.0) * 0.85);
  CHECK(mirrored(8.5) / mirrored(7.5) == Approx(opacity).epsilon(1e-4));
  CHECK(mirrored(12.5) / mirrored(7.5) == Approx(std::pow(opacity, 5.0)).epsilon(1e-4));
}

TEST_CASE(
    "as published cones start two voxels along their axes from the surface itself and read level 1 at least") {
  // Everything is opaque, so that the first sample is all that a cone sees. Radiance grows evenly with the
  // height, which means and trilinear reading keep.
  const auto radianceAt = [](double y) { return 2.0 + y / kVoxel / kResolution; };  // y in m from the middle
  const RadianceGrid grid = filtered(
      makeGrid(kResolution,
               [&](int, int y, int) {
                 const auto value = static_cast<float>(radianceAt((y + 0.5 - kResolution / 2) * kVoxel));
                 return glm::vec4(value, value, value, 1.0f);
               }),
      "average");
  GatherSettings settings;
  settings.asPublished = true;
  settings.offset = settings.start = 4.0;  // without say
  const double expected = radianceAt(2.0 * kVoxel) + 4 * 0.707 * radianceAt(2.0 * std::sqrt(0.5) * kVoxel);
  CHECK(gather(emptyScene(), grid, glm::vec3(0.0f), {0, 1, 0}, settings).r == Approx(expected).epsilon(1e-5));
  // A surface seen straight from above mirrors upwards: one cone.
  CHECK(gatherGlossy(emptyScene(), grid, glm::vec3(0.0f), {0, 0, 1}, glm::vec4(0.5f, 0.5f, 0.5f, 1e5f),
                     settings)
            .r == Approx(0.5 * radianceAt(0.0)).epsilon(1e-5));
  // One bright voxel of 8, whose lowest corner is 2 above the point, in opaque black. Its parent of level 1
  // has 1, and the upright cone reads at the parent's corner: 1/8 (the finest level would give 8/8). Tilted
  // cones read at 1.414 to a side and up, which is 0.207 of a parent's width inside of the parent's lower
  // half in height, and 0.793 of the way to its middle on the two sides that are near it; on the other two,
  // none of it.
  const int middle = kResolution / 2;
  const RadianceGrid spark = filtered(makeGrid(kResolution,
                                               [&](int x, int y, int z) {
                                                 return x == middle && y == middle + 2 && z == middle
                                                            ? glm::vec4(8, 8, 8, 1)
                                                            : glm::vec4(0, 0, 0, 1);
                                               }),
                                      "average");
  settings.coneRatio = 0.5;             // samples as narrow as they get
  const double aside = std::sqrt(0.5);  // in voxels of level 1
  const double tilted = (aside - 0.5) * (1.5 - aside) * 0.5;
  CHECK(gather(emptyScene(), spark, glm::vec3(0.0f), {0, 1, 0}, settings).r ==
        Approx(0.125 + 0.707 * 2.0 * tilted).epsilon(1e-4));
}

TEST_CASE(
    "the published mipmap reads the mean of eight children in one fetch, and at odd sizes what lies in between") {
  const auto noise = [](int x, int y, int z) {
    const auto hash = [&](int k) {
      return static_cast<float>((x * 73 + y * 151 + z * 211 + k * 37) % 97) / 97.0f;
    };
    return glm::vec4(hash(1), hash(2), hash(3), hash(4));
  };
  const RadianceGrid mean = filtered(makeGrid(16, noise), "average"),
                     read = filtered(makeGrid(16, noise), "trilinear");
  CHECK(read.opacity == RadianceGrid::Opacity::ofFinestVoxel);
  for (int level = 1; level < 5; ++level) {
    const std::vector<float> expected = mean.radiance->downloadFloats(level),
                             got = read.radiance->downloadFloats(level);
    REQUIRE(expected.size() == got.size());
    for (std::size_t i = 0; i < got.size(); ++i) CHECK(got[i] == Approx(expected[i]).epsilon(1e-5));
  }
  // Three voxels to one: the fetch in the middle is the middle voxel alone, the mean is that of all 27.
  CHECK(filtered(makeGrid(3, noise), "trilinear").radiance->downloadFloats(1).at(0) ==
        Approx(noise(1, 1, 1).r));
  double sum = 0.0;
  for (int i = 0; i < 27; ++i) sum += noise(i % 3, i / 3 % 3, i / 9).r / 27.0;
  CHECK(filtered(makeGrid(3, noise), "average").radiance->downloadFloats(1).at(0) ==
        Approx(sum).epsilon(1e-5));
}
