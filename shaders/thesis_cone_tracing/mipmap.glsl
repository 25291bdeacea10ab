// Sec. 4.2.1, Mipmapping: one filtered texture read between eight children. At odd sizes it misses the remaining children.
layout(std140, binding = 0) uniform Parameters {
  ivec3 coarse;  // voxels of the level that is written
  int fineLevel;
};
layout(binding = 0) uniform sampler3D radianceGrid;
layout(binding = 0) uniform writeonly image3D radianceImage;  // of any float format

void mipmapCell(ivec3 cell) {
  imageStore(radianceImage, cell, textureLod(radianceGrid, (vec3(cell) + 0.5) / vec3(coarse), float(fineLevel)));
}
