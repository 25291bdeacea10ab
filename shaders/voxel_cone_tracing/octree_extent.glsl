// The nodes of a depth that show something of a voxel of the finest level.
// Voxels at corners: voxel i adds to the voxels floor(i / 2^l) and ceil(i / 2^l) of level l, and a voxel j is in the bricks of the nodes
// ceil(j / 2) - 1 and floor(j / 2), which are one for odd j. In leaves, as published: the node that the voxel lies in.
void nodesWith(ivec3 voxel, int level, int nodesAlong, bool atCorners, out ivec3 first, out ivec3 last) {
  first = last = voxel >> level + 1;
  if (!atCorners) return;
  first = max((voxel >> level) - 1 >> 1, 0);
  last = min(voxel + (1 << level) - 1 >> level + 1, nodesAlong - 1);
}
