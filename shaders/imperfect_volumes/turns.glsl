// Light of the frame before in turns: which voxels hold some, for how long, and which of them a surface reads.
#ifndef LUMIVOX_TURNS
#define LUMIVOX_TURNS

// Marks. Those of pixels are stored after those of surfaces, so that a voxel that both read is seen.
const uint kUnseen = 1u;  // only surfaces read the voxel, for the next bounce
const uint kSeen = 2u;    // a pixel reads the voxel

// What a voxel holds: kNothing, or light. Then the low 8 bits are one more than the frames since its rays began, and the others the number
// of frames to come in which they begin all the same.
const uint kNothing = 0u;
// In which of `turns` frames rays begin in a voxel: any 2 x 2 x 2 voxels begin in eight frames in a row.
uint turnOf(ivec3 voxel, uint turns) { return 1u + uint(voxel.x + 2 * voxel.y + 4 * voxel.z) % turns; }

#endif
