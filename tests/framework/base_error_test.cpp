// Diagnostics and the nearest word.
#include "lumivox/base/error.h"
#include "support/support.h"

using namespace lumivox;
using Catch::Matchers::Contains;

TEST_CASE("a diagnostic shows place, finding, expectation, suggestion, line and caret") {
  Diagnostic diagnostic;
  diagnostic.place = {"a.scene", 3, 5};
  diagnostic.what = "unknown property 'fow'";
  diagnostic.expected = "one of eye, fov";
  diagnostic.suggestion = "fov";
  diagnostic.sourceLine = "    fow 39 deg";
  diagnostic.length = 3;
  REQUIRE(diagnostic.text() ==
          "a.scene:3:5: unknown property 'fow'; expected one of eye, fov; did you mean 'fov'?\n"
          "      fow 39 deg\n"
          "      ^~~");
}

TEST_CASE("a diagnostic leaves out what it does not know, and a warning says that it is one") {
  Diagnostic diagnostic;
  diagnostic.severity = Diagnostic::Severity::warning;
  diagnostic.place.file = "b.obj";
  diagnostic.what = "3 triangles without area";
  REQUIRE(diagnostic.text() == "b.obj: warning: 3 triangles without area");
  diagnostic.place.line = 7;
  REQUIRE_THAT(diagnostic.text(), Catch::Matchers::StartsWith("b.obj:7: "));
}

TEST_CASE("the caret stands under its column behind tabs") {
  Diagnostic diagnostic;
  diagnostic.place = {"t", 1, 3};
  diagnostic.what = "x";
  diagnostic.sourceLine = "\t\tword";
  REQUIRE_THAT(diagnostic.text(), Catch::Matchers::EndsWith("\n  \t\t^"));
}

TEST_CASE("all findings are reported together and stay available one by one") {
  Diagnostic first, second;
  first.place = {"f", 1, 1};
  first.what = "one";
  second.place = {"f", 2, 1};
  second.what = "two";
  const DiagnosticsError error({first, second});
  REQUIRE_THAT(error.what(), Contains("f:1:1: one") && Contains("f:2:1: two"));
  REQUIRE(error.diagnostics().size() == 2);
  REQUIRE_THROWS_AS(throw DiagnosticsError({first}), Error);
}

TEST_CASE("the nearest word is found for a slip of the pen and for nothing else") {
  const std::vector<std::string> words = {"eye",        "target",   "up",        "fov",
                                          "resolution", "radiance", "irradiance"};
  CHECK(nearestWord("fow", words) == "fov");
  CHECK(nearestWord("resoluton", words) == "resolution");    // a letter left out
  CHECK(nearestWord("reesolution", words) == "resolution");  // a letter too many
  CHECK(nearestWord("tagret", words) == "target");           // two letters swapped count as one slip
  CHECK(nearestWord("radiace", words) == "radiance");        // nearer than irradiance
  CHECK(nearestWord("colour", words).empty());
  CHECK(nearestWord("degrees", {"m", "s", "deg", "rad"}) == "deg");  // one is the beginning of the other
  CHECK(nearestWord("f", {"m", "s"}).empty());                       // nothing in common
  CHECK(nearestWord("xyz", words).empty());
  CHECK(nearestWord("", words).empty());
  CHECK(nearestWord("fov", {}).empty());
  CHECK(nearestWord(std::string(100000, 'a'), words).empty());
}
