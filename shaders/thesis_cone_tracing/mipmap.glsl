// Sec. 4.2.1, Mipmapping: one read between eight children, by the filter of the texture. At odd sizes it misses the others.
layout(std140, binding = 0) uniform Parameters {
  ivec3 coarse;  // voxels of the level that is written
  int fineLevel;
};
layout(binding = 0) uniform sampler3D radianceGrid;
layout(binding = 0) uniform writeonly image3D radianceImage;  // of whatever float format the grid has

void mipmapCell(ivec3 cell) {
  imageStore(radianceImage, cell, textureLod(radianceGrid, (vec3(cell) + 0.5) / vec3(coarse), float(fineLevel)));
}
