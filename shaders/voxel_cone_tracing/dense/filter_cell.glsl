// A coarse voxel from the next finer level. C++ side: fillLevels in techniques/voxel_cone_tracing/dense/levels.h.
#include "common/cones.glsl"
#include "../children.glsl"

const int kFacing = 0, kAverage = 1, kTrilinear = 2;
layout(constant_id = 0) const int rule = kFacing;

layout(std140, binding = 0) uniform Parameters {
  ivec3 coarse;   // voxels of the level that is written
  int fineLevel;
  ivec3 fine;     // voxels of the level that is read
};
layout(binding = 0) uniform sampler3D radianceGrid;
layout(binding = 0) uniform writeonly image3D radianceImage;  // of whatever float format the grid has

// Mean over the columns along one axis, and over both ways along it.
vec4 lookThrough(ivec3 cell, int axis, ivec3 first, ivec3 last, vec3 ratio) {
  int side = (axis + 1) % 3, up = (axis + 2) % 3;
  vec4 sum = vec4(0.0);
  float weight = 0.0;
  for (int v = first[up]; v <= last[up]; ++v)
    for (int u = first[side]; u <= last[side]; ++u) {
      float part = share(cell[up], v, ratio[up]) * share(cell[side], u, ratio[side]);
      vec4 ahead = vec4(0.0), back = vec4(0.0);
      for (int w = first[axis]; w <= last[axis]; ++w) {
        ivec3 child;
        child[axis] = w;
        child[side] = u;
        child[up] = v;
        vec4 value = slab(texelFetch(radianceGrid, child, fineLevel), share(cell[axis], w, ratio[axis]));
        ahead = over(ahead, value);
        back = over(value, back);
      }
      sum += part * (ahead + back);
      weight += 2.0 * part;
    }
  return sum / weight;
}

void filterCell(ivec3 cell) {
  if (rule == kTrilinear) {
    imageStore(radianceImage, cell, textureLod(radianceGrid, (vec3(cell) + 0.5) / vec3(coarse), float(fineLevel)));
    return;
  }
  if (rule == kFacing && fine == 2 * coarse) {
    vec4 child[8];
    for (int i = 0; i < 8; ++i) child[i] = texelFetch(radianceGrid, 2 * cell + ivec3(i & 1, i >> 1 & 1, i >> 2), fineLevel);
    imageStore(radianceImage, cell, seenThrough(child));
    return;
  }
  vec3 ratio = vec3(fine) / vec3(coarse);
  ivec3 first = ivec3(floor(vec3(cell) * ratio)), last = min(ivec3(ceil(vec3(cell + 1) * ratio)) - 1, fine - 1);

  if (rule == kFacing) {
    imageStore(radianceImage, cell,
               facing(lookThrough(cell, 0, first, last, ratio), lookThrough(cell, 1, first, last, ratio),
                      lookThrough(cell, 2, first, last, ratio)));
    return;
  }
  vec4 sum = vec4(0.0);
  float weight = 0.0;
  for (int z = first.z; z <= last.z; ++z)
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x) {
        float part = share(cell.x, x, ratio.x) * share(cell.y, y, ratio.y) * share(cell.z, z, ratio.z);
        sum += part * texelFetch(radianceGrid, ivec3(x, y, z), fineLevel);
        weight += part;
      }
  imageStore(radianceImage, cell, weight > 0.0 ? sum / weight : vec4(0.0));
}
