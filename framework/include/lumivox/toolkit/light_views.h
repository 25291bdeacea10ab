// Views of the lights, drawn as layers of one array: the frame of shadow maps and of reflective shadow maps.
#pragma once

#include <functional>

#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/light_samples.h"

namespace lumivox {

/// All lights as point samples with their views, on the device too.
struct LightViews {
  LightSet set;
  int side = 1;  ///< texels along a side of every view
  gpu::BufferRef lights, views;
  int lightCount() const { return static_cast<int>(set.samples.size()); }
  int layerCount() const { return static_cast<int>(set.views.size()); }
  /// An array with a layer for each view.
  gpu::TextureRef layers(PassContext& frame, gpu::Format format, const std::string& label) const;
};

/// One array holds all layers, so that they share one size: `size`, or `areaSize` where there are no lights
/// but emissive triangles.
LightViews placeLightViews(PassContext& frame, int areaSamples, int size, int areaSize);

/// The base of passes that draw the scene from each light, with their parameters.
class LightViewPass : public Pass {
 public:
  Reads readsFrom() const override { return Reads::geometry | Reads::materials | Reads::lights; }
  Needs needs() const override { return Needs::anyLight; }

 protected:
  LightViewPass(int size, ParamRange<int> sizes, int areaSize, ParamRange<int> areaSizes)
      : size_(this, "size", size, sizes,
              "texels along a side of each view of a point, spot or directional light"),
        areaSamples_(this, "area_samples", 16, within(1, 1024),
                     "point samples that represent all emissive triangles together"),
        areaSize_(this, "area_size", areaSize, areaSizes,
                  "texels along a side of each cube face of an area sample") {}
  LightViews placed(PassContext& frame) const {
    return placeLightViews(frame, areaSamples_, size_, areaSize_);
  }

 private:
  Param<int> size_, areaSamples_, areaSize_;
};

/// One view while it is drawn.
struct LightViewDrawn {
  const LightView& view;
  int light, layer;
};
/// Clears `targets(layer)` of every view and has all of the scene drawn into those that are used.
void drawLightViews(PassContext& frame, const LightViews& views, const gpu::RasterState& state,
                    const std::function<gpu::RenderTargets(int layer)>& targets,
                    const std::function<void(const LightViewDrawn&, const SceneDraw&)>& draw);

}  // namespace lumivox
