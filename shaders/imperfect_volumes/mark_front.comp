#version 450
// Lists the occupied voxels, and marks those from which they read light of the frame before in the next frame.
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
#include "common/voxel.glsl"
#include "feeding.glsl"
#include "front.glsl"
#include "turns.glsl"
layout(binding = 1) uniform sampler3D meanNormals;
layout(binding = 0, r32ui) uniform writeonly uimage3D marks;
layout(std430, binding = 0) buffer SurfaceCount { uint surfaceCount; };
layout(std430, binding = 1) writeonly buffer Surfaces { Surface surfaces[]; };

void mark(ivec3 voxel) { imageStore(marks, voxel, uvec4(kUnseen)); }

uint markFront(ivec3 voxel, vec3 normal) {
  ivec3 way;
  if (!wayToFront(voxel, normal, 1, way)) return kNoFront;
  mark(voxel + way);
  return packWay(way);
}

void main() {
  ivec3 voxel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(voxel, resolution)) || texelFetch(opacity, voxel, 0).r <= occupied) return;
  vec3 mean = texelFetch(meanNormals, voxel, 0).xyz;
  uint fronts = kNoNormal;
  if (feedsOwn != 0) {
    mark(voxel);
  } else if (dot(mean, mean) > kLeastNormal * kLeastNormal) {
    fronts = markFront(voxel, mean) | markFront(voxel, -mean) << 8;
  } else {
    // The light in the voxel itself decides the surface's direction, which is not known yet.
    mark(voxel);
    for (int i = 0; i < 27; ++i) {
      ivec3 around = voxel + unpackWay(uint(i));
      if (isFree(around)) mark(around);
    }
  }
  surfaces[atomicAdd(surfaceCount, 1u)] = Surface(packVoxel(voxel), fronts);
}
