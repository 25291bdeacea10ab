// Light from beyond the scene: constant, or a map that is also sampled.
#pragma once

#include <glm/glm.hpp>
#include <memory>

#include "lumivox/base/random.h"
#include "lumivox/scene/scene.h"
#include "reference/sampling.h"

namespace lumivox::reference {

class EnvironmentLight {
 public:
  explicit EnvironmentLight(const Scene& scene);

  /// Whether directions are sampled. A constant environment is met by reflected rays alone.
  bool sampled() const { return map_ != nullptr; }
  /// Radiance that arrives against a unit direction, W/(sr m^2).
  glm::vec3 towards(const glm::vec3& direction) const {
    return map_ != nullptr ? map_->towards(direction) : constant_;
  }
  /// Mean of the channels, summed over the sphere, W/m^2.
  double total() const { return total_; }

  struct Sample {
    glm::vec3 direction;  ///< unit, towards the light
    glm::vec3 radiance;
    float density;  ///< 1/sr
  };
  /// A direction with a density proportional to the mean of the channels: a texel by radiance times solid
  /// angle, and a point in it evenly by solid angle.
  Sample sample(RandomStream& random) const;
  /// The density, 1/sr, with which sample() picks a direction of this radiance.
  float density(const glm::vec3& radiance) const;

 private:
  glm::vec3 constant_;
  std::shared_ptr<const EnvironmentMap> map_;
  double total_ = 0.0;
  AliasTable texels_;
};

}  // namespace lumivox::reference
