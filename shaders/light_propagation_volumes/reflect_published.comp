#version 450
// The reflection grid as printed (thesis 004 Sec. 4.3.4, Listing 4.34): the albedo times the mean of the light of the finest cells from all
// sides. That is the coefficient Y00 of the light per area of a cell's face, times the coefficient of a clamped cosine, times the albedo
// over pi. The lookup lacks half a voxel along z. The text lets the light fade out with the distance to the centre of the grid, without the
// distance at which it is gone: here half a side, where the grid ends.
#include "common/spherical_harmonics.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

#include "cell_grid.glsl"
layout(std140, binding = 0) uniform Parameters {
  float fadeDistance;   // m
  vec3 reflectionLow;   // m
  float voxelSize;      // m
  vec3 centre;          // m, where the light does not fade: the eye
};
layout(binding = 0) uniform sampler3D red;
layout(binding = 1) uniform sampler3D green;
layout(binding = 2) uniform sampler3D blue;
layout(binding = 3) uniform sampler3D surfaceAlbedo;
layout(binding = 0, rgba32f) uniform writeonly image3D radianceImage;

void main() {
  ivec3 voxel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(voxel, imageSize(radianceImage)))) return;
  vec4 albedo = texelFetch(surfaceAlbedo, voxel, 0);
  vec4 result = vec4(0.0);
  if (albedo.a > 0.0) {
    vec3 texcoord = (reflectionLow + (vec3(voxel) + vec3(0.5, 0.5, 0.0)) * voxelSize - gridLow) / (cellSize * vec3(resolution));
    vec3 ambient = kPi * kY0 * vec3(texture(red, texcoord).x, texture(green, texcoord).x, texture(blue, texcoord).x) / (cellSize * cellSize);
    vec3 position = reflectionLow + (vec3(voxel) + 0.5) * voxelSize;
    float fade = 1.0 - clamp(distance(position, centre) / fadeDistance, 0.0, 1.0);
    result = vec4(albedo.rgb / kPi * ambient * fade, 1.0);
  }
  imageStore(radianceImage, voxel, result);
}
