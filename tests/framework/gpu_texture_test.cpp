// Contents of textures and how they are read.
#include <cmath>
#include <cstring>

#include "support/gpu_programs.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::gpu;
using namespace lumivox::test;

namespace {

constexpr Format kAllFormats[] = {Format::r8,      Format::rgba8,  Format::r16f,     Format::rg16f,
                                  Format::rgba16f, Format::r32f,   Format::rg32f,    Format::rgba32f,
                                  Format::r32ui,   Format::rg32ui, Format::rgba32ui, Format::depth32f};

bool isInteger(Format format) {
  return format == Format::r32ui || format == Format::rg32ui || format == Format::rgba32ui;
}

}  // namespace

TEST_CASE("every format gives back the bytes that were put in") {
  for (const Format format : kAllFormats) {
    CAPTURE(name(format));
    for (const TextureKind kind : {TextureKind::d2, TextureKind::d2Array, TextureKind::d3}) {
      if (kind == TextureKind::d3 && format == Format::depth32f) continue;
      const TextureDescription description{kind, format, 5, 3, kind == TextureKind::d2 ? 1 : 2, 2};
      Texture texture(device(), description, "round trip");
      // Level 1: 2 x 1 texels, the slices of a volume halved too.
      const std::size_t texels = kind == TextureKind::d2Array ? 4 : 2;
      std::vector<std::byte> bytes(texels * bytesPerTexel(format));
      for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i * 7 % 50 + 10);
      texture.upload(1, bytes);
      CHECK(texture.download(1) == bytes);
      CHECK(texture.download(0).size() == 15 * bytesPerTexel(format) * (kind == TextureKind::d2 ? 1 : 2));
    }
  }
}

TEST_CASE("slices of a volume and layers of an array are the parts of the whole that they name") {
  for (const TextureKind kind : {TextureKind::d2Array, TextureKind::d3}) {
    Texture texture(device(), {kind, Format::rg16f, 6, 5, 9, 2}, "slices");
    for (int level = 0; level < 2; ++level) {
      std::vector<std::byte> bytes = texture.download(level);
      for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i * 7 % 50 + i / 64);
      texture.upload(level, bytes);
      const int slices = kind == TextureKind::d2Array || level == 0 ? 9 : 4;
      const std::size_t sliceBytes = bytes.size() / static_cast<std::size_t>(slices);
      for (int first = 0; first < slices; ++first) {
        for (int count = 1; count <= slices - first; ++count) {
          const std::byte* expected = bytes.data() + sliceBytes * static_cast<std::size_t>(first);
          // A byte behind the slices shows that no more is written.
          std::vector<std::byte> some(sliceBytes * static_cast<std::size_t>(count) + 1, std::byte{77});
          texture.downloadSlices(level, first, count, std::span(some).first(some.size() - 1));
          REQUIRE(std::equal(some.begin(), some.end() - 1, expected));
          REQUIRE(some.back() == std::byte{77});
        }
      }
    }
  }
}

TEST_CASE("every format is cleared to the value, at every level") {
  for (const Format format : kAllFormats) {
    CAPTURE(name(format));
    Texture texture(device(), image(format, 4, 4, format == Format::depth32f ? 1 : 3), "cleared");
    texture.clear(glm::vec4(1.0f, 0.0f, 1.0f, 0.0f));
    for (int level = 0; level < texture.description().levels; ++level) {
      std::vector<float> values;
      if (isInteger(format)) {
        const auto bytes = texture.download(level);
        for (std::size_t i = 0; i < bytes.size(); i += 4) {
          std::uint32_t word = 0;
          std::memcpy(&word, &bytes[i], 4);
          values.push_back(static_cast<float>(word));
        }
      } else {
        values = texture.downloadFloats(level);
      }
      const auto components = static_cast<std::size_t>(componentCount(format));
      for (std::size_t i = 0; i < values.size(); ++i)
        REQUIRE(values[i] == (i % components % 2 == 0 ? 1.0f : 0.0f));
    }
  }
}

TEST_CASE("clearing one level leaves the others alone") {
  Texture texture(device(), {TextureKind::d3, Format::r32f, 4, 4, 4, 3}, "levels");
  texture.clear(glm::vec4(1.0f));
  texture.clear(glm::vec4(5.0f), 1);
  CHECK(texture.downloadFloats(0)[63] == 1.0f);
  CHECK(texture.downloadFloats(1)[7] == 5.0f);
  CHECK(texture.downloadFloats(2)[0] == 1.0f);
}

TEST_CASE("half floats round to the nearest and keep infinity and subnormals") {
  Texture texture(device(), image(Format::r16f, 6, 1), "halves");
  // 10 bits of fraction: the step at 1 is 2^-10. Greatest finite 65504, least subnormal 2^-24.
  const float step = std::ldexp(1.0f, -10);
  const float values[] = {
      1.0f + 0.75f * step, 1.0f + 0.25f * step, 65504.0f, INFINITY, std::ldexp(1.0f, -24), -0.5f};
  texture.uploadFloats(0, values);
  const auto back = texture.downloadFloats();
  CHECK(back == std::vector<float>{1.0f + step, 1.0f, 65504.0f, INFINITY, std::ldexp(1.0f, -24), -0.5f});
}

TEST_CASE("a texture is read as its sampling says, inside and outside") {
  Texture texture(device(), image(Format::r32f, 2, 1, 2), "ramp");
  const float level0[] = {1.0f, 3.0f}, level1[] = {10.0f};
  texture.uploadFloats(0, level0);
  texture.uploadFloats(1, level1);
  const Program reading = computeProgram("read", R"(
    layout(local_size_x = 1) in;
    layout(binding = 1) uniform sampler2D source;
    layout(std430, binding = 0) buffer Values { float values[]; };
    void main() {
      values[0] = textureLod(source, vec2(0.5, 0.5), 0.0).r;
      values[1] = textureLod(source, vec2(-0.25, 0.5), 0.0).r;
      values[2] = textureLod(source, vec2(0.3, 0.5), 0.0).r;
      values[3] = textureLod(source, vec2(0.25, 0.5), 0.5).r;
    })");
  const Buffer values(device(), 16, "values");
  const auto read = [&](Sampling sampling) {
    dispatch(reading, Bindings{sampled(1, texture, sampling), storage(0, values)}, {1, 1, 1});
    return values.downloadValues<float>();
  };
  // Texel centres at u = 0.25 (1) and 0.75 (3): half-way 2; at u = 0.3 1.2. u = -0.25 is half a texel outside
  // of the first texel's centre: the edge continues (1), repeats (3) or is nothing (0). Half-way between the
  // levels at u = 0.25: (1 + 10) / 2.
  const auto close = [](float value, double expected) {
    return Approx(expected).margin(0.01) == value;
  };  // 8-bit weights
  const auto nearest = read(Sampling::nearest);
  CHECK(nearest[2] == 1.0f);
  CHECK(nearest[1] == 1.0f);
  const auto linear = read(Sampling::linear);
  CHECK(close(linear[0], 2.0));
  CHECK(close(linear[1], 1.0));
  CHECK(close(linear[2], 1.2));
  CHECK(close(linear[3], 1.0));
  CHECK(close(read(Sampling::linearMips)[3], 5.5));
  CHECK(close(read(Sampling::linearMipsRepeat)[1], 3.0));
  CHECK(close(read(Sampling::linearBorder)[1], 0.0));
  CHECK(close(read(Sampling::linearMipsBorder)[1], 0.0));
  // Level 1 has its only texel's centre at u = 0.5: three quarters of 10 are left at u = 0.25; (1 + 7.5) / 2.
  CHECK(close(read(Sampling::linearMipsBorder)[3], 4.25));
}

TEST_CASE("generated levels are box-filtered halves") {
  Texture texture(device(), image(Format::r32f, 4, 2, 3), "mips");
  const float values[] = {0, 2, 4, 6, 8, 10, 12, 14};
  texture.uploadFloats(0, values);
  texture.generateLevels();
  // Level 1: (0 + 2 + 8 + 10) / 4 and (4 + 6 + 12 + 14) / 4; level 2: their mean.
  CHECK(texture.downloadFloats(1) == std::vector<float>{5.0f, 9.0f});
  CHECK(texture.downloadFloats(2) == std::vector<float>{7.0f});
}

TEST_CASE("a shadow sampler gives the filtered share of texels that the reference does not lie behind") {
  Texture depth(device(), {TextureKind::d2Array, Format::depth32f, 2, 1, 2, 1}, "shadow map");
  const float depths[] = {0.4f, 0.6f, 0.1f, 0.1f};
  depth.uploadFloats(0, depths);
  const Program comparing = computeProgram("compare", R"(
    layout(local_size_x = 1) in;
    layout(binding = 0) uniform sampler2DArrayShadow map;
    layout(std430, binding = 0) buffer Values { float values[]; };
    void main() {
      values[0] = texture(map, vec4(0.5, 0.5, 0.0, 0.5));   // half-way between a nearer and a farther texel
      values[1] = texture(map, vec4(0.5, 0.5, 0.0, 0.4));   // equal counts as lit
      values[2] = texture(map, vec4(0.5, 0.5, 0.0, 0.7));
      values[3] = texture(map, vec4(0.5, 0.5, 1.0, 0.5));   // the other layer
    })");
  const Buffer values(device(), 16, "values");
  dispatch(comparing, Bindings{sampled(0, depth, Sampling::shadow), storage(0, values)}, {1, 1, 1});
  const auto read = values.downloadValues<float>();
  CHECK(read[0] == Approx(0.5).margin(0.01));
  CHECK(read[1] == 1.0f);
  CHECK(read[2] == 0.0f);
  CHECK(read[3] == 0.0f);
}
