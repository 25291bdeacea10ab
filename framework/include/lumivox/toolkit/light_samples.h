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

/// The disc of a whole light, at which a cone is aimed.
struct LightDisc {
  glm::vec3 centre{0.0f};  ///< of an area light: the mean place of its power
  /// That of a disc across which points lie as far from the centre, in the mean of the squares: half a side
  /// times 1.15 of a square. 0 of a light without extent.
  float radius = 0.0f;
  /// Of an area light: the mean of its normals by power, of length 1 where it is flat and shorter where it is
  /// curved. Else 0.
  glm::vec3 normal{0.0f};
  int firstSample = 0, sampleCount = 1;
};

struct LightSet {
  std::vector<LightSampleData> samples;
  std::vector<LightView> views;
  std::vector<LightDisc> discs;  ///< one for each light, in the order of their samples
};

/// Lights without extent become one sample each, and come first. Emissive triangles together become
/// `areaSamples` samples: one for each emissive part of an object and the others by emitted power, chosen
/// with stratified numbers and placed by the R2 sequence, so that the same scene always gives the same
/// samples. They lie where alpha masks leave the triangles, and the samples of a part carry all of its light:
/// no hole shines. Of more parts than samples the dimmest may have none; each sample then is a disc of its
/// own.
LightSet sampleLights(const Scene& scene, const SceneSnapshot& snapshot, int areaSamples, int shadowSize);

}  // namespace lumivox
