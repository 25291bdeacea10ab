// Reflection at a surface: Lambert diffuse/pi plus Phong specular (n+2)/(2 pi) max(0, cos a)^n, a from the
// mirror direction of the viewing direction (scene.h, Material); with n = 0 the lobe is constant over the
// hemisphere around that direction and 0 beyond it, as in shaders/common/brdf.glsl. Directions below the
// interpolated or the geometric horizon reflect nothing.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "lumivox/base/random.h"
#include "reference/ray_scene.h"
#include "reference/sampling.h"

namespace lumivox::reference {

/// Both lobes towards one direction.
struct Reflectance {
  float lambert = 0.0f;    ///< 1/sr, cosine at the surface over pi: to be multiplied by the albedo
  glm::vec3 glossy{0.0f};  ///< 1/sr, times the cosine at the surface
  float density = 0.0f;    ///< 1/sr, at which sampleReflection gives this direction; 0 below the horizon
};

inline Reflectance reflectanceTowards(const Surface& surface, const glm::vec3& direction) {
  Reflectance result;
  const float cosine = glm::dot(surface.normal, direction);
  if (!(cosine > 0.0f) || !(glm::dot(surface.geometricNormal, direction) > 0.0f)) return result;
  result.lambert = cosine * (1.0f / kPi);
  result.density = result.lambert;
  if (surface.glossy) {
    const float mirrorCosine = glm::dot(surface.mirror, direction);
    // Beyond the mirror hemisphere the lobe is 0 and nothing is sampled. The cosine decides, because with
    // exponent 0 the power of a cosine clamped to 0 would be 1.
    const float lobe = mirrorCosine > 0.0f ? std::pow(mirrorCosine, surface.exponent) * (0.5f / kPi) : 0.0f;
    result.glossy = ((surface.exponent + 2.0f) * lobe * cosine) * surface.specular;
    result.density = glm::mix(result.density, (surface.exponent + 1.0f) * lobe, surface.glossyProbability);
  }
  return result;
}

struct ReflectionSample {
  glm::vec3 direction;
  glm::vec3 diffuse{0.0f}, glossy{0.0f};  ///< throughput of each lobe: reflectance over density
  float density = 0.0f;                   ///< 1/sr; 0: the path ends
};

/// Samples a direction by the sum of both lobes, with the throughput of each. Precondition: the texture was
/// read.
inline ReflectionSample sampleReflection(const Surface& surface, RandomStream& random) {
  ReflectionSample result;
  if (!surface.glossy) {
    if (surface.diffuse == glm::vec3(0.0f)) return result;
    const float u1 = random.uniform(), u2 = random.uniform();
    result.direction = sampleCosine(surface.normal, u1, u2);
    if (!(glm::dot(surface.geometricNormal, result.direction) > 0.0f)) return result;
    result.density = glm::dot(surface.normal, result.direction) * (1.0f / kPi);
    result.diffuse = surface.diffuse;  // the cosine and pi cancel
    return result;
  }
  const bool glossy = random.uniform() < surface.glossyProbability;
  const float u1 = random.uniform(), u2 = random.uniform();
  result.direction = glossy ? samplePowerCosine(surface.mirror, surface.exponent, u1, u2)
                            : sampleCosine(surface.normal, u1, u2);
  const Reflectance reflectance = reflectanceTowards(surface, result.direction);
  if (!(reflectance.density > 0.0f)) return result;
  result.density = reflectance.density;
  const float inverseDensity = 1.0f / reflectance.density;
  result.diffuse = inverseDensity * reflectance.lambert * surface.diffuse;
  result.glossy = inverseDensity * reflectance.glossy;
  return result;
}

}  // namespace lumivox::reference
