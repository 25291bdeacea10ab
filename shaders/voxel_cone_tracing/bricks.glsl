// Occupied voxels and the places of their sums, without a volume of sums: one bit per voxel, in bricks of 4 x 4 x 4, and for each brick the
// place of its first occupied voxel's sums. C++ side: OccupiedBricks in framework/include/lumivox/pipeline/ports/.
struct Brick {
  uint low, high;  // 64 bits: voxel (x, y, z) of the brick is bit x + 4 y + 16 z
  uint first;      // place of its first occupied voxel's sums; the sums of the others follow in the order of their bits
};

// Sums over the fragments of one voxel.
struct VoxelSums {
  uint fragments;
  uint brightest;  // bits of a non-negative float, which order like the float
  uint red, green, blue, coverage;  // shares of averages, in units of kFixedPoint
};

// The same for the six faces of a voxel, whose outward normals are +x, -x, +y, -y, +z and -z.
struct VoxelDirections {
  uint fragments;
  uint brightest;   // as above, of both sides
  uint opacity[3];  // along x, y, z: bits of the largest; or sum of shares of a mean; SAMPLED: a shorter sum above the sample bits
  uint faces[24];   // per face red, green, blue and their weight: shares of averages
};

// Number of samples of a voxel's side, one bit each, and the unit of the sum in the bits above them.
const uint kSideSamples = 8u, kAllSides = (1u << kSideSamples) - 1u;
const float kSampledFixedPoint = 8388608.0;  // 2^23

uint brickOf(ivec3 voxel, ivec3 brickCount) {
  ivec3 brick = voxel >> 2;
  return uint((brick.z * brickCount.y + brick.y) * brickCount.x + brick.x);
}
uint bitOf(ivec3 voxel) {
  ivec3 inside = voxel & 3;
  return uint(inside.x | inside.y << 2 | inside.z << 4);
}
ivec3 voxelOf(ivec3 brick, uint bit) { return 4 * brick + ivec3(bit & 3u, bit >> 2 & 3u, bit >> 4); }

bool isOccupied(Brick brick, uint bit) { return ((bit < 32u ? brick.low : brick.high) >> (bit & 31u) & 1u) != 0u; }

// The place of an occupied voxel's sums: after those of the occupied voxels with lower bits.
uint sumsOf(Brick brick, uint bit) {
  uint below = (1u << (bit & 31u)) - 1u;
  return brick.first + uint(bit < 32u ? bitCount(brick.low & below) : bitCount(brick.low) + bitCount(brick.high & below));
}
