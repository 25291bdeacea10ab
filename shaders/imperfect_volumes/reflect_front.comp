#version 450
// As feed.comp, for the light that voxels hold in turns: each side of a surface reads the voxel in front of it or, if that one holds
// nothing, one beside it.
#pragma lumivox axis DIRECT 0 1
layout(local_size_x = 64) in;
#include "common/list.glsl"
#include "common/voxel.glsl"
#include "feeding.glsl"
#include "turns.glsl"
layout(binding = 8) uniform usampler3D turnsOfLight;
bool isKnown(ivec3 voxel) { return texelFetch(turnsOfLight, voxel, 0).r != kNothing; }
#define COUNTS(voxel) isKnown(voxel)
#include "front.glsl"
layout(binding = 1) uniform sampler3D meanNormals;
layout(binding = 2) uniform sampler3D albedo;
layout(binding = 5) uniform sampler3D red;
layout(binding = 6) uniform sampler3D green;
layout(binding = 7) uniform sampler3D blue;
layout(binding = 0, rgba32f) uniform writeonly image3D redImage;
layout(binding = 1, rgba32f) uniform writeonly image3D greenImage;
layout(binding = 2, rgba32f) uniform writeonly image3D blueImage;
layout(std430, binding = 0) readonly buffer SurfaceCount { uint surfaceCount; };
layout(std430, binding = 1) readonly buffer Surfaces { Surface surfaces[]; };
#if DIRECT
layout(std140, binding = 0) uniform Beside { float directUnit; };  // radiance of the number 1, W/(sr m^2)
layout(binding = 3) uniform sampler3D directRed;
layout(binding = 4) uniform sampler3D directGreen;
layout(binding = 10) uniform sampler3D directBlue;
#endif

bool findFront(ivec3 voxel, vec3 normal, uint fronts, uint shift, out ivec3 front) {
  uint code = fronts >> shift & 255u;
  front = voxel;
  if (feedsOwn != 0) return isKnown(voxel);
  if (fronts != kNoNormal) {
    if (code == kNoFront) return false;
    front = voxel + unpackWay(code);
    if (isKnown(front)) return true;
  }
  ivec3 way;
  for (int apart = 1; apart <= 2; ++apart) {
    if (!wayToFront(voxel, normal, apart, way)) continue;
    front = voxel + apart * way;
    return true;
  }
  return false;
}

// Radiance that the side of a normal reflects, W/(sr m^2).
vec3 sentInto(ivec3 voxel, vec3 normal, uint fronts, uint shift, vec3 reflects) {
  ivec3 front;
  if (!findFront(voxel, normal, fronts, shift, front)) return vec3(0.0);
  vec4 cosine = shClampedCosine(normal);
  vec3 irradiance = vec3(dot(texelFetch(red, front, 0), cosine), dot(texelFetch(green, front, 0), cosine),
                         dot(texelFetch(blue, front, 0), cosine));
  return reflects / kPi * max(irradiance, 0.0);
}

void main() {
  uint item = listIndex();
  if (item >= surfaceCount) return;
  Surface surface = surfaces[item];
  ivec3 voxel = unpackVoxel(surface.voxel);
  vec3 mean = texelFetch(meanNormals, voxel, 0).xyz;
  vec3 normal = surface.fronts != kNoNormal ? normalize(mean) : vec3(0.0);
  if (surface.fronts == kNoNormal && isKnown(voxel))
    normal = surfaceNormal(mean, texelFetch(red, voxel, 0), texelFetch(green, voxel, 0), texelFetch(blue, voxel, 0));
  if (normal == vec3(0.0)) normal = vec3(0.0, 0.0, 1.0);
  vec3 reflects = texelFetch(albedo, voxel, 0).rgb;
  vec3 front = sentInto(voxel, normal, surface.fronts, 0u, reflects), back = sentInto(voxel, -normal, surface.fronts, 8u, reflects);
  vec3 both = 2.0 * kPi * kY0 * (front + back), difference = kPi * kY1 * (front - back);
  vec4 redSum = vec4(both.r, difference.r * normal.yzx), greenSum = vec4(both.g, difference.g * normal.yzx),
       blueSum = vec4(both.b, difference.b * normal.yzx);
#if DIRECT
  redSum += directUnit * texelFetch(directRed, voxel, 0);
  greenSum += directUnit * texelFetch(directGreen, voxel, 0);
  blueSum += directUnit * texelFetch(directBlue, voxel, 0);
#endif
  imageStore(redImage, voxel, redSum);
  imageStore(greenImage, voxel, greenSum);
  imageStore(blueImage, voxel, blueSum);
}
