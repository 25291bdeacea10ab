// Light propagation volumes: Kaplanyan & Dachsbacher 2010, "Cascaded light propagation volumes for real-time
// indirect illumination"; Doghramachi 2013, "Rasterized voxel-based dynamic global illumination"; thesis
// Gomes 2015, Sec. 3.4 and 4.3. Virtual point lights, propagated from cell to cell in nested grids.
#include "nested_grids.h"

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::light_propagation_volumes;
  registry.describe("Light propagation volumes in nested grids",
                    "Kaplanyan & Dachsbacher 2010; Doghramachi 2013; thesis Gomes 2015, Sec. 3.4, 4.3");
  addInject(registry);
  addPropagate(registry);
  addGather(registry);
}
