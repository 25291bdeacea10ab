#version 450
// Mavridis & Papaioannou 2011, Sec. 3.2: each pixel that shows a surface marks the voxel that contains the surface point.
// Deviates: the g-buffer holds positions, so that none is reconstructed from depth.
// With REFLECTED, the fragment also gets the direct light that the renderer computed at the point, and which of its sides reflects it.
#pragma lumivox axis EMISSION 0 1
#pragma lumivox axis REFLECTED 0 1
#pragma lumivox axis GLOSSY 0 1
#include "fragment_list.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

#if REFLECTED
layout(std430, binding = 2) writeonly buffer Reflected { uint reflected[]; };
layout(binding = 4) uniform sampler2D direct;  // radiance from the surface towards the camera without indirect light, W/(sr m^2)
#endif
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
layout(binding = 2) uniform sampler2D gDiffuse;
#if EMISSION
layout(binding = 3) uniform sampler2D gEmission;
#endif
#if GLOSSY
layout(binding = 5) uniform sampler2D gSpecular;
#endif

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(gPosition, 0)))) return;
  vec4 posWorld = texelFetch(gPosition, pixel, 0);
  if (posWorld.w == 0.0) return;
  vec3 posGrid = (posWorld.xyz - gridLow) / voxelSize;
  ivec3 voxel = ivec3(floor(posGrid));
  if (any(lessThan(voxel, ivec3(0))) || any(greaterThanEqual(voxel, resolution))) return;

  // A fragment stores the normal of the front side; the normal of the g-buffer faces the camera.
  vec4 facing = texelFetch(gNormal, pixel, 0);
  vec3 albedo = texelFetch(gDiffuse, pixel, 0).rgb;
  vec3 radiance = vec3(0.0);
#if EMISSION
  radiance = texelFetch(gEmission, pixel, 0).rgb;
#endif
  uint index = atomicAdd(fragmentCount, 1u);
  if (index >= uint(capacity)) return;
  VoxelFragment fragment;
  fragment.voxel = packVoxel(voxel);
  fragment.offset = packOffset(posGrid - vec3(voxel));
#if REFLECTED
  if (facing.w <= 0.5) fragment.offset |= kSeenBehind;
#endif
  fragment.normal = packNormal(facing.w > 0.5 ? facing.xyz : -facing.xyz);
  fragment.albedoRg = packHalves(albedo.rg);
  fragment.albedoBCoverage = packHalves(vec2(albedo.b, 1.0));
  vec4 specular = vec4(0.0);
#if GLOSSY
  specular = texelFetch(gSpecular, pixel, 0);
#endif
  fragment.emission = packEmissionOrLobe(radiance, specular);
  fragments[index] = fragment;
#if REFLECTED
  // The reader of the fragment adds its emission.
  reflected[index] = packShared(max(texelFetch(direct, pixel, 0).rgb - radiance, 0.0));
#endif
}
