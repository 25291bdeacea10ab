#version 450
// A camera's view of the voxels of a field. Cubes: the value of the first occupied voxel on a pixel's ray; the voxel around the eye is
// skipped. Lobes: the same for spherical harmonics (voxel_lobe.glsl). Blended: all voxels through a transfer function, each by the length
// of the ray inside it.
// C++ side: viewVoxels() in framework/include/lumivox/toolkit/voxel_view.h.
#pragma lumivox axis SHAPE cubes lobes blended
#pragma lumivox require SHAPE != lobes || SOURCE == texels
#pragma lumivox require SHAPE == blended || OPACITY == solid
#include "toolkit/voxel_rays.glsl"
#include "toolkit/voxel_transfer.glsl"
#include "toolkit/voxel_walk.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0, rgba32f) uniform writeonly image2D seenImage;  // cubes and lobes: rgb value, a brightness, 0 where no voxel is visible

#if SHAPE == SHAPE_LOBES
#include "toolkit/voxel_lobe.glsl"
#endif

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(seenImage)))) return;
  float perDepth;
  vec3 direction = rayOf(pixel, perDepth);
  vec4 seen = vec4(0.0);
  for (VoxelWalk walk = startWalk(eye, direction, cut * perDepth); walk.inside; nextVoxel(walk)) {
#if SHAPE == SHAPE_BLENDED
    float brightness = 1.0;
    if (shading != 0) brightness = sideBrightness(walk.side, eye + walk.from * direction, pixelWidth * walk.from, shading == 2);
    if (walk.to > walk.from) addLengths(seen, transferOf(walk.voxel), (walk.to - walk.from) / shortestSide(), brightness);
    if (seen.a >= kOpaque) break;
#else
    if (walk.side == kWithin) continue;
#if SHAPE == SHAPE_LOBES
    if (meetsLobe(walk, eye, direction, above, seen)) break;
#else
    vec3 value = fieldValue(walk.voxel);
    // NaN is drawn as well.
    if (all(lessThanEqual(abs(value), vec3(above)))) continue;
    seen = vec4(value, sideBrightness(walk.side, eye + walk.from * direction, pixelWidth * walk.from, true));
    break;
#endif
#endif
  }
#if SHAPE == SHAPE_BLENDED
  seen = beforeBackground(seen);
#endif
  imageStore(seenImage, pixel, seen);
}
