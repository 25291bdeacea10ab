// Media as shaders read them. GLSL side: shaders/common/media.glsl.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "lumivox/pipeline/pass.h"
#include "lumivox/scene/medium.h"

namespace lumivox {

/// Mirror of MediumData in shaders/common/media.glsl (std430).
struct MediumData {
  glm::vec4 lowAnisotropy, highDensity;
  glm::vec4 extinction, scattering;
  glm::vec4 gridLowVoxel, gridExtent;
};

/// What a shader that includes common/media.glsl is bound to.
class MediaBinding {
 public:
  MediaBinding() = default;  ///< without media: adds nothing
  MediaBinding(PassContext& frame, const ScatteringGrid& media);
  /// Whether there are densities in textures: the axis MEDIUM of the shader.
  bool varying() const { return densities_.front() != nullptr; }
  /// The bindings of common/media.glsl.
  void addTo(std::vector<gpu::ResourceBinding>& bindings) const;

 private:
  gpu::BufferRef media_;
  std::array<gpu::TextureRef, kMostVaryingMedia> densities_;  ///< all set where a medium varies, else null
};

}  // namespace lumivox
