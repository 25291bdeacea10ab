// Triangles to voxel fragments. One pass per voxelizer, all with the same output, so that any gathering
// technique can use any of them.
#include "voxelizer.h"

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::voxelization;
  registry.describe("Voxelizers: triangles to voxel fragments",
                    "Crassin & Green 2012; Schwarz & Seidel 2010; thesis Gomes 2015, Sec. 2.1.2, 4.2.1");
  addConservative(registry);
  addMsaaOpacity(registry);
  addSlicing(registry);
  addDepthPeeling(registry);
  addAverage(registry);
  addPoints(registry);
  addReproject(registry);
  addAtlas(registry);
  addSolid(registry);
}
