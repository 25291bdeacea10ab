// Imperfect volumes: Mavridis & Papaioannou 2011, "Global Illumination Using Imperfect Volumes". Light and
// openness are gathered once per voxel of a rough voxelisation, and read at the surfaces.
#include "volume.h"

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::imperfect_volumes;
  registry.describe(
      "Imperfect volumes: light cached in spherical harmonics on a rough voxelisation, gathered by rays from voxel to voxel",
      "Mavridis & Papaioannou 2011");
  addInject(registry);
  addMarch(registry);
  addGather(registry);
}
