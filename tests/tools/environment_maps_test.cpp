// Environment maps through the committed pipelines, against the reference.
#include "support/environment_maps.h"

#include "support/against_reference.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

Pipeline committed(const std::string& name) {
  return Pipeline::load(sourceDirectory() / "scenes/pipelines" / (name + ".pipeline"));
}

/// A box and a slanted board on a floor, without any lamp.
Scene outside() {
  SceneBuilder builder;
  const int floor = builder.lambert(0.6f), white = builder.lambert(0.7f);
  builder.box({-1.2f, -0.1f, -1.2f}, {1.2f, 0.0f, 1.2f}, floor, false);
  builder.box({-0.4f, 0.0f, -0.4f}, {0.1f, 0.5f, 0.1f}, white, false);
  builder.box({0.4f, 0.0f, 0.2f}, {0.8f, 0.3f, 0.6f}, white, false);
  builder.look({1.5, 1.3, 2.0}, {0, 0.15, 0}, {0, 1, 0}, 0.75, 40, 40);
  return builder.scene;
}

}  // namespace

TEST_CASE(
    "techniques whose other errors are smaller err less by reading a map by direction than by its mean") {
  Scene scene = outside();
  // Bright from one side and above, with a wide soft sun.
  const glm::vec3 sun = glm::normalize(glm::vec3(0.9f, 0.5f, 0.3f));
  shineFrom(scene, environmentOf(32, [&](const glm::vec3& d) {
              const float towards = std::max(glm::dot(d, sun), 0.0f);
              return glm::vec3(0.1f) + glm::vec3(2.0f, 1.5f, 1.0f) * std::pow(towards, 6.0f) +
                     glm::vec3(0.0f, 0.1f, 0.3f) * std::max(d.y, 0.0f);
            }));
  Scene even = scene;
  even.environmentMap = nullptr;
  const Picture picture{40, 40, 256};
  const LayeredImage reference = referenceOf(scene, picture);
  struct Row {
    const char* pipeline;
    std::vector<std::string> settings;
    double most;  // error of that of no light at all
  };
  const auto& [pipeline, settings, most] = GENERATE(values<Row>({
      {"voxel_cone_tracing", {"resolution=64"}, 0.25},
      {"voxel_cone_tracing_directional", {"resolution=64"}, 0.25},
      {"voxel_cone_tracing_octree", {"resolution=64"}, 0.25},
      {"layered_reflective_shadow_maps", {"resolution=64"}, 0.25},
      {"near_field_voxels", {"resolution=64"}, 0.3},
      {"voxel_path_tracing", {"resolution=64"}, 0.5},
      {"screen_space", {}, 0.5},
      {"implicit_visibility", {}, 0.3},
      {"imperfect_volumes", {"resolution=32"}, 0.4},
  }));
  INFO(pipeline);
  const Pipeline text = committed(pipeline);
  const auto errorOf = [&](const Scene& lit) {
    return lightAgainst(reference, pictured(lit, picture, text, settings).outputs.at("indirect_diffuse"));
  };
  const Against byDirection = errorOf(scene), byMean = errorOf(even);
  INFO("error of no light: " << byDirection.rmse << " by direction, " << byMean.rmse
                             << " by the mean; ratios of means " << byDirection.ratio << ", "
                             << byMean.ratio);
  CHECK(byDirection.rmse < most);
  CHECK(byDirection.rmse < 0.75 * byMean.rmse);
}

TEST_CASE(
    "light propagation brings a bright and a dark half of the sky to the sides that face them, within an eighth") {
  // L = 1 + d.s on an open floor: E / pi = 1 + 2/3 s.y.
  const float up = GENERATE(0.5f, -0.5f);
  SceneBuilder builder;
  builder.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, builder.lambert(0.6f));
  builder.look({0, 1.2, 1.6}, {0, 0, 0}, {0, 1, 0}, 0.5, 24, 24);
  shineFrom(builder.scene, environmentOf(32, [&](const glm::vec3& d) { return glm::vec3(1.0f + up * d.y); }));
  const ImageBuffer light =
      pictured(builder.scene, {24, 24}, committed("light_propagation_volumes"), {"resolution=32"})
          .outputs.at("indirect_diffuse");
  CHECK(light.at(12, 12, 1) == Approx(0.6 * (1.0 + 2.0 / 3.0 * up)).epsilon(0.125));
}

TEST_CASE("camera rays that miss see the texels that the reference sees") {
  Scene scene = outside();
  EnvironmentMap map = environmentOf(16, [](const glm::vec3& d) { return glm::vec3(1.0f) + d; });
  map.toMap = glm::mat3(glm::vec3(0, 0, 1), glm::vec3(0, 1, 0), glm::vec3(-1, 0, 0));
  shineFrom(scene, map);
  Camera& camera = scene.cameras.front();
  camera.target = camera.eye + glm::dvec3(0.3, 0.9, -0.4);  // away from all
  RenderOptions options;
  const ImageBuffer image = renderOnce(scene, committed("direct_lighting"), options).outputs.at("direct");
  const CameraView view = snapshotOf(scene, 0.0).camera;
  int other = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const glm::vec3 wanted =
          map.towards(view.direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f));
      for (int c = 0; c < 3; ++c)
        if (image.at(x, y, c) != wanted[c]) {
          ++other;
          break;
        }
    }
  CHECK(other <= image.width() * image.height() / 200);  // directions on the edge between two texels
}

TEST_CASE("a map of one value in two texels gives the image of the constant environment") {
  Scene constant = outside();
  constant.environment = glm::vec3(0.4f, 0.5f, 0.6f);
  Scene map = constant;
  map.environmentMap = std::make_shared<const EnvironmentMap>(
      environmentOf(1, [](const glm::vec3&) { return glm::vec3(0.4f, 0.5f, 0.6f); }));
  const char* pipeline = GENERATE("voxel_cone_tracing", "near_field_voxels", "screen_space",
                                  "implicit_visibility", "imperfect_volumes", "direct_lighting");
  INFO(pipeline);
  const Picture picture{24, 24};
  const FrameResult one = pictured(constant, picture, committed(pipeline), {}),
                    other = pictured(map, picture, committed(pipeline), {});
  for (const auto& [name, image] : one.outputs) {
    INFO(name);
    double most = 0.0;
    for (std::size_t i = 0; i < image.values().size(); ++i)
      most = std::max(most, std::abs(double(image.values()[i]) - double(other.outputs.at(name).values()[i])));
    CHECK(most < 1e-6);  // weights of texels of one value round
  }
}

TEST_CASE("cones read a map around the whole sphere, across the folds of its octahedron, at every width") {
  // Camera rays of soft shadows are cones as wide as a pixel. The mean of 1 + d.s over a narrow cone is that
  // on its axis.
  Scene scene = outside();
  const glm::vec3 slope(0.5f, -0.3f, 0.4f);
  EnvironmentMap map =
      environmentOf(64, [&](const glm::vec3& d) { return glm::vec3(1.0f + glm::dot(d, slope)); });
  shineFrom(scene, map);
  const auto [size, most] = GENERATE(table<int, double>({{48, 0.02}, {12, 0.04}, {4, 0.12}}));
  scene.cameras.front().fov = 1.6;
  scene.cameras.front().eye = {0, 50, 0};
  for (const glm::dvec3 ahead :
       {glm::dvec3(1, 0, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0.01), glm::dvec3(0, 0, 1),
        glm::dvec3(0, 0, -1), glm::dvec3(1, 1, -1), glm::dvec3(-1, 0.5, -1)}) {
    scene.cameras.front().target = scene.cameras.front().eye + ahead;
    RenderOptions options;
    options.width = options.height = size;
    const ImageBuffer image =
        renderOnce(scene, committed("voxel_cone_tracing_soft_shadows"), options).outputs.at("direct");
    const CameraView view = snapshotOf(scene, 0.0, {}, size, size).camera;
    double worst = 0.0;
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const glm::vec3 d =
            glm::normalize(view.direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f));
        worst = std::max(worst, std::abs(double(image.at(x, y, 1)) - (1.0 + glm::dot(d, slope))));
      }
    INFO("image of " << size << " pixels ahead " << ahead.x << " " << ahead.y << " " << ahead.z);
    CHECK(worst < most);
  }
}

TEST_CASE("another environment of a scene that is kept is rendered as by a fresh executor") {
  Scene first = outside();
  Scene second = first, constant = first;
  shineFrom(first, environmentOf(16, [](const glm::vec3& d) { return glm::vec3(1.0f + 0.9f * d.x); }));
  shineFrom(second, environmentOf(16, [](const glm::vec3& d) { return glm::vec3(1.0f + 0.9f * d.y); }));
  constant.environment = glm::vec3(0.2f, 0.3f, 0.4f);
  RenderOptions options;
  options.width = options.height = 16;
  options.keepEverything = GENERATE(false, true);
  const Pipeline text = committed("near_field_voxels");
  PipelineExecutor kept(device(), techniques(), first, text, options);
  kept.render(0.0);
  for (const Scene* next : {&second, &constant, &first}) {
    kept.setScene(*next);
    const FrameResult changed = kept.render(0.0);
    const FrameResult fresh = PipelineExecutor(device(), techniques(), *next, text, options).render(0.0);
    for (const auto& [name, image] : fresh.outputs) {
      INFO(name);
      CHECK(image.values() == changed.outputs.at(name).values());
    }
  }
}
