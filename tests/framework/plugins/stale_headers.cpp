// Compiled against other public headers: the hash is another. Its registration must never be called: it would
// end the program.
#include <cstdlib>
#include <cstring>

#include "lumivox/plugin/technique.h"

extern "C" __attribute__((visibility("default"))) const lumivox::TechniqueVersionRecord*
lumivox_technique_version() {
  static lumivox::TechniqueVersionRecord record = lumivox::techniqueVersionHere();
  std::strncpy(record.headers, "0123456789abcdef", sizeof(record.headers) - 1);
  return &record;
}
extern "C" __attribute__((visibility("default"))) void lumivox_technique_register(
    lumivox::TechniqueRegistry*) {
  std::abort();
}
