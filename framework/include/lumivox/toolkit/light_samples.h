// Every light as point samples, and the views in which they cast shadows.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "lumivox/scene/scene.h"

namespace lumivox {

enum class LightSampleKind : std::int32_t { directional = 0, point = 1, spot = 2, area = 3 };

/// Mirror of LightSample in shaders/common/lights.glsl (std430), where the members are explained.
struct LightSampleData {
  glm::vec3 position{0.0f};
  LightSampleKind kind = LightSampleKind::directional;
  glm::vec3 direction{0.0f};
  std::int32_t firstView = 0;
  glm::vec3 power{0.0f};
  std::int32_t viewCount = 0;
  float cosInner = 0.0f, cosOuter = 0.0f;
  float texelWidth = 0.0f;
  float patchRadiusSquared = 0.0f;
};
static_assert(sizeof(LightSampleData) == 64);

/// The view of one light sample through one layer of a shadow array or of a reflective shadow map; an unused
/// one (behind an area light) is left empty.
struct LightView {
  glm::mat4 worldToClip{1.0f};  ///< x, y in [-1,1] with y up, z in [0,1]
  bool used = true;
};

struct LightSet {
  std::vector<LightSampleData> samples;
  std::vector<LightView> views;
};

/// Lights without extent become one sample each. Emissive triangles together become `areaSamples` samples:
/// one for each emissive part of an object and the others by emitted power, chosen with stratified numbers
/// and placed by the R2 sequence, so that the same scene always gives the same samples. They lie where alpha
/// masks leave the triangles, and the samples of a part carry all of its light: no hole shines. Of more parts
/// than samples the dimmest may have none.
LightSet sampleLights(const Scene& scene, const SceneSnapshot& snapshot, int areaSamples, int shadowSize);

}  // namespace lumivox
