#version 450
// Transmittance of the heterogeneous media between every point of a grid and every light sample, one slab of the texture per light,
// computed once per frame instead of a march from each sample of each ray. It stores transmittance rather than optical depth: between a
// point in thick smoke and a point outside, half of the light is a better interpolation than half of the depth, which transmits nothing.
#pragma lumivox axis MEDIUM even varying
#pragma lumivox require MEDIUM == varying
#include "common/media.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(std140, binding = 0) uniform Parameters {
  vec3 boxLow;  // m
  int side;     // points along a side of a slab
  vec3 boxHigh; // m
  int lightCount;
  int mostSteps;
};
layout(binding = 0, rgba32f) uniform writeonly image3D transmittanceImage;

void main() {
  ivec3 texel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(texel, ivec3(side, side, side * lightCount)))) return;
  vec3 share = (vec3(texel.xy, texel.z % side) + 0.5) / float(side);
  vec3 posWorld = mix(boxLow, boxHigh, share), direction;
  float reach;
  wayToLight(lights[texel.z / side], posWorld, direction, reach);
  imageStore(transmittanceImage, texel, vec4(exp(-varyingDepth(posWorld, direction, reach, mostSteps)), 0.0));
}
