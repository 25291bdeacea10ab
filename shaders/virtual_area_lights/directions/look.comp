#version 450
// What each point sees: the nearest disc of another point in the middle of each of its directions, by the loop over discs of Sec. 3.3. The
// box of the disc's circle in the projected hemisphere tells which directions are asked.
layout(local_size_x = 64) in;
#include "common/list.glsl"
#include "../surface_points.glsl"
#include "sight.glsl"

layout(std140, binding = 0) uniform Parameters {
  int firstDisc, discs;  // range of this dispatch
  int begins;            // 1: the first dispatch
};
layout(std430, binding = 0) buffer Sight { uint nearest[]; };

const int kCells = kSightSide * kSightSide;
// Entries of a work group: one point an invocation, so that neighbours lie in different banks.
shared uint found[kCells * 64];

// Whether any cell's middle may see a disc, and which: the box of its circle in the square.
bool cellsOf(vec3 toDisc, float radius, float distance, out ivec2 first, out ivec2 end) {
  // A sphere of this radius is seen within this sine; projecting makes nothing longer.
  float sine = min(1.0, radius / distance);
  vec2 disc = toDisc.xy / distance;
  if (sine > 0.5 || toDisc.z < radius) {
    first = ivec2(0);
    end = ivec2(kSightSide);
    return true;
  }
  // The concentric map stretches by at most sqrt(2) * 2 / sqrt(pi), half of it in 0..1.
  vec2 place = squareFromDisc(disc);
  float reach = 0.85 * sine;
  first = max(ivec2(ceil((place - reach) * float(kSightSide) - 0.5)), ivec2(0));
  end = min(ivec2(floor((place + reach) * float(kSightSide) - 0.5)) + 1, ivec2(kSightSide));
  return all(lessThan(first, end));
}

void main() {
  uint index = listIndex(), lane = gl_LocalInvocationID.x;
  if (index >= uint(pointCount)) return;
  ivec2 texel = pointTexel(index);
  vec3 position = texelFetch(pointPosition, texel, 0).xyz, normal = texelFetch(pointNormal, texel, 0).xyz;
  for (int cell = 0; cell < kCells; ++cell)
    found[cell * 64 + int(lane)] = begins != 0 ? kSeesNothing : nearest[int(index) * kCells + cell];
  if (normal != vec3(0.0)) {
    vec3 tangent, binormal;
    planeAxes(normal, tangent, binormal);
    for (int i = firstDisc; i < firstDisc + discs; ++i) {
      ivec2 discTexel = pointTexel(uint(i));
      vec3 offset = texelFetch(pointPosition, discTexel, 0).xyz - position, discNormal = texelFetch(pointNormal, discTexel, 0).xyz;
      float radius = texelFetch(pointRadius, discTexel, 0).x;
      // The plane of the disc; only its front occludes, as in occlude.comp.
      float plane = dot(offset, discNormal), above = dot(offset, normal);
      if (!(plane < 0.0) || !(above > -radius) || i == int(index)) continue;
      vec3 toDisc = vec3(dot(offset, tangent), dot(offset, binormal), above);
      ivec2 first, end;
      if (!cellsOf(toDisc, radius, length(toDisc), first, end)) continue;
      vec3 turned = vec3(dot(discNormal, tangent), dot(discNormal, binormal), dot(discNormal, normal));
      for (int y = first.y; y < end.y; ++y)
        for (int x = first.x; x < end.x; ++x) {
          vec3 direction = sightDirection(ivec2(x, y));
          float along = dot(direction, turned);
          if (!(along < 0.0)) continue;
          float distance = plane / along;
          vec3 beside = distance * direction - toDisc;
          if (dot(beside, beside) > radius * radius) continue;
          int entry = (y * kSightSide + x) * 64 + int(lane);
          found[entry] = min(found[entry], sightEntry(distance, uint(i)));
        }
    }
  }
  for (int cell = 0; cell < kCells; ++cell) nearest[int(index) * kCells + cell] = found[cell * 64 + int(lane)];
}
