#version 450
// Marks the voxels that visible surfaces read. A voxel that the pixel to the left or above reads too is left to that pixel: stores are the
// largest cost here, and many pixels read the same voxel.
layout(local_size_x = 8, local_size_y = 8) in;
#include "mark.glsl"
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gGeometricNormal;

struct SurfacePoint {
  bool any;  // a surface inside the volume
  vec3 place, normal;
};

SurfacePoint seenAt(ivec2 pixel) {
  if (any(lessThan(pixel, ivec2(0)))) return SurfacePoint(false, vec3(0.0), vec3(0.0));
  vec4 posWorld = texelFetch(gPosition, pixel, 0);
  precise vec3 place = (posWorld.xyz - gridLow) / voxelSize;  // equal, to the bit, to gather.comp
  return SurfacePoint(posWorld.w > 0.0 && isInVolume(place), place, texelFetch(gGeometricNormal, pixel, 0).xyz);
}

bool reads(SurfacePoint point, int i, ivec3 block) {
  ivec3 low;
  return point.any && readBlock(i, point.place, point.normal, low) && low == block;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(gPosition, 0)))) return;
  SurfacePoint own = seenAt(pixel);
  if (!own.any) return;
  SurfacePoint left = seenAt(pixel - ivec2(1, 0)), before = seenAt(pixel - ivec2(0, 1));
  for (int i = 0; i < neighbourCount(); ++i) {
    ivec3 block;
    if (readBlock(i, own.place, own.normal, block) && !reads(left, i, block) && !reads(before, i, block)) markBlock(block);
  }
}
