// Paths through bits: closed forms, the two orders, accumulation, and what the pass refuses.
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
  Gatherer result = tracer(gridOf(shellOf(kRoom)));
  result.at(kMiddle, kUp).map(shiningAll(radiance, albedo, kMiddle));
  result.harness().setInput("attributes", attributesOf(kRoom, albedo));
  return result.with({{"samples", 4},
                      {"bounces", static_cast<double>(bounces)},
                      {"tolerance", 1000},
                      {"front", 0, "off"},
                      {"normals", 0, "voxels"}});
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

AttributeGrid attributesOf(const VoxelSet& set, float albedo) {
  const glm::ivec3 size = set.resolution();
  std::vector<glm::vec4> albedos, normals;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const bool is = set.contains({x, y, z});
        albedos.emplace_back(is ? glm::vec4(glm::vec3(albedo), 1.0f) : glm::vec4(0.0f));
        normals.emplace_back(is ? glm::vec4(glm::normalize(glm::vec3(0.2f, 1.0f, 0.1f)), 0.0f)
                                : glm::vec4(0.0f));
      }
  return {{glm::vec3(0.0f), 1.0f, size}, volumeOf(size, albedos), volumeOf(size, normals), nullptr};
}

/// Paths under a sky among boxes that nothing else lights.
Gatherer underOpenSky(int bounces, int samples) {
  const VoxelSet set = clutteredFloor();
  Gatherer result = tracer(gridOf(set), underSky(2.0f));
  result.at({9.3f, 1.4f, 10.2f}, kUp);
  result.harness().setInput("attributes", attributesOf(set, 0.7f));
  return result.with({{"bounces", static_cast<double>(bounces)}, {"samples", static_cast<double>(samples)}});
}

/// A g-buffer with a Phong lobe.
GBuffer glossyAt(const glm::vec3& position, const glm::vec3& normal, const glm::vec4& specular,
                 float diffuse) {
  GBuffer result = pointsAt(position, normal);
  const auto filled = [&](const glm::vec4& value) {
    auto texture = std::make_shared<gpu::Texture>(
        device(), gpu::TextureDescription{.format = gpu::Format::rgba32f, .width = 8, .height = 8}, "test");
    texture->clear(value);
    return texture;
  };
  result.diffuse = filled(glm::vec4(glm::vec3(diffuse), 1.0f));
  result.specular = filled(specular);
  return result;
}

}  // namespace

TEST_CASE("in a closed room of equal walls N bounces bring L (1 + a + ... + a^(N - 1))") {
  const float albedo = GENERATE(0.5f, 0.9f);
  const int bounces = GENERATE(1, 2, 8, 64);
  const auto* order = GENERATE("forward", "backward");
  CAPTURE(albedo, bounces, order);
  Gatherer room = inRoom(0.25f, albedo, bounces);
  room.with({{"order", 0, order}});
  const std::vector<float> arriving = room.run();
  const double expected = 0.25 * (1.0 - std::pow(albedo, bounces)) / (1.0 - albedo);
  for (std::size_t i = 0; i < arriving.size(); i += 4) CHECK(arriving[i] == Approx(expected).epsilon(1e-4));
}

TEST_CASE("a thousand bounces at an albedo of 0.999 stay below the series, and do not grow without end") {
  Gatherer room = inRoom(1.0f, 0.999f, 1000);
  room.with({{"samples", 1}});
  CHECK(room.run()[0] == Approx((1.0 - std::pow(0.999, 1000)) / 0.001).epsilon(1e-3));
}

TEST_CASE(
    "a plane under an even sky gets its radiance, and its Phong lobe reflects its albedo of it from above") {
  Gatherer open = tracer(gridOf(VoxelSet({8, 8, 8})), underSky(3.0f));
  open.at({4, 4, 4}, kUp).with({{"samples", 4}, {"bounces", 1}});
  CHECK(open.run()[0] == Approx(3.0).epsilon(1e-6));

  const float exponent = GENERATE(1.0f, 20.0f, 400.0f);
  SceneBuilder above;
  above.scene.environment = glm::vec3(3.0f);
  above.look({4, 1000, 4}, {4, 4, 4}, {0, 0, 1}, 0.001, 8, 8);
  for (const float diffuse : {0.0f, 0.5f}) {
    CAPTURE(exponent, diffuse);
    Gatherer glossy = tracer(gridOf(VoxelSet({8, 8, 8})), above.scene);
    glossy.harness().setInput("gbuffer", glossyAt({4, 4, 4}, kUp, {0.4f, 0.4f, 0.4f, exponent}, diffuse));
    glossy.with({{"samples", 512}, {"bounces", 1}});
    CHECK(glossy.mean("glossy") == Approx(0.4 * 3.0).epsilon(0.005));
    // The same paths tell what the diffuse lobe gets.
    CHECK(glossy.mean("arriving") == Approx(3.0).epsilon(0.02));
  }
}

TEST_CASE("one bounce of paths is what near-field rays find, ray for ray") {
  const VoxelSet set = clutteredFloor();
  const glm::vec3 place(9.3f, 1.4f, 10.2f);
  Gatherer rays(gridOf(set), underSky(2.0f));
  rays.at(place, kUp).with({{"rays", 33}});
  Gatherer paths = tracer(gridOf(set), underSky(2.0f));
  paths.at(place, kUp).with({{"samples", 33}, {"bounces", 1}});
  const std::vector<float> ofRays = rays.run(), ofPaths = paths.run();
  for (std::size_t i = 0; i < ofRays.size(); ++i) CHECK(ofPaths[i] == Approx(ofRays[i]).epsilon(1e-6));
}

TEST_CASE("light that is carried back over stored surfaces is light that is added as it is met") {
  for (const int bounces : {1, 2, 5}) {
    Gatherer forward = underOpenSky(bounces, 8), backward = underOpenSky(bounces, 8);
    backward.with({{"order", 0, "backward"}});
    const std::vector<float> first = forward.run(), second = backward.run();
    for (std::size_t i = 0; i < first.size(); ++i) CHECK(second[i] == Approx(first[i]).epsilon(1e-5));
    CHECK(first[0] > 0.1f);
  }
}

TEST_CASE("frames that accumulate are one frame of as many paths, to the bit") {
  const auto* order = GENERATE("forward", "backward");
  Gatherer once = underOpenSky(3, 24), often = underOpenSky(3, 6);
  for (Gatherer* each : {&once, &often}) each->with({{"order", 0, order}});
  often.harness().accumulate();
  for (int i = 0; i < 3; ++i) often.run();
  CHECK(often.run() == once.run());
}

TEST_CASE("paths that end by chance bring the same light on average") {
  Gatherer all = underOpenSky(6, 512), some = underOpenSky(6, 512);
  some.with({{"roulette", 0, "on"}});
  CHECK(some.mean() == Approx(all.mean()).epsilon(0.02));
  CHECK(some.run() != all.run());
}

TEST_CASE("a ray that would begin in a set voxel begins behind it, or ends at once as published") {
  // Between two walls a voxel apart, paths that are not pushed meet the wall that they leave again.
  VoxelSet set({12, 12, 12});
  for (int x = 0; x < 12; ++x)
    for (int z = 0; z < 12; ++z) set.insert({x, 0, z}), set.insert({x, 1, z});
  const auto light = [&](const char* stuck) {
    Gatherer paths = tracer(gridOf(set), underSky(1.0f));
    paths.at({6, 6, 6}, -kUp);
    AttributeGrid attributes = attributesOf(set, 0.5f);
    paths.harness().setInput("attributes", attributes);
    return paths.with({{"samples", 64}, {"bounces", 2}, {"offset", 0.3}, {"stuck", 0, stuck}}).mean();
  };
  CHECK(light("push") > light("hit"));
}

TEST_CASE("what does not belong together is refused with what was expected") {
  const BinaryGrid bits = gridOf(shellOf(kRoom));
  const auto message = [](Gatherer& gatherer) {
    try {
      gatherer.run();
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  Gatherer without = tracer(bits);
  without.at(kMiddle, kUp);
  CHECK(message(without).find("'attributes'") != std::string::npos);

  Gatherer other = tracer(bits);
  other.at(kMiddle, kUp);
  other.harness().setInput("attributes", voxel_paths::attributesOf(kRoom + 1, 0.5f));
  CHECK(message(other).find("13") != std::string::npos);

  Gatherer plain = tracer(bits);
  ReflectiveShadowMap map = shiningAll(1.0f, 0.5f, kMiddle);
  map.albedo = nullptr;
  plain.at(kMiddle, kUp).map(map).with({{"bounces", 1}});
  CHECK(message(plain).find("'surfaces'") != std::string::npos);

  Gatherer many = tracer(bits);
  map = shiningAll(1.0f, 0.5f, kMiddle);
  const std::vector<LightSampleData> lights(70000, map.lights->downloadValues<LightSampleData>().front());
  map.lights = std::make_shared<gpu::Buffer>(device(), lights.size() * sizeof(LightSampleData), "lights");
  map.lights->uploadValues(std::span<const LightSampleData>(lights));
  map.lightCount = static_cast<int>(lights.size());
  many.at(kMiddle, kUp).map(map).with({{"bounces", 1}});
  CHECK(message(many).find("70000") != std::string::npos);
}
