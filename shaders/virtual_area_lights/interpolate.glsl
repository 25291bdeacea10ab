// Sec. 3.2 step 3 (Eq. 12, 13): the averaged lights of the nearest points as one.
#ifndef LUMIVOX_INTERPOLATE
#define LUMIVOX_INTERPOLATE
#define POINT_CANDIDATES
#include "surface_points.glsl"
#include "light.glsl"

const int kMostNeighbours = 32;  // of the pass 'points'
layout(constant_id = 0) const int neighbours = 8;

// By growing distances. All places are known when the program is linked, so that loops unroll and everything stays in registers.
struct Nearest {
  uint points[kMostNeighbours];
  float distancesSquared[kMostNeighbours];
  int count;
  float farthestSquared;  // of the last of them
};

// What is seen.
struct SeenSurface {
  vec3 position, normal;
  float model;
};

void keep(inout Nearest nearest, uint point, float distanceSquared) {
  // Points come by growing numbers, so that of equal distances the first stays.
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

// The nearest points of the same model whose normals are off by no more than the angle of cosine `alike`, none farther than where all are
// listed, unless it is the only one; with an exponent of 0 or more only those that reflect by it.
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

// Those of the same side. Where these all lie on surfaces across an edge, which light nothing here (Eq. 12: a foot of a wall among the points
// of the floor), those that face as what is seen does.
Nearest nearestPoints(SeenSurface seen, float exponent) {
  Nearest nearest = nearestAlike(seen, kOtherSideCosine, exponent);
  for (int i = 0; i < neighbours; ++i)
    if (i < nearest.count && dot(seen.normal, texelFetch(pointNormal, pointTexel(nearest.points[i]), 0).xyz) >= kAlikeCosine) return nearest;
  Nearest alike = nearestAlike(seen, kAlikeCosine, exponent);
  if (alike.count > 0) return alike;
  return nearest;
}

// Weight of a neighbour by Eq. 12, or of its normal alone. Distances that differ by their rounding are equal, and a neighbour across an edge
// counts nothing: by rounding it would be all that counts where the only one that faces alike is the last.
float neighbourWeight(SeenSurface seen, uint point, float distanceSquared, float farthestSquared, bool byDistance) {
  const float kRounding = 1e-5;
  float alike = dot(seen.normal, texelFetch(pointNormal, pointTexel(point), 0).xyz);
  if (alike < kAlikeCosine) return 0.0;
  if (!byDistance) return alike;
  float near = farthestSquared > 0.0 ? 1.0 - sqrt(distanceSquared / farthestSquared) : 0.0;
  return near > kRounding ? alike * near : 0.0;
}

// `glossy`: the light of points that reflect nothing towards the camera (w = 0) does not count, and as `seenFromPoints` offsets from the
// points are averaged. Deviates from Eq. 13, which averages places: what a lobe catches of an area wider than itself moves along with the
// point. Where all neighbours lie on one side, above all where surfaces meet, a mean of places is out of the lobe of what is seen there.
// `plain`: of what points reflect, in place of their lights.
AveragedLight interpolated(SeenSurface seen, Nearest nearest, sampler2D lights, sampler2D places, bool glossy, bool seenFromPoints,
                           bool plain) {
  vec4 light = vec4(0.0);
  vec3 offset = vec3(0.0);  // from what is seen, so that nothing is lost far from the origin
  float weights = 0.0;
  // By Eq. 12; where all weights are 0 by the normals alone; where these are too, the nearest.
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
