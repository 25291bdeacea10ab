#version 450
// Writes the finest level of the grid from the integer sums: radiance pre-multiplied by opacity, and opacity. The opacity of an occupied
// voxel is the coverage of its fragments (thesis 004 Listing 4.10: always 1).
//
// With MEDIUM the voxels hold the participating media as well (thesis 004 Sec. 4.5: a regular grid has room for smoke in its empty voxels,
// so that the cones that gather surfaces see it). A voxel of width w and extinction sigma_t has the opacity 1 - exp(-sigma_t w). Its
// radiance is the light that it scatters, equal in all directions: a voxel has one radiance for all directions.
//
// DIRECTIONS: the same for each of the six faces of a voxel.
// REFLECTED: light of bounces is added to the direct light of the sums.
// CHANGED: the listed bricks hold values of an earlier frame, so that voxels that have become empty are cleared.
#pragma lumivox axis DIRECTIONS 0 1
#pragma lumivox axis LIGHTS 0 1
#pragma lumivox axis MEDIUM none even varying
#pragma lumivox axis CHANGED 0 1
#pragma lumivox require (!LIGHTS || MEDIUM != none) && (!CHANGED || (MEDIUM == none && !REFLECTED))

#include "common/voxel.glsl"
#include "../resolved.glsl"
#if MEDIUM != MEDIUM_NONE
#if LIGHTS
#define SHADOW_VIEWS
#endif
#include "common/media.glsl"
#endif

#if MEDIUM == MEDIUM_NONE
layout(local_size_x = 64) in;
#include "common/list.glsl"
#else
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
#endif

layout(std140, binding = 0) uniform Parameters {
  ivec3 brickCount;
  float unit;       // radiance of the value 1 of the grid, W/(sr m^2)
  ivec3 resolution;
  int coverageSum;  // opacity of a voxel: 1: the sum of its coverages, at most 1; 0: their mean, with DIRECTIONS the largest
  vec3 gridLow;     // m
  float voxelSize;  // m
  int lightCount;
  int mediumSteps;     // step limit through a heterogeneous medium, towards a light
  float mostRadiance;  // limit of the radiance of a voxel of this size, W/(sr m^2)
};
layout(std430, binding = 3) readonly buffer Bricks { Brick bricks[]; };
#if DIRECTIONS
layout(std430, binding = 4) readonly buffer DirectionalSums { VoxelDirections directions[]; };
#include "../face_images.glsl"

#include "../face_sums.glsl"

void store(ivec3 voxel, bool occupied, uint place, vec4 media) {
  vec4 faces[6];
  for (int face = 0; face < 6; ++face) {
    faces[face] = occupied ? withReflected(faceOf(place, face, coverageSum != 0, unit), 6u * place + uint(face), unit) : vec4(0.0);
    faces[face] += (1.0 - faces[face].a) * media;
  }
  storeFaces(voxel, faces);
}
#else
layout(std430, binding = 4) readonly buffer Sums { VoxelSums sums[]; };
layout(binding = 0) uniform writeonly image3D radianceImage;  // of any float format

void store(ivec3 voxel, bool occupied, uint place, vec4 media) {
  vec4 value = occupied ? withReflected(surfacesOf(sums[place], coverageSum != 0, unit), place, unit) : vec4(0.0);
  imageStore(radianceImage, voxel, value.a < 1.0 ? value + (1.0 - value.a) * media : value);
}
#endif

#if MEDIUM == MEDIUM_NONE
layout(std430, binding = 0) readonly buffer BrickList { uint brickList[]; };
layout(std430, binding = 1) readonly buffer BrickCount { uint listed; };

void main() {
  uint item = listIndex();
  if (item / 64u >= listed) return;
  ivec3 voxel = voxelOf(unpackVoxel(brickList[item / 64u]), item % 64u);
  Brick brick = bricks[brickOf(voxel, brickCount)];
  bool occupied = isOccupied(brick, item % 64u);
  if (occupied || CHANGED != 0) store(voxel, occupied, sumsOf(brick, item % 64u), vec4(0.0));
}
#else
// Fluence at a point due to the lights, W/m^2.
vec3 fluence(vec3 posWorld) {
  vec3 sum = vec3(0.0);
#if LIGHTS
  for (int i = 0; i < lightCount; ++i) {
    vec3 toLight;
    vec3 arriving = arrivingIrradiance(lights[i], posWorld, toLight);
    if (any(greaterThan(arriving, vec3(0.0)))) arriving *= visibility(lights[i], posWorld, toLight, toLight);
    if (any(greaterThan(arriving, vec3(0.0)))) arriving *= transmittanceToLight(lights[i], posWorld, mediumSteps);
    sum += arriving;
  }
#endif
  return sum;
}

// Mean density of a medium in a voxel.
float meanDensity(int medium, vec3 low) {
  vec3 overlap = min(media[medium].highDensity.xyz, low + voxelSize) - max(media[medium].lowAnisotropy.xyz, low);
  if (any(lessThanEqual(overlap, vec3(0.0)))) return 0.0;
#if MEDIUM == MEDIUM_VARYING
  if (!isEven(medium)) {
    // About one sample per voxel of the medium along each axis.
    const float kMostSamples = 4.0;
    int samples = int(clamp(ceil(voxelSize / media[medium].gridLowVoxel.w), 1.0, kMostSamples));
    float sum = 0.0;
    for (int i = 0; i < samples * samples * samples; ++i) {
      vec3 share = (vec3(i % samples, i / samples % samples, i / (samples * samples)) + 0.5) / float(samples);
      sum += densityAt(medium, low + voxelSize * share);
    }
    return sum / float(samples * samples * samples);
  }
#endif
  return overlap.x * overlap.y * overlap.z / (voxelSize * voxelSize * voxelSize);
}

vec4 mediaIn(ivec3 voxel) {
  vec3 low = gridLow + vec3(voxel) * voxelSize;
  vec3 depth = vec3(0.0), scattering = vec3(0.0);
  for (int i = 0; i < mediumCount; ++i) {
    float extent = meanDensity(i, low) * voxelSize;
    depth += media[i].extinction.rgb * extent;
    scattering += media[i].scattering.rgb * extent;
  }
  // One opacity for all channels; each channel scatters by its own depth.
  float opacity = 1.0 - exp(-(depth.r + depth.g + depth.b) / 3.0);
  if (opacity <= 0.0) return vec4(0.0);
  vec3 albedo = mix(scattering / max(depth, vec3(1e-30)), vec3(0.0), equal(depth, vec3(0.0)));
  vec3 radiance = min(albedo * fluence(low + 0.5 * voxelSize) / (4.0 * kPi), mostRadiance);
  return vec4(radiance * (1.0 - exp(-depth)) / unit, opacity);
}

void main() {
  ivec3 voxel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(voxel, resolution))) return;
  Brick brick = bricks[brickOf(voxel, brickCount)];
  uint bit = bitOf(voxel);
  store(voxel, isOccupied(brick, bit), sumsOf(brick, bit), mediaIn(voxel));  // media fill the share that surfaces leave open
}
#endif
