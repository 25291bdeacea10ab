// Surfaces with Phong lobes: what they reflect, by quadrature, and scenes made of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "support/passes.h"
#include "support/scene_builder.h"

namespace lumivox::test {

/// Share of light that a Phong lobe of albedo 1 reflects, by quadrature over the hemisphere about its mirror
/// direction, which is tilted by the angle of incidence.
inline double reflectedShare(double exponent, double cosine) {
  constexpr int kRings = 1000, kTurns = 400;
  const double sine = std::sqrt(1.0 - cosine * cosine);
  double sum = 0.0;
  for (int i = 0; i < kRings; ++i) {
    // Uniform in cos^(n + 1) of the angle, which makes all rings weigh the same.
    const double along = std::pow((i + 0.5) / kRings, 1.0 / (exponent + 1.0)),
                 across = std::sqrt(1.0 - along * along);
    for (int k = 0; k < kTurns; ++k)
      sum += std::max(0.0, cosine * along + sine * across * std::cos(2.0 * kPi * (k + 0.5) / kTurns));
  }
  return (exponent + 2.0) / (exponent + 1.0) * sum / (kRings * kTurns);
}

/// A committed scene with every surface polished.
inline Scene polished(const std::string& name) {
  Scene scene = committed(name);
  for (Material& material : scene.materials) {
    material.diffuse *= 0.6f;
    material.specular = glm::vec3(0.35f);
    material.exponent = 30.0f;
  }
  return scene;
}

}  // namespace lumivox::test
