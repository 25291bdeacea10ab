#version 450
// Indirect diffuse light at the visible surfaces (thesis 004 Sec. 4.3.5, Listings 4.35 and 4.36). One dispatch per grid, the coarsest
// first; each finer grid is blended over the coarser ones.
#include "cells.glsl"
#include "beside_walls.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const int filtered = 0;        // 1: filtered reads, as in Listing 4.35
layout(constant_id = 1) const int closure = 1;         // 0: negative values of two bands are clamped to 0
layout(constant_id = 2) const int ownLobe = 0;       // 1: lobe and unit of Listing 4.35
layout(constant_id = 3) const int radialBlend = 0;   // 1: blended as in Listing 4.36

#include "cell_grid.glsl"
layout(std140, binding = 0) uniform Parameters {
  float blend;         // width of the seam, cells
  float offset;        // offset of the lookup along the normal, cells
  float exponent;      // of the radiance
  int first, last;     // 1 for the first and the last dispatch
  vec3 eye;            // m, centre of the grids in Listing 4.36
  float innerReach;    // radialBlend: distance from the eye up to which only this grid counts, m
  float outerReach;    // radialBlend: distance from which on only the coarser grid counts, m
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
layout(binding = 2) uniform sampler2D gGeometricNormal;
layout(binding = 3) uniform sampler2D gDiffuse;
layout(binding = 5) uniform sampler3D red;
layout(binding = 6) uniform sampler3D green;
layout(binding = 7) uniform sampler3D blue;
layout(binding = 8) uniform sampler3D occluded;
layout(binding = 0, rgba32f) uniform image2D diffuseImage;
layout(binding = 1, rgba32f) uniform image2D clippedImage;

// Limits, in cells, how far a lookup leaves its first cell sideways: less than half a cell, so that the first cell always counts.
const float kReach = 0.49;
// W/(sr m^2): limit that keeps the power of a bright radiance finite.
const float kMostRadiance = 1e30;

// How open the eight cells from `low` on are, seen from `base`, one of them: the narrowest face on the widest path within the eight; a face
// that is at least half open counts as fully open. All cells that are open from each other see the same cells as open, so that there is no
// jump where a surface continues from one cell into the next. x is the lowest bit of a cell's number.
float[8] openWays(ivec3 low, ivec3 base) {
  float open[24];
  for (int corner = 0; corner < 8; ++corner) {
    vec3 share = texelFetch(occluded, clamp(low + ivec3(corner & 1, corner >> 1 & 1, corner >> 2), ivec3(0), resolution), 0).xyz;
    for (int axis = 0; axis < 3; ++axis) open[3 * corner + axis] = min(2.0 * (1.0 - share[axis]), 1.0);
  }
  ivec3 start = clamp(base - low, ivec3(0), ivec3(1));
  float reached[8] = float[8](0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
  reached[start.x | start.y << 1 | start.z << 2] = 1.0;
  bool changed = true;
  while (changed) {
    changed = false;
    for (int corner = 0; corner < 8; ++corner)
      for (int axis = 0; axis < 3; ++axis) {
        int other = corner ^ 1 << axis;
        float way = min(reached[other], open[3 * max(corner, other) + axis]);
        if (way <= reached[corner]) continue;
        reached[corner] = way;
        changed = true;
      }
  }
  return reached;
}

// Light of intensity c . Y in a cell is converted to a radiance by the mean projected area of the cell, 3/2 h^2 (Cauchy: a quarter of its
// surface). The irradiance of a surface is the integral of this radiance with the cosine: `mean`, equal on both sides, plus or minus `net`.
// With two bands, mean + net can be negative. Deviates: with the closure, sqrt(mean^2 + net^2) replaces the mean. It is the smallest smooth
// function that keeps the difference between the sides exact and both sides non-negative.
struct Irradiance {
  vec3 value;    // W/m^2
  vec3 clipped;  // the negative part with two bands, as a positive value
};
Irradiance irradianceOf(vec4 redLight, vec4 greenLight, vec4 blueLight, vec3 normal) {
  // As published: the lobe around the normal itself, so that light that moves away from the surface counts; and the area of a cell's face,
  // h^2, instead of its mean projected area.
  vec4 lobe = ownLobe != 0 ? shClampedCosine(normal) / (cellSize * cellSize)
                           : shClampedCosine(-normal) / (kMeanProjection * cellSize * cellSize);
  vec3 mean = lobe.x * vec3(redLight.x, greenLight.x, blueLight.x);
  vec3 net = vec3(dot(redLight.yzw, lobe.yzw), dot(greenLight.yzw, lobe.yzw), dot(blueLight.yzw, lobe.yzw));
  vec3 clipped = max(-(mean + net), 0.0);
  // Squares relative to the larger value: squares of amplified light could overflow.
  vec3 larger = max(max(abs(mean), abs(net)), vec3(1e-30));
  vec3 both = larger * sqrt((mean / larger) * (mean / larger) + (net / larger) * (net / larger));
  return Irradiance(closure != 0 ? max(both + net, 0.0) : mean + net, clipped);
}

Irradiance irradianceAt(vec3 position, vec3 normal, vec3 geometricNormal) {
  // The surface is moved to the nearest plane of faces, as it is for the light. Paths begin in the cell in front of it.
  int dominant = dominantAxis(geometricNormal);
  int up = geometricNormal[dominant] >= 0.0 ? 1 : -1;
  ivec3 base = clamp(cellBeside(position, geometricNormal), ivec3(0), resolution - 1);
  // A lookup one cell away along the dominant axis does not change when the plane jumps; it is never behind the first cell's centre.
  vec3 away = geometricNormal * (offset / abs(geometricNormal[dominant]));
  vec3 lookup = clamp(position + clamp(away, vec3(-0.5), vec3(0.5)), vec3(base) - kReach, vec3(base) + 1.0 + kReach);
  float centre = float(base[dominant]) + 0.5;
  lookup[dominant] = position[dominant] + away[dominant];
  lookup[dominant] = up > 0 ? clamp(lookup[dominant], centre, centre + 1.0) : clamp(lookup[dominant], centre - 1.0, centre);

  ivec3 low = ivec3(floor(lookup - 0.5));
  vec3 share = lookup - 0.5 - vec3(low);
  float reached[8] = openWays(low, base);
  vec4 redSum = vec4(0.0), greenSum = vec4(0.0), blueSum = vec4(0.0);
  float weights = 0.0;
  // Between surfaces less than a cell apart, the first cell may be closed on all sides and without light. Then all cells with light count,
  // whatever surfaces lie between.
  for (int attempt = 0; attempt < 2 && redSum.x + greenSum.x + blueSum.x <= 0.0; ++attempt) {
    redSum = greenSum = blueSum = vec4(0.0);
    weights = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      ivec3 high = ivec3(corner & 1, corner >> 1 & 1, corner >> 2);
      ivec3 cell = clamp(low + high, ivec3(0), resolution - 1);
      vec3 part = mix(1.0 - share, share, vec3(high));
      float weight = part.x * part.y * part.z;
      vec4 redLight = texelFetch(red, cell, 0), greenLight = texelFetch(green, cell, 0), blueLight = texelFetch(blue, cell, 0);
      if (attempt == 0) weight *= reached[corner];
      else if (redLight.x + greenLight.x + blueLight.x <= 0.0) continue;
      redSum += weight * redLight;
      greenSum += weight * greenLight;
      blueSum += weight * blueLight;
      weights += weight;
    }
  }
  if (weights <= 0.0) return Irradiance(vec3(0.0), vec3(0.0));
  return irradianceOf(redSum / weights, greenSum / weights, blueSum / weights, normal);
}

// Listing 4.35: filtered at the surface, regardless of surfaces between; half a cell too low along z, as printed.
Irradiance filteredIrradiance(vec3 position, vec3 normal) {
  vec3 texcoord = (position - vec3(0.0, 0.0, 0.5)) / vec3(resolution);
  return irradianceOf(texture(red, texcoord), texture(green, texcoord), texture(blue, texcoord), normal);
}

// Weight of this grid against the coarser grid.
float shareOfGrid(vec3 position, vec3 posWorld) {
  if (radialBlend != 0) {
    // Listing 4.36: by the distance to the eye only; the coarsest grid has no end.
    if (first != 0) return 1.0;
    return clamp((outerReach - distance(posWorld, eye)) / (outerReach - innerReach), 0.0, 1.0);
  }
  // Distance to the border in cells; the coarsest grid fades out at its border.
  vec3 inside = min(position, vec3(resolution) - position);
  float toBorder = min(inside.x, min(inside.y, inside.z));
  return first != 0 ? clamp(toBorder, 0.0, 1.0) : clamp((toBorder - 1.0) / blend, 0.0, 1.0);
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(gPosition, 0)))) return;
  vec4 posWorld = texelFetch(gPosition, pixel, 0);
  vec3 irradiance = vec3(0.0), clipped = vec3(0.0);
  if (first == 0) {
    irradiance = imageLoad(diffuseImage, pixel).rgb;
    clipped = imageLoad(clippedImage, pixel).rgb;
  }
  if (posWorld.w > 0.0) {
    vec3 position = (posWorld.xyz - gridLow) / cellSize;
    float weight = shareOfGrid(position, posWorld.xyz);
    if (weight > 0.0) {
      vec3 normal = texelFetch(gNormal, pixel, 0).xyz;
      Irradiance here;
      if (filtered != 0) here = filteredIrradiance(position, normal);
      else here = irradianceAt(position, normal, texelFetch(gGeometricNormal, pixel, 0).xyz);
      irradiance = mix(irradiance, here.value, weight);
      clipped = mix(clipped, here.clipped, weight);
    }
    if (last != 0) {
      vec3 albedo = texelFetch(gDiffuse, pixel, 0).rgb;
      vec3 radiance = max(irradiance, 0.0) / kPi;
      if (exponent != 1.0) radiance = min(pow(radiance, vec3(exponent)), vec3(kMostRadiance));
      irradiance = albedo * radiance;
      clipped *= albedo / kPi;
    }
  }
  imageStore(diffuseImage, pixel, vec4(irradiance, 1.0));
  imageStore(clippedImage, pixel, vec4(clipped, 1.0));
}
