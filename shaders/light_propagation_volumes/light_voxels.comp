#version 450
// Doghramachi 2013; thesis 004 Sec. 4.3.2, Listing 4.30: illuminated voxels become virtual point lights, for all lights at once.
#define SHADOW_VIEWS
#include "common/lights.glsl"
#include "lit_voxel.glsl"
#include "virtual_lights.glsl"
#include "bricks.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

#include "cell_grid.glsl"
layout(std140, binding = 0) uniform Parameters {
  float largestFlux;  // W
  int lightCount;
  int contrastAlbedo;  // 1: the most contrasting albedo, as published; 0: the mean
  int closestNormal;   // 1: a light illuminates only the normal closest to its direction, as published; 0: all
  int wholeFaces;      // 1: a surface fills its voxel, as published; 0: the parts that it covers
};

// Irradiance by one light at the surface of a group, W/m^2.
vec3 irradianceFrom(LightSample light, vec3 posWorld, vec3 normal) {
  vec3 toLight;
  vec3 perpendicular = arrivingIrradiance(light, posWorld, toLight);
  float cosSurface = dot(normal, toLight);
  if (cosSurface <= 0.0) return vec3(0.0);
  return perpendicular * (cosSurface * visibility(light, posWorld, normal, toLight));
}

void main() {
  ivec3 cell = listedCell();
  if (any(greaterThanEqual(cell, resolution))) return;
  int voxel = (cell.z * resolution.y + cell.y) * resolution.x + cell.x;
  if (voxels[voxel].weight == 0u) return;
  vec3 albedo = signedMeanOf(voxels[voxel].albedo[0], voxels[voxel].albedo[1], voxels[voxel].albedo[2]);
  uint winner = voxels[voxel].winner;
  if (contrastAlbedo != 0) albedo = vec3(winner >> 16 & 255u, winner >> 8 & 255u, winner & 255u) / 255.0;

  vec3 centre = gridLow + (vec3(cell) + 0.5) * cellSize;
  vec3 normals[4], positions[4], irradiance[4];
  float areas[4];
  for (int i = 0; i < kGroups; ++i) {
    SurfaceGroup group = voxels[voxel].groups[i];
    vec3 mean = signedMeanOf(group.normal[0], group.normal[1], group.normal[2]);
    float size = length(mean);
    normals[i] = size > 0.0 ? mean / size : vec3(0.0);
    // Parts are counted on the plane of faces; the area of the surface is larger by its slant.
    vec3 slant = abs(normals[i]);
    uint parts = size > 0.0 ? (wholeFaces != 0 ? 16u : uint(bitCount(group.parts))) : 0u;
    areas[i] = parts == 0u ? 0.0 : float(parts) / 16.0 * cellSize * cellSize / max(slant.x, max(slant.y, slant.z));
    positions[i] = centre + signedMeanOf(group.position[0], group.position[1], group.position[2]) * (kPositionRange * cellSize);
    irradiance[i] = vec3(0.0);
  }
  for (int l = 0; l < lightCount; ++l) {
    LightSample light = lights[l];
    int closest = 0;
    float largest = -2.0;
    for (int i = 0; i < kGroups; ++i) {
      vec3 toLight;
      arrivingIrradiance(light, positions[i], toLight);
      if (areas[i] > 0.0 && dot(normals[i], toLight) > largest) {
        largest = dot(normals[i], toLight);
        closest = i;
      }
    }
    for (int i = 0; i < kGroups; ++i)
      if (areas[i] > 0.0 && (closestNormal == 0 || i == closest)) irradiance[i] += irradianceFrom(light, positions[i], normals[i]);
  }
  // No cell reflects more than all lights emit: near a light, the irradiance at one point is no measure for its cell.
  vec3 fluxes[4];
  float brightest = 0.0;
  for (int i = 0; i < kGroups; ++i) {
    fluxes[i] = min(albedo * irradiance[i] * areas[i], largestFlux);
    brightest = max(brightest, largestOf(fluxes[i]));
  }
  int place = sumsOf(cell, resolution);
  sums[place].brightest = floatBitsToUint(brightest);
  sums[place].lights = uint(kGroups);
  for (int i = 0; i < kGroups; ++i) addVirtualLight(place, fluxes[i], normals[i]);
}
