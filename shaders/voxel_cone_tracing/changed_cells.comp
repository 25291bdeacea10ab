#version 450
// Finds the cells to which light may come otherwise: those that lie in a shadow view behind something that moves. A cell that is found is
// lit anew and nothing else, so that it does no harm to find too many.
layout(local_size_x = 64) in;
#include "common/list.glsl"
#define CHANGES_BUILD
#include "changed_cells.glsl"
#define SHADOW_VIEWS
#include "common/lights.glsl"
#include "changed_light.glsl"

layout(std140, binding = 0) uniform Cells {
  vec3 gridLow;   // m
  float cellSize; // m
  int boxCount;
  int lightCount;
  float texel;    // of the shadow views, in clip space
};
layout(std430, binding = 1) readonly buffer Casts { Cast casts[]; };
layout(std430, binding = 2) readonly buffer CellEnds { uint cellEnds[]; };

bool isShadowedAnew(vec3 low, vec3 high) {
  for (int i = 0; i < lightCount; ++i) {
    LightSample light = lights[i];
    if (light.firstView < 0) continue;
    // Visibility is looked up up to two texels of the view off the surface, between four texels.
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

void main() {
  uint cell = listIndex();
  if (cell >= 1u << 3 * cellDepth || cellEnds[cell] == (cell > 0u ? cellEnds[cell - 1u] : 0u)) return;  // or nothing static is there
  vec3 low = gridLow + cellSize * vec3(placeOf(cell));
  if (isShadowedAnew(low, low + cellSize)) setChanged(cell);
}
