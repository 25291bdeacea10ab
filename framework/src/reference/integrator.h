// One path, all components of it.
#pragma once

#include <glm/glm.hpp>

#include "lumivox/base/random.h"
#include "lumivox/reference/path_tracer.h"
#include "reference/lights.h"
#include "reference/ray_scene.h"
#include "reference/scattering.h"

namespace lumivox::reference {

/// What one path says about a pixel; radiance, components as in path_tracer.h.
struct PathSample {
  glm::vec3 direct{0.0f};
  glm::vec3 oneBounceDiffuse{0.0f}, oneBounceGlossy{0.0f};
  glm::vec3 indirectDiffuse{0.0f}, indirectGlossy{0.0f};
  float unoccluded = 1.0f;

  glm::vec3 full() const { return direct + indirectDiffuse + indirectGlossy; }
};

/// The way of the path tracer to the triangles; counts its rays.
struct CountingRays {
  const RayScene& scene;
  std::uint64_t count = 0;

  bool closestHit(const glm::vec3& origin, const glm::vec3& direction, Hit& hit) {
    ++count;
    return scene.closestHit(origin, direction, hit);
  }
  bool occluded(const glm::vec3& origin, const glm::vec3& direction, float reach) {
    ++count;
    return scene.occluded(origin, direction, reach);
  }
};

struct Integrator {
  static constexpr float kRouletteBelow =
      0.5f;  ///< throughput behind the first surface below which paths are shortened

  const RayScene& scene;
  const LightSampler& lights;
  glm::vec3 environment;
  int bounces;
  bool roulette;
  float occlusionDistance;  ///< m; not positive: no occlusion ray

  template <class Rays>
  PathSample trace(Rays& rays, RandomStream& random, const glm::vec3& origin,
                   const glm::vec3& direction) const;

 private:
  /// Light of one chosen emitter that reaches a surface.
  struct NextEvent {
    glm::vec3 diffuse{0.0f};  ///< W/(sr m^2), to be multiplied by the albedo
    glm::vec3 glossy{0.0f};   ///< reflected radiance
  };
  template <class Rays>
  NextEvent nextEvent(Rays& rays, RandomStream& random, const Surface& surface) const;
};

template <class Rays>
Integrator::NextEvent Integrator::nextEvent(Rays& rays, RandomStream& random, const Surface& surface) const {
  const LightSample light = lights.sample(scene, surface, random);
  if (!light.shines) return {};
  const Reflectance reflectance = reflectanceTowards(surface, light.direction);
  if (reflectance.density == 0.0f) return {};
  if (rays.occluded(surface.position, light.shadowDirection, light.shadowReach)) return {};
  // Only emissive triangles can also be met by a reflected ray; for other lights the ratio is zero and the
  // weight one.
  const float weight = powerHeuristic(reflectance.density * light.inverseDensity);
  return {weight * reflectance.lambert * light.irradiance, weight * reflectance.glossy * light.irradiance};
}

template <class Rays>
PathSample Integrator::trace(Rays& rays, RandomStream& random, const glm::vec3& origin,
                             const glm::vec3& direction) const {
  PathSample result;
  Hit hit;
  if (!rays.closestHit(origin, direction, hit)) {
    result.direct = environment;
    return result;
  }
  result.direct = scene.emissionTowards(scene.triangles[hit.triangle], direction);
  Surface surface;
  scene.surfaceAt(hit, direction, surface);

  if (occlusionDistance > 0.0f) {
    const float u1 = random.uniform(), u2 = random.uniform();
    const glm::vec3 probe = sampleCosine(surface.normal, u1, u2);
    const bool open = glm::dot(probe, surface.geometricNormal) > 0.0f &&
                      !rays.occluded(surface.position, probe, occlusionDistance);
    result.unoccluded = open ? 1.0f : 0.0f;
  }

  // Throughput of the first surface's lobes, and of the path behind it; radiance that arrives at the first
  // surface over exactly one and over any number of bounces.
  glm::vec3 firstDiffuse(0.0f), firstGlossy(0.0f), throughput(1.0f);
  glm::vec3 arrivingOnce(0.0f), arriving(0.0f);
  const auto arrive = [&](const glm::vec3& radiance, int bounce) {
    arriving += throughput * radiance;
    if (bounce == 1) arrivingOnce += throughput * radiance;
  };
  for (int depth = 0;; ++depth) {
    const NextEvent event = lights.empty() ? NextEvent{} : nextEvent(rays, random, surface);
    surface.readTexture();
    const glm::vec3 reflected = event.diffuse * surface.diffuse + event.glossy;
    if (depth == 0) {
      result.direct += reflected;
    } else {
      arrive(reflected, depth);
    }
    // Behind the last surface a ray is of use only to meet emissive triangles, the other half of next-event
    // estimation.
    const bool last = depth == bounces;
    if (last && !lights.hasEmitters()) break;

    const ReflectionSample reflection = sampleReflection(surface, random);
    if (reflection.density == 0.0f) break;
    if (depth == 0) {
      firstDiffuse = reflection.diffuse;
      firstGlossy = reflection.glossy;
    } else {
      throughput *= reflection.diffuse + reflection.glossy;
      // Russian roulette once little of the path's radiance is left; survivors stand for the others.
      const float largest = std::max({throughput.x, throughput.y, throughput.z});
      if (roulette && largest < kRouletteBelow) {
        const float survival = largest / kRouletteBelow;
        if (random.uniform() >= survival) break;
        throughput *= 1.0f / survival;
      }
    }

    if (!rays.closestHit(surface.position, reflection.direction, hit)) {
      if (!last) arrive(environment, depth + 1);
      break;
    }
    const TriangleRecord& triangle = scene.triangles[hit.triangle];
    const glm::vec3 emission = scene.emissionTowards(triangle, reflection.direction);
    if (emission != glm::vec3(0.0f)) {
      const float cosine = -glm::dot(triangle.normal, reflection.direction);
      const float density = LightSampler::density(triangle, hit.distance * hit.distance, cosine);
      const glm::vec3 met = powerHeuristic(density / reflection.density) * emission;
      if (depth == 0) {
        result.direct += (firstDiffuse + firstGlossy) * met;
      } else {
        arrive(met, depth);
      }
    }
    if (last) break;
    scene.surfaceAt(hit, reflection.direction, surface);
  }
  result.oneBounceDiffuse = firstDiffuse * arrivingOnce;
  result.oneBounceGlossy = firstGlossy * arrivingOnce;
  result.indirectDiffuse = firstDiffuse * arriving;
  result.indirectGlossy = firstGlossy * arriving;
  return result;
}

}  // namespace lumivox::reference
