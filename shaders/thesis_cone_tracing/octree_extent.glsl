// The nodes of a depth whose bricks depend on a voxel of the finest level. With voxels in leaves, this is the node that contains the voxel.
// With voxels at corners, voxel j of a level is in the bricks of the nodes ceil(j / 2) - 1 and floor(j / 2), which are the same node for
// odd j; and voxel i of the finest level contributes to the voxels floor(i / 2^l) and ceil(i / 2^l) of level l.
void nodesWith(ivec3 voxel, int depth, out ivec3 first, out ivec3 last) {
  int level = octreeDepth - depth;
  first = last = voxel >> level + 1;
  if (octreeAtCorners == 0) return;
  first = max((voxel >> level) - 1 >> 1, 0);
  last = min(voxel + (1 << level) - 1 >> level + 1, (1 << depth) - 1);
}
