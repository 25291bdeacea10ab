// Pictures of a depth camera as light for virtual content: Lensing & Broll 2013, Sec. 5.
#include "passes.h"

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::captured_frames;
  registry.describe("Pictures of a depth camera light virtual content", "Lensing & Broll 2013, Sec. 5");
  addRead(registry);
  addLights(registry);
  addSurfaces(registry);
  addRelight(registry);
  addComposite(registry);
}
