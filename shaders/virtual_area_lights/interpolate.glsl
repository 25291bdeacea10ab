// Sec. 3.2 step 3 (Eq. 12, 13): interpolates the averaged lights of the nearest points.
#ifndef LUMIVOX_INTERPOLATE
#define LUMIVOX_INTERPOLATE
#define POINT_CANDIDATES
#include "surface_points.glsl"
#include "light.glsl"

const int kMostNeighbours = 32;  // limit of the pass 'points'
layout(constant_id = 0) const int neighbours = 8;

// The nearest points, by increasing distance. All indices are known when the program is linked, so that
// loops unroll and the arrays stay in registers.
struct Nearest {
  uint points[kMostNeighbours];
  float distancesSquared[kMostNeighbours];
  int count;
  float farthestSquared;  // squared distance of the last point
};

// The visible surface.
struct SeenSurface {
  vec3 position, normal;
  float model;
};

void keep(inout Nearest nearest, uint point, float distanceSquared) {
  // Points come in increasing order, so that of equally distant points the first is kept.
  for (int i = neighbours - 1; i > 0; --i) {
    bool moves = nearest.distancesSquared[i - 1] > distanceSquared, enters = nearest.distancesSquared[i] > distanceSquared;
    nearest.points[i] = moves ? nearest.points[i - 1] : enters ? point : nearest.points[i];
    nearest.distancesSquared[i] = moves ? nearest.distancesSquared[i - 1] : enters ? distanceSquared : nearest.distancesSquared[i];
  }
  if (nearest.distancesSquared[0] > distanceSquared) {
    nearest.points[0] = point;
    nearest.distancesSquared[0] = distanceSquared;
  }
}

// The nearest points of the same model whose normals have at least the cosine `alike` to the surface's. None but the nearest is farther
// than pointFarthest, up to which the candidates are complete. With an exponent of 0 or more, only glossy points of this exponent count.
Nearest nearestAlike(SeenSurface seen, float alike, float exponent) {
  const float kNone = 3.4e38;
  Nearest nearest;
  for (int i = 0; i < neighbours; ++i) {
    nearest.points[i] = 0u;
    nearest.distancesSquared[i] = kNone;
  }
  uvec2 candidates = candidatesAt(seen.position);
  for (uint i = candidates.x; i < candidates.y; ++i) {
    uint point = pointCandidates[i];
    ivec2 texel = pointTexel(point);
    vec4 normal = texelFetch(pointNormal, texel, 0);
    if (normal.w != seen.model || dot(seen.normal, normal.xyz) < alike) continue;
    if (exponent >= 0.0) {
      vec4 radius = texelFetch(pointRadius, texel, 0);
      if (radius.y != exponent || radius.z == 0.0) continue;
    }
    vec3 path = texelFetch(pointPosition, texel, 0).xyz - seen.position;
    keep(nearest, point, dot(path, path));
  }
  nearest.count = nearest.distancesSquared[0] < kNone ? 1 : 0;
  nearest.farthestSquared = nearest.distancesSquared[0];
  for (int i = 1; i < neighbours; ++i)
    if (nearest.distancesSquared[i] < kNone && nearest.distancesSquared[i] <= pointFarthest * pointFarthest) {
      nearest.count = i + 1;
      nearest.farthestSquared = nearest.distancesSquared[i];
    }
  return nearest;
}

// The nearest points on the same side. If these all lie on surfaces across an edge, which have no weight here (Eq. 12: the foot of a wall
// among points of the floor), the nearest points with similar normals.
Nearest nearestPoints(SeenSurface seen, float exponent) {
  Nearest nearest = nearestAlike(seen, kOtherSideCosine, exponent);
  for (int i = 0; i < neighbours; ++i)
    if (i < nearest.count && dot(seen.normal, texelFetch(pointNormal, pointTexel(nearest.points[i]), 0).xyz) >= kAlikeCosine) return nearest;
  Nearest alike = nearestAlike(seen, kAlikeCosine, exponent);
  if (alike.count > 0) return alike;
  return nearest;
}

// Weight of a neighbour by Eq. 12, or by its normal only. Distances that differ by rounding count as equal. A neighbour across an edge has
// weight 0: otherwise its rounding error would be the only weight if the only neighbour with a similar normal is the farthest.
float neighbourWeight(SeenSurface seen, uint point, float distanceSquared, float farthestSquared, bool byDistance) {
  const float kRounding = 1e-5;
  float alike = dot(seen.normal, texelFetch(pointNormal, pointTexel(point), 0).xyz);
  if (alike < kAlikeCosine) return 0.0;
  if (!byDistance) return alike;
  float near = farthestSquared > 0.0 ? 1.0 - sqrt(distanceSquared / farthestSquared) : 0.0;
  return near > kRounding ? alike * near : 0.0;
}

// `glossy`: points that reflect nothing towards the camera (w = 0) do not count. `seenFromPoints`: averages offsets from the points.
// Deviates from Eq. 13, which averages positions: the part of a large area that a lobe sees moves along with the point. If all neighbours
// lie on one side, above all where surfaces meet, a mean of positions lies outside the lobe of the visible surface. `plain`: averages the
// light that the points reflect, instead of their lights.
AveragedLight interpolated(SeenSurface seen, Nearest nearest, sampler2D lights, sampler2D places, bool glossy, bool seenFromPoints,
                           bool plain) {
  vec4 light = vec4(0.0);
  vec3 offset = vec3(0.0);  // from the visible surface, so that no precision is lost far from the origin
  float weights = 0.0;
  // First by Eq. 12; if all weights are 0, by the normals only; if these are 0 too, the nearest point.
  for (int attempt = 0; attempt < 3 && weights <= 0.0; ++attempt)
    for (int i = 0; i < neighbours; ++i) {
      if (i >= nearest.count) continue;
      float weight = attempt == 2 ? (weights > 0.0 ? 0.0 : 1.0)
                                  : neighbourWeight(seen, nearest.points[i], nearest.distancesSquared[i], nearest.farthestSquared, attempt == 0);
      if (!(weight > 0.0)) continue;
      ivec2 texel = pointTexel(nearest.points[i]);
      vec4 here = texelFetch(lights, texel, 0);
      if (glossy && here.w <= 0.0) continue;
      vec3 place = texelFetch(places, texel, 0).xyz;
      vec3 position = texelFetch(pointPosition, texel, 0).xyz;
      if (plain) here.rgb *= cosineTo(place, position, texelFetch(pointNormal, texel, 0).xyz);
      light += weight * here;
      offset += weight * (place - (seenFromPoints ? position : seen.position));
      weights += weight;
    }
  if (weights <= 0.0) return AveragedLight(vec4(0.0), seen.position);
  return AveragedLight(light / weights, seen.position + offset / weights);
}
#endif
