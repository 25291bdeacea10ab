// Straight rays through a grid of one bit per voxel, in stacks of 128 bits along z with mip levels that halve x and y (BinaryGrid):
// Thiedemann, Henrich, Grosch & Mueller 2011, Sec. 4; thesis 004, Sec. 3.2.2 and 4.4.6. All rules but `printed` find the same first voxel,
// to the bit, by the definition in lumivox/measure/voxel_walk.h:
//   BIT_RULE hierarchy: a texel of a level is a block of columns. The part of the ray inside the block is a run of bits along z, ANDed with
//     the stack. If no bit is common, the ray goes on to its exit from the block, and one level up if it also leaves the block of the next
//     level. Otherwise it goes one level down; in a single column the first common bit is the hit.
//   BIT_RULE stacks: the same at level 0 only.
//   BIT_RULE plain: one voxel after another (Amanatides & Woo 1987).
//   BIT_RULE printed: thesis 004, Listings 4.39, 4.40 and 4.47 as printed, whatever voxel they find.
// No position is computed from t: columns and cells are integers, and only crossings of planes are compared. Lengths are in voxels from the
// corner of voxel (0, 0, 0).
#pragma lumivox axis BIT_RULE hierarchy stacks plain printed
#ifndef LUMIVOX_BIT_GRID
#define LUMIVOX_BIT_GRID
#ifndef PLANES
#define PLANES 0  // 1: rays end at the surface within an occupied voxel, or pass it (common/voxel_planes.glsl); not with BIT_RULE printed
#endif

layout(binding = 8) uniform usampler2DArray bitStacks;

struct BitHit {
  ivec3 voxel;
  float t;      // where the ray enters the voxel; 0 if the ray begins in it. With PLANES, where it ends in it
  bool found;
  int fetches;  // texels of the stacks that were read
};

const float kNever = 1.0 / 0.0;  // infinite (GLSL 4.50, Sec. 4.7.1)
const int kStackBits = 128;

// The ray that is followed.
vec3 bitOrigin, bitDirection, bitInverse;
ivec3 bitStart;    // the voxel of the origin; -1 or the size of the grid if the origin lies outside
ivec3 bitVoxels;   // of the grid
bvec3 bitMoves;

float crossingAt(int axis, int plane) { return (float(plane) - bitOrigin[axis]) * bitInverse[axis]; }

bool isBefore(float t, int axis, float otherT, int otherAxis) { return t < otherT || (t == otherT && axis < otherAxis); }

// The cell along an axis after a crossing of another axis: estimated from t, then corrected by the crossings of its planes.
int cellBehind(int axis, float t, int crossedAxis) {
  if (!bitMoves[axis]) return bitStart[axis];
  bool rises = bitDirection[axis] > 0.0;
  int last = rises ? bitVoxels[axis] : -1, step = rises ? 1 : -1;
  int leaving = rises ? 1 : 0, entering = 1 - leaving;  // offsets of the planes through which the ray leaves and enters a cell
  int cell = int(clamp(floor(bitOrigin[axis] + t * bitDirection[axis]), -1.0, float(bitVoxels[axis])));
  cell = rises ? max(cell, bitStart[axis]) : min(cell, bitStart[axis]);
  while (cell != last && isBefore(crossingAt(axis, cell + leaving), axis, t, crossedAxis)) cell += step;
  while (cell != bitStart[axis] && !isBefore(crossingAt(axis, cell + entering), axis, t, crossedAxis)) cell -= step;
  return cell;
}

bool isInGrid(ivec3 voxel) { return all(greaterThanEqual(voxel, ivec3(0))) && all(lessThan(voxel, bitVoxels)); }

// The t at which the ray leaves a voxel; kNever for a direction of length 0. leavesGrid(): the same for the grid.
float leavesVoxel(ivec3 voxel) {
  float t = kNever;
  for (int axis = 0; axis < 3; ++axis)
    if (bitMoves[axis]) t = min(t, crossingAt(axis, voxel[axis] + (bitDirection[axis] > 0.0 ? 1 : 0)));
  return t;
}
float leavesGrid() {
  float t = kNever;
  for (int axis = 0; axis < 3; ++axis)
    if (bitMoves[axis]) t = min(t, crossingAt(axis, bitDirection[axis] > 0.0 ? bitVoxels[axis] : 0));
  return t;
}

#if PLANES
// Where the ray that is followed ends in an occupied voxel that it enters at a t; kNever: it passes.
float stopIn(ivec3 voxel, float enters);
#endif

// The first voxel of the grid that a ray enters, and the t of entry; false if the ray misses the grid.
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

// The first set bit of a texel, upwards or downwards; -1: none.
int firstOfStack(uvec4 stack, bool upwards) {
  if (upwards) {
    int word = stack.x != 0u ? 0 : stack.y != 0u ? 1 : stack.z != 0u ? 2 : 3;
    return stack[word] != 0u ? 32 * word + findLSB(stack[word]) : -1;
  }
  int word = stack.w != 0u ? 3 : stack.z != 0u ? 2 : stack.y != 0u ? 1 : 0;
  return stack[word] != 0u ? 32 * word + findMSB(stack[word]) : -1;
}

// A texel in which the bits from `low` to `high`, both included, are set.
uvec4 runOfBits(int low, int high) {
  ivec4 first = ivec4(low) - ivec4(0, 32, 64, 96), last = ivec4(high) - ivec4(0, 32, 64, 96);
  uvec4 from = mix(uvec4(0xffffffffu) << uvec4(clamp(first, 0, 31)), uvec4(0u), greaterThan(first, ivec4(31)));
  return mix(from & (uvec4(0xffffffffu) >> uvec4(31 - clamp(last, 0, 31))), uvec4(0u), lessThan(last, ivec4(0)));
}

// The first set bit of a stack of a level, going along z from one cell to another, both included; -1: none.
int firstOfRun(ivec2 texel, int level, int from, int to, inout int fetches) {
  bool upwards = to >= from;
  int low = min(from, to), high = max(from, to), step = upwards ? 1 : -1;
  for (int layer = from / kStackBits; layer != to / kStackBits + step; layer += step) {
    int base = kStackBits * layer;
    uvec4 met = texelFetch(bitStacks, ivec3(texel, layer), level) & runOfBits(max(low - base, 0), min(high - base, kStackBits - 1));
    ++fetches;
    int first = firstOfStack(met, upwards);
    if (first >= 0) return base + first;
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
#if PLANES
    if ((stack[voxel.z >> 5 & 3] >> (voxel.z & 31) & 1u) != 0u) {
      float end = stopIn(voxel, t);
      if (!isinf(end)) return BitHit(voxel, end, end <= reach, hit.fetches);
    }
#else
    if ((stack[voxel.z >> 5 & 3] >> (voxel.z & 31) & 1u) != 0u) return BitHit(voxel, t, true, hit.fetches);
#endif
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
#elif BIT_RULE == BIT_RULE_PRINTED
// C++ side: RayMethod::binding() in framework/src/toolkit/voxel_rays.cpp.
layout(std140, binding = 7) uniform Printed {
  int printedSteps;     // step limit of a ray; a ray that reaches it counts as unoccluded, as printed
  float printedOffset;  // distance past each exit at which the ray goes on, voxels
};
// Listing 4.40: texel (i, j) holds the bits from i to j, the XOR of the prefix masks i and j + 1 of Listing 4.39. Prefix mask 128 does not
// exist; it counts as 0, as a guarded out-of-bounds read returns.
layout(binding = 9) uniform usampler2D rayMasks;

// Listing 4.47. A ray is a line segment with the parameter 0 to 1, in a grid of 2^k voxels along x and along y and one stack along z.
// Deviates: as printed the level grows without a bound; here the coarsest level is read again. Reads outside the texture find no set bit.
BitHit firstBit(vec3 origin, vec3 direction, float reach, ivec3 voxels) {
  BitHit hit = BitHit(ivec3(-1), kNever, false, 0);
  bitOrigin = origin, bitDirection = direction, bitInverse = 1.0 / direction, bitVoxels = voxels;
  bitMoves = not(bvec3(isinf(bitInverse.x), isinf(bitInverse.y), isinf(bitInverse.z)));
  bitStart = ivec3(floor(origin));
  float segment = min(reach, leavesGrid());
  if (!(segment > 0.0) || isinf(segment)) return hit;
  float offset = printedOffset / segment, near = 0.0;
  int top = textureQueryLevels(bitStacks) - 1, level = max(min(3, top - 1), 0);
  vec3 way = direction * segment, place = origin;
  for (int i = 0; i < printedSteps && near <= 1.0; ++i) {
    float side = float(1 << level);
    ivec2 texel = ivec2(place.xy / side);
    vec2 low = vec2(texel) * side;
    vec3 toLow = (vec3(low, 0.0) - origin) / way, toHigh = (vec3(low + side, float(kStackBits)) - origin) / way;
    vec3 leaving = max(toLow, toHigh);
    float far = min(1.0, min(min(leaving.x, leaving.y), leaving.z));
    float lastZ = far * way.z + origin.z;
    uvec4 met = uvec4(0u);
    ivec2 size = max(voxels.xy >> level, 1);
    if (all(greaterThanEqual(place.xy, vec2(0.0))) && all(lessThan(place.xy, vec2(voxels.xy)))) {
      vec2 run = vec2(min(place.z, lastZ), max(place.z, lastZ)) / float(kStackBits);
      met = textureLod(rayMasks, run, 0.0) & texelFetch(bitStacks, ivec3(min(texel, size - 1), 0), level);
      ++hit.fetches;
    }
    if (met != uvec4(0u)) {
      // The sign of the direction decides which bit is the first. Integer operations replace the logarithms of Listing 4.48.
      if (level == 0) return BitHit(ivec3(texel, firstOfStack(met, direction.z >= 0.0)), near * segment, true, hit.fetches);
      --level;
    } else {
      near = far + offset;
      place = origin + near * way;
      level = min(level + 1, top);
    }
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
#if PLANES
  const int kFirst = 0;  // rays begin at a surface, whose voxels they pass
#else
  const int kFirst = 3;  // as published: the block around a surface is hardly ever empty at coarser levels
#endif
  int level = min(kFirst, coarsest);
  while (t <= reach) {
    ivec2 size = max(voxels.xy >> level, 1), texel = min(voxel.xy >> level, size - 1);
    ivec2 low = texel << level, high = mix((texel + 1) << level, voxels.xy, equal(texel, size - 1));
    // Where the ray leaves the block, over its sides.
    ivec2 planes = mix(low, high, greaterThan(bitDirection.xy, vec2(0.0)));
    float overX = bitMoves.x ? crossingAt(0, planes.x) : kNever, overY = bitMoves.y ? crossingAt(1, planes.y) : kNever;
    bool alongX = overX <= overY;
    float leaving = alongX ? overX : overY;
    int axis = alongX ? 0 : 1;
    bool leaves = !isinf(leaving);
    int next = !bitMoves.z ? voxel.z : leaves ? cellBehind(2, leaving, axis) : bitDirection.z > 0.0 ? voxels.z : -1;
    int found = firstOfRun(texel, level, voxel.z, clamp(next, 0, voxels.z - 1), hit.fetches);
    if (found >= 0) {
      if (level > 0) {
        --level;
        continue;
      }
      if (found != voxel.z) t = crossingAt(2, bitDirection.z > 0.0 ? found : found + 1);
      if (t > reach) break;
#if PLANES
      float end = stopIn(ivec3(voxel.xy, found), t);
      if (!isinf(end)) return BitHit(ivec3(voxel.xy, found), end, end <= reach, hit.fetches);
      if (found != clamp(next, 0, voxels.z - 1)) {
        // On to the next voxel of the column; after its last one, out of the column.
        t = crossingAt(2, bitDirection.z > 0.0 ? found + 1 : found);
        voxel.z = found + (bitDirection.z > 0.0 ? 1 : -1);
        continue;
      }
#else
      return BitHit(ivec3(voxel.xy, found), t, true, hit.fetches);
#endif
    }
    if (!leaves || next < 0 || next >= voxels.z) break;
    t = leaving;
    int other = cellBehind(1 - axis, t, axis);
    ivec2 behind = mix(low - 1, high, greaterThan(bitDirection.xy, vec2(0.0)));
    voxel = alongX ? ivec3(behind.x, other, next) : ivec3(other, behind.y, next);
    if (any(lessThan(voxel.xy, ivec2(0))) || any(greaterThanEqual(voxel.xy, voxels.xy))) break;
    // The next level's block has a set bit.
    if (any(notEqual(voxel.xy >> (level + 1), texel >> 1))) level = min(level + 1, coarsest);
  }
  return hit;
}
#endif

#endif
