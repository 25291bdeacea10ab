// Points, lights and averaged lights made by hand, and the passes of virtual area lights over them.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "../../techniques/virtual_area_lights/points/surface_points_port.h"
#include "../../techniques/virtual_area_lights/sparse_light.h"
#include "lumivox/pipeline/pass.h"
#include "lumivox/pipeline/ports.h"
#include "support/scene_builder.h"
#include "support/techniques.h"

namespace lumivox::test {

using virtual_area_lights::SparseLight, virtual_area_lights::SurfacePoint, virtual_area_lights::SurfacePoints,
    virtual_area_lights::SurfacePointSet, virtual_area_lights::SurfacePointState,
    virtual_area_lights::SurfacePlace;

struct SparsePoint {
  glm::vec3 position{0.0f}, normal{0, 1, 0};
  float area = 0.01f, radius = 0.1f;
  float exponent = -1.0f;  ///< below 0: not glossy
  int model = 0;
};

/// A disc that shines.
struct DiscLight {
  glm::vec3 position{0.0f}, normal{0, -1, 0};
  float area = 0.01f;
  glm::vec3 exitance{1.0f};
};

inline gpu::TextureRef texels(const std::vector<glm::vec4>& values, glm::ivec2 size, const char* label) {
  auto texture = std::make_shared<gpu::Texture>(
      device(), gpu::TextureDescription{.format = gpu::Format::rgba32f, .width = size.x, .height = size.y},
      label);
  std::vector<glm::vec4> all = values;
  all.resize(static_cast<std::size_t>(size.x * size.y), glm::vec4(0.0f));
  texture->upload(0, std::as_bytes(std::span(all)));
  return texture;
}

template <class T>
gpu::BufferRef bufferOf(const std::vector<T>& values, const char* label) {
  auto buffer =
      std::make_shared<gpu::Buffer>(device(), std::max(values.size(), std::size_t{1}) * sizeof(T), label);
  if (!values.empty()) buffer->uploadValues(std::span<const T>(values));
  return buffer;
}

/// Every point is a candidate everywhere.
inline SurfacePoints pointsOf(const std::vector<SparsePoint>& points, float spacing = 0.1f,
                              int neighbours = 8) {
  std::vector<glm::vec4> positions, normals, radii;
  std::vector<std::uint32_t> candidates;
  for (const SparsePoint& point : points) {
    positions.emplace_back(point.position, point.area);
    normals.emplace_back(point.normal, static_cast<float>(point.model));
    radii.emplace_back(point.radius, std::max(point.exponent, 0.0f), point.exponent >= 0.0f ? 1.0f : 0.0f,
                       1.0f);
    candidates.push_back(static_cast<std::uint32_t>(candidates.size()));
  }
  const glm::ivec2 size = SurfacePoints::sizeFor(static_cast<int>(points.size()));
  SurfacePoints result;
  result.position = texels(positions, size, "positions");
  result.normal = texels(normals, size, "normals");
  result.radius = texels(radii, size, "radii");
  result.grid = {glm::vec3(-1e3f), 2e3f, glm::ivec3(1)};
  result.cells = bufferOf<std::uint32_t>({0, static_cast<std::uint32_t>(points.size())}, "cells");
  result.candidates = bufferOf(candidates, "candidates");
  result.count = static_cast<int>(points.size());
  result.neighbours = neighbours;
  result.spacing = spacing;
  result.farthest = 1e6f;
  return result;
}

inline SurfaceLights lightsOf(const std::vector<DiscLight>& lights) {
  std::vector<glm::vec4> values;
  for (const DiscLight& light : lights) {
    values.emplace_back(light.position, light.area);
    values.emplace_back(light.normal, 0.0f);
    values.emplace_back(light.exitance * light.area, 0.0f);
  }
  return {bufferOf(values, "lights"), static_cast<int>(lights.size())};
}

/// Parameters of one pass.
using PassSettings = std::vector<std::pair<std::string, std::variant<double, std::string>>>;

/// Runs one pass of the technique over inputs made by hand; the camera looks from (0, 1, 0) at a glossy
/// floor.
class SparsePasses {
 public:
  explicit SparsePasses(glm::dvec3 eye = {0, 1, 0}, int side = 8) {
    builder_.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder_.phong(0.5f, 0.5f, 10.0f));
    builder_.light(LightKind::point, glm::vec3(1.0f), {0, 1, 0});
    builder_.look(eye, {0, 0, 1e-3}, {0, 0, -1}, 0.7, side, side);
  }

  SparseLight gather(const SurfacePoints& points, const SurfaceLights& lights,
                     const PassSettings& settings = {}, const SurfaceLights* more = nullptr) {
    PassHarness& pass = add("gather", settings);
    pass.setInput("points", points);
    pass.setInput("lights", lights);
    if (more != nullptr) pass.setInput("more_lights", *more);
    pass.run();
    return pass.output<SparseLight>("light");
  }
  SparseLight normalise(const SurfacePoints& points, const SparseLight& light,
                        const PassSettings& settings = {}) {
    return over("normalise", points, light, settings);
  }
  SparseLight occlude(const SurfacePoints& points, const SparseLight& light,
                      const PassSettings& settings = {}) {
    return over("occlude", points, light, settings);
  }
  /// What is reflected by surfaces of albedo 1 at `seen`, one in each pixel from the upper left on.
  std::pair<ImageBuffer, ImageBuffer> apply(const SurfacePoints& points, const SparseLight& light,
                                            const std::vector<SparsePoint>& seen,
                                            const PassSettings& settings = {}) {
    PassHarness& pass = add("apply", settings);
    pass.setInput("gbuffer", gbuffer(seen));
    pass.setInput("points", points);
    pass.setInput("light", light);
    pass.run();
    return {imageOf(*pass.output<Image>("diffuse").texture), imageOf(*pass.output<Image>("glossy").texture)};
  }
  std::pair<ImageBuffer, ImageBuffer> bruteForce(const SurfaceLights& lights,
                                                 const std::vector<SparsePoint>& seen) {
    PassHarness& pass = add("brute_force", {});
    pass.setInput("gbuffer", gbuffer(seen));
    pass.setInput("lights", lights);
    pass.run();
    return {imageOf(*pass.output<Image>("diffuse").texture), imageOf(*pass.output<Image>("glossy").texture)};
  }
  const Scene& scene() const { return builder_.scene; }

 private:
  PassHarness& add(const std::string& name, const PassSettings& settings) {
    harnesses_.push_back(std::make_unique<PassHarness>(device(), techniques(), "virtual_area_lights", name,
                                                       builder_.scene, snapshotOf(builder_.scene, 0.0)));
    for (const auto& [parameter, value] : settings)
      std::visit([&, &key = parameter](const auto& set) { harnesses_.back()->setParameter(key, set); },
                 value);
    return *harnesses_.back();
  }
  SparseLight over(const std::string& name, const SurfacePoints& points, const SparseLight& light,
                   const PassSettings& settings) {
    PassHarness& pass = add(name, settings);
    pass.setInput("points", points);
    pass.setInput("light", light);
    pass.run();
    return pass.output<SparseLight>("light");
  }
  GBuffer gbuffer(const std::vector<SparsePoint>& seen) const {
    const Camera& camera = builder_.scene.cameras.front();
    const glm::ivec2 size(camera.width, camera.height);
    std::vector<glm::vec4> position, normal, geometric, diffuse, specular;
    for (const SparsePoint& point : seen) {
      position.emplace_back(point.position, 1.0f);
      normal.emplace_back(point.normal, 1.0f);
      geometric.emplace_back(point.normal, static_cast<float>(point.model));
      diffuse.emplace_back(1.0f);
      specular.push_back(point.exponent >= 0.0f ? glm::vec4(1, 1, 1, point.exponent) : glm::vec4(0.0f));
    }
    return {texels(position, size, "position"),          texels(normal, size, "normal"),
            texels(geometric, size, "geometric normal"), texels(diffuse, size, "diffuse"),
            texels(specular, size, "specular"),          nullptr};
  }

  SceneBuilder builder_;
  std::vector<std::unique_ptr<PassHarness>> harnesses_;
};

/// The texels of the first points.
inline std::vector<glm::vec4> valuesOf(const gpu::TextureRef& texture, std::size_t count) {
  const std::vector<float> floats = texture->downloadFloats(0);
  std::vector<glm::vec4> result;
  for (std::size_t i = 0; i < count; ++i)
    result.emplace_back(floats[4 * i], floats[4 * i + 1], floats[4 * i + 2], floats[4 * i + 3]);
  return result;
}

}  // namespace lumivox::test
