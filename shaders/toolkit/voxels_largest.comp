#version 450
// The largest value of each column of voxels, component by component, regardless of the sign: along x with z to the left, along z with x to
// the right, both with y up; along y, from above, with z downwards.
// C++ side: largestAlong() in framework/include/lumivox/toolkit/voxel_view.h.
#include "toolkit/voxel_field.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = 0) uniform Columns { int axis; };
layout(binding = 0, rgba32f) uniform writeonly image2D largest;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), last = imageSize(largest) - 1;
  if (any(greaterThan(pixel, last))) return;
  ivec3 voxel = ivec3(pixel.x, last.y - pixel.y, 0);
  if (axis == 0) voxel = ivec3(0, last.y - pixel.y, last.x - pixel.x);
  if (axis == 1) voxel = ivec3(pixel.x, 0, pixel.y);
  vec3 most = vec3(0.0);
  for (; voxel[axis] < gridResolution[axis]; ++voxel[axis]) {
    vec3 value = abs(fieldValue(voxel));
    // NaN is kept, so that it shows.
    for (int c = 0; c < 3; ++c)
      if (isnan(value[c]) || value[c] > most[c]) most[c] = value[c];
  }
  imageStore(largest, pixel, vec4(most, 1.0));
}
