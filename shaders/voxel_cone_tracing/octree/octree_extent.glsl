// The nodes of a depth that show something of a voxel of the finest level, by where voxels lie (VoxelOctree::Voxels).
// A voxel j is in the bricks of the nodes ceil(j / 2) - 1 and floor(j / 2), which are one for odd j. As in a grid, voxel i adds to the voxel
// floor(i / 2^l) of level l; at corners to that and to ceil(i / 2^l). In leaves, as published: the node that the voxel lies in.
const int kAsGrid = 0, kAtCorners = 1, kInLeaves = 2;

void nodesWith(ivec3 voxel, int level, int nodesAlong, int voxels, out ivec3 first, out ivec3 last) {
  first = last = voxel >> level + 1;
  if (voxels == kInLeaves) return;
  first = max((voxel >> level) - 1 >> 1, 0);
  if (voxels == kAtCorners) last = min(voxel + (1 << level) - 1 >> level + 1, nodesAlong - 1);
}
