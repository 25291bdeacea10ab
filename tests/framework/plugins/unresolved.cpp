// Calls a function that exists nowhere.
#include "lumivox/plugin/technique.h"

void functionThatNobodyWrote();

LUMIVOX_TECHNIQUE(registry) {
  functionThatNobodyWrote();
  registry.describe("never opens", "");
}
