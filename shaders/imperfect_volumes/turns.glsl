// Light of the frame before in turns: which voxels hold some, for how long, and which of them a surface reads.
#ifndef LUMIVOX_TURNS
#define LUMIVOX_TURNS

// Marks. Those of pixels are stored after those of surfaces, so that a voxel that both read is seen.
const uint kUnseen = 1u;  // only surfaces read the voxel, for the next bounce
const uint kSeen = 2u;    // a pixel reads the voxel

// Turns: 0 where a voxel holds no light, else one more than the frames since its rays began. Neighbours begin at different turns: eight in a
// row among any 2 x 2 x 2 voxels.
const uint kNothing = 0u;
uint turnOf(ivec3 voxel, uint turns) { return 1u + uint(voxel.x + 2 * voxel.y + 4 * voxel.z) % turns; }

#endif
