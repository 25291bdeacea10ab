// The two faces of a coarse voxel across an axis: the children of a column are composited front to back from either side, and the columns
// are averaged (Crassin et al. 2011, Sec. 8.1; thesis 004, Sec. 3.1.3). Including files first define the faces of a child, vec4
// higherFace(int axis, ivec3 child) and lowerFace.
#include "common/coarser_voxel.glsl"

// Means over the columns along an axis: `higher` seen from the higher side, `lower` from the lower side.
void lookThrough(ivec3 cell, int axis, ivec3 first, ivec3 last, vec3 ratio, out vec4 higher, out vec4 lower) {
  int side = (axis + 1) % 3, up = (axis + 2) % 3;
  higher = vec4(0.0);
  lower = vec4(0.0);
  float weight = 0.0;
  for (int v = first[up]; v <= last[up]; ++v)
    for (int u = first[side]; u <= last[side]; ++u) {
      float part = share(cell[up], v, ratio[up]) * share(cell[side], u, ratio[side]);
      vec4 fromHigher = vec4(0.0), fromLower = vec4(0.0);
      for (int w = first[axis]; w <= last[axis]; ++w) {
        ivec3 child;
        child[axis] = w;
        child[side] = u;
        child[up] = v;
        float length = share(cell[axis], w, ratio[axis]);
        vec4 ahead = slab(lowerFace(axis, child), length);
        if (ahead.a <= 0.0) continue;
        fromLower = over(fromLower, ahead);
        fromHigher = over(slab(higherFace(axis, child), length), fromHigher);
      }
      higher += part * fromHigher;
      lower += part * fromLower;
      weight += part;
    }
  higher /= weight;
  lower /= weight;
}
