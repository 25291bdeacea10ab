#version 450
// Dong et al. 2007, Sec. 4.3, steps 8 and 9: the irradiance of leaves over their links, and the light that they reflect. LISTED: only over
// links to emitters (4.3.1). ENVIRONMENT: bins without a link receive the environment (4.4). OUTGOING: glossy elements also send the light
// that their lobes reflect.
#pragma lumivox axis LISTED 0 1
#pragma lumivox axis ENVIRONMENT 0 1
#pragma lumivox axis WEIGHT bin element
#pragma lumivox axis OUTGOING 0 1
#pragma lumivox require !LISTED || (!ENVIRONMENT && !OUTGOING)
#include "sent.glsl"
#include "common/constants.glsl"
#if ENVIRONMENT
#include "environment_of_bin.glsl"
#endif

// Eight invocations share the links of a leaf; the first one adds up their sums, always in the same order.
layout(local_size_x = 64) in;
#include "common/list.glsl"
const uint kTogether = 8u;

layout(constant_id = 0) const bool adds = false;     // to the irradiance of earlier bounces
layout(constant_id = 1) const bool reflects = true;  // the reflected light is written

layout(std140, binding = 1) uniform Illumination {
  vec3 environment;  // W/(sr m^2)
};

#if LISTED
layout(std430, binding = 3) readonly buffer Lights { uint lights[]; };
#endif
#if WEIGHT == WEIGHT_ELEMENT
layout(std430, binding = 4) readonly buffer Counts { uint counts[]; };  // for each link, the number of the leaf's links to the same node
#endif
layout(binding = 3) uniform sampler2D albedos;
layout(binding = 0, rgba32f) uniform image2D irradianceImage;
layout(binding = 1, rgba32f) uniform writeonly image2D reflectedImage;
layout(binding = 2, rgba32f) uniform image2D radianceImage;

shared vec3 found[2u * gl_WorkGroupSize.x];

struct Leaf {
  vec3 position, normal;
  float scale;
};

// Adds the irradiance over a link to the side at which it arrives.
void add(uint number, Leaf leaf, inout vec3 front, inout vec3 back) {
  uvec2 link = links[number];
#if WEIGHT == WEIGHT_BIN
  float weight = binWeight(linkBin(link), leaf.normal, leaf.scale);
#else
  vec4 seen = texelFetch(elementPosition, texelOf(link.y), 0);
  vec3 path = seen.xyz - leaf.position, toSeen = normalize(path);
  vec3 normal = texelFetch(elementNormal, texelOf(link.y), 0).xyz;
  // For groups, elementNormal holds the area projected along each axis.
  float shown = link.y < uint(firstGroup) ? seen.w * abs(dot(normal, toSeen)) : dot(normal, abs(toSeen));
  float weight = dot(leaf.normal, toSeen) * shown / (dot(path, path) * float(counts[number]));
#endif
  vec3 arriving = abs(weight) * sentOver(link, leaf.position);
  if (weight > 0.0) front += arriving;
  else back += arriving;
}

#if ENVIRONMENT
// Adds the environment in bins without a link, from `begin` on and before `end`.
void addSky(uint begin, uint end, Leaf leaf, inout vec3 front, inout vec3 back) {
  for (uint bin = begin; bin < end; ++bin) {
    float weight = binWeight(bin, leaf.normal, leaf.scale);
    vec3 sky = environmentOfBin(environment, bin);
    if (weight > 0.0) front += weight * sky;
    else back -= weight * sky;
  }
}
#endif

void main() {
  uint item = listIndex() / kTogether, lane = gl_LocalInvocationID.x % kTogether;
  bool isLeaf = item < uint(leafCount);
  vec3 front = vec3(0.0), back = vec3(0.0);
  if (isLeaf) {
    uvec4 entry = first[item];
    Leaf leaf = Leaf(texelFetch(elementPosition, texelOf(item), 0).xyz, texelFetch(elementNormal, texelOf(item), 0).xyz,
                     uintBitsToFloat(entry.z));
    // Each invocation takes every eighth link of the leaf, so that sums do not depend on which links are listed.
#if LISTED
    uint listFirst = lights[2u * item], listEnd = listFirst + lights[2u * item + 1u];
    for (uint i = listFirst; i < listEnd; ++i)
      if ((lights[i] - entry.x) % kTogether == lane) add(lights[i], leaf, front, back);
#else
    for (uint i = lane; i < entry.y; i += kTogether) {
#if ENVIRONMENT
      addSky(i == 0u ? 0u : linkBin(links[entry.x + i - 1u]) + 1u, linkBin(links[entry.x + i]), leaf, front, back);
#endif
      add(entry.x + i, leaf, front, back);
    }
#if ENVIRONMENT
    if (lane == entry.y % kTogether)
      addSky(entry.y == 0u ? 0u : linkBin(links[entry.x + entry.y - 1u]) + 1u, uint(binCount), leaf, front, back);
#endif
#endif
  }
  found[2u * gl_LocalInvocationID.x] = front;
  found[2u * gl_LocalInvocationID.x + 1u] = back;
  barrier();
  if (!isLeaf || lane != 0u) return;
  for (uint other = 1u; other < kTogether; ++other) {
    front += found[2u * (gl_LocalInvocationID.x + other)];
    back += found[2u * (gl_LocalInvocationID.x + other) + 1u];
  }
  vec3 albedo = texelFetch(albedos, texelOf(item), 0).rgb;
  for (uint side = 0u; side < 2u; ++side) {
    ivec2 texel = texelOf(2u * item + side);
    vec3 arriving = side == 0u ? front : back;
    imageStore(irradianceImage, texel, vec4(arriving + (adds ? imageLoad(irradianceImage, texel).rgb : vec3(0.0)), 1.0));
    if (!reflects) continue;
    vec3 reflected = albedo / kPi * arriving;
    imageStore(reflectedImage, texel, vec4(reflected, 1.0));
    imageStore(radianceImage, texel, vec4(imageLoad(radianceImage, texel).rgb + reflected, 1.0));
  }
}
