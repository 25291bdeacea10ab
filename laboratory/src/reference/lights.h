// Chooses a light and a point on it for next-event estimation.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include "lumivox/base/random.h"
#include "reference/environment.h"
#include "reference/ray_scene.h"
#include "reference/sampling.h"

namespace lumivox::reference {

/// One light seen from a point.
struct LightSample {
  bool shines = false;   ///< whether the light can reach the point; otherwise the other members are not set
  glm::vec3 direction;   ///< unit, from the point towards the light
  glm::vec3 irradiance;  ///< on a plane that faces the light, divided by the probability of the choice
  float inverseDensity = 0.0f;  ///< sr; inverse density of this direction among those to emissive triangles
                                ///< or the environment; 0 for a light without extent
  bool ofEnvironment = false;   ///< its light counts as one bounce more
  glm::vec3 shadowDirection;    ///< not unit: for the shadow ray
  float shadowReach = 0.0f;     ///< in lengths of shadowDirection

  /// The whole way to the light, m.
  float reach() const {
    return std::isinf(shadowReach) ? shadowReach : shadowReach * glm::length(shadowDirection);
  }
};

class LightSampler {
 public:
  /// Sets emitterDensity of the scene's triangles.
  LightSampler(RayScene& scene, const SceneSnapshot& snapshot, const EnvironmentLight& environment);

  bool empty() const { return choice_.empty(); }
  bool hasEmitters() const { return emitters_ > 0; }

  /// Chooses a light for this point.
  LightSample sample(const RayScene& scene, const glm::vec3& position, RandomStream& random) const;

  /// The density, 1/sr, with which sample() picks the direction to this point of an emissive triangle.
  static float density(const TriangleRecord& triangle, float squaredDistance, float cosineAtLight) {
    return triangle.emitterDensity * squaredDistance / cosineAtLight;
  }

  /// The density, 1/sr, with which sample() picks a direction of this radiance of the environment; 0 if that
  /// is not sampled.
  float environmentDensity(const glm::vec3& radiance) const {
    return environmentProbability_ > 0.0f ? environmentProbability_ * environment_.density(radiance) : 0.0f;
  }

 private:
  struct Choice {
    enum class Kind { point, triangle, environment } kind;
    std::uint32_t index;
    float inverseProbability;
  };
  LightSample sampleTriangle(const RayScene& scene, const glm::vec3& position, const Choice& choice,
                             RandomStream& random) const;
  LightSample sampleEnvironment(RandomStream& random) const;
  LightSample sampleLight(const Choice& choice, const glm::vec3& position) const;

  /// A light without extent, with the cosines of a spot's angles.
  struct PreparedLight {
    LightState state;
    float cosineInner, cosineOuter;
    float falloffTowards(float cosine) const;
  };
  const EnvironmentLight& environment_;
  float environmentProbability_ = 0.0f;  ///< of its choice
  std::vector<PreparedLight> lights_;
  std::vector<Choice> choices_;
  AliasTable choice_;
  std::size_t emitters_ = 0;
};

}  // namespace lumivox::reference
