// The surfaces that a camera sees, drawn by whichever pass covers the same pixels at the same depths
// (common/visible_surface.glsl).
#pragma once

#include <vector>

#include "lumivox/gpu/device.h"
#include "lumivox/scene/scene.h"
#include "lumivox/toolkit/bindings.h"

namespace lumivox {

/// World to clip space of a camera, z in [0,1]: for draws with kVisibleSurface.
glm::mat4 worldToClip(const SceneSnapshot& snapshot);

/// Depth is clamped, so that the near plane sets precision alone.
inline constexpr gpu::RasterState kVisibleSurface{.depthTest = true, .depthWrite = true, .depthClamp = true};

/// View, Eye and Drawn of common/visible_surface.glsl.
class VisibleSurfaceBinding : public shader::BindingSet {
 public:
  VisibleSurfaceBinding(const PassContext& frame, const SceneDraw& draw);
};

/// Draws what the camera sees into images of its size (null: what goes there is not kept), each part by the
/// variant with the axes that its material needs.
template <class Variant>
void drawVisible(PassContext& frame, const std::vector<gpu::TextureRef>& images, const Variant& variant,
                 const shader::BindingSet& bindings) {
  const glm::ivec3 size = pixels(frame);
  const gpu::TextureRef depth = frame.texture(
      {gpu::TextureKind::d2, gpu::Format::depth32f, size.x, size.y, 1, 1}, "depth of visible surfaces");
  gpu::RenderTargets targets{.depth = depth.get()};
  for (const gpu::TextureRef& image : images) targets.colours.push_back({image.get(), -1});
  while (!targets.colours.empty() && targets.colours.back().texture == nullptr) targets.colours.pop_back();
  const gpu::Drawing drawing = frame.device().drawTo(targets, kVisibleSurface);
  for (const SceneDraw& draw : frame.scene().draws())
    drawPart(frame, draw, variant, {VisibleSurfaceBinding(frame, draw), bindings});
}

}  // namespace lumivox
