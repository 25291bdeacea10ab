// Paths through bits: closed forms, the two orders, accumulation, and what the pass refuses.
#include <cmath>

#include "lumivox/base/error.h"
#include "support/facts.h"
#include "support/voxel_paths.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::near_field;
using namespace lumivox::test::voxel_paths;

namespace {

constexpr int kRoom = 12;
const glm::vec3 kMiddle(6.2f, 5.1f, 6.4f);

/// Paths in a closed room whose walls shine alike.
Gatherer inRoom(float radiance, float albedo, int bounces) {
  Gatherer result = tracer(gridOf(shellOf(kRoom)), kMiddle, kUp);
  result.map(shiningAll(radiance, albedo, kMiddle));
  result.in("attributes", attributesOfShell(kRoom, albedo));
  return std::move(result.with(
      {{"samples", 4}, {"bounces", bounces}, {"tolerance", 1000}, {"front", "off"}, {"normals", "voxels"}}));
}

/// A floor of voxels at height 0 of a grid, and boxes on it.
VoxelSet clutteredFloor() {
  VoxelSet set({24, 24, 24});
  for (int x = 0; x < 24; ++x)
    for (int z = 0; z < 24; ++z) set.insert({x, 0, z});
  for (int y = 1; y < 9; ++y)
    for (int x = 3; x < 7; ++x)
      for (int z = 4; z < 9; ++z) set.insert({x, y, z});
  for (int y = 1; y < 5; ++y)
    for (int x = 14; x < 20; ++x)
      for (int z = 12; z < 19; ++z) set.insert({x, y, z});
  return set;
}

/// Voxels of a set that look up, a little aside.
AttributeGrid attributesOf(const VoxelSet& set, float albedo) {
  return attributesWhere(set.resolution(), albedo, [&](const glm::ivec3& at) {
    return set.contains(at) ? glm::normalize(glm::vec3(0.2f, 1.0f, 0.1f)) : glm::vec3(0.0f);
  });
}

/// Paths under a sky among boxes that nothing else lights.
Gatherer underOpenSky(int bounces, int samples) {
  const VoxelSet set = clutteredFloor();
  Gatherer result = tracer(gridOf(set), {9.3f, 1.4f, 10.2f}, kUp, underSky(2.0f));
  result.in("attributes", attributesOf(set, 0.7f));
  return std::move(result.with({{"bounces", bounces}, {"samples", samples}}));
}

}  // namespace

TEST_CASE("in a closed room of equal walls N bounces bring L (1 + a + ... + a^(N - 1))") {
  const float albedo = GENERATE(0.5f, 0.9f);
  const int bounces = GENERATE(1, 2, 8, 64);
  const auto* order = GENERATE("forward", "backward");
  CAPTURE(albedo, bounces, order);
  Gatherer room = inRoom(0.25f, albedo, bounces);
  room.with({{"order", order}});
  const std::vector<float> arriving = room.arriving();
  const double expected = 0.25 * (1.0 - std::pow(albedo, bounces)) / (1.0 - albedo);
  for (std::size_t i = 0; i < arriving.size(); i += 4) CHECK(arriving[i] == Approx(expected).epsilon(1e-4));
}

TEST_CASE(
    "a thousand bounces at an albedo of 0.999 are the series of a thousand, and do not grow without end") {
  Gatherer room = inRoom(1.0f, 0.999f, 1000);
  room.with({{"samples", 1}});
  CHECK(room.arriving()[0] == Approx((1.0 - std::pow(0.999, 1000)) / 0.001).epsilon(1e-3));
}

TEST_CASE(
    "a plane under an even sky gets its radiance, and its Phong lobe reflects its albedo of it from above") {
  const BinaryGrid empty = gridOf(VoxelSet({8, 8, 8}));
  Gatherer open = tracer(empty, {4, 4, 4}, kUp, underSky(3.0f));
  open.with({{"samples", 4}, {"bounces", 1}});
  CHECK(open.arriving()[0] == Approx(3.0).epsilon(1e-6));

  const float exponent = GENERATE(1.0f, 20.0f, 400.0f), diffuse = GENERATE(0.0f, 0.5f);
  CAPTURE(exponent, diffuse);
  SceneBuilder above;
  above.scene.environment = glm::vec3(3.0f);
  above.look({4, 1000, 4}, {4, 4, 4}, {0, 0, 1}, 0.001, 8, 8);
  Gatherer glossy = tracer(empty, {4, 4, 4}, kUp, above.scene, diffuse, {0.4f, 0.4f, 0.4f, exponent});
  glossy.with({{"samples", 512}, {"bounces", 1}});
  CHECK(glossy.mean("glossy") == Approx(0.4 * 3.0).epsilon(0.005));
  // The same paths tell what the diffuse lobe gets.
  CHECK(glossy.mean("arriving") == Approx(3.0).epsilon(0.02));
}

TEST_CASE("one bounce of paths is what near-field rays find, ray for ray") {
  const VoxelSet set = clutteredFloor();
  const glm::vec3 place(9.3f, 1.4f, 10.2f);
  Gatherer rays(gridOf(set), underSky(2.0f));
  rays.at(place, kUp).with({{"rays", 33}});
  Gatherer paths = tracer(gridOf(set), place, kUp, underSky(2.0f));
  paths.with({{"samples", 33}, {"bounces", 1}});
  const std::vector<float> ofRays = rays.arriving(), ofPaths = paths.arriving();
  for (std::size_t i = 0; i < ofRays.size(); ++i) CHECK(ofPaths[i] == Approx(ofRays[i]).epsilon(1e-6));
}

TEST_CASE("light that is carried back over stored surfaces is light that is added as it is met") {
  for (const int bounces : {1, 2, 5}) {
    Gatherer forward = underOpenSky(bounces, 8), backward = underOpenSky(bounces, 8);
    backward.with({{"order", "backward"}});
    const std::vector<float> first = forward.arriving(), second = backward.arriving();
    for (std::size_t i = 0; i < first.size(); ++i) CHECK(second[i] == Approx(first[i]).epsilon(1e-5));
    CHECK(first[0] > 0.1f);
  }
}

TEST_CASE("light of Phong lobes that is carried back is light that is added as it is met") {
  // A room that shines, whose walls have a lobe too: what the map knows of the second surface counts.
  const auto traced = [](const char* order, const glm::vec4& ofWalls) {
    SceneBuilder inside;
    inside.look({6.2, 9.1, 5.4}, {6.2, 5.1, 6.4}, {0, 0, 1}, 0.5, 8, 8);
    Gatherer room =
        tracer(gridOf(shellOf(kRoom)), kMiddle, kUp, inside.scene, 0.3f, {0.5f, 0.4f, 0.2f, 12.0f});
    ReflectiveShadowMap map = shiningAll(0.25f, 0.4f, kMiddle);
    map.specular = filled(layers(4, 4, map.layerCount), ofWalls);
    room.map(map);
    room.in("attributes", attributesOfShell(kRoom, 0.4f));
    return std::move(room.with(
        {{"samples", 32}, {"bounces", 4}, {"tolerance", 1000}, {"front", "off"}, {"order", order}}));
  };
  const glm::vec4 sharp(0.5f, 0.5f, 0.5f, 30.0f), dull(0.0f);
  for (const char* output : {"arriving", "glossy"}) {
    Gatherer forward = traced("forward", sharp), backward = traced("backward", sharp),
             without = traced("forward", dull);
    const std::vector<float> first = forward.floats(output), second = backward.floats(output);
    CAPTURE(output);
    for (std::size_t i = 0; i < first.size(); ++i)
      CHECK(second[i] == Approx(first[i]).epsilon(1e-5).margin(1e-7));
    CHECK(forward.mean(output) > 1.2 * without.mean(output));
  }
}

TEST_CASE("frames that accumulate are one frame of as many paths, to the bit") {
  const auto* order = GENERATE("forward", "backward");
  Gatherer once = underOpenSky(3, 24), often = underOpenSky(3, 6);
  for (Gatherer* each : {&once, &often}) each->with({{"order", order}});
  often.harness().accumulate();
  for (int i = 0; i < 4; ++i) often.run();
  CHECK(often.arriving() == once.arriving());
}

TEST_CASE("paths that end by chance bring the same light on average") {
  Gatherer all = underOpenSky(6, 512), some = underOpenSky(6, 512);
  some.with({{"roulette", "on"}});
  CHECK(some.mean("arriving") == Approx(all.mean("arriving")).epsilon(0.02));
  CHECK(some.arriving() != all.arriving());
}

TEST_CASE("a ray that would begin in a set voxel begins behind it, or ends at once as published") {
  // A floor of two layers: paths that are not pushed out of it meet it where they begin.
  VoxelSet set({12, 12, 12});
  for (int x = 0; x < 12; ++x)
    for (int z = 0; z < 12; ++z) set.insert({x, 0, z}), set.insert({x, 1, z});
  const auto light = [&](const char* stuck) {
    Gatherer paths = tracer(gridOf(set), {6, 6, 6}, -kUp, underSky(1.0f));
    paths.in("attributes", attributesOf(set, 0.5f));
    return paths.with({{"samples", 64}, {"bounces", 2}, {"offset", 0.3}, {"stuck", stuck}}).mean("arriving");
  };
  CHECK(light("push") > light("hit"));
}

TEST_CASE("what does not belong together is refused with what was expected") {
  const BinaryGrid bits = gridOf(shellOf(kRoom));
  const auto refused = [&](const auto& give, const Settings& settings, const Tells& tells) {
    Gatherer paths = tracer(bits, kMiddle, kUp);
    give(paths);
    paths.with(settings);
    CHECK_THROWS_MATCHES(paths.run(), Error, tells);
  };
  refused([](Gatherer&) {}, {}, Tells("'bounces'", 2, "'attributes'"));
  CHECK_THROWS_MATCHES(inRoom(1.0f, 0.5f, 2).with({{"roulette", "on"}, {"order", "backward"}}).arriving(),
                       Error, Tells("'roulette'", "'order'"));
  refused([](Gatherer& paths) { paths.in("attributes", attributesOfShell(kRoom + 1, 0.5f)); }, {},
          Tells("'bits'", "'attributes'"));
  ReflectiveShadowMap map = shiningAll(1.0f, 0.5f, kMiddle);
  map.albedo = nullptr;
  refused([&](Gatherer& paths) { paths.map(map); }, {{"bounces", 1}}, Tells("'map'", "'surfaces'"));
  map = shiningAll(1.0f, 0.5f, kMiddle);
  const std::vector<LightSampleData> lights(70000, map.lights->downloadValues<LightSampleData>().front());
  map.lights = bufferOf(lights);
  map.lightCount = static_cast<int>(lights.size());
  refused([&](Gatherer& paths) { paths.map(map); }, {{"bounces", 1}}, Tells(70000));
}
