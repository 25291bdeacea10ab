#version 450
// Dong et al. 2007, Sec. 4.3, step 10: the radiance of a node is the mean of its children, weighted by area. A group has six values instead
// of two: the radiance of its discs along each axis, weighted by their projected area. Discs with their front towards the axis hide the
// backs of others.
#pragma lumivox axis SUMS 0 1
#include "nodes.glsl"

layout(local_size_x = 64) in;
#include "common/list.glsl"

layout(constant_id = 0) const bool adds = true;  // to the sum over bounces; false: begins it

layout(std140, binding = 1) uniform Run {
  int firstNode, nodesInRun;
};
layout(std430, binding = 0) readonly buffer Children { uvec4 children[]; };
layout(binding = 1, rgba32f) uniform image2D reflectedImage;
#if SUMS
layout(binding = 2, rgba32f) uniform image2D radianceImage;
#endif
const uint kNone = 0xffffffffu;

void put(uint texel, vec4 value) {
  ivec2 at = texelOf(texel);
  imageStore(reflectedImage, at, value);
#if SUMS
  imageStore(radianceImage, at, vec4(value.rgb + (adds ? imageLoad(radianceImage, at).rgb : vec3(0.0)), value.w));
#endif
}

void pullUpDisc(uint node, uvec4 below) {
  vec3 front = vec3(0.0), back = vec3(0.0);
  float area = 0.0;
  for (uint i = 0u; i < 4u; ++i) {
    if (below[i] == kNone) continue;
    float own = texelFetch(elementPosition, texelOf(below[i]), 0).w;
    front += own * imageLoad(reflectedImage, texelOf(2u * below[i])).rgb;
    back += own * imageLoad(reflectedImage, texelOf(2u * below[i] + 1u)).rgb;
    area += own;
  }
  float scale = area > 0.0 ? 1.0 / area : 0.0;
  put(2u * node, vec4(front * scale, 1.0));
  put(2u * node + 1u, vec4(back * scale, 1.0));
}

// Adds the projected area of a child along an axis, and radiance times area, to `fronts` or `backs`.
void addShown(uint child, uint axis, bool negative, inout vec4 fronts, inout vec4 backs) {
  vec3 normal = texelFetch(elementNormal, texelOf(child), 0).xyz;
  uint texel = radianceTexel(child);
  if (child < uint(firstGroup)) {
    float along = texelFetch(elementPosition, texelOf(child), 0).w * (negative ? -normal[axis] : normal[axis]);
    vec4 sent = vec4(imageLoad(reflectedImage, texelOf(texel + (along >= 0.0 ? 0u : 1u))).rgb, 1.0);
    if (along >= 0.0) fronts += along * sent;
    else backs -= along * sent;
    return;
  }
  vec4 sent = imageLoad(reflectedImage, texelOf(texel + 2u * axis + (negative ? 1u : 0u)));
  if (sent.w > 0.0) fronts += vec4(sent.rgb * sent.w, sent.w);
  else backs += normal[axis] * vec4(sent.rgb, 1.0);
}

void pullUpGroup(uint node, uvec4 below) {
  for (uint axis = 0u; axis < 3u; ++axis) {
    for (uint sign = 0u; sign < 2u; ++sign) {
      vec4 fronts = vec4(0.0), backs = vec4(0.0);
      for (uint i = 0u; i < 4u; ++i)
        if (below[i] != kNone) addShown(below[i], axis, sign == 1u, fronts, backs);
      vec3 mean = fronts.w > 0.0 ? fronts.rgb / fronts.w : backs.w > 0.0 ? backs.rgb / backs.w : vec3(0.0);
      put(radianceTexel(node) + 2u * axis + sign, vec4(mean, fronts.w));
    }
  }
}

void main() {
  uint item = listIndex();
  if (item >= uint(nodesInRun)) return;
  uint node = uint(firstNode) + item;
  uvec4 below = children[node - uint(leafCount)];
  if (node < uint(firstGroup)) pullUpDisc(node, below);
  else pullUpGroup(node, below);
}
