// Diagnostics and the nearest word.
#include <algorithm>
#include <cstdint>

#include "lumivox/base/error.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using Catch::Matchers::Contains;
using lumivox::test::Tells;

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
  REQUIRE_THAT(error.what(), Tells("f:1:1: one", "f:2:1: two"));
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

TEST_CASE("of very many findings the first are shown, and how many more there are is said") {
  std::vector<Diagnostic> all(25000);
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].place = {"a.scene", static_cast<int>(i + 1), 1};
    all[i].what = "wrong";
  }
  const DiagnosticsError error(all);
  CHECK(error.diagnostics().size() == 25000);
  const std::string text = error.what();
  CHECK_THAT(text, Contains("a.scene:200:1: wrong") && !Contains("a.scene:201:1"));
  CHECK_THAT(text, Catch::Matchers::EndsWith("and 24800 more findings; the first 200 are shown"));
  all.resize(kMostFindingsShown + 1);
  CHECK_THAT(std::string(DiagnosticsError(all).what()),
             Contains("a.scene:201:1: wrong") && !Contains("more findings"));
}

TEST_CASE("a list of very many words names the first, and how many more there are") {
  std::vector<std::string> words(25000, "word");
  CHECK_THAT(listed(words), Catch::Matchers::EndsWith("word, ... and 24900 more"));
  CHECK(listed(words).size() < 1000);
  words.resize(3);
  CHECK(listed(words) == "word, word, word");
}

TEST_CASE("the nearest word is the one that the whole table of edit distances finds") {
  // The table as it is written in textbooks, beside the band of it that is looked at.
  const auto distance = [](const std::string& a, const std::string& b) {
    std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
    for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i)
      for (std::size_t j = 1; j <= b.size(); ++j) {
        const std::size_t change = a[i - 1] == b[j - 1] ? 0 : 1;
        d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + change});
        if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
          d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
      }
    return d[a.size()][b.size()];
  };
  std::uint32_t state = 1;
  const auto random = [&](std::uint32_t below) {
    state = state * 1664525u + 1013904223u;
    return (state >> 8) % below;
  };
  const auto word = [&] {
    std::string text(1 + random(12), ' ');
    for (char& letter : text) letter = static_cast<char>('a' + random(3));
    return text;
  };
  int found = 0;
  for (int round = 0; round < 3000; ++round) {
    const std::string wrong = word();
    std::vector<std::string> known;
    for (int i = 0; i < 6; ++i) known.push_back(word());
    std::string best;
    std::size_t least = std::max<std::size_t>(1, wrong.size() / 3) + 1;
    for (const std::string& one : known) {
      if (one == wrong) continue;
      const std::size_t d = distance(wrong, one);
      if (d >= least || d >= std::max(wrong.size(), one.size())) continue;
      least = d;
      best = one;
    }
    if (best.empty()) continue;
    ++found;
    CAPTURE(wrong, known);
    REQUIRE(nearestWord(wrong, known) == best);
  }
  CHECK(found > 400);
}

TEST_CASE("facts of a message are whole words and numbers in their order") {
  const std::string text = "a.scene:3:7: 'width' is 0.5, not -2 in 1..64; expected size_2";
  using test::Tells;
  CHECK_THAT(text, Tells("a.scene:3:7", "width", 0.5, -2, 1, 64, "size_2"));
  CHECK_THROWS_MATCHES(throw Error(text), Error, Tells("a.scene:3", 0.5));
  for (const char* absent : {"widt", "idth", "5", "2", "4", "size", "a.scen"})
    CHECK_THAT(text, !Tells(absent));
  CHECK_THAT(text, !Tells(0) && !Tells("width", "a.scene:3:7") && !Tells("width", "width"));
  CHECK_THAT(text + "\n  width height\n  ^",
             !Tells("height") && !Tells("^"));  // the source line and its caret
}
