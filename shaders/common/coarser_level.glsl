// One voxel of a mip level from those of the next finer level (Crassin et al. 2011, Sec. 5; thesis 004 Sec. 4.2.1 Mipmapping). An including
// file first defines how to read a finer voxel, radiance pre-multiplied by the opacity in a:
//   vec4 finerVoxel(ivec3 at)
//
// Along each of the three axes, the children of each column are composited front to back, in both directions, and the columns are averaged:
// this is the view through the coarse voxel along that axis. The opacity is the largest of the three,
// that of the axis which a surface faces:
// - A uniform medium of opacity a per voxel gets 1 - (1-a)^2: its transmittance does not depend on the level that a cone reads.
// - A sheet one voxel thick of opacity a keeps a at every level. The plain mean of the thesis halves its opacity at every level and leaks
//   light. Any mean over the axes leaks too, more slowly: along the sheet only half of the columns meet it.
// Radiance over opacity is the mean of the three views, weighted by the square of their opacities. `average` is the published mean of the
// eight children, or of all children that a coarse voxel overlaps.
#ifndef LUMIVOX_COARSER_LEVEL
#define LUMIVOX_COARSER_LEVEL
#include "common/coarser_voxel.glsl"

const int kFacing = 0, kAverage = 1;

// Mean over the columns along one axis, and over both directions along it.
vec4 lookThrough(ivec3 cell, int axis, ivec3 first, ivec3 last, vec3 ratio) {
  int side = (axis + 1) % 3, up = (axis + 2) % 3;
  vec4 sum = vec4(0.0);
  float weight = 0.0;
  for (int v = first[up]; v <= last[up]; ++v)
    for (int u = first[side]; u <= last[side]; ++u) {
      float part = share(cell[up], v, ratio[up]) * share(cell[side], u, ratio[side]);
      vec4 ahead = vec4(0.0), back = vec4(0.0);
      for (int w = first[axis]; w <= last[axis]; ++w) {
        ivec3 child = axis == 0 ? ivec3(w, u, v) : axis == 1 ? ivec3(v, w, u) : ivec3(u, v, w);
        vec4 value = slab(finerVoxel(child), share(cell[axis], w, ratio[axis]));
        ahead = over(ahead, value);
        back = over(value, back);
      }
      sum += part * (ahead + back);
      weight += 2.0 * part;
    }
  return sum / weight;
}

// Voxel `cell` of a level of `coarse` voxels, from the finer level of `fine` voxels.
vec4 coarserVoxel(ivec3 cell, ivec3 coarse, ivec3 fine, int rule) {
  if (rule == kFacing && fine == 2 * coarse) {
    ivec3 first = 2 * cell;
    return seenThrough(vec4[8](finerVoxel(first), finerVoxel(first + ivec3(1, 0, 0)), finerVoxel(first + ivec3(0, 1, 0)),
                               finerVoxel(first + ivec3(1, 1, 0)), finerVoxel(first + ivec3(0, 0, 1)), finerVoxel(first + ivec3(1, 0, 1)),
                               finerVoxel(first + ivec3(0, 1, 1)), finerVoxel(first + ivec3(1, 1, 1))));
  }
  vec3 ratio = vec3(fine) / vec3(coarse);
  ivec3 first = ivec3(floor(vec3(cell) * ratio)), last = min(ivec3(ceil(vec3(cell + 1) * ratio)) - 1, fine - 1);

  if (rule == kFacing)
    return facing(lookThrough(cell, 0, first, last, ratio), lookThrough(cell, 1, first, last, ratio),
                  lookThrough(cell, 2, first, last, ratio));
  vec4 sum = vec4(0.0);
  float weight = 0.0;
  for (int z = first.z; z <= last.z; ++z)
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x) {
        float part = share(cell.x, x, ratio.x) * share(cell.y, y, ratio.y) * share(cell.z, z, ratio.z);
        sum += part * finerVoxel(ivec3(x, y, z));
        weight += part;
      }
  return weight > 0.0 ? sum / weight : vec4(0.0);
}

#endif
