// Layered reflective shadow maps: thesis Gomes 2015, Sec. 3.3, after Sugihara, Rauwendaal & Salvi 2014. Cones
// through voxels that hold opacity alone; light comes from filtered layers of what the lights see.
#include "passes.h"

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::layered_reflective_shadow_maps;
  registry.describe(
      "Layered reflective shadow maps: cones through opacities in voxels, lit by filtered layers of what the lights see",
      "Sugihara, Rauwendaal & Salvi 2014; thesis Gomes 2015, Sec. 3.3");
  addLayers(registry);
  addOcclusion(registry);
  addGather(registry);
}
