// The lights' views in layers that can be filtered: a kind of port of this technique's own.
#pragma once

#include <cstdint>

#include "lumivox/pipeline/port.h"

namespace lumivox {

/// The views of a reflective shadow map in layers by depth and by normal, one mip per halving (thesis Gomes
/// 2015, Sec. 3.3). A texel of the map belongs to one layer of its view and is 0 in the others. A filtered
/// texel thus holds means times the share of its area that the layer covers, and the layers of a view add up
/// to the map. Empty layers are not stored.
struct LayeredReflectiveShadowMap {
  /// Mirror of Layer in shaders/layered_reflective_shadow_maps/layer.glsl (std430).
  struct Layer {
    float middle, halfWidth;
    std::int32_t view, facing, slot;
  };
  gpu::BufferRef lights;
  gpu::BufferRef views;
  gpu::BufferRef layers = nullptr;
  gpu::BufferRef viewLayers = nullptr;
  gpu::TextureRef radiance = nullptr;
  gpu::TextureRef normal = nullptr;
  gpu::TextureRef depth = nullptr;
  int lightCount = 0;
  int viewCount = 0;
  int layerCount = 0;  ///< stored; the textures have one at least
  int mostOfView = 0;  ///< no view has more layers
  float unit = 1.0f;   ///< W/(sr m^2): keeps very bright and very dark light within half floats
};

template <>
struct PortTraits<LayeredReflectiveShadowMap> {
  static PortKind kind() {
    constexpr auto kAny = PortResource::Sign::any;
    const char* const shape = "d2Array rgba16f or rgba32f with mips";
    return {
        "LayeredReflectiveShadowMap",
        "the surfaces that each light sees, in layers by depth and by normal, one mip per halving",
        {{"lights", "buffer", "array of LightSample in shaders/common/lights.glsl"},
         {"views", "buffer", "mat4 per view: world to light clip space"},
         {"layers", "buffer",
          "of each layer: middle and half width of its depths, m; its view; the side of a cube that its normals look to, or -1; view, interval and side in one number",
          kAny},
         {"viewLayers", "buffer", "two words per view: its first layer, and how many it has"},
         {"radiance", shape, "rgb diffusely reflected radiance * cover / unit, a cover"},
         {"normal", shape, "xyz normal * cover", kAny},
         {"depth", "d2Array rg32f with mips",
          "depth, and its square, times cover: in half widths about the middle of the interval", kAny}},
        {},
        {},
        {radianceUnitCondition()}};
  }
  static void contents(const LayeredReflectiveShadowMap& port, PortContents& contents) {
    contents.buffer("lights", port.lights);
    contents.buffer("views", port.views);
    contents.buffer("layers", port.layers);
    contents.buffer("viewLayers", port.viewLayers);
    contents.texture("radiance", port.radiance);
    contents.texture("normal", port.normal);
    contents.texture("depth", port.depth);
  }
};

}  // namespace lumivox
