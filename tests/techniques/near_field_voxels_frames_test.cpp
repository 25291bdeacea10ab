// What gathering makes of many rays, many lights, several frames and some of the pixels; what it leaves out
// and what it refuses.
#include <array>

#include "lumivox/base/error.h"
#include "support/facts.h"
#include "support/near_field.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::near_field;

namespace {

VoxelSet clutter() {
  VoxelSet set({40, 41, 130});
  for (int i = 0; i < 900; ++i) set.insert({i * 7 % 40, (i * 13 + i / 40) % 41, (i * 29 + i / 7) % 130});
  return set;
}

const glm::vec3 kPlace(20.3f, 20.6f, 64.4f);

std::vector<float> everyFourth(const std::vector<float>& values) {
  std::vector<float> result;
  for (std::size_t i = 0; i < values.size(); i += 4) result.push_back(values[i]);
  return result;
}

}  // namespace

TEST_CASE("thousands of rays, in portions of another size for each method, find the same") {
  // Shares of hits are sums of whole numbers: they are the same to the bit.
  std::vector<std::vector<float>> found;
  for (const char* method : {"hierarchy", "stacks", "plain"}) {
    Gatherer gatherer(gridOf(clutter()), underSky(1.0f));
    gatherer.at(kPlace, kUp).with({{"rays", 3001}, {"occlusion_distance", 15}, {"method", method}});
    found.push_back(everyFourth(gatherer.floats("occlusion")));
  }
  CHECK(found[1] == found[0]);
  CHECK(found[2] == found[0]);
  CHECK(found[0].front() > 0.1f);
  CHECK(found[0].front() < 0.99f);
}

TEST_CASE("rays of many portions are those of one: twice as many halve into the frames that they come from") {
  Gatherer once(gridOf(clutter()), underSky(2.0f)), often(gridOf(clutter()), underSky(2.0f));
  once.at(kPlace, kUp).with({{"rays", 96}, {"occlusion_distance", 15}});
  often.at(kPlace, kUp).with({{"rays", 24}, {"occlusion_distance", 15}});
  often.harness().accumulate();
  for (int i = 0; i < 4; ++i) often.run();
  const std::vector<float> light = once.arriving(), accumulated = often.arriving(),
                           open = once.floats("occlusion"), openOfFrames = often.floats("occlusion");
  for (std::size_t i = 0; i < light.size(); ++i) {
    CHECK(accumulated[i] == Approx(light[i]).epsilon(1e-5));
    CHECK(openOfFrames[i] == Approx(open[i]).epsilon(1e-5));
  }
}

TEST_CASE("more lights than a dispatch can take add up") {
  const OneVoxel voxel;
  ReflectiveShadowMap map =
      mapOf(lightOf("directional"), 4, glm::vec4(voxel.centre, 1), {0, -1, 0, 1}, fluxOf(0.25f));
  const std::vector<LightSampleData> lights(20000, map.lights->downloadValues<LightSampleData>().front());
  map.lights = bufferOf(lights);
  map.lightCount = static_cast<int>(lights.size());
  Gatherer gatherer = voxel.gatherer(map);
  gatherer.with({{"rays", 3}, {"occlusion_distance", 100}});
  CHECK(gatherer.arriving()[0] == Approx(5000.0).epsilon(1e-5));
  CHECK(gatherer.floats("occlusion")[0] == 0.0f);
}

TEST_CASE("half and quarter of the pixels send rays, also of an image of one") {
  for (const glm::ivec2 size : {glm::ivec2(13, 6), glm::ivec2(1, 1)})
    for (const auto& [word, every] : {std::pair("full", 1), std::pair("half", 2), std::pair("quarter", 4)}) {
      Gatherer gatherer(gridOf(VoxelSet({8, 8, 8})), underSky(3.0f), size.x, size.y);
      gatherer.at({4, 4, 4}, kUp, size).with({{"pixels", word}, {"rays", 4}});
      const gpu::TextureRef arriving = gatherer.out<Image>("arriving").texture;
      CHECK(arriving->description().width == (size.x + every - 1) / every);
      CHECK(arriving->description().height == (size.y + every - 1) / every);
      // What smooths them fills the image: albedo 0.5.
      SceneBuilder builder;
      builder.look({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 0.7, size.x, size.y);
      LonePass smooth("image_filters.smooth", builder.scene);
      smooth.in("gbuffer", gbufferAt({{4, 4, 4}, kUp, glm::vec3(0.5f)}, size))
          .in("diffuse", Image{arriving})
          .in("occlusion", gatherer.out<Image>("occlusion"));
      const ImageBuffer diffuse = smooth.image("diffuse"), open = smooth.image("occlusion", 1);
      CHECK(diffuse.width() == size.x);
      for (const float value : diffuse.values()) CHECK(value == Approx(1.5).epsilon(1e-6));
      for (const float value : open.values()) CHECK(value == Approx(1.0).epsilon(1e-6));
    }
}

TEST_CASE("rotations are of the pixel, of a tile of four by four, or none") {
  const BinaryGrid grid = gridOf(clutter());
  const auto open = [&](const char* rotation) {
    Gatherer gatherer(grid);
    gatherer.at(kPlace, kUp).with({{"rays", 16}, {"occlusion_distance", 15}, {"rotation", rotation}});
    return everyFourth(gatherer.floats("occlusion"));
  };
  const std::vector<float> none = open("none"), tile = open("tile"), hash = open("hash");
  int other = 0, otherInTile = 0, otherOfHash = 0;
  for (std::size_t i = 0; i < 64; ++i) {
    other += none[i] != none[0];
    const std::size_t first = i / 8 % 4 * 8 + i % 8 % 4;
    otherInTile += tile[i] != tile[first];
    otherOfHash += hash[i] != hash[first];
  }
  CHECK(other == 0);
  CHECK(otherInTile == 0);
  CHECK(otherOfHash > 20);
}

TEST_CASE("each sequence is distributed as the cosine, and narrows with the spread") {
  // A disc of voxels overhead, seen from its middle: of directions whose squared sine is uniform up to s the
  // share min(1, r^2 / (r^2 + h^2) / s) meets a disc of radius r at height h.
  VoxelSet set({64, 16, 64});
  for (int x = 0; x < 64; ++x)
    for (int z = 0; z < 64; ++z)
      if (glm::length(glm::vec2(x + 0.5f, z + 0.5f) - 32.0f) < 20.0f) set.insert({x, 10, z});
  for (const char* sequence : {"r2", "hammersley"})
    for (const double spread : {1.0, 0.9}) {
      Gatherer gatherer(gridOf(set));
      // Ten below, but for the half that the height of the offset takes.
      gatherer.at({32, 0.5f, 32}, kUp)
          .with({{"rays", 512},
                 {"sequence", sequence},
                 {"spread", spread},
                 {"offset", 0},
                 {"occlusion_distance", 1000}});
      CAPTURE(sequence, spread);
      // The rim is in steps of a voxel.
      CHECK(1.0 - gatherer.mean("occlusion") == Approx(400.0 / (400.0 + 9.5 * 9.5) / spread).epsilon(0.01));
    }
}

TEST_CASE("as published the estimator has one more 1 / pi, and the environment begins at the radius") {
  VoxelSet set({16, 16, 16});
  for (int x = 0; x < 16; ++x)
    for (int z = 0; z < 16; ++z) set.insert({x, 14, z});
  const BinaryGrid grid = gridOf(set);
  const auto arriving = [&](const char* published) {
    Gatherer gatherer(grid, underSky(3.0f));
    gatherer.at({8, 2, 8}, kUp).with({{"rays", 64}, {"radius", 1}, {"as_published", published}});
    return gatherer.arriving()[0];
  };
  CHECK(arriving("on") == Approx(3.0 / kPi));
  CHECK(arriving("off") == 0.0f);
}

TEST_CASE("light of voxels is that of the finest level, whatever their opacity") {
  VoxelSet set({16, 16, 16});
  for (int x = 0; x < 16; ++x)
    for (int z = 0; z < 16; ++z) set.insert({x, 10, z});
  const BinaryGrid bits = gridOf(set);
  RadianceGrid radiance;
  radiance.grid = bits.grid;
  radiance.unit = 4.0f;
  // Pre-multiplied, in units.
  radiance.radiance = filled(volumeOf(glm::ivec3(16)), {0.5f, 0.25f, 1.0f, 0.5f});
  Gatherer gatherer(bits);
  gatherer.in("voxels", radiance);
  gatherer.at({8.5f, 5, 8.5f}, kUp).with({{"rays", 1}, {"spread", 0}, {"radiance", "voxels"}});
  const std::vector<float> arriving = gatherer.arriving();
  CHECK(arriving[0] == Approx(4.0));
  CHECK(arriving[1] == Approx(2.0));
  CHECK(arriving[2] == Approx(8.0));
}

TEST_CASE("what does not belong together is refused by name") {
  const BinaryGrid bits = gridOf(VoxelSet({16, 16, 16}));
  const auto at = [&](const BinaryGrid& grid, const Settings& settings) {
    Gatherer gatherer(grid);
    gatherer.at({8, 8, 8}, kUp).with(settings);
    return gatherer;
  };
  RadianceGrid radiance;
  radiance.grid = {glm::vec3(0.5f), 2.0f, glm::ivec3(8)};
  radiance.radiance = filled(volumeOf(glm::ivec3(8)), glm::vec4(0.0f));
  const Settings fromVoxels{{"radiance", "voxels"}};
  CHECK_THROWS_MATCHES(at(bits, fromVoxels).in("voxels", radiance).run(), Error,
                       Tells("bits", 16, 16, 16, 1, "(0, 0, 0)", "voxels", 8, 8, 8, 2, "(0.5, 0.5, 0.5)"));
  CHECK_THROWS_MATCHES(at(bits, fromVoxels).run(), Error, Tells("radiance voxels", "voxels", "connected"));
  ReflectiveShadowMap map = mapOf(lightOf("point"), 4, glm::vec4(0), glm::vec4(0), glm::vec4(0));
  map.lightCount = 3;
  CHECK_THROWS_MATCHES(at(bits, {}).map(map).run(), Error, Tells("map", 3, 6, 1, 6, 6));
  CHECK_THROWS_MATCHES(at(gridOf(VoxelSet({4, 4, 130})), {{"method", "printed"}}).run(), Error,
                       Tells(128, "bits", 130));
}

TEST_CASE("parameters out of their range are refused, and taps that are neither one nor four") {
  const auto told = [](const std::string& settings) {
    return messageOf<Error>([&] {
      const Pipeline text = Pipeline::parse(
          "pipeline \"p\" {\npass gbuffer direct_lighting.gbuffer { }\n"
          "pass voxels voxelization.conservative { }\n"
          "pass bits voxelization.average { fragments voxels.fragments }\n"
          "pass gather near_field_voxels.gather {\ngbuffer gbuffer\nbits bits.bits\n" +
              settings + "\n}\noutput o gather.arriving\n}\n",
          "test.pipeline");
      const Scene scene = litRoom(8, 8);
      PipelineExecutor(device(), techniques(), scene, text, {}).render(0.0);
    });
  };
  CHECK_THAT(told("radius -1 m"), Tells("radius"));
  CHECK_THAT(told("rays 2000000"), Tells("rays"));
  CHECK_THAT(told("taps 3"), Tells("taps", 3, 1, 4));
}
