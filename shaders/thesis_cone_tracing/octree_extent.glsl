// The nodes of a depth that show something of a voxel of the finest level. In leaves: the node that the voxel lies in. At corners: voxel j is in
// the bricks of the nodes ceil(j / 2) - 1 and floor(j / 2), which are one for odd j; and voxel i adds to the voxels floor(i / 2^l) and
// ceil(i / 2^l) of level l.
void nodesWith(ivec3 voxel, int depth, out ivec3 first, out ivec3 last) {
  int level = octreeDepth - depth;
  first = last = voxel >> level + 1;
  if (octreeAtCorners == 0) return;
  first = max((voxel >> level) - 1 >> 1, 0);
  last = min(voxel + (1 << level) - 1 >> level + 1, (1 << depth) - 1);
}
