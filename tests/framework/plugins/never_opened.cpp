// A technique that ends the process as soon as it is opened. Its record of versions is right; tests change it
// in copies of the file, which then must never be opened.
#include <cstdlib>

#include "lumivox/plugin/technique.h"

__attribute__((constructor)) static void opened() {
  std::abort();
}

LUMIVOX_TECHNIQUE(registry) {
  registry.describe("is never opened", "");
}
