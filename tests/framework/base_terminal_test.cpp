// Texts that fit a terminal.
#include <cstdlib>

#include "lumivox/base/terminal.h"
#include "support/support.h"

using namespace lumivox;

TEST_CASE("widths count characters, neither the bytes of UTF-8 nor colours") {
  CHECK(shownWidth("0.1 ± 0.2") == 9);
  CHECK(shownWidth(painted(Paint::bad, "failed", true)) == 6);
  CHECK(painted(Paint::bad, "failed", false) == "failed");
}

TEST_CASE("a text is cut between characters, and only when it is too long") {
  CHECK(cutTo("cornell", 7) == "cornell");
  CHECK(cutTo("cornell", 6) == "corn..");
  CHECK(cutTo("±±±±", 3) == "±..");
}

TEST_CASE("a text is broken at spaces, and a long word stays whole") {
  CHECK(wrapped("light that meets one surface", 12) == "light that\nmeets one\nsurface");
  CHECK(wrapped("not run: smoke", 9, 2) == "not run:\n  smoke");
  CHECK(wrapped("a_word_without_spaces b", 5) == "a_word_without_spaces\nb");
  CHECK(wrapped("", 5).empty());
}

TEST_CASE("COLUMNS says how wide a terminal is, unless it is no number") {
  const char* before = std::getenv("COLUMNS");
  const std::string kept = before == nullptr ? "" : before;
  setenv("COLUMNS", "64", 1);
  CHECK(terminalColumns(0) == 64);
  setenv("COLUMNS", "3", 1);
  CHECK(terminalColumns(0) == 20);
  for (const char* wrong : {"wide", "-4", "0", "80x25"}) {
    INFO(wrong);
    setenv("COLUMNS", wrong, 1);
    CHECK(terminalColumns(-1) == kUsualColumns);
  }
  unsetenv("COLUMNS");
  CHECK(terminalColumns(-1) == kUsualColumns);
  if (before != nullptr) setenv("COLUMNS", kept.c_str(), 1);
}

TEST_CASE("durations are told in the unit that suits them") {
  CHECK(durationText(12.3) == "12 s");
  CHECK(durationText(240.0) == "4 min");
  CHECK(durationText(5400.0) == "1.5 h");
}
