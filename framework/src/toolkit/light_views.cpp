#include "lumivox/toolkit/light_views.h"

#include <algorithm>

namespace lumivox {

gpu::TextureRef LightViews::layers(PassContext& frame, gpu::Format format, const std::string& label) const {
  return frame.texture({gpu::TextureKind::d2Array, format, side, side, std::max(layerCount(), 1), 1}, label);
}

LightViews placeLightViews(PassContext& frame, int areaSamples, int size, int areaSize) {
  LightViews result;
  result.side = frame.snapshot().lights.empty() ? areaSize : size;
  result.set = sampleLights(frame.sceneDescription(), frame.snapshot(), areaSamples, result.side);
  std::vector<glm::mat4> matrices;
  for (const LightView& view : result.set.views) matrices.push_back(view.worldToClip);
  result.lights = frame.uploaded(result.set.samples, "light samples");
  result.views = frame.uploaded(matrices, "light views");
  return result;
}

void drawLightViews(PassContext& frame, const LightViews& views, const gpu::RasterState& state,
                    const std::function<gpu::RenderTargets(int layer)>& targets,
                    const std::function<void(const LightViewDrawn&, const SceneDraw&)>& draw) {
  for (int light = 0; light < views.lightCount(); ++light) {
    const LightSampleData& sample = views.set.samples[static_cast<std::size_t>(light)];
    for (int layer = sample.firstView; layer < sample.firstView + sample.viewCount; ++layer) {
      const LightView& view = views.set.views[static_cast<std::size_t>(layer)];
      const gpu::Drawing drawing = frame.device().drawTo(targets(layer), state);
      if (!view.used) continue;
      for (const SceneDraw& one : frame.scene().draws()) draw({view, light, layer}, one);
    }
  }
}

}  // namespace lumivox
