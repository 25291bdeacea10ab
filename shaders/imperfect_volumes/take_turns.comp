#version 450
// Lists the voxels in which rays begin in this frame, and keeps the light of the frame before in the others. Rays begin in each voxel that
// a pixel reads, in one of `turns` frames where only surfaces read it, and at once where it holds nothing. BEFORE: there is such light; if
// not, rays begin in all voxels in so many frames from this one on. Images begin with zeros.
#pragma lumivox axis BEFORE 0 1
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
#include "common/voxel.glsl"
#include "volume.glsl"
#include "turns.glsl"
layout(constant_id = 0) const int everywhere = 0;  // 1: rays also begin in voxels that nothing reads, which still count as empty

layout(std140, binding = 0) uniform Turns { uint turns; };
layout(binding = 0, r32ui) uniform readonly uimage3D marks;
layout(binding = 1, r32ui) uniform writeonly uimage3D turnImage;
layout(binding = 2, rgba32f) uniform writeonly image3D redImage;
layout(binding = 3, rgba32f) uniform writeonly image3D greenImage;
layout(binding = 4, rgba32f) uniform writeonly image3D blueImage;
#if BEFORE
layout(binding = 0) uniform usampler3D turnBefore;
layout(binding = 2) uniform sampler3D red;
layout(binding = 3) uniform sampler3D green;
layout(binding = 4) uniform sampler3D blue;
#endif
layout(std430, binding = 0) buffer ListCount { uint listed; };
layout(std430, binding = 1) writeonly buffer List { uint list[]; };

void main() {
  ivec3 voxel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(voxel, resolution))) return;
  uint mark = imageLoad(marks, voxel).r, turn = turnOf(voxel, turns);
  bool isRead = mark == kSeen || mark == kUnseen, begins = isRead;
#if BEFORE
  uint before = mark == kUnseen ? texelFetch(turnBefore, voxel, 0).r : kNothing, atOnce = before >> 8;
  if (atOnce > 0u) {
    turn |= atOnce - 1u << 8;
  } else if (before >= turns) {
    turn = 1u;
  } else if (before != kNothing) {
    turn = before + 1u;
    begins = false;
    imageStore(redImage, voxel, texelFetch(red, voxel, 0));
    imageStore(greenImage, voxel, texelFetch(green, voxel, 0));
    imageStore(blueImage, voxel, texelFetch(blue, voxel, 0));
  }
#else
  turn |= turns - 1u << 8;
#endif
  if (isRead) imageStore(turnImage, voxel, uvec4(turn));
  if (begins || everywhere != 0 && !isRead) list[atomicAdd(listed, 1u)] = packVoxel(voxel);
}
