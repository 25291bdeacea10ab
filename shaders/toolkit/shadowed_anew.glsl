// Whether the direct light of a box may change: the box lies behind a moving object in a shadow view.
// C++ side: BoxesInViews in framework/include/lumivox/toolkit/change_tracking.h.
#ifndef LUMIVOX_SHADOWED_ANEW
#define LUMIVOX_SHADOWED_ANEW
#define SHADOW_VIEWS
#include "common/lights.glsl"
#include "boxes_in_views.glsl"

layout(std430, binding = 1) readonly buffer Casts { Cast casts[]; };  // for each view, the boxes of moving objects (changed_views.comp)

// `texel`: of the shadow views, in clip space.
bool isShadowedAnew(vec3 low, vec3 high, int lightCount, int boxCount, float texel) {
  for (int i = 0; i < lightCount; ++i) {
    LightSample light = lights[i];
    if (light.firstView < 0) continue;
    // Visibility is read up to two texels of the view away from the surface, filtered over four texels.
    const float kOffset = 2.1, kFilter = 2.0;
    vec3 farthest = max(abs(low - light.position), abs(high - light.position));
    float offset = kOffset * light.texelWidth * (light.kind == kLightDirectional ? 1.0 : length(farthest));
    for (int layer = light.firstView; layer < light.firstView + light.viewCount; ++layer) {
      Cast cell = castOf(views[layer], low - offset, high + offset);
      cell.rectangle += kFilter * texel * vec4(-1.0, -1.0, 1.0, 1.0);
      for (int box = 0; box < boxCount; ++box) {
        Cast moving = casts[layer * boxCount + box];
        bool isNearer = moving.depths.x > 0.0 && cell.depths.y < moving.depths.x - 1e-4;
        if (!isNearer && all(lessThanEqual(cell.rectangle.xy, moving.rectangle.zw)) && all(lessThanEqual(moving.rectangle.xy, cell.rectangle.zw))) return true;
      }
    }
  }
  return false;
}

#endif
