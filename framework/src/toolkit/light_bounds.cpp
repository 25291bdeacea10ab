#include "lumivox/toolkit/light_bounds.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "lumivox/toolkit/light_samples.h"

namespace lumivox {
namespace {

float largest(const glm::vec3& v) {
  return std::max({v.x, v.y, v.z});
}

}  // namespace

float largestRadiance(const Scene& scene, const SceneSnapshot& snapshot, float nearest) {
  float sum = 0.0f;
  for (const LightState& light : snapshot.lights) {
    const float irradiance = light.kind == LightKind::directional
                                 ? largest(light.power)
                                 : largest(light.power) / (nearest * nearest);
    sum += irradiance / glm::pi<float>();  // the albedo is at most 1
  }
  // Area lights fill at most the hemisphere: the irradiance is at most pi times their radiance.
  float brightest = 0.0f;
  for (const Object& object : scene.objects) {
    for (const Part& part : object.parts) {
      brightest =
          std::max(brightest, largest(scene.materials[static_cast<std::size_t>(part.material)].emission));
    }
  }
  sum += brightest;
  return sum > 0.0f ? sum : 1.0f;
}

float largestFlux(const Scene& scene, const SceneSnapshot& snapshot) {
  const float radius = 0.5f * glm::length(snapshot.bounds.high - snapshot.bounds.low) * 1.01f;
  constexpr int kEmitters = 64;  // samples of the emissive triangles; only their sum matters
  float sum = 0.0f;
  for (const LightSampleData& light : sampleLights(scene, snapshot, kEmitters, 1).samples) {
    const float power = largest(light.power);
    // Power of a directional light through the sphere around the scene, of a point over all directions, of a
    // Lambert emitter over its hemisphere.
    if (light.kind == LightSampleKind::directional) sum += power * glm::pi<float>() * radius * radius;
    if (light.kind == LightSampleKind::point || light.kind == LightSampleKind::spot)
      sum += power * 4.0f * glm::pi<float>();
    // Samples are chosen by luminance; the factor 2 covers emitters of other colours.
    if (light.kind == LightSampleKind::area) sum += 2.0f * power * glm::pi<float>();
  }
  return sum > 0.0f && std::isfinite(sum) ? sum : 1.0f;
}

}  // namespace lumivox
