// The environment as shaders read it by direction. GLSL side: shaders/common/environment.glsl.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "lumivox/pipeline/pass.h"

namespace lumivox {

/// The block of a shader that includes common/environment.glsl. Its specialisation constant `environmentMap`
/// is environmentMapOf(frame); the constant radiance stays a value of the pass's own block.
class EnvironmentBinding : public shader::BindingSet {
 public:
  explicit EnvironmentBinding(PassContext& frame);
};

/// 1 where the environment differs by direction, else 0: then nothing of a map is sampled.
int environmentMapOf(const PassContext& frame);

/// What camera rays that miss everything see: block EnvironmentView of common/environment_view.glsl, and the
/// map's own texels for common/environment_seen.glsl.
class EnvironmentViewBinding : public shader::BindingSet {
 public:
  explicit EnvironmentViewBinding(PassContext& frame);
};

/// The largest radiance of the environment, for each channel.
glm::vec3 brightestOfEnvironment(const Scene& scene);

/// Coefficients of the environment's radiance in the two lowest bands, for each colour: of Y00, Y1-1 (y), Y10
/// (z) and Y11 (x), as shaders/common/spherical_harmonics.glsl orders them.
std::array<glm::vec4, 3> environmentBands(const Scene& scene);

}  // namespace lumivox
