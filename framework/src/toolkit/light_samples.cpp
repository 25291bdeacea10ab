#include "lumivox/toolkit/light_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "lumivox/base/low_discrepancy.h"
#include "lumivox/scene/bilinear.h"

namespace lumivox {
namespace {

/// Perspective with z in [0,1], looking along `forward`.
glm::mat4 perspectiveView(const glm::vec3& eye, const glm::vec3& forward, float halfAngle, float near,
                          float far) {
  const glm::vec3 helper = std::abs(forward.y) > 0.9f ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
  return glm::perspectiveRH_ZO(2.0f * halfAngle, 1.0f, near, far) * glm::lookAtRH(eye, eye + forward, helper);
}

/// The six faces in the order of cubeFace() in shaders/common/lights.glsl.
const std::array<glm::vec3, 6> kFaces{glm::vec3(1, 0, 0),  glm::vec3(-1, 0, 0), glm::vec3(0, 1, 0),
                                      glm::vec3(0, -1, 0), glm::vec3(0, 0, 1),  glm::vec3(0, 0, -1)};

/// The distance to the farthest corner of the scene's bounds: no light needs a longer reach.
float reachFrom(const Bounds& bounds, const glm::vec3& point) {
  const glm::vec3 farCorner = glm::max(glm::abs(bounds.low - point), glm::abs(bounds.high - point));
  return std::max(glm::length(farCorner), 1e-6f) * 1.01f;
}

constexpr int kCubeViews = 6;
constexpr float kNearShare = 1e-3f;  // near plane of a perspective shadow view over its far plane

float texelPerMetre(float halfAngle, int size) {
  return 2.0f * std::tan(halfAngle) / static_cast<float>(size);
}

void addCube(LightSet& set, const glm::vec3& eye, const Bounds& bounds, const glm::vec3* front) {
  const float far = reachFrom(bounds, eye);
  for (const glm::vec3& face : kFaces) {
    LightView view;
    view.worldToClip = perspectiveView(eye, face, glm::radians(45.0f), far * kNearShare, far);
    // An area light shines on nothing in the face opposite to its normal, if the whole face is more than 90
    // degrees away: only when the normal is the axis itself.
    view.used = front == nullptr || glm::dot(*front, face) > -0.999f;
    set.views.push_back(view);
  }
}

/// An emissive triangle, of which an alpha mask may cut out holes.
struct Emitter {
  glm::vec3 a, b, c, normal;
  glm::vec3 radiance;
  float area;    ///< m^2, without holes
  float weight;  ///< luminance times area
  const SurfaceTexture* mask = nullptr;
  std::array<glm::vec2, 3> texcoords{};
  glm::vec2 someShiningPoint{0.0f};  ///< barycentric coordinates of b and c; set where there is a mask

  bool shinesAt(const glm::vec2& point) const {
    return mask == nullptr || !cutOut(*mask, texcoords[0] + point.x * (texcoords[1] - texcoords[0]) +
                                                 point.y * (texcoords[2] - texcoords[0]));
  }
};

/// The emissive triangles of one part of an object; they have one material.
struct AreaLight {
  std::vector<Emitter> emitters;
  double weight = 0.0;  ///< sum over its emitters
};

/// Area-uniform on a triangle, as barycentric coordinates of its second and third corner: the unit square
/// folded along its diagonal.
glm::vec2 trianglePoint(int index) {
  auto [u, v] = r2Point(index);
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  return glm::vec2(u, v);
}

/// Most mask look-ups of all emitters together for one set of samples: a few milliseconds.
constexpr std::size_t kMostMaskPoints = std::size_t{1} << 18;

/// The share of a masked emitter that is no hole, estimated at `points` points. The sequence continues from
/// one triangle to the next, so that the error of few points averages out over many leaves.
float shiningShare(Emitter& emitter, std::size_t points, int& sequence) {
  std::size_t shining = 0;
  for (std::size_t i = 0; i < points; ++i) {
    const glm::vec2 point = trianglePoint(++sequence);
    if (!emitter.shinesAt(point)) continue;
    if (shining++ == 0) emitter.someShiningPoint = point;
  }
  return static_cast<float>(shining) / static_cast<float>(points);
}

/// The number of emissive triangles with a mask.
std::size_t maskedEmitters(const Scene& scene) {
  std::size_t count = 0;
  for (const Object& object : scene.objects) {
    for (const Part& part : object.parts) {
      const Material& material = scene.materials[static_cast<std::size_t>(part.material)];
      if (material.emissive() && material.maskTexture >= 0) count += part.indexCount / 3;
    }
  }
  return count;
}

std::vector<AreaLight> areaLightsOf(const Scene& scene, const SceneSnapshot& snapshot) {
  // 2^14 points on one triangle give an error below a thousandth of its area.
  constexpr std::size_t kEnoughPoints = std::size_t{1} << 14, kFewestPoints = 16;
  const std::size_t points = std::clamp(kMostMaskPoints / std::max<std::size_t>(maskedEmitters(scene), 1),
                                        kFewestPoints, kEnoughPoints);
  int maskSequence = 0;
  std::vector<AreaLight> areaLights;
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    const ObjectState& state = snapshot.objects[o];
    for (const Part& part : scene.objects[o].parts) {
      const Material& material = scene.materials[static_cast<std::size_t>(part.material)];
      if (!material.emissive()) continue;
      AreaLight areaLight;
      for (std::uint32_t i = 0; i + 2 < part.indexCount; i += 3) {
        std::array<glm::vec3, 3> corner;
        Emitter emitter{};
        for (std::uint32_t k = 0; k < 3; ++k) {
          const std::uint32_t index = scene.indices[part.firstIndex + i + k];
          const glm::vec3 local = state.positions.empty()
                                      ? scene.positions[index]
                                      : state.positions[index - scene.objects[o].firstVertex];
          corner[k] = glm::vec3(state.toWorld * glm::vec4(local, 1.0f));
          emitter.texcoords[k] = scene.texcoords[index];
        }
        const glm::vec3 cross = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
        const float area = 0.5f * glm::length(cross);
        if (!(area > 0.0f)) continue;
        emitter.a = corner[0], emitter.b = corner[1], emitter.c = corner[2];
        emitter.normal = cross / (2.0f * area);
        emitter.radiance = material.emission;
        emitter.area = area;
        if (material.maskTexture >= 0) {
          emitter.mask = &scene.textures[static_cast<std::size_t>(material.maskTexture)];
          emitter.area *= shiningShare(emitter, points, maskSequence);
          if (!(emitter.area > 0.0f)) continue;
        }
        emitter.weight = emitter.area * glm::dot(material.emission,
                                                 glm::vec3(0.2126f, 0.7152f, 0.0722f));  // Rec. 709 luminance
        areaLight.weight += emitter.weight;
        areaLight.emitters.push_back(emitter);
      }
      if (areaLight.weight > 0.0) areaLights.push_back(std::move(areaLight));
    }
  }
  return areaLights;
}

/// A shining point of a triangle: the next point of the sequence that is no hole.
glm::vec2 pointOn(const Emitter& emitter, int& sequence) {
  constexpr int kMostHoles = 1000;
  for (int tries = 0; tries < kMostHoles; ++tries) {
    const glm::vec2 point = trianglePoint(++sequence);
    if (emitter.shinesAt(point)) return point;
  }
  return emitter.someShiningPoint;
}

/// One sample for each area light, since a dim one may be the only light of a place; the other samples by
/// power.
std::vector<int> samplesOfAreaLights(const std::vector<AreaLight>& areaLights, int count) {
  double total = 0.0;
  for (const AreaLight& areaLight : areaLights) total += areaLight.weight;
  const int shared = count - static_cast<int>(areaLights.size());
  std::vector<int> samples;
  double sum = 0.0;
  int given = 0;
  for (const AreaLight& areaLight : areaLights) {
    sum += areaLight.weight;
    const int upToHere =
        &areaLight == &areaLights.back() ? shared : static_cast<int>(std::lround(shared * (sum / total)));
    samples.push_back(1 + upToHere - given);
    given = upToHere;
  }
  return samples;
}

/// Adds the samples of one area light, stratified by power; together they carry all of its light.
void addAreaLight(LightSet& set, const AreaLight& areaLight, int count, int& sequence, const Bounds& bounds,
                  int shadowSize) {
  std::vector<double> cumulative;
  double sum = 0.0;
  for (const Emitter& emitter : areaLight.emitters)
    cumulative.push_back(sum += emitter.weight / areaLight.weight);
  const float diagonal = glm::length(bounds.high - bounds.low);
  for (int i = 0; i < count; ++i) {
    const double stratum = (i + 0.5) / count;
    const auto found = std::lower_bound(cumulative.begin(), cumulative.end(), stratum);
    const Emitter& emitter = areaLight.emitters[std::min<std::size_t>(
        static_cast<std::size_t>(found - cumulative.begin()), areaLight.emitters.size() - 1)];
    const glm::vec2 point = pointOn(emitter, sequence);
    const glm::vec3 onSurface =
        emitter.a + point.x * (emitter.b - emitter.a) + point.y * (emitter.c - emitter.a);
    const glm::vec3 position = onSurface + emitter.normal * (1e-5f * diagonal);
    const double probability = emitter.weight / areaLight.weight;
    const float area =
        static_cast<float>(emitter.area / (probability * count));  // area that the sample represents
    // The inverse square law of a point fails nearer than the radius of the sample's patch.
    const float patchRadius = std::sqrt(area / glm::pi<float>());
    set.samples.push_back({position, LightSampleKind::area, emitter.normal,
                           static_cast<int>(set.views.size()), emitter.radiance * area, kCubeViews,
                           1.0f / static_cast<float>(count), 0.0f,
                           texelPerMetre(glm::radians(45.0f), shadowSize), patchRadius * patchRadius});
    addCube(set, position, bounds, &emitter.normal);
  }
}

/// Holes of masks count as shining area.
LightDisc discOf(const AreaLight& areaLight) {
  LightDisc disc;
  const auto part = [&](const Emitter& emitter) {
    return static_cast<float>(emitter.weight / areaLight.weight);
  };
  for (const Emitter& emitter : areaLight.emitters) {
    disc.centre += part(emitter) / 3.0f * (emitter.a + emitter.b + emitter.c);
    disc.normal += part(emitter) * emitter.normal;
  }
  float meanSquare = 0.0f;
  for (const Emitter& emitter : areaLight.emitters) {
    // Over a triangle the mean of |p - c|^2 is (|a - c|^2 + |b - c|^2 + |c' - c|^2 + |a + b + c' - 3 c|^2)
    // / 12.
    const glm::vec3 a = emitter.a - disc.centre, b = emitter.b - disc.centre, c = emitter.c - disc.centre,
                    sum = a + b + c;
    meanSquare +=
        part(emitter) / 12.0f * (glm::dot(a, a) + glm::dot(b, b) + glm::dot(c, c) + glm::dot(sum, sum));
  }
  disc.radius = std::sqrt(2.0f * meanSquare);  // over a disc it is half the square of the radius
  return disc;
}

/// Adds a disc for each sample that has none.
void addDiscOfEachSample(LightSet& set) {
  for (std::size_t i = set.discs.size(); i < set.samples.size(); ++i) {
    const LightSampleData& sample = set.samples[i];
    set.discs.push_back(
        {sample.position, std::sqrt(sample.patchRadiusSquared), sample.direction, static_cast<int>(i), 1});
  }
}

void addAreaLights(LightSet& set, const Scene& scene, const SceneSnapshot& snapshot, int count,
                   int shadowSize) {
  std::vector<AreaLight> areaLights = areaLightsOf(scene, snapshot);
  if (areaLights.empty()) return;
  const bool eachItsDisc = static_cast<int>(areaLights.size()) <= count;
  if (!eachItsDisc) {
    // Too many area lights for a sample each: all emitters become one area light, and the dimmest may get no
    // sample.
    AreaLight all;
    for (const AreaLight& areaLight : areaLights) {
      all.emitters.insert(all.emitters.end(), areaLight.emitters.begin(), areaLight.emitters.end());
      all.weight += areaLight.weight;
    }
    areaLights = {std::move(all)};
  }
  const std::vector<int> samples = samplesOfAreaLights(areaLights, count);
  int sequence = 0;
  for (std::size_t i = 0; i < areaLights.size(); ++i) {
    if (eachItsDisc) {
      set.discs.push_back(discOf(areaLights[i]));
      set.discs.back().firstSample = static_cast<int>(set.samples.size());
      set.discs.back().sampleCount = samples[i];
    }
    addAreaLight(set, areaLights[i], samples[i], sequence, snapshot.bounds, shadowSize);
  }
  if (!eachItsDisc) addDiscOfEachSample(set);
}

void addDirectional(LightSet& set, const LightState& light, const Bounds& bounds, int shadowSize) {
  // The smallest orthographic view that contains the bounding sphere.
  const glm::vec3 centre = 0.5f * (bounds.low + bounds.high);
  const float radius = std::max(0.5f * glm::length(bounds.high - bounds.low), 1e-6f) * 1.01f;
  const glm::vec3 helper = std::abs(light.direction.y) > 0.9f ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
  LightView view;
  view.worldToClip = glm::orthoRH_ZO(-radius, radius, -radius, radius, 0.0f, 2.0f * radius) *
                     glm::lookAtRH(centre - light.direction * radius, centre, helper);
  set.samples.push_back({glm::vec3(0.0f), LightSampleKind::directional, light.direction,
                         static_cast<int>(set.views.size()), light.power, 1, 0.0f, 0.0f,
                         2.0f * radius / static_cast<float>(shadowSize), 0.0f});
  set.views.push_back(view);
}

}  // namespace

LightSet sampleLights(const Scene& scene, const SceneSnapshot& snapshot, int areaSamples, int shadowSize) {
  LightSet set;
  for (const LightState& light : snapshot.lights) {
    const float far = reachFrom(snapshot.bounds, light.position);
    switch (light.kind) {
      case LightKind::directional:
        addDirectional(set, light, snapshot.bounds, shadowSize);
        break;
      case LightKind::point:
        set.samples.push_back({light.position, LightSampleKind::point, glm::vec3(0.0f),
                               static_cast<int>(set.views.size()), light.power, kCubeViews, 0.0f, 0.0f,
                               texelPerMetre(glm::radians(45.0f), shadowSize), 0.0f});
        addCube(set, light.position, snapshot.bounds, nullptr);
        break;
      case LightKind::spot: {
        // A spot wider than one perspective view can hold has the six views of a point light; its cone is
        // shaped in the shader.
        constexpr float kWidestView = glm::radians(80.0f);
        const bool wide = light.outerAngle > kWidestView;
        const float halfAngle = wide ? glm::radians(45.0f)
                                     : std::clamp(light.outerAngle * 1.02f, glm::radians(0.5f), kWidestView);
        // smoothstep needs distinct edges: a hard edge gets a width of one millionth.
        const float cosInner = std::cos(light.innerAngle),
                    cosOuter = std::min(std::cos(light.outerAngle), cosInner - 1e-6f);
        set.samples.push_back({light.position, LightSampleKind::spot, light.direction,
                               static_cast<int>(set.views.size()), light.power, wide ? kCubeViews : 1,
                               cosInner, cosOuter, texelPerMetre(halfAngle, shadowSize), 0.0f});
        if (wide) {
          addCube(set, light.position, snapshot.bounds, nullptr);
        } else {
          set.views.push_back(
              {perspectiveView(light.position, light.direction, halfAngle, far * kNearShare, far), true});
        }
        break;
      }
    }
  }
  for (std::size_t i = 0; i < set.samples.size(); ++i)
    set.discs.push_back({set.samples[i].position, 0.0f, glm::vec3(0.0f), static_cast<int>(i), 1});
  addAreaLights(set, scene, snapshot, areaSamples, shadowSize);
  return set;
}

}  // namespace lumivox
