// Traces one path and returns all of its components.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "lumivox/base/random.h"
#include "lumivox/reference/path_tracer.h"
#include "reference/lights.h"
#include "reference/media.h"
#include "reference/ray_scene.h"
#include "reference/scattering.h"

namespace lumivox::reference {

/// Light of the late bounces of a path with at most `bounces`: of bounces from a quarter to a half of that
/// number, and of later ones. Their ratio estimates the light beyond the last bounce.
struct LateLight {
  glm::vec3 middle{0.0f}, late{0.0f};

  void add(const glm::vec3& radiance, int bounce, int bounces) {
    if (4 * bounce <= bounces) return;
    (2 * bounce <= bounces ? middle : late) += radiance;
  }
  LateLight times(const glm::vec3& factor) const { return {factor * middle, factor * late}; }
};

/// The contribution of one path to a pixel; radiance, components as in path_tracer.h.
struct PathSample {
  glm::vec3 direct{0.0f};
  glm::vec3 oneBounceDiffuse{0.0f}, oneBounceGlossy{0.0f};
  glm::vec3 indirectDiffuse{0.0f}, indirectGlossy{0.0f};
  float unoccluded = 1.0f;
  /// Part of both of the above: light of the environment that no other surface reflected on its way.
  glm::vec3 environmentDiffuse{0.0f}, environmentGlossy{0.0f};
  bool real = false;  ///< the first surface is of the scene that a capture stands for
  LateLight lateLight;

  glm::vec3 full() const { return direct + indirectDiffuse + indirectGlossy; }
};

/// The same in a scene with media. The light of surfaces excludes the media between camera and first surface,
/// which have members of their own.
struct MediaPathSample {
  PathSample surfaces;
  glm::vec3 transmittance{1.0f};      ///< between the camera and the first surface, or the end of all media
  glm::vec3 scatteredSingle{0.0f};    ///< light of the lights, scattered once by media towards the camera
  glm::vec3 scatteredMultiple{0.0f};  ///< all other light that media scatter to the camera
  LateLight lateLight;                ///< of surfaces and media together

  glm::vec3 scattered() const { return scatteredSingle + scatteredMultiple; }
  glm::vec3 full() const { return transmittance * surfaces.full() + scattered(); }
};

/// The light of one path over up to N bounces, for each N with layers of its own: radiance reflected by the
/// lobes of the first surface, or scattered to the camera by media.
struct BounceSums {
  struct Sum {
    int bounces;
    glm::vec3 diffuse{0.0f}, glossy{0.0f}, scattered{0.0f};
  };
  std::vector<Sum> sums;  ///< in rising order of bounces

  explicit BounceSums(const std::vector<int>& limits) {
    for (const int limit : limits) sums.push_back({limit});
  }
  void clear() {
    for (Sum& sum : sums) sum = {sum.bounces};
  }
  void add(int bounces, const glm::vec3& diffuse, const glm::vec3& glossy, const glm::vec3& scattered) {
    for (Sum& sum : sums) {
      if (bounces > sum.bounces) continue;
      sum.diffuse += diffuse;
      sum.glossy += glossy;
      sum.scattered += scattered;
    }
  }
};

/// Traces the path tracer's rays and counts them.
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
      0.5f;  ///< throughput behind the first surface below which Russian roulette begins

  const RayScene& scene;
  const LightSampler& lights;
  const Media& media;
  const EnvironmentLight& environment;
  int bounces;
  bool roulette;
  float occlusionDistance;  ///< m; not positive: no occlusion ray

  /// `sums`: filled if it is not null.
  template <class Rays>
  PathSample trace(Rays& rays, RandomStream& random, const glm::vec3& origin, const glm::vec3& direction,
                   BounceSums* sums = nullptr) const;

  /// For scenes with media.
  template <class Rays>
  MediaPathSample traceThroughMedia(Rays& rays, RandomStream& random, const glm::vec3& origin,
                                    const glm::vec3& direction, BounceSums* sums = nullptr) const;

 private:
  /// Light of one chosen emitter that reaches a surface.
  struct NextEvent {
    glm::vec3 diffuse{0.0f};  ///< W/(sr m^2), to be multiplied by the albedo
    glm::vec3 glossy{0.0f};   ///< reflected radiance
    bool ofEnvironment = false;
  };
  template <bool ThroughMedia, class Rays>
  NextEvent nextEvent(Rays& rays, RandomStream& random, const Surface& surface) const;

  /// 1 where a cosine-weighted direction is open as far as the occlusion distance, else 0.
  template <class Rays>
  float unoccludedAt(Rays& rays, RandomStream& random, const Surface& surface) const {
    if (!(occlusionDistance > 0.0f)) return 1.0f;
    const float u1 = random.uniform(), u2 = random.uniform();
    const glm::vec3 probe = sampleCosine(surface.normal, u1, u2);
    const bool open = glm::dot(probe, surface.geometricNormal) > 0.0f &&
                      !rays.occluded(surface.position, probe, occlusionDistance);
    return open ? 1.0f : 0.0f;
  }

  /// Light of the environment met by a ray in a direction that was sampled with this density: its half of
  /// multiple importance sampling.
  glm::vec3 missed(const glm::vec3& direction, float density) const {
    const glm::vec3 radiance = environment.towards(direction);
    return powerHeuristic(lights.environmentDensity(radiance) / density) * radiance;
  }

  /// Light that arrives at the start of a walk. `bounces`: reflections and scatterings on its way, a miss
  /// counting as one. `scattered`: whether a medium scattered it.
  struct Arrival {
    glm::vec3 radiance;
    int bounces;
    bool scattered;
    bool ofEnvironment = false;  ///< it comes straight from there
  };
  /// Follows light that arrives at a point through media, from a direction sampled with the given density.
  /// Calls arrive(Arrival) for each contribution.
  template <class Rays, class Arrive>
  void walk(Rays& rays, RandomStream& random, glm::vec3 origin, glm::vec3 direction, float density,
            Arrive&& arrive) const;
  /// Light of one chosen emitter, scattered once at a collision against `direction`, times the weight of the
  /// collision.
  struct Scattering {
    glm::vec3 radiance{0.0f};
    bool ofEnvironment = false;
  };
  template <class Rays>
  Scattering nextScattering(Rays& rays, RandomStream& random, const Collision& collision,
                            const glm::vec3& direction) const;
  template <class Rays>
  void traceSurfaces(Rays& rays, RandomStream& random, const Hit& hit, const glm::vec3& direction,
                     PathSample& result, BounceSums* sums) const;
  template <class Rays>
  void traceScattered(Rays& rays, RandomStream& random, const glm::vec3& origin, const glm::vec3& direction,
                      float reach, MediaPathSample& result, BounceSums* sums) const;
  /// Russian roulette when the throughput is small; survivors are weighted for the others. False: the path
  /// ends.
  bool survives(RandomStream& random, glm::vec3& throughput) const {
    const float largest = std::max({throughput.x, throughput.y, throughput.z});
    if (!(largest > 0.0f)) return false;
    if (!roulette || largest >= kRouletteBelow) return true;
    const float survival = largest / kRouletteBelow;
    if (random.uniform() >= survival) return false;
    throughput *= 1.0f / survival;
    return true;
  }
};

template <bool ThroughMedia, class Rays>
Integrator::NextEvent Integrator::nextEvent(Rays& rays, RandomStream& random, const Surface& surface) const {
  const LightSample light = lights.sample(scene, surface.position, random);
  if (!light.shines) return {};
  const Reflectance reflectance = reflectanceTowards(surface, light.direction);
  if (reflectance.density == 0.0f) return {};
  if (rays.occluded(surface.position, light.shadowDirection, light.shadowReach)) return {};
  // Reflected rays meet emissive triangles and the environment; for other lights the ratio is 0, the
  // weight 1.
  const float weight = powerHeuristic(reflectance.density * light.inverseDensity);
  if constexpr (ThroughMedia) {
    const glm::vec3 irradiance =
        weight * light.irradiance *
        media.transmittance(surface.position, light.direction, light.reach(), random);
    return {reflectance.lambert * irradiance, reflectance.glossy * irradiance, light.ofEnvironment};
  }
  return {weight * reflectance.lambert * light.irradiance, weight * reflectance.glossy * light.irradiance,
          light.ofEnvironment};
}

template <class Rays>
PathSample Integrator::trace(Rays& rays, RandomStream& random, const glm::vec3& origin,
                             const glm::vec3& direction, BounceSums* sums) const {
  PathSample result;
  Hit hit;
  if (!rays.closestHit(origin, direction, hit)) {
    result.direct = environment.towards(direction);
    return result;
  }
  result.real = scene.isReal(hit);
  result.direct = scene.emissionTowards(scene.triangles[hit.triangle], direction);
  Surface surface;
  scene.surfaceAt(hit, direction, surface);

  result.unoccluded = unoccludedAt(rays, random, surface);

  // Throughput of the first surface's lobes and of the path behind it, and radiance that arrives at the first
  // surface over exactly one and over any number of bounces.
  glm::vec3 firstDiffuse(0.0f), firstGlossy(0.0f), throughput(1.0f);
  glm::vec3 arrivingOnce(0.0f), arriving(0.0f);
  glm::vec3 metFirst(0.0f);  // the environment beside the first surface
  LateLight arrivingLate;
  const auto arrive = [&](const glm::vec3& radiance, int bounce) {
    arriving += throughput * radiance;
    arrivingLate.add(throughput * radiance, bounce, bounces);
    if (bounce == 1) arrivingOnce += throughput * radiance;
    if (sums != nullptr)
      sums->add(bounce, firstDiffuse * (throughput * radiance), firstGlossy * (throughput * radiance),
                glm::vec3(0.0f));
  };
  for (int depth = 0;; ++depth) {
    const bool last = depth == bounces;
    const NextEvent event = lights.empty() ? NextEvent{} : nextEvent<false>(rays, random, surface);
    surface.readTexture();
    const glm::vec3 diffuse = event.diffuse * surface.diffuse, reflected = diffuse + event.glossy;
    if (event.ofEnvironment) {
      if (last) {
        // It would be one bounce too many.
      } else if (depth > 0) {
        arrive(reflected, depth + 1);
      } else {
        result.environmentDiffuse = diffuse;
        result.environmentGlossy = event.glossy;
        if (sums != nullptr) sums->add(1, diffuse, event.glossy, glm::vec3(0.0f));
      }
    } else if (depth == 0) {
      result.direct += reflected;
    } else {
      arrive(reflected, depth);
    }
    // Behind the last surface a ray can only meet emissive triangles: the other half of multiple importance
    // sampling.
    if (last && !lights.hasEmitters()) break;

    const ReflectionSample reflection = sampleReflection(surface, random);
    if (reflection.density == 0.0f) break;
    if (depth == 0) {
      firstDiffuse = reflection.diffuse;
      firstGlossy = reflection.glossy;
    } else {
      throughput *= reflection.diffuse + reflection.glossy;
      if (!survives(random, throughput)) break;
    }

    if (!rays.closestHit(surface.position, reflection.direction, hit)) {
      if (last) break;
      const glm::vec3 met = missed(reflection.direction, reflection.density);
      if (depth == 0) metFirst = met;
      arrive(met, depth + 1);
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
  result.oneBounceDiffuse = result.environmentDiffuse + firstDiffuse * arrivingOnce;
  result.oneBounceGlossy = result.environmentGlossy + firstGlossy * arrivingOnce;
  result.indirectDiffuse = result.environmentDiffuse + firstDiffuse * arriving;
  result.indirectGlossy = result.environmentGlossy + firstGlossy * arriving;
  result.lateLight = arrivingLate.times(firstDiffuse + firstGlossy);
  result.lateLight.add(result.environmentDiffuse + result.environmentGlossy, 1, bounces);
  result.environmentDiffuse += firstDiffuse * metFirst;
  result.environmentGlossy += firstGlossy * metFirst;
  return result;
}

}  // namespace lumivox::reference

#include "reference/integrator_media.h"
