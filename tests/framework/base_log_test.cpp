// Messages.
#include "lumivox/base/log.h"
#include "support/support.h"

using namespace lumivox;

TEST_CASE("a warning says that it is one and is counted") {
  const LogCapture capture;
  const auto before = warningCount();
  logWarning("{} triangles without area", 3);
  logInformation("reading {}", "a.obj");
  REQUIRE(warningCount() == before + 1);
  REQUIRE(capture.text() == "warning: 3 triangles without area\nreading a.obj\n");
}

TEST_CASE("a capture sees every message, whatever level reaches the terminal") {
  const LogLevel before = logLevel();
  setLogLevel(LogLevel::quiet);
  REQUIRE(logLevel() == LogLevel::quiet);
  const LogCapture capture;
  logDetails("seen by the capture only");
  REQUIRE(capture.text() == "seen by the capture only\n");
  setLogLevel(before);
}
