#include <cstdlib>

#include "lumivox/plugin/technique.h"
#include "support/cases.h"

#if defined(__SANITIZE_ADDRESS__)
// OpenVDB loses the nodes that it had read when a file turns out to be damaged.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:openvdb::";
}
#endif

int main(int count, char** arguments) {
  // Every test, and every program that a test starts, hears at once what the driver finds wrong.
  setenv("LUMIVOX_DEBUG_CONTEXT", "1", 0);
  lumivox::requireLibraryOf(lumivox::techniqueVersionHere());
  return lumivox::test::runCases(count, arguments);
}
