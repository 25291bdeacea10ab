#version 450
// A coarser mip level for cones: the mean over the children that a coarse voxel overlaps, weighted by the overlap.
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(std140, binding = 0) uniform Mean {
  ivec3 coarse;
  int fineLevel;
  ivec3 fine;
};
layout(binding = 0) uniform sampler3D classified;
layout(binding = 0, rgba32f) uniform writeonly image3D meanImage;

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, coarse))) return;
  vec3 ratio = vec3(fine) / vec3(coarse), low = vec3(cell) * ratio, high = low + ratio;
  ivec3 first = ivec3(floor(low)), last = min(ivec3(ceil(high)) - 1, fine - 1);
  vec4 sum = vec4(0.0);
  float weight = 0.0;
  for (int z = first.z; z <= last.z; ++z)
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x) {
        vec3 part = clamp(min(high, vec3(x, y, z) + 1.0) - max(low, vec3(x, y, z)), 0.0, 1.0);
        sum += part.x * part.y * part.z * texelFetch(classified, ivec3(x, y, z), fineLevel);
        weight += part.x * part.y * part.z;
      }
  imageStore(meanImage, cell, sum / weight);
}
