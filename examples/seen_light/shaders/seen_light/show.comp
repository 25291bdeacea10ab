#version 450
// What a Lambert surface reflects of the light in a grid.
#include "common/spherical_harmonics.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = 0) uniform Grid {
  vec3 gridLow;     // m, relative to the snapshot's origin
  float voxelSize;  // m
  ivec3 resolution;
  float unit;       // W/(sr m^2) that the number 1 stands for
};

layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
layout(binding = 2) uniform sampler2D gDiffuse;
layout(binding = 3) uniform sampler3D red;
layout(binding = 4) uniform sampler3D green;
layout(binding = 5) uniform sampler3D blue;
layout(binding = 0, rgba32f) uniform writeonly image2D diffuseImage;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(diffuseImage)))) return;
  vec3 reflected = vec3(0.0);
  vec4 position = texelFetch(gPosition, pixel, 0);
  if (position.w != 0.0) {
    vec3 normal = texelFetch(gNormal, pixel, 0).xyz;
    // One voxel before the surface: its own voxel is occupied.
    vec3 place = ((position.xyz - gridLow) / voxelSize + normal) / vec3(resolution);
    vec4 cosine = shClampedCosine(normal);
    vec3 irradiance = unit * vec3(dot(textureLod(red, place, 0.0), cosine),
                                  dot(textureLod(green, place, 0.0), cosine),
                                  dot(textureLod(blue, place, 0.0), cosine));
    reflected = texelFetch(gDiffuse, pixel, 0).rgb / kPi * max(irradiance, vec3(0.0));  // two bands may go below 0
  }
  imageStore(diffuseImage, pixel, vec4(reflected, 1.0));
}
