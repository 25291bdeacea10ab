#version 450
// Carries light from a surface of each path back to the previous surface, as published (thesis Gomes 2015, Sec. 3.2.4): one layer of the
// textures of record.comp per dispatch. From the first surface, light arrives at the visible surface.
#pragma lumivox axis ARRIVING 0 1
#pragma lumivox axis REFLECTED 0 1
#pragma lumivox require ARRIVING || REFLECTED
#include "sums.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = 0) uniform CarriedLayer {
  int layer;
  int isLast;  // 1: the last layer, which comes first: nothing has been carried yet
};
layout(binding = 1, rgba32f) uniform readonly image2DArray vertexPlace;
layout(binding = 3, rgba32f) uniform readonly image2DArray vertexLight;
layout(binding = 4, rgba32f) uniform readonly image2DArray vertexReflection;
layout(binding = 2, rgba32f) uniform image2D carried;  // rgb radiance from the surface of the next layer, back along the path
layout(binding = 7, rgba32f) uniform readonly image2D firstWeights;

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, imageSize(carried)))) return;
  ivec3 vertex = ivec3(at, layer);
  vec3 light = imageLoad(vertexLight, vertex).rgb;
  if (isLast == 0 && imageLoad(vertexPlace, vertex).w > 0.0) light += imageLoad(vertexReflection, vertex).rgb * imageLoad(carried, at).rgb;
  if (layer > 0) {
    imageStore(carried, at, vec4(light, 0.0));
    return;
  }
  vec2 weights = imageLoad(firstWeights, at).rg;
#if ARRIVING
  addTo(kArriving, at, weights.r * light);
#endif
#if REFLECTED
  addTo(kReflected, at, weights.g * light);
#endif
}
