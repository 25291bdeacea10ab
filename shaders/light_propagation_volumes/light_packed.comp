#version 450
// Illuminated voxels become virtual point lights as printed (thesis 004 Listings 4.30 and 4.31): each voxel is lit at its centre, by each
// light on the normal closest to the light's direction, and emits as a clamped cosine around that normal. The light of all lights is
// summed. A printed coefficient is one of radiance: times the area of a cell's face, it is the
// intensity of a surface that fills the face, W/sr.
#define SHADOW_VIEWS
#include "common/lights.glsl"
#include "common/spherical_harmonics.glsl"
#include "packed_voxels.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

#include "cell_grid.glsl"
layout(std140, binding = 0) uniform Parameters {
  float largestFlux;  // W
  int lightCount;
};
layout(std430, binding = 3) readonly buffer Words { PackedVoxel words[]; };
layout(binding = 0, rgba32f) uniform writeonly image3D red;
layout(binding = 1, rgba32f) uniform writeonly image3D green;
layout(binding = 2, rgba32f) uniform writeonly image3D blue;

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, resolution))) return;
  vec4 channels[3] = vec4[3](vec4(0.0), vec4(0.0), vec4(0.0));
  int voxel = (cell.z * resolution.y + cell.y) * resolution.x + cell.x;
  uint albedo = words[voxel].albedo;
  if (albedo != 0u) {
    uvec4 directions = uvec4(words[voxel].directions[0], words[voxel].directions[1], words[voxel].directions[2], words[voxel].directions[3]);
    vec3 centre = gridLow + (vec3(cell) + 0.5) * cellSize;
    for (int l = 0; l < lightCount; ++l) {
      LightSample light = lights[l];
      vec3 toLight;
      vec3 perpendicular = arrivingIrradiance(light, centre, toLight);
      vec3 normal = closestNormal(directions, toLight);
      float cosSurface = dot(normal, toLight);
      if (!(cosSurface > 0.0)) continue;
      vec3 radiance = unpackAlbedo(albedo) * perpendicular * (cosSurface * visibility(light, centre, normal, toLight));
      // Deviates: limited, as in light_voxels.comp; the thesis has no light inside the scene.
      vec3 intensity = min(radiance * (cellSize * cellSize), largestFlux / kPi);
      for (int i = 0; i < 3; ++i) channels[i] += shClampedCosine(normal) * intensity[i];
    }
  }
  imageStore(red, cell, channels[0]);
  imageStore(green, cell, channels[1]);
  imageStore(blue, cell, channels[2]);
}
