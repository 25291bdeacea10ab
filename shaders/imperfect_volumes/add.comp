#version 450
// Adds a bounce to the sum of the previous bounces.
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
layout(binding = 0, rgba32f) uniform readonly image3D bounceImage;
layout(binding = 1, rgba32f) uniform image3D sumImage;

void main() {
  ivec3 voxel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(voxel, imageSize(sumImage)))) return;
  imageStore(sumImage, voxel, imageLoad(sumImage, voxel) + imageLoad(bounceImage, voxel));
}
