// Messages.
#include "lumivox/base/findings.h"
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

TEST_CASE("a warning with a place says once that it is a warning") {
  const LogCapture capture;
  Diagnostic finding;
  finding.severity = Diagnostic::Severity::warning;
  finding.place = {"a.pipeline", 3, 5};
  finding.what = "no pass uses it";
  logFinding(finding);
  CHECK(capture.text() == "a.pipeline:3:5: warning: no pass uses it\n");
}

TEST_CASE("a collector takes the warnings of its thread, the innermost first, and nothing else") {
  const LogCapture capture;
  const WarningCollector outer;
  {
    const WarningCollector inner;
    logWarning("{} flat triangles", 2);
    logInformation("reading");
    REQUIRE(inner.findings().size() == 1);
    CHECK(inner.findings()[0].what == "2 flat triangles");
    CHECK(inner.findings()[0].place.file.empty());
    logFinding(inner.findings()[0]);
    CHECK(inner.findings().size() == 2);
  }
  CHECK(outer.findings().empty());
  CHECK(capture.text() == "reading\n");
  logWarning("after it");
  CHECK(outer.findings().size() == 1);
}
