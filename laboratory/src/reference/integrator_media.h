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
Integrator::Scattering Integrator::nextScattering(Rays& rays, RandomStream& random,
                                                  const Collision& collision,
                                                  const glm::vec3& direction) const {
  if (lights.empty()) return {};
  const LightSample light = lights.sample(scene, collision.position, random);
  if (!light.shines) return {};
  if (rays.occluded(collision.position, light.shadowDirection, light.shadowReach)) return {};
  // The angle lies between the direction of the light and that to the viewer.
  const float density = phase(collision.anisotropy, glm::dot(light.direction, direction));
  const float weight = density * powerHeuristic(density * light.inverseDensity);
  return {weight * light.irradiance *
              media.transmittance(collision.position, light.direction, light.reach(), random),
          light.ofEnvironment};
}

template <class Rays, class Arrive>
void Integrator::walk(Rays& rays, RandomStream& random, glm::vec3 origin, glm::vec3 direction, float density,
                      Arrive&& arrive) const {
  glm::vec3 throughput(1.0f);
  bool scattered = false;
  Hit hit;
  Surface surface;
  Collision collision;
  // The light of the environment counts as one bounce more than that of the lights.
  const auto arriveUnlessLate = [&](const glm::vec3& radiance, int bounce, bool ofEnvironment) {
    if (ofEnvironment && bounce == bounces) return;
    arrive(Arrival{throughput * radiance, bounce + (ofEnvironment ? 1 : 0), scattered});
  };
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
      const Scattering light = nextScattering(rays, random, collision, direction);
      arriveUnlessLate(light.radiance, depth + 1, light.ofEnvironment);
      direction = scatter(collision, direction, random, density);
      origin = collision.position;
      if (!survives(random, throughput)) return;
      continue;
    }
    if (!met) {
      if (!last) arrive(Arrival{throughput * missed(direction, density), depth + 1, scattered, depth == 0});
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
    arriveUnlessLate(event.diffuse * surface.diffuse + event.glossy, depth + 1, event.ofEnvironment);
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
  const auto addIndirect = [&](const glm::vec3& diffuse, const glm::vec3& glossy, const Arrival& light) {
    if (sums != nullptr) sums->add(light.bounces, diffuse, glossy, glm::vec3(0.0f));
    result.indirectDiffuse += diffuse;
    result.indirectGlossy += glossy;
    result.lateLight.add(diffuse + glossy, light.bounces, bounces);
    if (light.bounces > 1 || light.scattered) return;
    result.oneBounceDiffuse += diffuse;
    result.oneBounceGlossy += glossy;
    if (!light.ofEnvironment) return;
    result.environmentDiffuse += diffuse;
    result.environmentGlossy += glossy;
  };
  const glm::vec3 lit = event.diffuse * surface.diffuse;
  if (!event.ofEnvironment) {
    result.direct += lit + event.glossy;
  } else if (bounces > 0) {
    addIndirect(lit, event.glossy, Arrival{glm::vec3(0.0f), 1, false, true});
  }
  const ReflectionSample reflection = sampleReflection(surface, random);
  if (reflection.density == 0.0f) return;
  walk(rays, random, surface.position, reflection.direction, reflection.density, [&](const Arrival& light) {
    const glm::vec3 diffuse = reflection.diffuse * light.radiance,
                    glossy = reflection.glossy * light.radiance;
    if (light.bounces == 0) {
      result.direct += diffuse + glossy;
      return;
    }
    addIndirect(diffuse, glossy, light);
  });
}

template <class Rays>
void Integrator::traceScattered(Rays& rays, RandomStream& random, const glm::vec3& origin,
                                const glm::vec3& direction, float reach, MediaPathSample& result,
                                BounceSums* sums) const {
  glm::vec3 weight(1.0f);
  Collision collision;
  if (!media.collide(origin, direction, reach, random, weight, collision)) return;
  const auto addMultiple = [&](const glm::vec3& radiance, int bounce) {
    if (sums != nullptr) sums->add(bounce, glm::vec3(0.0f), glm::vec3(0.0f), radiance);
    result.scatteredMultiple += radiance;
    result.lateLight.add(radiance, bounce, bounces);
  };
  const Scattering event = nextScattering(rays, random, collision, direction);
  if (!event.ofEnvironment) {
    result.scatteredSingle = weight * event.radiance;
  } else if (bounces > 0) {
    addMultiple(weight * event.radiance, 1);
  }
  float density;
  const glm::vec3 onwards = scatter(collision, direction, random, density);
  walk(rays, random, collision.position, onwards, density, [&](const Arrival& light) {
    if (light.bounces > 0) {
      addMultiple(weight * light.radiance, light.bounces);
    } else {
      result.scatteredSingle += weight * light.radiance;
    }
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
    result.surfaces.direct = environment.towards(direction);
  }
  return result;
}

}  // namespace lumivox::reference
