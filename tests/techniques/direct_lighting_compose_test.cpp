// The last pass of most pipelines, on images made here.
#include <array>
#include <optional>

#include "support/marching.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr std::array<const char*, 5> kInputs{"direct", "diffuse", "glossy", "transmittance", "scattered"};
/// Exact in binary, so that sums are; another one for each channel.
const std::array<glm::vec3, 5> kValues{glm::vec3(1.0f, 2.0f, 3.0f), glm::vec3(0.5f, 0.25f, 4.0f),
                                       glm::vec3(8.0f, 0.125f, 1.5f), glm::vec3(0.5f, 0.75f, 0.25f),
                                       glm::vec3(16.0f, 32.0f, 0.0625f)};

ImageBuffer composed(const std::array<bool, 5>& given) {
  LonePass compose("direct_lighting.compose", emptyScene());
  for (std::size_t i = 0; i < kInputs.size(); ++i)
    if (given[i])
      compose.in(kInputs[i], Image{filled(pixels(kPixels, kPixels), glm::vec4(kValues[i], 1.0f))});
  return compose.image("radiance", 4);
}

}  // namespace

TEST_CASE(
    "an image is direct, diffuse and glossy light, dimmed by the media before it, and what they scatter") {
  // Each of the optional inputs given or left out: what is left out adds nothing and dims nothing.
  for (int choice = 0; choice < 16; ++choice) {
    const std::array<bool, 5> given{true, (choice & 1) != 0, (choice & 2) != 0, (choice & 4) != 0,
                                    (choice & 8) != 0};
    CAPTURE(choice);
    glm::vec3 expected = kValues[0];
    if (given[1]) expected += kValues[1];
    if (given[2]) expected += kValues[2];
    if (given[3]) expected *= kValues[3];
    if (given[4]) expected += kValues[4];
    const ImageBuffer image = composed(given);
    for (const glm::ivec2 pixel : {glm::ivec2(0, 0), glm::ivec2(kPixels - 1, 3)}) {
      for (int c = 0; c < 3; ++c) CHECK(image.at(pixel.x, pixel.y, c) == expected[c]);
      CHECK(image.at(pixel.x, pixel.y, 3) == 1.0f);
    }
  }
}
