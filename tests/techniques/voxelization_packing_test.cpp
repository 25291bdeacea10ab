// The words of a fragment: numbers as 16-bit signed normalised ones, for which drivers have a built-in
// function or none.
#include <cmath>
#include <cstdint>
#include <glm/gtc/packing.hpp>
#include <random>

#include "support/glsl_functions.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

const std::vector<std::string> kFiles{"common/voxel.glsl"};

/// OpenGL 4.5, 2.3.5, to the nearest and of two alike to the even one.
std::uint32_t packed(float value) {
  const float steps = std::nearbyint(std::fmin(std::fmax(value, -1.0f), 1.0f) * 32767.0f);
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(steps)) & 0xffffu;
}
float unpacked(std::uint32_t word) {
  return std::fmax(static_cast<float>(static_cast<std::int16_t>(word)) / 32767.0f, -1.0f);
}

}  // namespace

TEST_CASE("each of the 65536 signed normalised words is its number, and packed again it is itself") {
  constexpr std::uint32_t kWords = 65536, kBelowMinusOne = 0x8000, kMinusOne = 0x8001;
  std::vector<glm::vec4> inputs;
  for (std::uint32_t word = 0; word < kWords; ++word)
    inputs.push_back(glm::vec4(static_cast<float>(word), static_cast<float>(kWords - 1 - word), 0.0f, 0.0f));
  const std::vector<glm::vec4> found = evaluated(kFiles, R"(
      vec2 numbers = unpackSigned(uint(given.x) | uint(given.y) << 16);
      uint again = packSigned(numbers);
      found = vec4(numbers, float(again & 0xffffu), float(again >> 16));)",
                                                 inputs);
  std::size_t wrong = 0;
  for (std::uint32_t word = 0; word < kWords; ++word) {
    const std::uint32_t other = kWords - 1 - word;
    const auto again = [](std::uint32_t one) {
      return static_cast<float>(one == kBelowMinusOne ? kMinusOne : one);
    };
    const glm::vec4 expected(unpacked(word), unpacked(other), again(word), again(other));
    // A division may be off by its last bits (GLSL 4.50, 4.7.1); the words are exact.
    const bool near =
        std::abs(found[word].x - expected.x) <= 1e-6f && std::abs(found[word].y - expected.y) <= 1e-6f;
    if (!near || found[word].z != expected.z || found[word].w != expected.w) ++wrong;
  }
  CHECK(wrong == 0);
}

TEST_CASE("numbers are packed to the nearest signed normalised word, those beyond 1 to that of 1") {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> within(-1.1f, 1.1f);
  std::vector<glm::vec4> inputs{{0.5f, -0.5f, 0.0f, 0.0f},   {1.0f, -1.0f, 0.0f, 0.0f},
                                {2.0f, -2.0f, 0.0f, 0.0f},   {0.0f, -0.0f, 0.0f, 0.0f},
                                {1e-5f, -1e-5f, 0.0f, 0.0f}, {1e30f, -1e30f, 0.0f, 0.0f}};
  for (int i = 0; i < 100000; ++i) inputs.push_back(glm::vec4(within(random), within(random), 0.0f, 0.0f));
  const std::vector<glm::vec4> found = evaluated(kFiles, R"(
      uint word = packSigned(given.xy);
      found = vec4(float(word & 0xffffu), float(word >> 16), 0.0, 0.0);)",
                                                 inputs);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const glm::vec2 expected(packed(inputs[i].x), packed(inputs[i].y));
    if (glm::vec2(found[i]) != expected) ++wrong;
  }
  CHECK(wrong == 0);
}

TEST_CASE("halves are packed to the nearest, of two alike to the even one, down to the smallest") {
  // Halves as they are, the middle between two of them, and what lies beside it.
  std::vector<glm::vec4> inputs;
  std::vector<glm::vec2> expected;
  for (std::uint16_t half = 0; half < 0x7bff; half = static_cast<std::uint16_t>(half + 7)) {
    const auto next = static_cast<std::uint16_t>(half + 1);
    const float low = glm::unpackHalf1x16(half), high = glm::unpackHalf1x16(next),
                middle = 0.5f * (low + high);
    const auto even = static_cast<float>(half % 2 == 0 ? half : next);
    inputs.push_back({low, middle, 0.0f, 0.0f});
    expected.push_back({half, even});
    inputs.push_back({std::nextafter(middle, 0.0f), std::nextafter(middle, 1e9f), 0.0f, 0.0f});
    expected.push_back({half, next});
  }
  const std::vector<glm::vec4> found = evaluated(kFiles, R"(
      uint word = packHalves(given.xy), below = packHalves(-given.xy);
      found = vec4(float(word & 0xffffu), float(word >> 16), float(below & 0x7fffu), float(below >> 16 & 0x7fffu));)",
                                                 inputs);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < inputs.size(); ++i)
    if (found[i] != glm::vec4(expected[i], expected[i])) ++wrong;
  CHECK(wrong == 0);
}

TEST_CASE("a fragment keeps what it emits, or the lobe of a surface that emits nothing, in one word") {
  const auto kept = [](const glm::vec4& lobe, const glm::vec3& emitted, bool asLobe) {
    return evaluated(kFiles,
                     fmt::format(R"(
      VoxelFragment fragment;
      fragment.emission = packEmissionOrLobe(vec3({:.9e}, {:.9e}, {:.9e}), given);
      found = {};)",
                                 emitted.x, emitted.y, emitted.z,
                                 asLobe ? "lobeOf(fragment)" : "vec4(emissionOf(fragment), 0.0)"),
                     {lobe})
        .front();
  };
  const glm::vec3 dark(0.0f);
  for (const float exponent : {0.0f, 1.0f, 7.0f, 40.0f, 1000.0f, 60000.0f}) {
    const glm::vec4 lobe(0.65f, 0.04f, 1.0f, exponent);
    const glm::vec4 found = kept(lobe, dark, true);
    CAPTURE(exponent, found.w);
    CHECK(glm::distance(glm::vec3(found), glm::vec3(lobe)) < 0.004f);
    CHECK(std::abs(std::log2((found.w + 1.0f) / (exponent + 1.0f))) < 0.31f);
    CHECK(kept(lobe, dark, false) == glm::vec4(0.0f));
  }
  // The dimmest radiance that is kept lies above all lobes.
  for (const float radiance : {1e-30f, 0.5f, 3e30f}) {
    const glm::vec3 emitted(radiance, 0.5f * radiance, 0.0f);
    CHECK(kept(glm::vec4(0.5f, 0.5f, 0.5f, 10.0f), emitted, true) == glm::vec4(0.0f));
    const glm::vec3 found(kept(glm::vec4(0.5f), emitted, false));
    CHECK(glm::distance(found / radiance, emitted / radiance) < 0.01f);
  }
  CHECK(kept(glm::vec4(0.0f, 0.0f, 0.0f, 40.0f), dark, true) == glm::vec4(0.0f));
}
