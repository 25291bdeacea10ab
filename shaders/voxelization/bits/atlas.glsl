// The list of the atlas texels that lie on the surface (Thiedemann et al. 2011; thesis 004 Sec. 4.4.2, 4.4.3), each with its triangle and
// the place on the triangle. Including files first include grid_corner.glsl.
// Deviates: the atlas holds places on triangles, which stay valid, instead of positions, which are rendered again when something moves. The
// list of its texels is created together with the atlas, without a read-back.
#include "common/list.glsl"

layout(std430, binding = 9) readonly buffer TexelTriangles { uint texelTriangles[]; };
layout(std430, binding = 10) readonly buffer TexelPlaces { uint texelPlaces[]; };  // barycentric: second and third corner, 16 bits each
layout(std140, binding = 2) uniform Texels {
  int firstTexel;  // of this draw
  int texelCount;
};

struct SurfacePlace {
  int triangle;
  vec3 corners[3];  // voxels
  vec3 weights;
};

SurfacePlace placeOf(int texel) {
  SurfacePlace place;
  place.triangle = int(texelTriangles[texel]);
  for (int k = 0; k < 3; ++k) place.corners[k] = cornerInGrid(place.triangle, k);
  vec2 weights = unpackUnorm2x16(texelPlaces[texel]);
  place.weights = vec3(max(1.0 - weights.x - weights.y, 0.0), weights);
  return place;
}

// The texel of this invocation, or -1.
int texelOfThread() {
  int item = int(listIndex());
  return item < texelCount ? firstTexel + item : -1;
}
