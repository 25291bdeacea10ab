// Built by another compiler, whose name even lacks its end.
#include <cstdlib>
#include <cstring>

#include "lumivox/plugin/technique.h"

extern "C" __attribute__((visibility("default"))) const lumivox::TechniqueVersionRecord*
lumivox_technique_version() {
  static lumivox::TechniqueVersionRecord record = lumivox::techniqueVersionHere();
  std::memset(record.compiler, 'x', sizeof(record.compiler));
  return &record;
}
extern "C" __attribute__((visibility("default"))) void lumivox_technique_register(
    lumivox::TechniqueRegistry*) {
  std::abort();
}
