// Finds the elements around a point of a surface: each size class of elements has a grid of cubes, and a hash table lists the elements of
// each cube. C++ side: techniques/implicit_visibility/elements/element_cells.h.
#ifndef LUMIVOX_NEIGHBOURS
#define LUMIVOX_NEIGHBOURS
#include "nodes.glsl"

const int kMostSizes = 16;
layout(std140, binding = 2) uniform Cells {
  vec4 cellSizes[kMostSizes];  // per grid: x width of a cube, m; y its reciprocal
  int sizes;
  uint buckets;     // a power of two
  float reach;      // radius of an element's support, in radii of the element
};
layout(std430, binding = 6) readonly buffer CellStarts { uint cellStarts[]; };  // first entry of each bucket, then the total
layout(std430, binding = 7) readonly buffer CellLeaves { uvec2 cellLeaves[]; };  // leaf; grid: ordered by bucket

uint bucketOf(ivec3 cell, uint grid) {
  uvec3 words = uvec3(cell);
  return (words.x * 73856093u ^ words.y * 19349663u ^ words.z * 83492791u ^ grid * 2654435761u) & (buckets - 1u);
}

struct SurfacePoint {
  vec3 position, normal;  // the normal faces the visible side
  bool isFront;           // whether the visible side is the front
};

// The interpolation at a point: weighted sum of the values, sum of the weights, and the leaves with the largest weights, the largest first.
// sides: 0 front, 1 back.
const int kNearest = 4;
struct Around {
  vec3 sum;
  float weights;
  uint leaves[kNearest], sides[kNearest];
  float shares[kNearest];
};

#ifdef LEAF_VALUES
layout(binding = 4) uniform sampler2D leafValues;  // two texels per leaf: front, back
#endif

// Weight of a leaf: its area, decreasing with the distance, to 0 at `times` its support. `strict`: the weight also decreases with the angle
// between the normals and with the distance from the plane, so that leaves across a wall or turned away do not count.
float neighbourWeight(SurfacePoint point, vec4 place, vec4 normal, float times, bool strict) {
  float support = reach * normal.w * times;
  vec3 path = place.xyz - point.position;
  float part = 1.0 - dot(path, path) / (support * support);
  if (!(part > 0.0)) return 0.0;
  float weight = place.w * part * part;
  if (!strict) return weight;
  float alike = dot(point.normal, normal.xyz) * (point.isFront ? 1.0 : -1.0);
  float above = 1.0 - abs(dot(path, point.normal)) / (0.5 * support);
  return alike > 0.0 && above > 0.0 ? weight * alike * alike * above : 0.0;
}

void keepNearest(inout Around around, uint leaf, uint side, float weight) {
  for (int i = 0; i < kNearest; ++i) {
    if (weight <= around.shares[i]) continue;
    uint otherLeaf = around.leaves[i], otherSide = around.sides[i];
    float other = around.shares[i];
    around.leaves[i] = leaf, around.sides[i] = side, around.shares[i] = weight;
    leaf = otherLeaf, side = otherSide, weight = other;
  }
}

void addCell(SurfacePoint point, ivec3 cell, uint grid, float inverse, float times, bool strict, inout Around around) {
  uint bucket = bucketOf(cell, grid), end = cellStarts[bucket + 1u];
  for (uint i = cellStarts[bucket]; i < end; ++i) {
    uvec2 entry = cellLeaves[i];
    if (entry.y != grid) continue;
    vec4 place = texelFetch(elementPosition, texelOf(entry.x), 0);
    if (ivec3(floor(place.xyz * inverse)) != cell) continue;  // another cube with the same hash
    vec4 normal = texelFetch(elementNormal, texelOf(entry.x), 0);
    float weight = neighbourWeight(point, place, normal, times, strict);
    if (!(weight > 0.0)) continue;
    uint side = dot(point.normal, normal.xyz) >= 0.0 ? 0u : 1u;
    around.weights += weight;
#ifdef LEAF_VALUES
    around.sum += weight * texelFetch(leafValues, texelOf(2u * entry.x + side), 0).rgb;
#endif
#ifdef KEEPS_NEAREST
    keepNearest(around, entry.x, side, weight);
#endif
  }
}

void addAround(SurfacePoint point, float times, bool strict, inout Around around) {
  for (int grid = 0; grid < sizes; ++grid) {
    float width = cellSizes[grid].x, inverse = cellSizes[grid].y;
    // A cube is at least as wide as the supports of its elements.
    ivec3 low = ivec3(floor((point.position - 0.5 * times * width) * inverse));
    ivec3 high = ivec3(floor((point.position + 0.5 * times * width) * inverse));
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) addCell(point, ivec3(x, y, z), uint(grid), inverse, times, strict, around);
  }
}

// Interpolates the leaves around a point. If there are none, it searches farther, and then on any side. Without any leaf the weights are 0.
Around findAround(SurfacePoint point) {
  Around around;
  around.sum = vec3(0.0);
  around.weights = 0.0;
  for (int i = 0; i < kNearest; ++i) around.leaves[i] = 0u, around.sides[i] = 0u, around.shares[i] = 0.0;
  for (int attempt = 0; attempt < 3 && around.weights <= 0.0; ++attempt)
    addAround(point, attempt == 0 ? 1.0 : 3.0, attempt < 2, around);
  return around;
}
#endif
