// Media as shaders read them. GLSL side: shaders/common/media.glsl.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "lumivox/pipeline/pass.h"
#include "lumivox/scene/medium.h"

namespace lumivox {

/// Mirror of MediumData in shaders/common/media.glsl (std430).
struct MediumData {
  glm::vec4 lowAnisotropy, highDensity;
  glm::vec4 extinction, scattering;
  glm::vec4 gridLowVoxel, gridExtent;
};

/// Bindings of a shader that includes common/media.glsl; none without media.
class MediaBinding : public shader::BindingSet {
 public:
  MediaBinding() = default;
  MediaBinding(PassContext& frame, const ScatteringGrid& media);
  /// Nothing either where they are not read.
  MediaBinding(PassContext& frame, const In<ScatteringGrid>& media, bool read = true)
      : MediaBinding(read && media.present() ? MediaBinding(frame, *media) : MediaBinding()) {}
  /// The axis `MEDIUM none even varying` of the shader.
  enum Axis : int { none, even, varying };
  Axis axis = none;

 private:
  std::array<gpu::TextureRef, kMostVaryingMedia> densities_;  ///< all set where a medium varies, else null
  gpu::BufferRef media_;
};

}  // namespace lumivox
