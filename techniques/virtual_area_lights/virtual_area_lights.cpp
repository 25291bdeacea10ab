// Light of surface patches, gathered at sparse points of the surfaces and averaged to one light per point
// (Lensing and Broll 2013).
#include "passes.h"

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::virtual_area_lights;
  registry.describe(
      "One bounce of virtual area lights, averaged to one light at each of a few surface points",
      "Lensing & Broll 2013");
  addPoints(registry);
  addVertices(registry);
  addLook(registry);
  addGather(registry);
  addNormalise(registry);
  addOcclude(registry);
  addApply(registry);
  addPixels(registry);
  addBruteForce(registry);
  addBounce(registry);
}
