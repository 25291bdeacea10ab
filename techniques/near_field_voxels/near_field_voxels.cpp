// Near-field voxels: Thiedemann, Henrich, Grosch & Mueller 2011, "Voxel-based global illumination"; thesis
// Gomes 2015, Sec. 3.2 and 4.4.6. Rays through one bit a voxel, and light where they end.
#include "passes.h"

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::near_field_voxels;
  registry.describe(
      "Near-field voxels: rays through a grid of one bit a voxel, whose hits are lit by reflective shadow maps",
      "Thiedemann et al. 2011; thesis Gomes 2015, Sec. 3.2");
  addGather(registry);
  addProbe(registry);
}
