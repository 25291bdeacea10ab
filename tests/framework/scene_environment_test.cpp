// Environment maps: files, words of the text, and what is refused.
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/base/image.h"
#include "lumivox/scene/scene.h"
#include "scene/octahedral_environment.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using Catch::Matchers::Contains;
using test::TemporaryDirectory;

namespace {

/// A scene of one environment block.
Scene load(const TemporaryDirectory& directory, const std::string& block, bool strict = false) {
  directory.write(
      "sky.scene",
      "scene \"sky\" {\n  camera main { eye 0 0 1  target 0 0 0 }\n  environment { " + block + " }\n}\n");
  SceneLoadOptions options;
  options.strict = strict;
  return loadScene(directory.path() / "sky.scene", options);
}

/// 4 x 2 texels whose red is the column and whose green is the row.
ImageBuffer small() {
  ImageBuffer image(4, 2, 3);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x)
      image.at(x, y, 0) = static_cast<float>(x), image.at(x, y, 1) = static_cast<float>(y),
                     image.at(x, y, 2) = 0.5f;
  return image;
}

void writeMap(const TemporaryDirectory& directory, const ImageBuffer& image, const char* name = "sky.exr") {
  LayeredImage layered;
  layered.layers.emplace("", image);
  writeExr(directory.path() / name, layered);
}

/// A Radiance image of 4 x 2 flat pixels, all (128, 64, 32) with the exponent 129: 1.00390625 of 2^0 in red.
std::string smallHdr(const std::string& variables = "FORMAT=32-bit_rle_rgbe\n",
                     const std::string& size = "-Y 2 +X 4\n") {
  std::string bytes = "#?RADIANCE\n" + variables + "\n" + size;
  for (int i = 0; i < 8; ++i) bytes += std::string("\x80\x40\x20", 3) + static_cast<char>(129);
  return bytes;
}

}  // namespace

TEST_CASE(
    "an environment map holds the texels of its file times the scale, turned, with their mean over the sphere") {
  const TemporaryDirectory directory;
  writeMap(directory, small());
  const Scene scene = load(directory, "file \"sky.exr\"  rotate 0 1 0 90 deg  scale 2");
  REQUIRE(scene.environmentMap != nullptr);
  const EnvironmentMap& map = *scene.environmentMap;
  CHECK((map.width == 4 && map.height == 2));
  CHECK(map.radiance[6] == glm::vec3(4, 2, 1));
  // Two rows: each half of the sphere; the mean of 0..3 is 1.5.
  CHECK(scene.environment.x == Approx(3.0f));
  CHECK(scene.environment.y == Approx(1.0f));
  CHECK(scene.environment.z == Approx(1.0f));
  CHECK(map.brightest == glm::vec3(6, 2, 1));
  // Column 2 begins in the middle, at -Z; a quarter turn about +Y brings it to -X.
  const glm::vec3 slightlyRight = glm::normalize(glm::vec3(-1.0f, 0.1f, -0.05f));
  CHECK(map.towards(slightlyRight).x == 4.0f);
  CHECK(SceneTraits::of(scene).environmentMap);
  // Another scale is another scene.
  CHECK(!(load(directory, "file \"sky.exr\"").hash == load(directory, "file \"sky.exr\"  scale 2").hash));
}

TEST_CASE("a map of one value, or of one texel, is a constant environment and nothing of a map remains") {
  const TemporaryDirectory directory;
  const int size = GENERATE(1, 8);
  writeMap(directory, ImageBuffer(2 * size, size, 3, 0.25f));
  if (size == 1) writeMap(directory, ImageBuffer(1, 1, 3, 0.25f));
  const Scene scene = load(directory, "file \"sky.exr\"  scale 2");
  CHECK(scene.environmentMap == nullptr);
  CHECK(scene.environment == glm::vec3(0.5f));
  CHECK(!SceneTraits::of(scene).environmentMap);
}

TEST_CASE("grey maps, maps with alpha and maps in a layer of another name are read") {
  const TemporaryDirectory directory;
  ImageBuffer grey(4, 2, 1, 1.0f), alpha(4, 2, 4, 1.0f);
  grey.at(1, 0, 0) = 3.0f;
  alpha.at(1, 0, 0) = 3.0f, alpha.at(1, 0, 3) = 0.0f;
  writeMap(directory, grey);
  CHECK(load(directory, "file \"sky.exr\"").environmentMap->radiance[1] == glm::vec3(3.0f));
  writeMap(directory, alpha);
  CHECK(load(directory, "file \"sky.exr\"").environmentMap->radiance[1] == glm::vec3(3, 1, 1));
  LayeredImage named;
  named.layers.emplace("beauty", small());
  writeExr(directory.path() / "sky.exr", named);
  CHECK(load(directory, "file \"sky.exr\"").environmentMap->radiance[1] == glm::vec3(1, 0, 0.5f));
}

TEST_CASE(
    "texels that are infinite or no numbers are refused with their place; negative ones count as 0 or are refused") {
  const TemporaryDirectory directory;
  for (const float bad : {std::nanf(""), INFINITY}) {
    ImageBuffer image = small();
    image.at(3, 1, 2) = bad;
    writeMap(directory, image);
    CHECK_THROWS_WITH(load(directory, "file \"sky.exr\""),
                      Contains("sky.exr: texel 3 1") && Contains("not finite"));
  }
  writeMap(directory, small());
  CHECK_THROWS_WITH(load(directory, "file \"sky.exr\"  scale 1e30").environment, Contains("scale"));
  ImageBuffer negative = small();
  negative.at(2, 0, 1) = -1.0f;
  writeMap(directory, negative);
  CHECK(load(directory, "file \"sky.exr\"").environmentMap->radiance[2].y == 0.0f);
  CHECK_THROWS_WITH(load(directory, "file \"sky.exr\"", true), Contains("texel 2 0") && Contains("negative"));
}

TEST_CASE("what is wrong with an environment block is told where it stands") {
  const TemporaryDirectory directory;
  writeMap(directory, small());
  CHECK_THROWS_WITH(load(directory, ""),
                    Contains("sky.scene:3:3") && Contains("an environment without light"));
  CHECK_THROWS_WITH(load(directory, "radiance 1  file \"sky.exr\""),
                    Contains("both a constant radiance and a file"));
  CHECK_THROWS_WITH(load(directory, "radiance 1  scale 2"), Contains("'scale' without a file"));
  CHECK_THROWS_WITH(load(directory, "radiance 1  rotate 0 1 0 90 deg"), Contains("'rotate' without a file"));
  CHECK_THROWS_WITH(load(directory, "file \"sky.png\""), Contains(".exr") && Contains(".hdr"));
  CHECK_THROWS_WITH(load(directory, "file \"skies.exr\""),
                    Contains("'skies.exr' does not exist") && Contains("did you mean 'sky.exr'"));
  directory.write("bad.exr", "no image");
  CHECK_THROWS_WITH(load(directory, "file \"bad.exr\""), Contains("bad.exr"));
}

TEST_CASE("a map of more texels than are allowed is refused by its header, with its size in memory") {
  const TemporaryDirectory directory;
  directory.write("large.hdr", smallHdr("FORMAT=32-bit_rle_rgbe\n", "-Y 8192 +X 16384\n"));
  CHECK_THROWS_WITH(load(directory, "file \"large.hdr\""),
                    Contains("has 16384 x 8192 pixels, 1.5 GiB as floats; expected at most 33554432 pixels"));
  writeMap(directory, small());
  CHECK_THROWS_WITH(readExr(directory.path() / "sky.exr", 7),
                    Contains("4 x 2 pixels") && Contains("at most 7"));
  // What a header claims is compared with the bytes before memory is taken.
  directory.write("lying.hdr", smallHdr("FORMAT=32-bit_rle_rgbe\n", "-Y 4096 +X 8192\n"));
  CHECK_THROWS_WITH(load(directory, "file \"lying.hdr\""), Contains("claims 8192 x 4096 pixels"));
}

TEST_CASE("Radiance images are read flat and in runs, divided by their exposure") {
  const TemporaryDirectory directory;
  const auto read = [&](const std::string& bytes) {
    directory.write("sky.hdr", bytes);
    return readHdr(directory.path() / "sky.hdr", 1u << 20);
  };
  // (m + 1/2) / 256 2^(129 - 128)
  const ImageBuffer flat = read(smallHdr());
  CHECK((flat.width() == 4 && flat.height() == 2));
  CHECK(flat.at(3, 1, 0) == 128.5f / 128.0f);
  CHECK(flat.at(3, 1, 1) == 64.5f / 128.0f);
  CHECK(flat.at(3, 1, 2) == 32.5f / 128.0f);
  CHECK(read(smallHdr("EXPOSURE=4\nFORMAT=32-bit_rle_rgbe\nEXPOSURE= 0.5\n")).at(0, 0, 0) == 128.5f / 256.0f);
  // A row of 10 pixels: red a run of 10, green 3 values and a run of 7, blue and exponent runs.
  const std::string runs = std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 10\n") +
                           std::string("\x02\x02\x00\x0a", 4) + std::string("\x8a\x80", 2) +
                           std::string("\x03\x01\x02\x03\x87\x40", 6) + std::string("\x8a\x20", 2) +
                           std::string("\x8a\x81", 2);
  const ImageBuffer packed = read(runs);
  CHECK(packed.at(9, 0, 0) == 128.5f / 128.0f);
  CHECK(packed.at(1, 0, 1) == 2.5f / 128.0f);
  CHECK(packed.at(5, 0, 1) == 64.5f / 128.0f);
  // Old runs: (1, 1, 1, n) repeats the pixel before.
  const std::string old = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 4\n" +
                          std::string("\x80\x40\x20\x81\x01\x01\x01\x03", 8);
  CHECK(read(old).at(3, 0, 2) == 32.5f / 128.0f);
  // An exponent of 0 is black.
  CHECK(read("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n" + std::string("\x80\x40\x20\x00", 4))
            .at(0, 0, 0) == 0.0f);
}

TEST_CASE("a damaged Radiance image is refused with the file and what is wrong") {
  const TemporaryDirectory directory;
  const auto says = [&](const std::string& bytes, const std::string& what) {
    directory.write("sky.hdr", bytes);
    CHECK_THROWS_WITH(readHdr(directory.path() / "sky.hdr", 1u << 20),
                      Contains("sky.hdr: ") && Contains(what));
  };
  const std::string good = smallHdr();
  for (std::size_t length = good.find("-Y"); length < good.size(); ++length) {
    directory.write("sky.hdr", good.substr(0, length));
    CHECK_THROWS_AS(readHdr(directory.path() / "sky.hdr", 1u << 20), Error);
  }
  says(good.substr(0, good.size() - 1), "is truncated: it ends in row 2 of 2");
  says("P6 4 2", "is not a Radiance image");
  says(smallHdr(""), "names no format");
  says(smallHdr("FORMAT=32-bit_rle_xyze\n"), "32-bit_rle_xyze");
  says(smallHdr("FORMAT=32-bit_rle_rgbe\nEXPOSURE=-1\n"), "exposure '-1'");
  says(smallHdr("FORMAT=32-bit_rle_rgbe\n", "+Y 2 +X 4\n"), "has the size '+Y 2 +X 4'");
  says(smallHdr("FORMAT=32-bit_rle_rgbe\n", "-Y 0 +X 4\n"), "has the size");
  const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 10\n";
  says(header + std::string("\x02\x02\x00\x09\x89\x80", 6), "row 1 has 9 pixels of 10");
  says(header + std::string("\x02\x02\x00\x0a\x8b\x80", 6), "a run in row 1 has 11 of 10 values");
  says(header + std::string("\x02\x02\x00\x0a\x00\x80", 6), "a run in row 1 has 0 of 10 values");
  says(header + std::string("\x01\x01\x01\x05", 4), "goes beyond its end");
}

TEST_CASE("levels by direction keep the mean of a map, and each texel the mean of its directions") {
  EnvironmentMap map;
  map.width = 64, map.height = 32;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x)
      map.radiance.push_back(
          glm::vec3(1.0f) + 0.9f * map.direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f));
  map.toMap = glm::mat3(glm::vec3(0, 0, 1), glm::vec3(0, 1, 0), glm::vec3(-1, 0, 0));
  map.finish();
  const OctahedralEnvironment levels(map);
  CHECK(levels.side() == 32);
  CHECK(levels.levels() == 6);
  REQUIRE(levels.radiance().size() == 32 * 32 + 16 * 16 + 8 * 8 + 4 * 4 + 2 * 2 + 1);
  const glm::vec3 coarsest = levels.radiance().back(), mean = map.mean();
  for (int c = 0; c < 3; ++c) CHECK(coarsest[c] == Approx(mean[c]).epsilon(1e-5));
  // The middle of a texel of the finest level, unfolded.
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / 16.0f - 1.0f,
                  v = (static_cast<float>(y) + 0.5f) / 16.0f - 1.0f;
      glm::vec3 d(u, v, 1.0f - std::abs(u) - std::abs(v));
      if (d.z < 0.0f)
        d = glm::vec3(std::copysign(1.0f - std::abs(v), u), std::copysign(1.0f - std::abs(u), v), d.z);
      const glm::vec3 inMap = map.toMap * glm::normalize(d);
      for (int c = 0; c < 3; ++c)
        CHECK(levels.radiance()[static_cast<std::size_t>(y * 32 + x)][c] ==
              Approx(1.0f + 0.9f * inMap[c]).margin(0.09));
    }
}

TEST_CASE("four fifths of the light on the ground of open_air are its sun, which has four texels") {
  const Scene scene = loadScene(test::sourceDirectory() / "scenes/open_air.scene");
  REQUIRE(scene.environmentMap != nullptr);
  const EnvironmentMap& map = *scene.environmentMap;
  double sun = 0.0, sky = 0.0;
  int texels = 0;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const double up = map.direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f).y;
      const double light = map.radiance[static_cast<std::size_t>(y * map.width + x)].y;
      const bool isSun = light > 50.0;
      texels += isSun;
      (isSun ? sun : sky) += light * map.solidAngle(y) * std::max(up, 0.0);
    }
  CHECK(texels == 4);
  INFO(sun << " and " << sky << " W/m^2");
  CHECK(sun / (sun + sky) == Approx(0.8).margin(0.05));
}
