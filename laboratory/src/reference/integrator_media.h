// The integrator's paths through participating media; the end of integrator.h.
#pragma once

#include "reference/integrator.h"

namespace lumivox::reference {

/// Samples a direction by the phase function, for light (or a path) that travels along `direction`; `density`
/// receives its density, 1/sr.
inline glm::vec3 scatter(const Collision& collision, const glm::vec3& direction, RandomStream& random,
                         float& density) {
  const float cosine = samplePhaseCosine(collision.anisotropy, random.uniform());
  density = phase(collision.anisotropy, cosine);
  const glm::vec2 side = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)) * pointOfCircle(random.uniform());
  return glm::normalize(aboutAxis(direction, side.x, side.y, cosine));
}

template <class Rays>
glm::vec3 Integrator::nextScattering(Rays& rays, RandomStream& random, const Collision& collision,
                                     const glm::vec3& direction) const {
  if (lights.empty()) return glm::vec3(0.0f);
  const LightSample light = lights.sample(scene, collision.position, random);
  if (!light.shines) return glm::vec3(0.0f);
  if (rays.occluded(collision.position, light.shadowDirection, light.shadowReach)) return glm::vec3(0.0f);
  // The angle lies between the direction of the light and that to the viewer.
  const float density = phase(collision.anisotropy, glm::dot(light.direction, direction));
  const float weight = density * powerHeuristic(density * light.inverseDensity);
  return weight * light.irradiance *
         media.transmittance(collision.position, light.direction, light.reach(), random);
}

template <class Rays, class Arrive>
void Integrator::walk(Rays& rays, RandomStream& random, glm::vec3 origin, glm::vec3 direction, float density,
                      Arrive&& arrive) const {
  glm::vec3 throughput(1.0f);
  bool scattered = false;
  Hit hit;
  Surface surface;
  Collision collision;
  for (int depth = 0;; ++depth) {
    // Behind the last bounce a ray can only meet emissive triangles: the other half of multiple importance
    // sampling.
    const bool last = depth == bounces;
    if (last && !lights.hasEmitters()) return;
    const bool met = rays.closestHit(origin, direction, hit);
    const float reach = met ? hit.distance : std::numeric_limits<float>::infinity();
    if (media.collide(origin, direction, reach, random, throughput, collision)) {
      if (last) return;
      scattered = true;
      arrive(Arrival{throughput * nextScattering(rays, random, collision, direction), depth + 1, scattered});
      direction = scatter(collision, direction, random, density);
      origin = collision.position;
      if (!survives(random, throughput)) return;
      continue;
    }
    if (!met) {
      if (!last) arrive(Arrival{throughput * environment, depth + 1, scattered});
      return;
    }
    const TriangleRecord& triangle = scene.triangles[hit.triangle];
    const glm::vec3 emission = scene.emissionTowards(triangle, direction);
    if (emission != glm::vec3(0.0f)) {
      const float cosine = -glm::dot(triangle.normal, direction);
      const float byLight = LightSampler::density(triangle, hit.distance * hit.distance, cosine);
      arrive(Arrival{throughput * powerHeuristic(byLight / density) * emission, depth, scattered});
    }
    if (last) return;
    scene.surfaceAt(hit, direction, surface);
    const NextEvent event = lights.empty() ? NextEvent{} : nextEvent<true>(rays, random, surface);
    surface.readTexture();
    arrive(Arrival{throughput * (event.diffuse * surface.diffuse + event.glossy), depth + 1, scattered});
    const ReflectionSample reflection = sampleReflection(surface, random);
    if (reflection.density == 0.0f) return;
    throughput *= reflection.diffuse + reflection.glossy;
    if (!survives(random, throughput)) return;
    origin = surface.position;
    direction = reflection.direction;
    density = reflection.density;
  }
}

template <class Rays>
void Integrator::traceSurfaces(Rays& rays, RandomStream& random, const Hit& hit, const glm::vec3& direction,
                               PathSample& result, BounceSums* sums) const {
  result.real = scene.isReal(hit);
  result.direct = scene.emissionTowards(scene.triangles[hit.triangle], direction);
  Surface surface;
  scene.surfaceAt(hit, direction, surface);
  result.unoccluded = unoccludedAt(rays, random, surface);
  const NextEvent event = lights.empty() ? NextEvent{} : nextEvent<true>(rays, random, surface);
  surface.readTexture();
  result.direct += event.diffuse * surface.diffuse + event.glossy;
  const ReflectionSample reflection = sampleReflection(surface, random);
  if (reflection.density == 0.0f) return;
  walk(rays, random, surface.position, reflection.direction, reflection.density, [&](const Arrival& light) {
    const glm::vec3 diffuse = reflection.diffuse * light.radiance,
                    glossy = reflection.glossy * light.radiance;
    if (light.bounces == 0) {
      result.direct += diffuse + glossy;
      return;
    }
    if (sums != nullptr) sums->add(light.bounces, diffuse, glossy, glm::vec3(0.0f));
    result.indirectDiffuse += diffuse;
    result.indirectGlossy += glossy;
    result.lateLight.add(diffuse + glossy, light.bounces, bounces);
    if (light.bounces > 1 || light.scattered) return;
    result.oneBounceDiffuse += diffuse;
    result.oneBounceGlossy += glossy;
  });
}

template <class Rays>
void Integrator::traceScattered(Rays& rays, RandomStream& random, const glm::vec3& origin,
                                const glm::vec3& direction, float reach, MediaPathSample& result,
                                BounceSums* sums) const {
  glm::vec3 weight(1.0f);
  Collision collision;
  if (!media.collide(origin, direction, reach, random, weight, collision)) return;
  result.scatteredSingle = weight * nextScattering(rays, random, collision, direction);
  float density;
  const glm::vec3 onwards = scatter(collision, direction, random, density);
  walk(rays, random, collision.position, onwards, density, [&](const Arrival& light) {
    if (sums != nullptr && light.bounces > 0)
      sums->add(light.bounces, glm::vec3(0.0f), glm::vec3(0.0f), weight * light.radiance);
    (light.bounces == 0 ? result.scatteredSingle : result.scatteredMultiple) += weight * light.radiance;
    result.lateLight.add(weight * light.radiance, light.bounces, bounces);
  });
}

template <class Rays>
MediaPathSample Integrator::traceThroughMedia(Rays& rays, RandomStream& random, const glm::vec3& origin,
                                              const glm::vec3& direction, BounceSums* sums) const {
  MediaPathSample result;
  Hit hit;
  const bool met = rays.closestHit(origin, direction, hit);
  const float reach = met ? hit.distance : std::numeric_limits<float>::infinity();
  result.transmittance = media.transmittance(origin, direction, reach, random);
  traceScattered(rays, random, origin, direction, reach, result, sums);
  if (met) {
    traceSurfaces(rays, random, hit, direction, result.surfaces, sums);
    const LateLight behind = result.surfaces.lateLight.times(result.transmittance);
    result.lateLight.middle += behind.middle;
    result.lateLight.late += behind.late;
  } else {
    result.surfaces.direct = environment;
  }
  return result;
}

}  // namespace lumivox::reference
