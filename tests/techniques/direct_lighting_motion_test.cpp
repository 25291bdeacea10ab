// Direct light of lights that move, at each time of their keys and rates.
#include <glm/gtc/constants.hpp>

#include "support/scene_builder.h"
#include "support/techniques.h"

using namespace lumivox;
using namespace lumivox::test;
using Catch::Matchers::WithinRel;

namespace {

constexpr int kPixels = 16;

/// A floor of 2 m x 2 m at y = 0 facing up, seen from 3 m above; `up` of the image is -z.
SceneBuilder floorFromAbove() {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.8f));
  builder.look({0, 3, 0}, {0, 0, 0}, {0, 0, -1}, 2.0 * std::atan(1.0 / 3.0), kPixels, kPixels);
  return builder;
}

/// Frames of one run, so that what an earlier frame left is found.
std::vector<ImageBuffer> framesAt(const Scene& scene, const std::vector<double>& times) {
  PipelineExecutor executor(device(), techniques(), scene, pipeline("direct_lighting"), {});
  std::vector<ImageBuffer> images;
  for (const double time : times)
    images.push_back(executor.render(time, static_cast<int>(images.size())).outputs.at("direct"));
  return images;
}

/// Where the centre of a pixel lies on the floor.
glm::vec3 floorPoint(int x, int y) {
  return {2.0f * (static_cast<float>(x) + 0.5f) / kPixels - 1.0f, 0.0f,
          2.0f * (static_cast<float>(y) + 0.5f) / kPixels - 1.0f};
}

}  // namespace

TEST_CASE("a point light that moves over a plane gives I cos / r^2 in every frame of a run") {
  SceneBuilder builder = floorFromAbove();
  LightMotion& motion = builder.light(LightKind::point, glm::vec3(10.0f), {0, 1, 0}).motion.emplace();
  motion.keys.resize(2);
  motion.keys[0].position = glm::dvec3(-0.5, 1, 0);
  motion.keys[1].time = 2.0;
  motion.keys[1].position = glm::dvec3(0.5, 1.5, 0.5);
  const std::vector<double> times{0.0, 0.5, 2.0};
  const std::vector<ImageBuffer> images = framesAt(builder.scene, times);
  for (std::size_t i = 0; i < times.size(); ++i) {
    CAPTURE(times[i]);
    const auto part = static_cast<float>(times[i] / 2.0);
    const glm::vec3 light(part - 0.5f, 1.0f + 0.5f * part, 0.5f * part);
    for (const glm::ivec2 pixel : {glm::ivec2(2, 2), glm::ivec2(8, 8), glm::ivec2(14, 3)}) {
      const glm::vec3 path = light - floorPoint(pixel.x, pixel.y);
      const float r = glm::length(path);
      CHECK_THAT(images[i].at(pixel.x, pixel.y, 1),
                 WithinRel(0.8f / glm::pi<float>() * 10.0f * (path.y / r) / (r * r), 1e-3f));
    }
  }
}

TEST_CASE("a sun that turns lights a plane by the cosine of its angle in every frame of a run") {
  SceneBuilder builder = floorFromAbove();
  builder.light(LightKind::directional, glm::vec3(3.0f), {}, {0, -1, 0}).motion.emplace().rigid =
      RigidMotion{.axis = {0, 0, 1}, .angularSpeed = 0.5};
  const std::vector<double> times{0.0, 0.5, 1.0, 2.5};
  const std::vector<ImageBuffer> images = framesAt(builder.scene, times);
  for (std::size_t i = 0; i < times.size(); ++i) {
    CAPTURE(times[i]);
    CHECK_THAT(
        images[i].at(5, 9, 0),
        WithinRel(0.8f / glm::pi<float>() * 3.0f * static_cast<float>(std::cos(0.5 * times[i])), 1e-3f));
  }
}

TEST_CASE("a lamp that is switched off leaves the image of the scene without it, bit for bit") {
  SceneBuilder builder = floorFromAbove();
  builder.light(LightKind::directional, glm::vec3(1.0f), {}, {0.2, -1, 0});
  const Scene without = builder.scene;
  LightMotion& motion = builder.light(LightKind::point, glm::vec3(10.0f), {0, 1, 0}).motion.emplace();
  motion.interpolation = Interpolation::step;
  motion.keys.resize(1);
  motion.keys[0].time = 1.0;
  motion.keys[0].power = glm::vec3(0.0f);
  const std::vector<ImageBuffer> images = framesAt(builder.scene, {0.0, 1.0});
  const ImageBuffer dark = framesAt(without, {1.0}).front();
  CHECK(images[0].values() != dark.values());
  CHECK(images[1].values() == dark.values());
}

TEST_CASE("a light that is dark in the first frame and lit by its keys lights the later ones") {
  SceneBuilder builder = floorFromAbove();
  LightMotion& motion = builder.light(LightKind::point, glm::vec3(0.0f), {0, 1, 0}).motion.emplace();
  motion.keys.resize(2);
  motion.keys[0].power = glm::vec3(0.0f);
  motion.keys[1].time = 1.0;
  motion.keys[1].power = glm::vec3(10.0f);
  const std::vector<ImageBuffer> images = framesAt(builder.scene, {0.0, 1.0});
  for (const float radiance : images[0].values()) CHECK(radiance == 0.0f);
  const float r = glm::length(glm::vec3(0, 1, 0) - floorPoint(8, 8));
  CHECK_THAT(images[1].at(8, 8, 0), WithinRel(0.8f / glm::pi<float>() * 10.0f / (r * r * r), 1e-3f));
}
