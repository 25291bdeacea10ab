// The scene's atlas on the device, made at the first frame.
#pragma once

#include "lumivox/scene/atlas.h"
#include "voxelizer.h"

namespace lumivox::voxelization {

/// The texels that lie on the surface. They are made again only when their size changes, and never travel
/// back.
class AtlasTexels {
 public:
  /// For texels of this size at rest, in metres.
  void update(PassContext& frame, double texelSize);

  /// Of all texels; `texels` are those that are looked at.
  shader::BindingSet bindings(const AtlasPart& texels) const;
  /// Those of one draw of the scene.
  AtlasPart texelsOf(PassContext& frame, const SceneDraw& draw) const;

 private:
  double texelSize_ = 0.0;
  std::vector<AtlasPart> parts_;
  gpu::BufferRef triangles_, places_;
};

/// Texels along a voxel's side. Two leave neighbours on the surface at most 0.71 voxels apart.
inline constexpr float kTexelsPerVoxel = 2.0f;
inline constexpr ParamRange<float> kTexelsPerVoxelRange{0.1f, 16.0f};
inline constexpr const char* kTexelsPerVoxelMeaning =
    "texels of the atlas along the side of a voxel; fewer leave holes";

}  // namespace lumivox::voxelization
