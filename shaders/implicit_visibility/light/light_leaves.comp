#version 450
// OF reflected: direct light that leaves reflect: from lights by their shadow maps, and from emitters by links (LINKED).
// OF emitted: the emission of the leaves instead.
#pragma lumivox axis OF reflected emitted
#pragma lumivox axis LIGHTS 0 1
#pragma lumivox axis SHADOWS 0 1
#pragma lumivox axis LINKED 0 1
#pragma lumivox axis BEFORE 0 1  // leaves reflect what arrived in the frame before, too
#pragma lumivox require !SHADOWS || LIGHTS
#pragma lumivox require OF == reflected || (!LIGHTS && !LINKED && !BEFORE)
#include "nodes.glsl"
#include "common/constants.glsl"
#if LIGHTS
#if SHADOWS
#define SHADOW_VIEWS
#endif
#include "common/lights.glsl"
#include "common/two_sided_light.glsl"
#include "leaf_points.glsl"
#endif

layout(local_size_x = 64) in;
#include "common/list.glsl"

layout(constant_id = 0) const int samplesPerSide = 1;

layout(std140, binding = 1) uniform DirectLight {
  int lightCount;
};
#if OF == OF_REFLECTED
layout(binding = 3) uniform sampler2D albedos;
#else
layout(binding = 3) uniform sampler2D emissions;
#endif
#if LINKED
layout(binding = 4) uniform sampler2D arrivingFromLights;
#endif
#if BEFORE
layout(binding = 5) uniform sampler2D arrivedBefore;
#endif
layout(binding = 1, rgba32f) uniform writeonly image2D reflectedImage;
layout(binding = 2, rgba32f) uniform writeonly image2D radianceImage;

void main() {
  uint leaf = listIndex();
  if (leaf >= uint(leafCount)) return;
#if OF == OF_EMITTED
  vec3 sides[2] = vec3[2](texelFetch(emissions, texelOf(leaf), 0).rgb, vec3(0.0));
#else
  vec3 sides[2] = vec3[2](vec3(0.0), vec3(0.0));
#if LIGHTS
  vec4 place = texelFetch(elementPosition, texelOf(leaf), 0);
  vec3 normal = texelFetch(elementNormal, texelOf(leaf), 0).xyz;
  LeafSquare square = squareOf(place, normal);
  for (int i = 0; i < samplesPerSide * samplesPerSide; ++i)
    addArriving(lightCount, pointOf(square, i, samplesPerSide), normal, true, 0, sides[0], sides[1]);
  sides[0] /= float(samplesPerSide * samplesPerSide);
  sides[1] /= float(samplesPerSide * samplesPerSide);
#endif
#if LINKED
  for (uint side = 0u; side < 2u; ++side) sides[side] += texelFetch(arrivingFromLights, texelOf(2u * leaf + side), 0).rgb;
#endif
#if BEFORE
  for (uint side = 0u; side < 2u; ++side) sides[side] += texelFetch(arrivedBefore, texelOf(2u * leaf + side), 0).rgb;
#endif
  vec3 lobe = texelFetch(albedos, texelOf(leaf), 0).rgb / kPi;
  sides[0] *= lobe;
  sides[1] *= lobe;
#endif
  for (uint side = 0u; side < 2u; ++side) {
    imageStore(reflectedImage, texelOf(2u * leaf + side), vec4(sides[side], 1.0));
#if OF == OF_REFLECTED
    imageStore(radianceImage, texelOf(2u * leaf + side), vec4(sides[side], 1.0));
#endif
  }
}
