#version 450
// Dong et al. 2007, Sec. 4.3, step 10, for directional radiance: the radiance of a node is the mean of its children, weighted by their
// projected area in the direction. Children with their front towards the direction hide the backs of others.
#include "nodes.glsl"
#include "../links/direction_bins.glsl"

layout(local_size_x = 64) in;
#include "common/list.glsl"

layout(std140, binding = 1) uniform OutgoingRun {
  int firstRow, rowsInRun;
  int side;  // bins along a side of a face of the cube
};
layout(std430, binding = 0) readonly buffer Children { uvec4 children[]; };
layout(std430, binding = 3) readonly buffer OutgoingNodes { uint outgoingNodes[]; };  // of rows
layout(std430, binding = 5) readonly buffer OutgoingRows { uint outgoingRows[]; };    // of nodes
layout(binding = 2) uniform sampler2D pulledUp;  // as ElementLight::radiance; w of groups: projected area of fronts
layout(binding = 0, rgba32f) uniform image2D outgoingImage;
const uint kNone = 0xffffffffu;

// Projected area in a direction, m^2; negative for backs.
float areaShown(uint node, vec3 direction) {
  vec3 normal = texelFetch(elementNormal, texelOf(node), 0).xyz;
  if (node < uint(firstGroup)) return texelFetch(elementPosition, texelOf(node), 0).w * dot(normal, direction);
  float fronts = 0.0;
  for (uint axis = 0u; axis < 3u; ++axis) {
    float along = direction[axis];
    fronts += abs(along) * texelFetch(pulledUp, texelOf(radianceTexel(node) + 2u * axis + (along < 0.0 ? 1u : 0u)), 0).w;
  }
  return fronts > 0.0 ? fronts : -dot(normal, abs(direction));
}

void main() {
  uint item = listIndex(), all = uint(6 * side * side);
  if (item >= uint(rowsInRun) * all) return;
  uint row = uint(firstRow) + item / all, bin = item % all;
  vec3 direction = directionOfBin(bin, side, true);
  uvec4 below = children[outgoingNodes[row] - uint(leafCount)];
  vec4 fronts = vec4(0.0), backs = vec4(0.0);
  for (uint i = 0u; i < 4u; ++i) {
    if (below[i] == kNone) continue;
    float area = areaShown(below[i], direction);
    uint own = outgoingRows[below[i]];
    vec3 sent = own == kNone ? vec3(0.0) : imageLoad(outgoingImage, texelOf(own * all + bin)).rgb;
    if (area > 0.0) fronts += area * vec4(sent, 1.0);
    else backs -= area * vec4(sent, 1.0);
  }
  vec3 mean = fronts.w > 0.0 ? fronts.rgb / fronts.w : backs.w > 0.0 ? backs.rgb / backs.w : vec3(0.0);
  imageStore(outgoingImage, texelOf(row * all + bin), vec4(mean, 1.0));
}
