// Points, lights and averaged lights with given values, and the passes of virtual area lights over them.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "../../techniques/virtual_area_lights/points/surface_points_port.h"
#include "../../techniques/virtual_area_lights/sparse_light.h"
#include "lumivox/pipeline/ports.h"
#include "support/passes.h"

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

/// A disc that emits.
struct DiscLight {
  glm::vec3 position{0.0f}, normal{0, -1, 0};
  float area = 0.01f;
  glm::vec3 exitance{1.0f};
};

/// A texture with one texel for each point, in their order.
inline gpu::TextureRef texels(std::vector<glm::vec4> values) {
  const glm::ivec2 size = SurfacePoints::sizeFor(static_cast<int>(values.size()));
  values.resize(static_cast<std::size_t>(size.x * size.y), glm::vec4(0.0f));
  gpu::TextureRef texture = filled(pixels(size.x, size.y), glm::vec4(0.0f));
  texture->upload(0, std::as_bytes(std::span(values)));
  return texture;
}

/// Light of the diffuse lobe alone, from one position for each point. lightOverhead(): from far above.
inline SparseLight diffuseLight(const std::vector<glm::vec4>& lights, const std::vector<glm::vec4>& places) {
  return {texels(lights), texels(places), nullptr, nullptr};
}
inline SparseLight lightOverhead(const std::vector<glm::vec4>& lights) {
  return diffuseLight(lights, std::vector<glm::vec4>(lights.size(), glm::vec4(0, 1e4, 0, 1)));
}

/// Sparse points, each a candidate neighbour everywhere.
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
  SurfacePoints result;
  result.position = texels(positions);
  result.normal = texels(normals);
  result.radius = texels(radii);
  result.grid = {glm::vec3(-1e3f), 2e3f, glm::ivec3(1)};
  result.cells = bufferOf<std::uint32_t>({0, static_cast<std::uint32_t>(points.size())});
  result.candidates = bufferOf(candidates);
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
  return {bufferOf(values), static_cast<int>(lights.size())};
}

/// Lights on all walls of a cube of side 2 around the origin, n x n each, which emit inwards.
inline std::vector<DiscLight> shiningBox(int n) {
  std::vector<DiscLight> lights;
  const float side = 2.0f / static_cast<float>(n);
  for (int axis = 0; axis < 3; ++axis)
    for (const float sign : {-1.0f, 1.0f})
      for (int i = 0; i < n * n; ++i) {
        glm::vec3 position(0.0f), normal(0.0f);
        position[axis] = sign;
        normal[axis] = -sign;
        position[(axis + 1) % 3] = -1.0f + side * (static_cast<float>(i % n) + 0.5f);
        position[(axis + 2) % 3] = -1.0f + side * (static_cast<float>(i / n) + 0.5f);
        lights.push_back({position, normal, side * side});
      }
  return lights;
}

/// Runs single passes of the technique on given inputs. The camera looks from (0, 1, 0) at a glossy floor.
class SparsePasses {
 public:
  explicit SparsePasses(glm::dvec3 eye = {0, 1, 0}, int side = 8) {
    builder_.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder_.phong(0.5f, 0.5f, 10.0f));
    builder_.light(LightKind::point, glm::vec3(1.0f), {0, 1, 0});
    builder_.look(eye, {0, 0, 1e-3}, {0, 0, -1}, 0.7, side, side);
  }

  SparseLight gather(const SurfacePoints& points, const SurfaceLights& lights, const Settings& settings = {},
                     const SurfaceLights* more = nullptr) {
    LonePass pass = lone("gather", settings);
    pass.in("points", points).in("lights", lights);
    if (more != nullptr) pass.in("more_lights", *more);
    return pass.out<SparseLight>("light");
  }
  SparseLight normalise(const SurfacePoints& points, const SparseLight& light,
                        const Settings& settings = {}) {
    return over("normalise", points, light, settings);
  }
  SparseLight occlude(const SurfacePoints& points, const SparseLight& light, const Settings& settings = {}) {
    return over("occlude", points, light, settings);
  }
  /// The light reflected by surfaces of albedo 1 at `seen`, one per pixel from the upper left on.
  std::pair<ImageBuffer, ImageBuffer> apply(const SurfacePoints& points, const SparseLight& light,
                                            const std::vector<SparsePoint>& seen,
                                            const Settings& settings = {}) {
    LonePass pass = lone("apply", settings);
    pass.in("gbuffer", gbuffer(seen)).in("points", points).in("light", light);
    return {pass.image("diffuse"), pass.image("glossy")};
  }
  std::pair<ImageBuffer, ImageBuffer> bruteForce(const SurfaceLights& lights,
                                                 const std::vector<SparsePoint>& seen) {
    LonePass pass = lone("brute_force", {});
    pass.in("gbuffer", gbuffer(seen)).in("lights", lights);
    return {pass.image("diffuse"), pass.image("glossy")};
  }
  const Scene& scene() const { return builder_.scene; }

 private:
  LonePass lone(const std::string& name, const Settings& settings) const {
    return {"virtual_area_lights." + name, builder_.scene, settings};
  }
  SparseLight over(const std::string& name, const SurfacePoints& points, const SparseLight& light,
                   const Settings& settings) {
    return lone(name, settings).in("points", points).in("light", light).out<SparseLight>("light");
  }
  GBuffer gbuffer(const std::vector<SparsePoint>& seen) const {
    const Camera& camera = builder_.scene.cameras.front();
    const auto at = [&](int x, int y) {
      const auto i = static_cast<std::size_t>(y * camera.width + x);
      return i < seen.size() ? seen[i] : SparsePoint{};
    };
    GBuffer result = gbufferWhere({camera.width, camera.height}, [&](int x, int y) {
      const SparsePoint point = at(x, y);
      return SeenSurface{point.position, point.normal, glm::vec3(1.0f),
                         point.exponent >= 0.0f ? glm::vec4(1, 1, 1, point.exponent) : glm::vec4(0.0f),
                         static_cast<std::size_t>(y * camera.width + x) < seen.size()};
    });
    result.geometricNormal = pixelsWhere({camera.width, camera.height}, [&](int x, int y) {
      return glm::vec4(at(x, y).normal, static_cast<float>(at(x, y).model));
    });
    return result;
  }

  SceneBuilder builder_;
};

/// The values of the first `count` points.
inline std::vector<glm::vec4> valuesOf(const gpu::TextureRef& texture, std::size_t count) {
  const std::vector<float> floats = texture->downloadFloats(0);
  std::vector<glm::vec4> result;
  for (std::size_t i = 0; i < count; ++i)
    result.emplace_back(floats[4 * i], floats[4 * i + 1], floats[4 * i + 2], floats[4 * i + 3]);
  return result;
}

}  // namespace lumivox::test
