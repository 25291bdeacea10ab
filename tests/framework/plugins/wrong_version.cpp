// Built for another version of the interface. Its registration must never be called: it would end the
// program.
#include <cstdlib>

#include "lumivox/plugin/technique.h"

extern "C" __attribute__((visibility("default"))) const lumivox::TechniqueVersionRecord*
lumivox_technique_version() {
  static lumivox::TechniqueVersionRecord record = lumivox::techniqueVersionHere();
  record.apiVersion = lumivox::kTechniqueApiVersion + 1;
  return &record;
}
extern "C" __attribute__((visibility("default"))) void lumivox_technique_register(
    lumivox::TechniqueRegistry*) {
  std::abort();
}
