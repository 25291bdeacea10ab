// Which voxels are occupied, and where the sums of each lie, without a volume of sums: a bit for each voxel, in bricks of 4 x 4 x 4, and for
// each brick the place of its first occupied voxel's sums. C++ side: OccupiedBricks in framework/include/lumivox/pipeline/ports/.
struct Brick {
  uint low, high;  // 64 bits: voxel (x, y, z) of the brick is bit x + 4 y + 16 z
  uint first;      // the sums of its first occupied voxel; those of the others follow in the order of their bits
};

// Over the fragments of one voxel.
struct VoxelSums {
  uint fragments;
  uint brightest;  // bits of a float: for numbers from 0 on their order is that of the numbers
  uint red, green, blue, coverage;  // shares of averages, in units of kFixedPoint
};

// The same for the six faces of a voxel, whose outward normals are +x, -x, +y, -y, +z and -z.
struct VoxelDirections {
  uint fragments;
  uint brightest;   // as above, of both sides
  uint opacity[3];  // along x, y and z: bits of the largest, or the sum of shares of a mean; that sum in fewer bits over a voxel's samples
  uint faces[24];   // of each face red, green, blue and their weight: shares of averages
};

// Samples of a side of a voxel, a bit each, and the unit of the sum above them.
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

// Where the sums of an occupied voxel lie: behind those of the occupied voxels with lower bits.
uint sumsOf(Brick brick, uint bit) {
  uint below = (1u << (bit & 31u)) - 1u;
  return brick.first + uint(bit < 32u ? bitCount(brick.low & below) : bitCount(brick.low) + bitCount(brick.high & below));
}
