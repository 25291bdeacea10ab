#include "scene/metallic_roughness.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene/limits.h"

namespace lumivox {
namespace {

constexpr int kSteps = 128;  // of the quadratures: four digits at every roughness

double schlick(double reflectance, double cosine) {
  return reflectance + (1.0 - reflectance) * std::pow(1.0 - cosine, 5.0);
}

/// Masking of Smith for GGX, one direction.
double smith(double alpha, double cosine) {
  const double tangent2 = 1.0 / (cosine * cosine) - 1.0;
  return 2.0 / (1.0 + std::sqrt(1.0 + alpha * alpha * tangent2));
}

/// Albedo at normal incidence of the GGX lobe. Half vectors at angle h are drawn with density D cos h:
/// tan^2 h = a^2 u / (1 - u). Light leaves at 2 h, above the surface where h < 45 degrees. Returns the parts
/// that do and do not scale with the reflectance at normal incidence.
glm::dvec2 specularAlbedo(double alpha) {
  glm::dvec2 sum(0.0);
  for (int i = 0; i < kSteps; ++i) {
    const double u = (i + 0.5) / kSteps;
    const double cosine = 1.0 / std::sqrt(1.0 + alpha * alpha * u / (1.0 - u));  // of h
    const double outgoing = 2.0 * cosine * cosine - 1.0;
    if (outgoing <= 0.0) continue;
    // D G F / (4 cos o cos i) * cos o * 4 cos h dh = G F * (D cos h dh), for i along the normal.
    const double fresnel = schlick(0.0, cosine);
    sum += smith(alpha, outgoing) * glm::dvec2(1.0 - fresnel, fresnel);
  }
  return sum / static_cast<double>(kSteps);
}

/// The share of diffuse light that the dielectric layer lets out, for light along the normal.
double diffuseTransmission() {
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double outgoing = std::sqrt((i + 0.5) / kSteps);  // cosines with the density of Lambert's law
    sum += 1.0 - schlick(kDielectricReflectance, std::sqrt(0.5 * (1.0 + outgoing)));
  }
  return sum / kSteps;
}

}  // namespace

double exponentOfRoughness(double roughness) {
  const double alpha = roughness * roughness;
  const double tangent2 = (std::numbers::sqrt2 - 1.0) * alpha * alpha;
  // cos 2h = (1 - tan^2 h) / (1 + tan^2 h)
  const double logarithm = std::log1p(-tangent2) - std::log1p(tangent2);
  if (-logarithm * kLargestExponent < std::numbers::ln2) return kLargestExponent;
  return -std::numbers::ln2 / logarithm;
}

PhongLobes phongLobesOf(const MetallicRoughness& material) {
  static const double transmission = diffuseTransmission();
  const double metallic = std::clamp<double>(material.metallic, 0.0, 1.0);
  const double roughness = std::clamp<double>(material.roughness, 0.0, 1.0);
  const glm::dvec3 base = glm::clamp(glm::dvec3(material.baseColour), 0.0, 1.0);
  const glm::dvec3 reflectance = glm::mix(glm::dvec3(kDielectricReflectance), base, metallic);
  const glm::dvec2 parts = specularAlbedo(std::max(roughness * roughness, 1e-4));
  PhongLobes lobes;
  lobes.specular = glm::vec3(reflectance * parts.x + glm::dvec3(parts.y));
  lobes.diffuse = glm::vec3(base * ((1.0 - metallic) * transmission));
  const glm::vec3 sum = lobes.diffuse + lobes.specular;
  for (int i = 0; i < 3; ++i)
    if (sum[i] > 1.0f) lobes.diffuse[i] = std::max(0.0f, 1.0f - lobes.specular[i]);
  lobes.exponent = static_cast<float>(exponentOfRoughness(roughness));
  return lobes;
}

}  // namespace lumivox
