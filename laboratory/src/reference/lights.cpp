#include "reference/lights.h"

#include <algorithm>
#include <cmath>

namespace lumivox::reference {
namespace {

/// Length of a shadow ray towards a light without extent over its distance, so that a surface under the light
/// does not hide it. The gap exceeds the rounding of single precision.
constexpr float kReachOfPoint = 1.0f - 1e-5f;

/// Flux of a light without extent, W: the weight of choosing it, not a radiometric result.
double fluxOf(const LightState& light, double sceneRadius) {
  constexpr double pi = std::numbers::pi;
  switch (light.kind) {
    case LightKind::directional:
      return meanOf(light.power) * pi * sceneRadius * sceneRadius;
    case LightKind::point:
      return meanOf(light.power) * 4.0 * pi;
    case LightKind::spot:
      return meanOf(light.power) * 2.0 * pi * (1.0 - std::cos(0.5 * (light.innerAngle + light.outerAngle)));
  }
  return 0.0;
}

}  // namespace

AliasTable::AliasTable(std::vector<double> weights) {
  const std::size_t count = weights.size();
  double sum = 0.0;
  for (const double weight : weights) sum += weight;
  std::vector<double>& scaled = weights;
  std::vector<std::uint32_t> small, large;
  slots_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    scaled[i] = weights[i] / sum * static_cast<double>(count);
    slots_[i] = {0u, static_cast<std::uint32_t>(i)};  // its own alias
    (scaled[i] < 1.0 ? small : large).push_back(static_cast<std::uint32_t>(i));
  }
  while (!small.empty() && !large.empty()) {
    const std::uint32_t less = small.back(), more = large.back();
    small.pop_back();
    slots_[less] = {static_cast<std::uint32_t>(std::min(scaled[less] * 0x1.0p32, 4294967295.0)), more};
    scaled[more] -= 1.0 - scaled[less];
    if (scaled[more] < 1.0) {
      large.pop_back();
      small.push_back(more);
    }
  }
}

/// scene.h: smoothstep(cos outer, cos inner, cos theta); a step where both angles are equal.
float LightSampler::PreparedLight::falloffTowards(float cosine) const {
  if (cosine >= cosineInner) return 1.0f;
  if (cosine <= cosineOuter) return 0.0f;
  const float t = (cosine - cosineOuter) / (cosineInner - cosineOuter);
  return t * t * (3.0f - 2.0f * t);
}

LightSampler::LightSampler(RayScene& scene, const SceneSnapshot& snapshot,
                           const EnvironmentLight& environment)
    : environment_(environment) {
  for (const LightState& light : snapshot.lights) {
    lights_.push_back({light, std::cos(light.innerAngle), std::cos(light.outerAngle)});
  }
  const double radius =
      std::max(0.5 * glm::length(glm::dvec3(snapshot.bounds.high) - glm::dvec3(snapshot.bounds.low)), 1e-30);
  std::vector<double> flux;
  for (std::size_t i = 0; i < lights_.size(); ++i) {
    const double value = fluxOf(lights_[i].state, radius);
    if (value <= 0.0) continue;
    choices_.push_back({Choice::Kind::point, static_cast<std::uint32_t>(i), 0.0f});
    flux.push_back(value);
  }
  if (environment.sampled()) {  // each direction lights the disc that the scene shows to it
    choices_.push_back({Choice::Kind::environment, 0, 0.0f});
    flux.push_back(environment.total() * std::numbers::pi * radius * radius);
  }
  const std::size_t firstTriangle = choices_.size();
  double emittedFlux = 0.0;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const TriangleRecord& triangle = scene.triangles[i];
    if (!scene.materials[triangle.material].emissive) continue;
    const double area = 0.5 * glm::length(glm::cross(glm::dvec3(triangle.edge1), glm::dvec3(triangle.edge2)));
    const double value = meanOf(scene.materials[triangle.material].emission) * std::numbers::pi * area;
    if (value <= 0.0) continue;
    choices_.push_back({Choice::Kind::triangle, static_cast<std::uint32_t>(i), 0.0f});
    flux.push_back(value);
    emittedFlux += value;
  }
  emitters_ = choices_.size() - firstTriangle;
  if (choices_.empty()) return;

  // Half of the choices go by flux, half evenly among the lights (all emissive triangles count as one), so
  // that a sun outside does not starve a lamp indoors.
  double totalFlux = 0.0;
  for (const double value : flux) totalFlux += value;
  const double share = 0.5 / static_cast<double>(firstTriangle + (emitters_ > 0 ? 1 : 0));
  for (std::size_t i = 0; i < choices_.size(); ++i) {
    const bool isTriangle = choices_[i].kind == Choice::Kind::triangle;
    const double even = isTriangle ? share * flux[i] / emittedFlux : share;
    const double probability = 0.5 * flux[i] / totalFlux + even;
    flux[i] = probability;
    choices_[i].inverseProbability = static_cast<float>(1.0 / probability);
    if (choices_[i].kind == Choice::Kind::environment)
      environmentProbability_ = static_cast<float>(probability);
    if (isTriangle) {
      TriangleRecord& triangle = scene.triangles[choices_[i].index];
      const double area =
          0.5 * glm::length(glm::cross(glm::dvec3(triangle.edge1), glm::dvec3(triangle.edge2)));
      triangle.emitterDensity = static_cast<float>(probability / area);
    }
  }
  choice_ = AliasTable(flux);
}

LightSample LightSampler::sample(const RayScene& scene, const glm::vec3& position,
                                 RandomStream& random) const {
  std::uint32_t chosen = 0;
  if (choices_.size() > 1) {
    const std::uint32_t slotBits = random.bits(), choiceBits = random.bits();
    chosen = choice_.pick(slotBits, choiceBits);
  }
  const Choice& choice = choices_[chosen];
  switch (choice.kind) {
    case Choice::Kind::triangle:
      return sampleTriangle(scene, position, choice, random);
    case Choice::Kind::environment:
      return sampleEnvironment(random);
    case Choice::Kind::point:
      break;
  }
  return sampleLight(choice, position);
}

LightSample LightSampler::sampleEnvironment(RandomStream& random) const {
  const EnvironmentLight::Sample sample = environment_.sample(random);
  LightSample result;
  result.direction = result.shadowDirection = sample.direction;
  result.shadowReach = std::numeric_limits<float>::infinity();
  result.inverseDensity = 1.0f / (environmentProbability_ * sample.density);
  result.irradiance = result.inverseDensity * sample.radiance;
  result.ofEnvironment = true;
  result.shines = true;
  return result;
}

LightSample LightSampler::sampleTriangle(const RayScene& scene, const glm::vec3& position,
                                         const Choice& choice, RandomStream& random) const {
  LightSample result;
  const TriangleRecord& triangle = scene.triangles[choice.index];
  const SurfaceMaterial& material = scene.materials[triangle.material];
  // Uniform over the parallelogram, its far half folded back. Turk 1990, "Generating random points in
  // triangles", method 2.
  float u = random.uniform(), v = random.uniform();
  const auto beyond =
      static_cast<float>(u + v > 1.0f);  // no branch, since half of them would be mispredicted
  u += beyond * (1.0f - 2.0f * u);
  v += beyond * (1.0f - 2.0f * v);
  // The shadow ray ends in front of the light, at the offset where rays leave it.
  const glm::vec3 end =
      triangle.corner + u * triangle.edge1 + v * triangle.edge2 + triangle.offset * triangle.normal;
  const glm::vec3 path = end - position;
  const float squaredDistance = glm::dot(path, path);
  // Density per solid angle of a light seen head on. It is 0 where the point lies on the light itself.
  const float headOn = triangle.emitterDensity * squaredDistance;
  if (!(headOn > 1e-18f)) return result;
  result.direction = (1.0f / std::sqrt(squaredDistance)) * path;
  const float cosine = -glm::dot(triangle.normal, result.direction);
  if (!(cosine > 0.0f)) return result;
  if (material.maskTexture != nullptr && scene.cutOut(choice.index, u, v)) return result;
  result.inverseDensity = cosine / headOn;
  result.irradiance = result.inverseDensity * material.emission;
  result.shadowDirection = path;
  result.shadowReach = 1.0f;
  result.shines = true;
  return result;
}

LightSample LightSampler::sampleLight(const Choice& choice, const glm::vec3& position) const {
  const PreparedLight& prepared = lights_[choice.index];
  const LightState& light = prepared.state;
  LightSample result;
  if (light.kind == LightKind::directional) {
    result.direction = result.shadowDirection = -light.direction;
    result.shadowReach = std::numeric_limits<float>::infinity();
    result.shines = true;
    result.irradiance = choice.inverseProbability * light.power;
    return result;
  }
  const glm::vec3 path = light.position - position;
  const float squaredDistance = glm::dot(path, path);
  if (!(squaredDistance > 0.0f)) return result;
  result.direction = (1.0f / std::sqrt(squaredDistance)) * path;
  result.shadowDirection = path;
  result.shadowReach = kReachOfPoint;
  const float falloff = light.kind == LightKind::spot
                            ? prepared.falloffTowards(-glm::dot(result.direction, light.direction))
                            : 1.0f;
  result.irradiance = (choice.inverseProbability * falloff / squaredDistance) * light.power;
  result.shines = falloff > 0.0f;
  return result;
}

}  // namespace lumivox::reference
