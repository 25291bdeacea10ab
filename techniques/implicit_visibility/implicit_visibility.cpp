// Light between surface elements; an element sees the nearest link in every bin of directions (Dong et al.
// 2007).
#include "passes.h"

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::implicit_visibility;
  registry.describe(
      "Light between surface elements, with visibility implied by the nearest link in bins of directions",
      "Dong, Kautz, Theobalt & Seidel 2007");
  addHierarchy(registry);
  addElements(registry);
  addLinks(registry);
  addIlluminate(registry);
  addDisplay(registry);
}
