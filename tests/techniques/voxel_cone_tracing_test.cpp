#include <algorithm>
#include <cmath>
#include <set>

#include "support/cones.h"
#include "support/voxel_fragments.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::cones;

namespace {

/// The finest level after injecting the fragments of a scene under its lights.
std::vector<float> injected(const Scene& scene, int resolution, const char* precision = "float",
                            float* unit = nullptr) {
  InjectSettings settings;
  settings.precision = precision;
  const RadianceGrid grid = injectedGrid(scene, resolution, settings);
  if (unit != nullptr) *unit = grid.unit;
  return grid.radiance->downloadFloats(0);
}

}  // namespace

TEST_CASE("an opaque wall fills the cones that face it with its radiance and hides what lies far behind") {
  // Everything beyond y = 0 is a wall of radiance 3; 24 voxels inside it is brighter, which must not be seen.
  const RadianceGrid grid = filtered(makeGrid(64, [](int, int y, int) {
    return y < 32 ? glm::vec4(0.0f) : y < 56 ? glm::vec4(3, 3, 3, 1) : glm::vec4(50, 50, 50, 1);
  }));
  const glm::vec3 radiance = gather(emptyScene(), grid, {0, -0.05f, 0}, {0, 1, 0}, {64});
  CHECK(radiance.x == Approx(3.0f).epsilon(0.03));
}

TEST_CASE("one level up a uniform medium of opacity a has 1 - (1-a)^2 and a with the plain mean") {
  const auto uniform = [](int, int, int) {
    return glm::vec4(0.6f, 0.3f, 0.15f, 0.3f);
  };                                          // radiance (2, 1, 0.5) times 0.3
  for (const int resolution : {16, 17, 6}) {  // even, odd, even then odd
    const std::vector<float> composite = filtered(makeGrid(resolution, uniform)).radiance->downloadFloats(1);
    const std::vector<float> mean =
        filtered(makeGrid(resolution, uniform), "average").radiance->downloadFloats(1);
    const double children =
        static_cast<double>(resolution) / (resolution / 2);  // along each axis: 2 or a little more
    const double expected = 1.0 - std::pow(0.7, children);
    REQUIRE(!composite.empty());
    for (std::size_t i = 0; i < composite.size(); i += 4) {
      CHECK(composite[i + 3] == Approx(expected).epsilon(1e-5));
      CHECK(composite[i] == Approx(2.0 * expected).epsilon(1e-5));
      CHECK(mean[i + 3] == Approx(0.3).epsilon(1e-5));
    }
  }
}

TEST_CASE("a sheet one voxel thick keeps its opacity and its radiance at every level") {
  // Every column across it meets the sheet once, at every level; the mean over the axes would lose opacity,
  // since only half of the columns along it meet it.
  for (const int resolution : {64, 24, 21}) {  // even, even then odd, odd
    for (const float opacity : {1.0f, 0.3f}) {
      const RadianceGrid grid = filtered(makeGrid(resolution, [&](int, int y, int) {
        return y == 9 ? glm::vec4(2.0f, 1.0f, 4.0f, 1.0f) * opacity : glm::vec4(0.0f);
      }));
      for (int level = 1; resolution >> level >= 2; ++level) {
        INFO(resolution << " voxels, level " << level << ", opacity " << opacity);
        // In grids of odd sizes the voxel of the sheet may be shared by two coarse ones: what they let
        // through multiplies.
        const int cells = resolution >> level;
        const std::vector<float> texels = grid.radiance->downloadFloats(level);
        double through = 1.0;
        for (int y = 0; y < cells; ++y) {
          const std::size_t texel = 4 * static_cast<std::size_t>((cells / 2 * cells + y) * cells + cells / 2);
          if (texels[texel + 3] == 0.0f) continue;
          through *= 1.0 - texels[texel + 3];
          CHECK(texels[texel] / texels[texel + 3] == Approx(2.0f).epsilon(1e-4));
          CHECK(texels[texel + 2] / texels[texel + 3] == Approx(4.0f).epsilon(1e-4));
        }
        CHECK(1.0 - through == Approx(opacity).epsilon(1e-4));
      }
    }
  }
}

TEST_CASE("an opaque sheet lets exp(-2 / cos) of the light through in trilinear reading by fine steps") {
  // At u voxels from the middle of the sheet the opacity that is read is 1 - |u|. By steps du the
  // transmittance is exp(-sum of -ln |u| du), and 2 int_0^1 -ln u du = 2; at a slant the path is longer. One
  // cone goes at 45 degrees.
  const RadianceGrid grid = filtered(
      makeGrid(64, [](int, int y, int) { return y == 40 ? glm::vec4(0, 0, 0, 1) : glm::vec4(0.0f); }));
  const Scene scene = emptyScene(glm::vec3(1.0f));
  // No clearance for wide samples: the finest level is read, by twentieths of a voxel.
  const glm::vec3 passed = gather(scene, grid, glm::vec3(0.0f), {0, 1, 0}, {1, "cosine", 0, 0, 0, 0.05, 0.0});
  CHECK(passed.r == Approx(std::exp(-2.0 * std::sqrt(2.0))).epsilon(0.1));
}

TEST_CASE(
    "a closed box whose walls all radiate L brings nearly pi L, whatever the resolution and the cones") {
  // The walls are sheets of one voxel, beside an empty margin as in the grids around scenes. What is missing
  // has come through the walls: of an opaque sheet trilinear reading lets exp(-2 / cos) through, 6 % over the
  // hemisphere:
  //   int_0^1 2 c exp(-2 / c) dc = 0.060.
  for (const int resolution : {32, 64, 128}) {
    const RadianceGrid grid = filtered(makeGrid(resolution, [&](int x, int y, int z) {
      const auto wall = [&](int i) { return i == 1 || i == resolution - 2; };
      const auto inside = [&](int i) { return i >= 1 && i <= resolution - 2; };
      return inside(x) && inside(y) && inside(z) && (wall(x) || wall(y) || wall(z)) ? glm::vec4(1.0f)
                                                                                    : glm::vec4(0.0f);
    }));
    for (const int cones : {6, 64}) {
      double sum = 0.0;
      constexpr int kPlaces = 4;  // along the diagonal of the floor, and on its edge
      for (int place = 0; place < kPlaces; ++place) {
        const float along = -0.8f + 0.4f * static_cast<float>(place);
        const glm::vec3 position(along, -1.0f + 2.0f / static_cast<float>(resolution), 0.5f * along);
        const double radiance =
            gather(emptyScene(), grid, position, {0, 1, 0}, {cones, "cosine", 1, 1, 0, 0.5}).r;
        INFO(resolution << " voxels, " << cones << " cones, place " << place);
        CHECK(radiance > 0.85);
        CHECK(radiance < 1.00001);
        sum += radiance / kPlaces;
      }
      INFO(resolution << " voxels, " << cones << " cones");
      CHECK(sum > 0.88);  // by steps of one voxel a little more comes through than by fine ones
    }
  }
}

TEST_CASE("a cone reads the grid to its end, however long the last step is") {
  // A uniform medium from the middle: at 45 degrees the border is sqrt(2) away.
  constexpr int kResolution = 64;
  constexpr double kOpacity = 0.02;
  const RadianceGrid grid = filtered(makeGrid(kResolution, [](int, int, int) {
    return glm::vec4(glm::vec3(static_cast<float>(kOpacity)), static_cast<float>(kOpacity));
  }));
  const double expected = 1.0 - std::pow(1.0 - kOpacity, std::sqrt(2.0) * kResolution / 2);
  for (const double step : {0.1, 2.0}) {
    // The finest level throughout: half a voxel at the border is blended with what lies outside.
    const glm::vec3 radiance =
        gather(emptyScene(), grid, glm::vec3(0.0f), {0, 1, 0}, {1, "cosine", 0, 0, 0, step, 0.0, 0.25});
    INFO("step " << step << ": " << radiance.r << " of " << expected);
    CHECK(radiance.r == Approx(expected).epsilon(0.005));
  }
}

TEST_CASE("filtering keeps radiance divided by opacity of what it blends") {
  // One voxel of radiance 5 in empty space: however diluted, every parent that sees it has radiance / opacity
  // = 5.
  const RadianceGrid grid = filtered(makeGrid(16, [](int x, int y, int z) {
    return x == 3 && y == 5 && z == 9 ? glm::vec4(5, 5, 5, 1) : glm::vec4(0.0f);
  }));
  for (int level = 1; level < 5; ++level) {
    const std::vector<float> texels = grid.radiance->downloadFloats(level);
    int seen = 0;
    for (std::size_t i = 0; i < texels.size(); i += 4) {
      if (texels[i + 3] == 0.0f) continue;
      ++seen;
      CHECK(texels[i] / texels[i + 3] == Approx(5.0f).epsilon(1e-4));
    }
    CHECK(seen == 1);
  }
}

TEST_CASE(
    "injection averages what the fragments of a voxel reflect, and a thousand equal ones count as one") {
  const auto scene = [](int copies) {
    SceneBuilder builder;
    const int grey = builder.lambert(0.5f);
    builder.quad({-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, grey);
    for (int i = 1; i < copies; ++i) builder.quad({-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, grey);
    builder.quad({-1, 1, -1}, {0, 0, 0.01f}, {0.01f, 0, 0}, grey);  // gives the grid its height
    builder.light(LightKind::directional, {2, 2, 2}, {}, {0, -1, 0});
    return builder.scene;
  };
  const std::vector<float> one = injected(scene(1), 8), thousand = injected(scene(1000), 8);
  REQUIRE(one.size() == thousand.size());
  int occupied = 0;
  for (std::size_t i = 0; i < one.size(); i += 4) {
    CHECK(thousand[i] == Approx(one[i]).epsilon(1e-4).margin(1e-6));
    CHECK(thousand[i + 3] == Approx(one[i + 3]).epsilon(1e-5));
    occupied += one[i + 3] > 0.0f;
  }
  CHECK(occupied > 20);
}

TEST_CASE(
    "a dim area light keeps its light in a grid with one 10^9 times as bright, in half floats with one of 10^6") {
  // Two spots that light a patch of the floor each. What the dim one lights alone is that of a scene without
  // the other. In half floats values below 6e-5 units have fewer digits: a hundredth of the largest here is
  // 4e-6 units.
  const auto scene = [](float bright) { return floorUnderTwoSpots(bright).scene; };
  const std::vector<float> alone = injected(scene(0.0f), 16);
  struct Run {
    const char* precision;
    float bright;
    double tolerance;
  };
  for (const auto& [precision, bright, tolerance] :
       {Run{"float", 1e6f, 1e-5}, Run{"float", 1e9f, 1e-5}, Run{"half", 1e6f, 0.01}}) {
    INFO(precision << ", " << bright);
    float unit = 0.0f;
    const std::vector<float> both = injected(scene(bright), 16, precision, &unit);
    REQUIRE(both.size() == alone.size());
    double largest = 0.0;
    int lit = 0;
    for (std::size_t i = 0; i < both.size(); i += 4) {
      REQUIRE(std::isfinite(both[i]));
      largest = std::max(largest, static_cast<double>(both[i]) * unit);
      if (alone[i] < 0.01f) continue;
      ++lit;
      CHECK(both[i] * unit == Approx(alone[i]).epsilon(tolerance));
    }
    CHECK(lit > 8);
    CHECK(largest > 0.1 * bright);
  }
}

TEST_CASE("a gather multiplies by the unit of its grid") {
  const auto grid = [](float unit) {
    RadianceGrid made = makeGrid(16, [&](int, int, int) { return glm::vec4(glm::vec3(0.1f / unit), 0.1f); });
    made.unit = unit;
    return filtered(made);
  };
  const glm::vec3 plain = gather(emptyScene(), grid(1.0f), {0, 0, 0}, {0, 1, 0}, {}),
                  scaled = gather(emptyScene(), grid(4096.0f), {0, 0, 0}, {0, 1, 0}, {});
  CHECK(plain.r > 0.1f);
  CHECK(scaled.r == Approx(plain.r).epsilon(1e-5));
}

TEST_CASE("injecting twice gives the same bits, however the fragments were ordered") {
  const Scene scene = litRoom(16, 16);
  CHECK(injected(scene, 32) == injected(scene, 32));
}

TEST_CASE("the glossy lobe of a constant environment reflects specular x cos of it") {
  // The integral of specular (n+2) / (2 pi) cos^n(a) times the cosine of the surface: by symmetry about the
  // mirror direction m the mean direction of the lobe is m times int cos^(n+1) = 2 pi / (n+2), so that it is
  // specular (m n) as long as the horizon does not cut the lobe, which it does for no exponent straight on,
  // and hardly for sharp ones.
  const RadianceGrid empty = filtered(uniformGrid(16, glm::vec4(0.0f)));
  const glm::vec3 environment(0.5f, 1.0f, 2.0f), specular(0.6f, 0.4f, 0.2f);
  for (const double angle : {0.0, 30.0, 60.0})
    for (const float exponent : {1.0f, 30.0f, 1e5f}) {
      // The eye is straight above, 2 m up: the normal is turned.
      const double a = angle * kPi / 180.0;
      const glm::vec3 normal(static_cast<float>(std::sin(a)), 0.0f, static_cast<float>(std::cos(a)));
      const glm::vec3 radiance = gatherGlossy(emptyScene(environment), empty, glm::vec3(0.0f), normal,
                                              glm::vec4(specular, exponent), {});
      INFO("angle " << angle << ", exponent " << exponent);
      for (int c = 0; c < 3; ++c)
        CHECK(radiance[c] == Approx(specular[c] * std::cos(a) * environment[c]).epsilon(1e-5));
    }
}

TEST_CASE(
    "a mirror-like lobe before a lit wall reflects specular x cos x the wall's radiance, at the wall's place") {
  // The wall fills x > 0.5; its radiance is 1 below y = 0 and 3 above. A surface in the middle is seen from
  // above and its normal turned by 45 degrees, so that it mirrors along x. The sharp lobe is thinner than a
  // voxel.
  const RadianceGrid grid = filtered(makeGrid(64, [](int x, int y, int) {
    return x < 48 ? glm::vec4(0.0f) : glm::vec4(glm::vec3(y < 32 ? 1.0f : 3.0f), 1.0f);
  }));
  const float half = std::sqrt(0.5f);
  for (const float height : {-0.3f, 0.3f}) {
    Scene scene = emptyScene(glm::vec3(100.0f));  // what comes through the wall would be seen
    scene.cameras.front().eye = {0, height, 2};
    const glm::vec3 radiance =
        gatherGlossy(scene, grid, {0, height, 0}, {half, 0, half}, glm::vec4(0.5f, 0.5f, 0.5f, 1e5f), {});
    CHECK(radiance.r == Approx(0.5 * std::cos(kPi / 4.0) * (height < 0 ? 1.0 : 3.0)).epsilon(0.002));
  }
  // A lobe as wide as a tenth of the distance sees both halves at their border, 50 to 50.
  Scene scene = emptyScene();
  CHECK(gatherGlossy(scene, grid, {0, 0, 0}, {half, 0, half}, glm::vec4(0.5f, 0.5f, 0.5f, 800.0f), {}).r ==
        Approx(0.5 * std::cos(kPi / 4.0) * 2.0).epsilon(0.01));
}

TEST_CASE(
    "a jittered start keeps what a uniform medium gives, in every pixel and to the last bit of a seed") {
  // A shorter first step moves the samples and leaves nothing out: L (1 - (1-a)^(d / voxel)) as without.
  const RadianceGrid grid = filtered(uniformGrid(64, glm::vec4(0.05f)));
  GatherSettings settings{6, "cosine", 0, 0, 0.4, 1.0};
  settings.jitter = 1.0;
  const ImageBuffer image = gatherImage(emptyScene(), grid, glm::vec3(0.0f), {0, 1, 0}, settings);
  const double expected = 1.0 - std::pow(0.95, 0.4 * 32.0);
  for (int y = 0; y < cones::kPixels; ++y)
    for (int x = 0; x < cones::kPixels; ++x) CHECK(image.at(x, y, 0) == Approx(expected).epsilon(0.01));
}

TEST_CASE(
    "a jittered start makes noise in place of bands: pixels differ, their mean depends less on the place") {
  // Long steps meet a thin sheet or leap over it, by how far it is: a band for each step. With jitter each
  // pixel leaps elsewhere, and the mean over the pixels hardly depends on the place.
  const RadianceGrid grid =
      filtered(makeGrid(64, [](int, int y, int) { return y == 44 ? glm::vec4(1.0f) : glm::vec4(0.0f); }));
  const auto spread = [&](double jitter, int cones) {
    double low = 1e9, high = 0.0;
    for (int place = 0; place < 12; ++place) {
      GatherSettings settings{cones, "cosine", 0, 0, 0, 2.0, 0.0};
      settings.jitter = jitter;
      const ImageBuffer image = gatherImage(
          emptyScene(), grid, {0, static_cast<float>(place) / 32.0f / 6.0f, 0}, {0, 1, 0}, settings);
      double mean = 0.0;
      for (const float value : image.values()) mean += value / static_cast<double>(image.values().size());
      low = std::min(low, mean);
      high = std::max(high, mean);
    }
    return (high - low) / (high + low);
  };
  const double bands = spread(0.0, 1), jittered = spread(1.0, 1);
  INFO("spread over places " << bands << " without, " << jittered << " with jitter");
  CHECK(bands > 0.05);
  CHECK(jittered < 0.5 * bands);

  GatherSettings settings{6, "cosine", 0, 0, 0, 2.0, 0.0};
  const auto image = [&](double jitter, std::uint64_t seed) {
    settings.jitter = jitter;
    settings.seed = seed;
    return gatherImage(emptyScene(), grid, glm::vec3(0.0f), {0, 1, 0}, settings).values();
  };
  CHECK(image(1.0, 1) == image(1.0, 1));
  CHECK(image(1.0, 1) != image(1.0, 2));
  const std::vector<float> still = image(0.0, 1), moved = image(1.0, 1);
  CHECK(still.at(0) == still.at(12));
  CHECK(moved.at(0) != moved.at(12));
}

TEST_CASE("every occupied voxel stores albedo / pi times its irradiance, of lights and of ambient light") {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.6f));
  builder.light(LightKind::directional, {3, 3, 3}, {}, {0, -1, 0});
  for (const char* precision : {"float", "half"})
    for (const double ambient : {0.0, 2.0})
      for (const bool lights : {true, false}) {
        InjectSettings settings;
        settings.precision = precision;
        settings.lights = lights;
        settings.ambient = ambient;
        const RadianceGrid grid = injectedGrid(builder.scene, 16, settings);
        const auto voxels = grid.radiance->downloadFloats(0);
        int occupied = 0;
        for (std::size_t i = 0; i < voxels.size(); i += 4) {
          if (voxels[i + 3] == 0.0f) continue;
          ++occupied;
          CHECK(voxels[i + 3] == Approx(1.0f));
          // Albedo is kept in half floats.
          CHECK(voxels[i] * grid.unit == Approx(0.6 / kPi * (ambient + (lights ? 3.0 : 0.0))).epsilon(0.002));
        }
        CHECK(occupied >= 14 * 14);
      }
}

TEST_CASE("injection lists the bricks that hold fragments, each once, and how to dispatch over them") {
  const Scene scene = litRoom(16, 16);
  for (const int resolution : {1, 7, 32, 50}) {
    VoxelFragments list;
    const RadianceGrid grid = injectedGrid(scene, resolution, {}, &list);
    std::set<std::uint32_t> expected;
    for (const FragmentData& fragment : fragmentsOf(list)) {
      const glm::ivec3 brick = fragment.cell() / OccupiedBricks::kSide;
      expected.insert(static_cast<std::uint32_t>(brick.x | brick.y << 10 | brick.z << 20));
    }
    const auto words = grid.occupied.count->downloadValues<std::uint32_t>();
    REQUIRE(words.at(0) == expected.size());
    std::vector<std::uint32_t> bricks = grid.occupied.bricks->downloadValues<std::uint32_t>();
    REQUIRE(bricks.size() >= expected.size());
    bricks.resize(expected.size());
    CHECK(std::set<std::uint32_t>(bricks.begin(), bricks.end()) == expected);
    for (int level = 0; level < 3; ++level) {
      const std::size_t first = OccupiedBricks::argumentsBytes(level) / sizeof(std::uint32_t);
      const std::uint64_t threads = expected.size() * (64u >> (3 * level));
      CHECK(words.at(first) * std::uint64_t{64} >= threads);
      CHECK((words.at(first) - 1) * std::uint64_t{64} < threads);
      CHECK(words.at(first + 1) == 1);
      CHECK(words.at(first + 2) == 1);
    }
  }
}

TEST_CASE("the filter gives the same bits whether it follows the occupied bricks or looks at every voxel") {
  const Scene scene = litRoom(16, 16);
  // The texels of all levels. Textures from the pool may contain anything.
  const auto levels = [](auto grid, const auto& texturesOf, bool follow, const auto& filter) {
    REQUIRE(grid.occupied.bricks != nullptr);
    if (!follow) grid.occupied = {};
    for (const gpu::TextureRef& texture : texturesOf(grid))
      for (int level = 1; level < texture->description().levels; ++level)
        texture->clear(glm::vec4(7.0f), level);
    grid = filter(grid);
    std::vector<std::vector<float>> texels;
    for (const gpu::TextureRef& texture : texturesOf(grid))
      for (int level = 0; level < texture->description().levels; ++level)
        texels.push_back(texture->downloadFloats(level));
    return texels;
  };
  for (const int resolution : {5, 32, 50}) {
    CAPTURE(resolution);
    for (const char* opacity : {"facing", "average"}) {
      const auto run = [&](bool follow) {
        return levels(
            injectedGrid(scene, resolution), [](const auto& grid) { return std::vector{grid.radiance}; },
            follow, [&](const auto& grid) { return filtered(grid, opacity); });
      };
      CAPTURE(opacity);
      CHECK(run(true) == run(false));
    }
    const auto six = [&](bool follow) {
      return levels(
          injectedDirections(scene, resolution), [](const auto& grid) { return grid.faces; }, follow,
          [](const auto& grid) { return filteredDirections(grid); });
    };
    CHECK(six(true) == six(false));
  }
}

TEST_CASE("injection takes memory for the fragments and a fifth of a byte a voxel beside its grid") {
  // Six words of sums and three of radiance a fragment, a word a listed brick, and three words for each brick
  // of 64.
  SceneBuilder builder;
  builder.box({0, 0, 0}, {1, 1, 1}, builder.lambert(0.5f), true);
  const SceneSnapshot snapshot = snapshotOf(builder.scene, 0.0);
  constexpr int kResolution = 128;
  PassHarness voxels(device(), techniques(), "voxelization", "conservative", builder.scene, snapshot);
  voxels.setParameter("resolution", kResolution);
  voxels.run();
  const auto& list = voxels.output<VoxelFragments>("fragments");
  PassHarness inject(device(), techniques(), "voxel_cone_tracing", "inject", builder.scene, snapshot);
  inject.setInput("fragments", list);
  const std::uint64_t before = device().allocatedBytes();
  device().resetPeak();
  inject.run();
  const std::uint64_t grid = inject.output<RadianceGrid>("radiance").radiance->sizeBytes();
  const std::uint64_t voxelCount = std::uint64_t{kResolution} * kResolution * kResolution;
  const std::uint64_t allowed = list.capacity * 10 * 4 + voxelCount * 3 * 4 / 64 + 4096;
  INFO(device().peakBytes() - before - grid << " bytes beside the grid, " << allowed << " allowed");
  CHECK(device().peakBytes() - before - grid <= allowed);
}

TEST_CASE(
    "every level of an injected grid halves the one before exactly, down to the few voxels of the coarsest") {
  // Where it does not, coarse voxels share children, and a wall grows thicker from level to level.
  SceneBuilder builder;
  builder.box({0, 0, 0}, {1.0f, 0.97f, 0.6f}, builder.lambert(0.5f), true);
  for (const int resolution : {1, 7, 33, 64, 127}) {
    PassHarness voxels(device(), techniques(), "voxelization", "conservative", builder.scene,
                       snapshotOf(builder.scene, 0.0));
    voxels.setParameter("resolution", resolution);
    voxels.run();
    PassHarness inject(device(), techniques(), "voxel_cone_tracing", "inject", builder.scene,
                       snapshotOf(builder.scene, 0.0));
    inject.setInput("fragments", voxels.output<VoxelFragments>("fragments"));
    inject.run();
    const GridPlacement &from = voxels.output<VoxelFragments>("fragments").grid,
                        &to = inject.output<RadianceGrid>("radiance").grid;
    const gpu::TextureDescription& texture = inject.output<RadianceGrid>("radiance").radiance->description();
    INFO(resolution << " voxels");
    CHECK(glm::ivec3(texture.width, texture.height, texture.depth) == to.resolution);
    CHECK(to.low == from.low);
    CHECK(to.voxelSize == from.voxelSize);
    for (int axis = 0; axis < 3; ++axis) {
      CHECK(to.resolution[axis] >= from.resolution[axis]);
      for (int level = 0; std::max({from.resolution.x, from.resolution.y, from.resolution.z}) >> level >= 8;
           ++level)
        CHECK((to.resolution[axis] >> level) % 2 == 0);
    }
    // The added part is empty: all light and opacity lies where fragments can be.
    const std::vector<float> texels = inject.output<RadianceGrid>("radiance").radiance->downloadFloats(0);
    for (int z = 0; z < texture.depth; ++z)
      for (int y = 0; y < texture.height; ++y)
        for (int x = 0; x < texture.width; ++x)
          if (glm::any(glm::greaterThanEqual(glm::ivec3(x, y, z), from.resolution)))
            REQUIRE(texels[4 * static_cast<std::size_t>((z * texture.height + y) * texture.width + x) + 3] ==
                    0.0f);
  }
}

TEST_CASE("the same seed and device give the same bits twice") {
  const Scene scene = litRoom(32, 32);
  const FrameResult first = renderOnce(scene, pipeline("voxel_cone_tracing")),
                    second = renderOnce(scene, pipeline("voxel_cone_tracing"));
  REQUIRE(first.outputs.size() == 4);
  for (const auto& [name, image] : first.outputs) CHECK(image.values() == second.outputs.at(name).values());
}
