#version 450
// Between two bounces: occupied voxels reflect the light that arrives at them. Mavridis & Papaioannou 2011, end of Sec. 3.3, alternate two
// buffers and do not say how light is reflected. Here each side of a voxel's surface emits its
// irradiance, times albedo / pi, into its half space. DIRECT: adds the direct light that the voxels reflect.
#pragma lumivox axis DIRECT 0 1
#define VOLUMES 3
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
#include "reconstruct.glsl"
#include "feeding.glsl"
layout(binding = 0) uniform sampler3D opacity;
layout(binding = 1) uniform sampler3D meanNormals;
layout(binding = 2) uniform sampler3D albedo;
layout(binding = 0, rgba32f) uniform writeonly image3D redImage;
layout(binding = 1, rgba32f) uniform writeonly image3D greenImage;
layout(binding = 2, rgba32f) uniform writeonly image3D blueImage;
#if DIRECT
layout(std140, binding = 0) uniform Beside { float directUnit; };  // radiance of the number 1, W/(sr m^2)
layout(binding = 3) uniform sampler3D directRed;
layout(binding = 4) uniform sampler3D directGreen;
layout(binding = 10) uniform sampler3D directBlue;
#endif

// Radiance that the side of a normal reflects, W/(sr m^2).
vec3 sentInto(ivec3 voxel, vec3 normal, vec3 reflects) {
  Arriving arriving;
  if (feedsOwn != 0) arriving.volumes = vec4[3](texelFetch(red, voxel, 0), texelFetch(green, voxel, 0), texelFetch(blue, voxel, 0));
  else arriving = arrivingAt(vec3(voxel) + 0.5, normal);
  vec4 cosine = shClampedCosine(normal);
  vec3 irradiance = vec3(dot(arriving.volumes[0], cosine), dot(arriving.volumes[1], cosine), dot(arriving.volumes[2], cosine));
  return reflects / kPi * max(irradiance, 0.0);
}

void main() {
  ivec3 voxel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(voxel, resolution)) || texelFetch(opacity, voxel, 0).r <= occupied) return;
  vec3 normal = surfaceNormal(texelFetch(meanNormals, voxel, 0).xyz, texelFetch(red, voxel, 0), texelFetch(green, voxel, 0),
                              texelFetch(blue, voxel, 0));
  if (normal == vec3(0.0)) normal = vec3(0.0, 0.0, 1.0);
  vec3 reflects = texelFetch(albedo, voxel, 0).rgb;
  vec3 front = sentInto(voxel, normal, reflects), back = sentInto(voxel, -normal, reflects);
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
