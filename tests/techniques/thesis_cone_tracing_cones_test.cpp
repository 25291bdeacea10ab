// Listings 4.12 to 4.15 and the mipmap of Sec. 4.2.1: what they must give is derived here from the printed
// formulas. All lengths are in finest voxels.
#include <cmath>

#include "support/filtered.h"
#include "support/thesis_cone_tracing.h"

using namespace lumivox;
using namespace lumivox::test;
using cones::emptyScene;
using cones::makeDirections;
using cones::makeGrid;
using cones::uniformGrid;
using thesis::gather;
using thesis::gatherGlossy;
using thesis::GatherSettings;
using thesis::mipmapped;

namespace {

constexpr int kResolution = 128;
constexpr double kVoxel = 2.0 / kResolution;       // m
constexpr double kSumOfWeights = 1.0 + 4 * 0.707;  // Listing 4.12, not normalised

/// The light that a point in the middle gathers, from samples no further than `reach` voxels.
template <class Store>
double gatheredAsPrinted(const Store& store, double environment, double coneRatio, double reach) {
  const GatherSettings settings{.coneRatio = coneRatio, .reach = reach * kVoxel};
  return gather(emptyScene(glm::vec3(static_cast<float>(environment))), store, glm::vec3(0.0f), {0, 1, 0},
                settings)
      .r;
}

/// Distance of sample n of a cone: the first at 2, each next one half a diameter, of 2 at least,
/// behind.
double sampleDistance(double coneRatio, int n) {
  double distance = 2.0;
  for (int i = 0; i < n; ++i) distance += 0.5 * std::max(2.0, coneRatio * distance);
  return distance;
}

}  // namespace

TEST_CASE("the five cones weigh 1 and 0.707 and a constant environment comes in 3.828 times") {
  const RadianceGrid empty = mipmapped(uniformGrid(16, glm::vec4(0.0f)));
  for (const double ratio : {0.5, 1.1547, 4.0}) {
    GatherSettings settings;
    settings.coneRatio = ratio;
    const glm::vec3 radiance =
        gather(emptyScene({0.5f, 1.0f, 2.0f}), empty, glm::vec3(0.1f), glm::vec3(0, 1, 0), settings);
    CHECK(radiance.g == Approx(kSumOfWeights).epsilon(1e-5));
    CHECK(radiance.b == Approx(2.0 * kSumOfWeights).epsilon(1e-5));
  }
}

TEST_CASE(
    "a uniform medium absorbs 0.76 where a sample is 16 voxels wide and 0.94 would be exact, and ours "
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
  const RadianceGrid grid = mipmapped(uniformGrid(kResolution, dark));
  const double before = gatheredAsPrinted(grid, 1.0, low, distance - 0.1),
               behind = gatheredAsPrinted(grid, 1.0, low, distance + 0.1);
  CHECK(1.0 - behind / before == Approx(1.0 - std::pow(0.7, 4.0)).epsilon(0.001));
  CHECK(1.0 - behind / before == Approx(0.76).margin(0.001));
  // All steps before it: their exponents are half of the way in voxels, from 2 to this sample.
  CHECK(before == Approx(kSumOfWeights * std::pow(0.7, 0.5 * (distance - 2.0))).epsilon(0.001));

  for (const RadianceGrid& ours :
       {cones::filtered(uniformGrid(kResolution, dark)), mipmapped(uniformGrid(kResolution, dark))}) {
    const auto passed = [&](double reach) {
      cones::GatherSettings settings{5, "published"};
      settings.reach = reach * kVoxel;
      settings.footprint = 1.0;
      settings.clearance = 1000.0;
      settings.step = 0.5;
      return cones::gather(emptyScene(glm::vec3(1.0f)), ours, glm::vec3(0.0f), {0, 1, 0}, settings).r;
    };
    CHECK(1.0 - passed(16.0) / passed(8.0) == Approx(1.0 - std::pow(0.7, 8.0)).epsilon(0.002));
  }
}

TEST_CASE("the exponent is fixed by the first sample, as wide as the cone there") {
  // With a ratio of 3 the first sample, 2 voxels away, is 6 wide: exponents are D / 12, and steps D / 2.
  const RadianceGrid grid = mipmapped(uniformGrid(kResolution, glm::vec4(0, 0, 0, 0.1)));
  const double second = 2.0 + 0.5 * 6.0, third = second + 0.5 * 3.0 * second;
  CHECK(gatheredAsPrinted(grid, 1.0, 3.0, 2.1) == Approx(kSumOfWeights * std::pow(0.9, 0.5)).epsilon(1e-4));
  CHECK(gatheredAsPrinted(grid, 1.0, 3.0, third - 0.1) ==
        Approx(kSumOfWeights * std::pow(0.9, 0.5 + 3.0 * second / 12.0)).epsilon(1e-4));
}

TEST_CASE("light is multiplied by opacity twice, and what was gathered by it anew at every step") {
  // Voxels hold a L = 0.3 at L = 1. For a ratio of 1 the samples are 2, 3 and 4.5 wide and away; their
  // opacities are 1 - 0.7^(1/2), 1 - 0.7^(3/4) and 1 - 0.7^(9/8). accum.rgb is multiplied by accum.a, then (1
  // - accum.a) times the new opacity times the value, which has the opacity in it, is added.
  const RadianceGrid grid = mipmapped(uniformGrid(kResolution, glm::vec4(0.3f)));
  const double first = 1.0 - std::pow(0.7, 0.5), second = 1.0 - std::pow(0.7, 0.75),
               third = 1.0 - std::pow(0.7, 1.125);
  const double one = first * 0.3;
  const double opacityOfTwo = 1.0 - std::pow(0.7, 0.5 + 0.75);
  const double two = one * first + (1.0 - first) * second * 0.3;
  const double three = two * opacityOfTwo + (1.0 - opacityOfTwo) * third * 0.3;
  CHECK(gatheredAsPrinted(grid, 0.0, 1.0, 2.5) == Approx(kSumOfWeights * one).epsilon(1e-4));
  CHECK(gatheredAsPrinted(grid, 0.0, 1.0, 3.5) == Approx(kSumOfWeights * two).epsilon(1e-4));
  CHECK(gatheredAsPrinted(grid, 0.0, 1.0, 5.0) == Approx(kSumOfWeights * three).epsilon(1e-4));
  // In empty space too. A sharp mirror looks up through 6 voxels of the medium: samples are 2 wide and one
  // apart, their exponents 1/2. Level 1 reads 0.3 up to the fifth voxel, half of it at the sixth and nothing
  // from the seventh on, so that the opacity stays 1 - (0.7^4 0.85)^(1/2), and every further sample
  // multiplies by it.
  const RadianceGrid slab = mipmapped(makeGrid(kResolution, [](int, int, int z) {
    return z >= kResolution / 2 && z < kResolution / 2 + 6 ? glm::vec4(0.3f) : glm::vec4(0.0f);
  }));
  const auto mirrored = [&](double reach) {
    GatherSettings settings;
    settings.reach = reach * kVoxel;
    return gatherGlossy(emptyScene(), slab, glm::vec3(0.0f), {0, 0, 1}, glm::vec4(1, 1, 1, 1e6f), settings).r;
  };
  const double opacity = 1.0 - std::sqrt(std::pow(0.7, 4.0) * 0.85);
  CHECK(mirrored(8.5) / mirrored(7.5) == Approx(opacity).epsilon(1e-4));
  CHECK(mirrored(12.5) / mirrored(7.5) == Approx(std::pow(opacity, 5.0)).epsilon(1e-4));
}

TEST_CASE("cones start two voxels along their axes from the surface itself and read level 1 at least") {
  // Everything is opaque, so that the first sample is all that a cone sees. Radiance grows evenly with the
  // height, which means and trilinear reading keep.
  const auto radianceAt = [](double y) { return 2.0 + y / kVoxel / kResolution; };  // y in m from the middle
  const RadianceGrid grid = mipmapped(makeGrid(kResolution, [&](int, int y, int) {
    const auto value = static_cast<float>(radianceAt((y + 0.5 - kResolution / 2) * kVoxel));
    return glm::vec4(value, value, value, 1.0f);
  }));
  GatherSettings settings;
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
  const RadianceGrid spark = mipmapped(makeGrid(kResolution, [&](int x, int y, int z) {
    return x == middle && y == middle + 2 && z == middle ? glm::vec4(8, 8, 8, 1) : glm::vec4(0, 0, 0, 1);
  }));
  settings.coneRatio = 0.5;             // samples as narrow as they get
  const double aside = std::sqrt(0.5);  // in voxels of level 1
  const double tilted = (aside - 0.5) * (1.5 - aside) * 0.5;
  CHECK(gather(emptyScene(), spark, glm::vec3(0.0f), {0, 1, 0}, settings).r ==
        Approx(0.125 + 0.707 * 2.0 * tilted).epsilon(filtered(1e-4f)));
}

TEST_CASE("the mipmap reads the mean of eight children in one fetch, and at odd sizes what lies in between") {
  const auto noise = [](int x, int y, int z) {
    const auto hash = [&](int k) {
      return static_cast<float>((x * 73 + y * 151 + z * 211 + k * 37) % 97) / 97.0f;
    };
    return glm::vec4(hash(1), hash(2), hash(3), hash(4));
  };
  const RadianceGrid mean = cones::filtered(makeGrid(16, noise), "average"),
                     read = mipmapped(makeGrid(16, noise));
  CHECK(read.opacity == RadianceGrid::Opacity::ofFinestVoxel);
  for (int level = 1; level < 5; ++level) {
    const std::vector<float> expected = mean.radiance->downloadFloats(level),
                             got = read.radiance->downloadFloats(level);
    REQUIRE(expected.size() == got.size());
    for (std::size_t i = 0; i < got.size(); ++i) CHECK(got[i] == Approx(expected[i]).epsilon(1e-5));
  }
  // Three voxels to one: the fetch in the middle is the middle voxel alone, the mean is that of all 27.
  CHECK(mipmapped(makeGrid(3, noise)).radiance->downloadFloats(1).at(0) == Approx(noise(1, 1, 1).r));
  double sum = 0.0;
  for (int i = 0; i < 27; ++i) sum += noise(i % 3, i / 3 % 3, i / 9).r / 27.0;
  CHECK(cones::filtered(makeGrid(3, noise), "average").radiance->downloadFloats(1).at(0) ==
        Approx(sum).epsilon(1e-5));
  // Of what is uniform all means are the same, at even sizes and at odd ones.
  for (const int resolution : {16, 17, 6})
    for (const float value : mipmapped(uniformGrid(resolution, glm::vec4(0.3f))).radiance->downloadFloats(1))
      CHECK(value == Approx(0.3).epsilon(1e-5));
}

TEST_CASE("of six grids a cone reads the three faces that it looks at, by the shares of its direction") {
  // Listing 4.15: weights |d| / sum |d|, of opaque voxels whose faces shine 1, 10, 2, 20, 4 and 40.
  const std::array<float, 6> shine{1, 10, 2, 20, 4, 40};
  const DirectionalRadianceGrid grid = mipmapped(makeDirections(16, [&](int face, int, int, int) {
    return glm::vec4(glm::vec3(shine[static_cast<std::size_t>(face)]), 1.0f);
  }));
  for (const glm::vec3 direction : {glm::vec3(-1, -2, -3), glm::vec3(3, -1, 1), glm::vec3(0, 0, 1)}) {
    const glm::vec3 d = glm::normalize(direction),
                    weights = glm::abs(d) / (std::abs(d.x) + std::abs(d.y) + std::abs(d.z));
    double expected = 0.0;
    for (int axis = 0; axis < 3; ++axis)
      expected += weights[axis] * shine[static_cast<std::size_t>(2 * axis + (d[axis] < 0.0f ? 0 : 1))];
    CAPTURE(d.x, d.y, d.z);
    CHECK(thesis::alongDirection(grid, glm::vec3(0.0f), d, 1e5f).r == Approx(expected).epsilon(1e-3));
  }
}

TEST_CASE("a jittered start moves the samples of each pixel and cone by the seed") {
  const RadianceGrid grid =
      mipmapped(makeGrid(64, [](int, int y, int) { return y == 44 ? glm::vec4(1.0f) : glm::vec4(0.0f); }));
  const Scene scene = emptyScene();
  const auto image = [&](double jitter, std::uint64_t seed) {
    return thesis::gathered(scene, grid, cones::surfacePoint(glm::vec3(0.0f), {0, 1, 0}, glm::vec3(1.0f)),
                            "diffuse", {.jitter = jitter, .seed = seed})
        .values();
  };
  CHECK(image(1.0, 1) == image(1.0, 1));
  CHECK(image(1.0, 1) != image(1.0, 2));
  const std::vector<float> still = image(0.0, 1), moved = image(1.0, 1);
  CHECK(still.at(0) == still.at(12));
  CHECK(moved.at(0) != moved.at(12));
}

TEST_CASE("cones read one store, and of six grids those that are six at all levels") {
  const RadianceGrid grid = mipmapped(uniformGrid(4, glm::vec4(0.0f)));
  const GBuffer gbuffer = cones::surfacePoint(glm::vec3(0.0f), {0, 1, 0}, glm::vec3(1.0f));
  const Scene scene = emptyScene();
  PassHarness none = thesis::passOf("gather", scene), both = thesis::passOf("gather", scene);
  none.setInput("gbuffer", gbuffer);
  CHECK_THROWS_WITH(none.run(), Catch::Matchers::Contains("no store"));
  both.setInput("gbuffer", gbuffer);
  both.setInput("grid", grid);
  DirectionalRadianceGrid six = cones::filteredDirections(uniformGrid(4, glm::vec4(0.0f)));
  both.setInput("directions", six);
  CHECK_THROWS_WITH(both.run(), Catch::Matchers::Contains("several stores"));
  CHECK_THROWS_WITH(gather(scene, six, glm::vec3(0.0f), {0, 1, 0}),
                    Catch::Matchers::Contains("reads six at all levels"));
}
