// The list of those texels of the atlas that lie on the surface (Thiedemann et al. 2011; thesis 004 Sec. 4.4.2, 4.4.3): for each the
// triangle and the place on it. Including files declare grid_corner.glsl before.
// Deviates: the atlas does not hold positions that are drawn into it anew when something moves, but places on triangles, which stay; and
// the list of its texels was made with it, so that nothing is read back.
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

// The texel of this thread, or -1.
int texelOfThread() {
  int item = int(listIndex());
  return item < texelCount ? firstTexel + item : -1;
}
