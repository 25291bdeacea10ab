// Throws while it registers.
#include <stdexcept>

#include "lumivox/plugin/technique.h"

LUMIVOX_TECHNIQUE(registry) {
  registry.describe("never finishes", "");
  throw std::runtime_error("the table of directions is missing");
}
