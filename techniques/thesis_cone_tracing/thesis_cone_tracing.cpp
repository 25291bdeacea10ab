// Voxel cone tracing as printed in the thesis of Gomes 2015, Sec. 4.2: its listings in their order.
#include "lumivox/plugin/technique.h"

namespace lumivox::thesis_cone_tracing {

void addInject(TechniqueRegistry& registry);
void addMipmap(TechniqueRegistry& registry);
void addOctree(TechniqueRegistry& registry);
void addOctreeBricks(TechniqueRegistry& registry);
void addGather(TechniqueRegistry& registry);

}  // namespace lumivox::thesis_cone_tracing

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::thesis_cone_tracing;
  registry.describe("Voxel cone tracing as printed: Listings 4.8 to 4.25, errors included",
                    "thesis Gomes 2015, Sec. 4.2; Crassin et al. 2011");
  addInject(registry);
  addMipmap(registry);
  addOctree(registry);
  addOctreeBricks(registry);
  addGather(registry);
}
