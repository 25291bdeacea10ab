#include <cstdlib>

#include "lumivox/plugin/technique.h"
#include "support/cases.h"

#if defined(__SANITIZE_ADDRESS__)
// OpenVDB leaks the nodes that it has read if a file turns out to be damaged.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:openvdb::";
}
#endif

int main(int count, char** arguments) {
  // A debug context makes the driver report errors at once, in every test and in the programs that tests
  // start.
  setenv("LUMIVOX_DEBUG_CONTEXT", "1", 0);
  lumivox::requireLibraryOf(lumivox::techniqueVersionHere());
  return lumivox::test::runCases(count, arguments);
}
