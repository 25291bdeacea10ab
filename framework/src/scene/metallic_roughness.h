// Metallic-roughness materials (glTF 2.0, Appendix B: Lambert under a dielectric layer, and a GGX lobe with
// Schlick's Fresnel term) as Lambert plus normalised Phong.
#pragma once

#include <glm/glm.hpp>

#include "lumivox/scene/scene.h"

namespace lumivox {

struct MetallicRoughness {
  glm::vec3 baseColour{1.0f};  ///< linear
  float metallic = 1.0f, roughness = 1.0f;
};

/// Reflectance of dielectrics at normal incidence: of a refractive index of 1.5.
inline constexpr double kDielectricReflectance = 0.04;

/// The factors of the diffuse and the specular lobe, each the lobe's albedo at normal incidence, and the
/// exponent of equal lobe width.
struct PhongLobes {
  glm::vec3 diffuse{0.0f}, specular{0.0f};
  float exponent = 0.0f;
};
PhongLobes phongLobesOf(const MetallicRoughness& material);

/// Phong exponent about the mirror direction whose lobe is as wide as that of GGX: with a = roughness^2, the
/// density of slopes tan(h) of half vectors halves at tan^2 h = (sqrt 2 - 1) a^2. A half vector at h mirrors
/// the normal direction to 2 h, so cos^n(2 h) = 1/2.
double exponentOfRoughness(double roughness);

}  // namespace lumivox
