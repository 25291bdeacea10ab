// Registers nothing.
#include "lumivox/plugin/technique.h"

LUMIVOX_TECHNIQUE(registry) {
  registry.describe("has no passes", "");
}
