// Straight rays through one bit a voxel, in stacks of 128 along z with levels that halve x and y (BinaryGrid): Thiedemann, Henrich, Grosch &
// Mueller 2011, Sec. 4; thesis 004, Sec. 3.2.2 and 4.4.6. Which voxel is the first is decided by the rule of lumivox/measure/voxel_walk.h,
// to the bit, whichever way it is found:
//   BIT_RULE hierarchy: a texel of a level is a block of columns; the part of the ray in it is a run of bits along z, ANDed with the stack.
//     Empty: on to where the ray leaves the block, and one level up; else one level down, and in a single column the first common bit.
//   BIT_RULE stacks: the same at level 0 alone.
//   BIT_RULE plain: one voxel after another (Amanatides & Woo 1987).
// No place is computed from t: columns and cells are integers, and all that is compared are crossings of planes. Lengths are in voxels from
// the corner of voxel (0, 0, 0).
#pragma lumivox axis BIT_RULE hierarchy stacks plain
#ifndef LUMIVOX_BIT_GRID
#define LUMIVOX_BIT_GRID

layout(binding = 8) uniform usampler2DArray bitStacks;

struct BitHit {
  ivec3 voxel;
  float t;      // where the ray enters it; 0 where it begins in it
  bool found;
  int fetches;  // texels of the stacks that were read
};

const float kNever = 1.0 / 0.0;  // infinite (GLSL 4.50, Sec. 4.7.1)
const int kStackBits = 128;

// The ray that is followed.
vec3 bitOrigin, bitDirection, bitInverse;
ivec3 bitStart;    // the voxel of the origin; -1 or the size of the grid outside
ivec3 bitVoxels;   // of the grid
bvec3 bitMoves;

float crossingAt(int axis, int plane) { return (float(plane) - bitOrigin[axis]) * bitInverse[axis]; }

bool isBefore(float t, int axis, float otherT, int otherAxis) { return t < otherT || (t == otherT && axis < otherAxis); }

// The cell along an axis behind a crossing of another one: estimated, and set right by the crossings of its planes.
int cellBehind(int axis, float t, int crossedAxis) {
  if (!bitMoves[axis]) return bitStart[axis];
  int side = bitVoxels[axis];
  int cell = int(clamp(floor(bitOrigin[axis] + t * bitDirection[axis]), -1.0, float(side)));
  if (bitDirection[axis] > 0.0) {
    cell = max(cell, bitStart[axis]);
    while (cell < side && isBefore(crossingAt(axis, cell + 1), axis, t, crossedAxis)) ++cell;
    while (cell > bitStart[axis] && !isBefore(crossingAt(axis, cell), axis, t, crossedAxis)) --cell;
  } else {
    cell = min(cell, bitStart[axis]);
    while (cell >= 0 && isBefore(crossingAt(axis, cell), axis, t, crossedAxis)) --cell;
    while (cell < bitStart[axis] && !isBefore(crossingAt(axis, cell + 1), axis, t, crossedAxis)) ++cell;
  }
  return cell;
}

bool isInGrid(ivec3 voxel) { return all(greaterThanEqual(voxel, ivec3(0))) && all(lessThan(voxel, bitVoxels)); }

// The voxel in which a ray begins in the grid, and t there; false where it misses it.
bool enterBits(vec3 origin, vec3 direction, ivec3 voxels, out ivec3 voxel, out float t) {
  bitOrigin = origin;
  bitDirection = direction;
  bitInverse = 1.0 / direction;
  bitVoxels = voxels;
  bitMoves = not(bvec3(isinf(bitInverse.x) || isnan(bitInverse.x), isinf(bitInverse.y) || isnan(bitInverse.y),
                       isinf(bitInverse.z) || isnan(bitInverse.z)));
  bitStart = ivec3(clamp(floor(origin), vec3(-1.0), vec3(voxels)));
  t = 0.0;
  int entered = -1;
  for (int axis = 0; axis < 3; ++axis) {
    if (bitStart[axis] >= 0 && bitStart[axis] < voxels[axis]) continue;
    bool below = bitStart[axis] < 0;
    if (!bitMoves[axis] || (direction[axis] > 0.0) != below) return false;
    float entry = crossingAt(axis, below ? 0 : voxels[axis]);
    if (entered >= 0 && !isBefore(t, entered, entry, axis)) continue;
    t = entry;
    entered = axis;
  }
  voxel = bitStart;
  if (entered < 0) return true;
  for (int axis = 0; axis < 3; ++axis)
    voxel[axis] = axis != entered ? cellBehind(axis, t, entered) : bitStart[axis] < 0 ? 0 : voxels[axis] - 1;
  return isInGrid(voxel);
}

// The first set bit of a stack of a level on the way from one cell to another along z, both included; -1: none.
int firstOfRun(ivec2 texel, int level, int from, int to, inout int fetches) {
  bool upwards = to >= from;
  int low = min(from, to), high = max(from, to), step = upwards ? 1 : -1, layer = -1;
  uvec4 stack = uvec4(0u);
  for (int word = from >> 5; word != (to >> 5) + step; word += step) {
    if (word >> 2 != layer) {
      layer = word >> 2;
      stack = texelFetch(bitStacks, ivec3(texel, layer), level);
      ++fetches;
    }
    int lowest = max(low - 32 * word, 0), highest = min(high - 32 * word, 31);
    uint met = stack[word & 3] & (0xffffffffu << lowest) & (0xffffffffu >> (31 - highest));
    if (met != 0u) return 32 * word + (upwards ? findLSB(met) : findMSB(met));
  }
  return -1;
}

#if BIT_RULE == BIT_RULE_PLAIN
BitHit firstBit(vec3 origin, vec3 direction, float reach, ivec3 voxels) {
  BitHit hit = BitHit(ivec3(-1), kNever, false, 0);
  ivec3 voxel;
  float t;
  if (!enterBits(origin, direction, voxels, voxel, t)) return hit;
  while (t <= reach) {
    ++hit.fetches;
    uvec4 stack = texelFetch(bitStacks, ivec3(voxel.xy, voxel.z / kStackBits), 0);
    if ((stack[voxel.z >> 5 & 3] >> (voxel.z & 31) & 1u) != 0u) return BitHit(voxel, t, true, hit.fetches);
    int axis = 0;
    float next = kNever;
    for (int i = 0; i < 3; ++i) {
      if (!bitMoves[i]) continue;
      float crossing = crossingAt(i, voxel[i] + (bitDirection[i] > 0.0 ? 1 : 0));
      if (!isBefore(crossing, i, next, axis)) continue;
      next = crossing;
      axis = i;
    }
    if (isinf(next)) break;
    voxel[axis] += bitDirection[axis] > 0.0 ? 1 : -1;
    t = next;
    if (!isInGrid(voxel)) break;
  }
  return hit;
}
#else
BitHit firstBit(vec3 origin, vec3 direction, float reach, ivec3 voxels) {
  BitHit hit = BitHit(ivec3(-1), kNever, false, 0);
  ivec3 voxel;
  float t;
  if (!enterBits(origin, direction, voxels, voxel, t)) return hit;
#if BIT_RULE == BIT_RULE_HIERARCHY
  int coarsest = textureQueryLevels(bitStacks) - 1;
#else
  const int coarsest = 0;
#endif
  int level = coarsest;
  while (t <= reach) {
    ivec2 size = max(voxels.xy >> level, 1), texel = min(voxel.xy >> level, size - 1);
    ivec2 low = texel << level, high = mix((texel + 1) << level, voxels.xy, equal(texel, size - 1));
    // Where the ray leaves the block, over its sides.
    float leaving[2] = float[2](kNever, kNever);
    for (int i = 0; i < 2; ++i)
      if (bitMoves[i]) leaving[i] = crossingAt(i, bitDirection[i] > 0.0 ? high[i] : low[i]);
    int axis = leaving[0] <= leaving[1] ? 0 : 1;
    bool leaves = !isinf(leaving[axis]);
    int next = !bitMoves.z ? voxel.z : leaves ? cellBehind(2, leaving[axis], axis) : bitDirection.z > 0.0 ? voxels.z : -1;
    int found = firstOfRun(texel, level, voxel.z, clamp(next, 0, voxels.z - 1), hit.fetches);
    if (found >= 0) {
      if (level > 0) {
        --level;
        continue;
      }
      if (found != voxel.z) t = crossingAt(2, bitDirection.z > 0.0 ? found : found + 1);
      if (t > reach) break;
      return BitHit(ivec3(voxel.xy, found), t, true, hit.fetches);
    }
    if (!leaves || next < 0 || next >= voxels.z) break;
    t = leaving[axis];
    voxel[1 - axis] = cellBehind(1 - axis, t, axis);
    voxel[axis] = bitDirection[axis] > 0.0 ? high[axis] : low[axis] - 1;
    voxel.z = next;
    if (voxel[axis] < 0 || voxel[axis] >= voxels[axis]) break;
    level = min(level + 1, coarsest);
  }
  return hit;
}
#endif

#endif
