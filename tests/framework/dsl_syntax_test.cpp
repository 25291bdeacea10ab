// Lexer, parser and includes: what the grammar means, and one message for each way to get it wrong.
#include <fmt/format.h>

#include <ctime>
#include <numbers>

#include "lumivox/dsl/document.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::dsl;
using Catch::Matchers::Contains;

namespace {

Document good(const std::string& source) {
  Document document = parse(source, "a.scene");
  for (const Diagnostic& finding : document.findings) FAIL_CHECK(finding.text());
  return document;
}

/// The text of the only finding.
std::string only(const std::string& source) {
  const Document document = parse(source, "a.scene");
  for (const Diagnostic& finding : document.findings) INFO(finding.text());
  REQUIRE(document.findings.size() == 1);
  return document.findings.front().text();
}

const Property& property(const Document& document, std::size_t index) {
  return *document.items.at(0).block->items.at(index).property;
}

}  // namespace

TEST_CASE("a block has a word, header values and items") {
  const Document document = good("light sun directional { direction -0.3 -1 0.2  irradiance 10 10 9 }");
  const Block& block = *document.items.at(0).block;
  CHECK(block.word == "light");
  REQUIRE(block.header.size() == 2);
  CHECK(block.header[0].text == "sun");
  CHECK(block.header[1].text == "directional");
  REQUIRE(block.items.size() == 2);
  CHECK(property(document, 0).word == "direction");
  CHECK(property(document, 0).values.size() == 3);
  CHECK(property(document, 0).values[1].number == -1.0);
  CHECK(property(document, 1).word == "irradiance");
}

TEST_CASE("a pass has a name, a dotted kind and inputs named by words and outputs") {
  const Document document =
      good("pass direct direct_lighting.shade { gbuffer gbuffer   shadow shadow.depth }");
  const Block& block = *document.items.at(0).block;
  CHECK(block.header.at(1).text == "direct_lighting.shade");
  REQUIRE(block.items.size() == 2);
  CHECK(property(document, 0).values.at(0).text == "gbuffer");
  CHECK(property(document, 1).values.at(0).text == "shadow.depth");
  CHECK(property(document, 0).values.at(0).isPlainWord());
  CHECK_FALSE(property(document, 1).values.at(0).isPlainWord());
}

TEST_CASE("a parameter line with its range is one property") {
  const Document document =
      good("p { param resolution 128 in 16..512\nparam quality high in [low high] cones $c }");
  const Property& first = property(document, 0);
  REQUIRE(first.values.size() == 4);
  CHECK(first.values[1].integral);
  CHECK(first.values[3].kind == ValueKind::range);
  CHECK(first.values[3].items[0].number == 16.0);
  CHECK(first.values[3].items[1].number == 512.0);
  const Property& second = property(document, 1);
  REQUIRE(second.values.size() == 4);
  CHECK(second.values[1].text == "high");
  CHECK(second.values[3].items.size() == 2);
  CHECK(property(document, 2).values.at(0).kind == ValueKind::parameter);
  CHECK(property(document, 2).values.at(0).text == "c");
}

TEST_CASE("units stand right behind a number or behind a blank and convert to base units") {
  const Document document = good("a { b 30 deg/s c 40 /m d 4cm e 2 min f 90deg g 1..2 cm h 40/m i 5 mm }");
  CHECK(property(document, 0).values[0].inBaseUnits() == Approx(std::numbers::pi / 6));
  CHECK(property(document, 0).values[0].unit->dimension == kAngularSpeed);
  CHECK(property(document, 1).values[0].inBaseUnits() == 40.0);
  CHECK(property(document, 2).values[0].inBaseUnits() == Approx(0.04));
  CHECK(property(document, 3).values[0].inBaseUnits() == 120.0);
  CHECK(property(document, 4).values[0].inBaseUnits() == Approx(std::numbers::pi / 2));
  CHECK(property(document, 5).values[0].items[0].inBaseUnits() == Approx(0.01));
  CHECK(property(document, 5).values[0].items[1].inBaseUnits() == Approx(0.02));
  CHECK(property(document, 6).values[0].unit->name == "/m");
  CHECK(property(document, 7).values[0].inBaseUnits() == Approx(0.005));
}

TEST_CASE("every known unit can be written in both ways") {
  for (const Unit& unit : knownUnits()) {
    CHECK(property(good("a { b 3 " + unit.name + " c 1 }"), 0).values.at(0).unit->name == unit.name);
    CHECK(property(good("a { b 3" + unit.name + " c 1 }"), 0).values.at(0).unit->name == unit.name);
  }
}

TEST_CASE("numbers are read as written in decimal") {
  const Document document = good("a { b -0.3 1e-3 .5 +2 6.02E23 7. }");
  const auto& values = property(document, 0).values;
  CHECK(values[0].number == -0.3);
  CHECK(values[1].number == 1e-3);
  CHECK(values[2].number == 0.5);
  CHECK(values[3].number == 2.0);
  CHECK(values[3].integral);
  CHECK(values[4].number == 6.02e23);
  CHECK(values[5].number == 7.0);
}

TEST_CASE("strings keep blanks, hash signs and escaped quotes") {
  CHECK(property(good(R"(a { b "x # \"y\" \\z" })"), 0).values[0].text == R"(x # "y" \z)");
}

TEST_CASE("words may hold dots, slashes and patterns") {
  const Document document = good("a { b room/tall_box c.d x-1 sponza_3* }");
  const auto& values = property(document, 0).values;
  REQUIRE(values.size() == 2);  // x-1 starts the next property
  CHECK(values[0].text == "room/tall_box");
}

TEST_CASE("values may go on in the next line but words start a statement there") {
  const Document document = good("a {\n b 1 2\n 3\n c [1 2\n 3] d }");
  CHECK(property(document, 0).values.size() == 3);
  CHECK(property(document, 1).values.at(0).items.size() == 3);
}

TEST_CASE("all syntax errors of a text are reported in the order of their places") {
  const Document document = parse("a {\n b = 1\n c 4 kq/m\n d 3.4.5\n}\n}\n", "a.scene");
  REQUIRE(document.findings.size() >= 3);
  for (std::size_t i = 1; i < document.findings.size(); ++i) {
    CHECK(document.findings[i - 1].place.line <= document.findings[i].place.line);
  }
  CHECK(document.findings.front().place.line == 2);
  CHECK(document.findings.back().place.line == 6);
}

TEST_CASE("a finding shows file, line, column, the source line and a caret") {
  CHECK(only("a {\n  fov = 3\n}\n") ==
        "a.scene:2:7: unexpected '='; expected words and values separated by blanks\n    fov = 3\n        ^");
}

TEST_CASE("columns count characters so that the caret stands right behind umlauts") {
  const Document document = parse("a { b \"\xC3\xBC\" = }", "a.scene");
  REQUIRE(document.findings.size() == 1);
  CHECK(document.findings[0].place.column == 11);
}

TEST_CASE("each slip of syntax has its own message") {
  CHECK_THAT(only("a { b 1, 2 }"), Contains("unexpected ','"));
  CHECK_THAT(only("a { b 1; }"), Contains("unexpected ';'"));
  CHECK_THAT(only("a { b ~ }"), Contains("unexpected character '~'"));
  CHECK_THAT(only("a { b - 3 }"), Contains("'-' without a number"));
  CHECK_THAT(only("a { b 1.2.3 }"), Contains("malformed number '1.2.3'"));
  CHECK_THAT(only("a { b 1e999 }"), Contains("1e999 is out of range"));
  CHECK_THAT(only("a { b \"open\n}"), Contains("the string is not closed"));
  CHECK_THAT(only("a { b $ }"), Contains("'$' without a name"));
  CHECK_THAT(only("a { b [1 2 }"), Contains("the list is not closed"));
  CHECK_THAT(only("a { b [1 [2] }"), Contains("a list in a list"));
  CHECK_THAT(only("a { b 1.. }"), Contains("'..' without an upper end"));
  CHECK_THAT(only("a { ..3 }"), Contains("unexpected '..'"));
  CHECK_THAT(only("a { ] }"), Contains("unexpected ']'"));
  CHECK_THAT(only("a { b 1 }\n}"), Contains("unexpected '}'"));
  CHECK_THAT(only("a { 3 }"), Contains("unexpected value"));
  CHECK_THAT(only("a { x.y 3 }"), Contains("unexpected 'x.y'"));
  CHECK_THAT(only("a { \"text\" }"), Contains("unexpected value"));
  CHECK_THAT(only("a {\n /m }"), Contains("unit '/m' without a number"));
  CHECK_THAT(only("a 3 { b 1 }"), Contains("unexpected '{'"));
  CHECK_THAT(only("a\n{ b 1 }"), Contains("'{' starts a line"));
}

TEST_CASE("an unknown unit is named with the nearest known one") {
  CHECK_THAT(only("a { b 39dge }"), Contains("unknown unit 'dge'") && Contains("one of m, cm, mm") &&
                                        Contains("did you mean 'deg'"));
  CHECK_THAT(only("a { b 39 /mm }"), Contains("unknown unit '/mm'"));
}

TEST_CASE("a truncated text names the blocks that are still open, once") {
  CHECK_THAT(only("scene \"x\" {\n  camera main {\n    eye 0 0"),
             Contains("a.scene:2:3") && Contains("the file ends inside blocks 'scene \"x\"', 'camera main'"));
}

TEST_CASE("empty, binary and huge texts give one clear error") {
  CHECK_THAT(only(""), Contains("a.scene: the text is empty"));
  CHECK_THAT(only("# only a comment\n"), Contains("the text is empty"));
  CHECK_THAT(only(std::string("scene \0 x", 9)), Contains("not a text file"));
  CHECK_THAT(only("\x7F"
                  "ELF"),
             Contains("not a text file"));
  CHECK_THAT(only(std::string(kMaximumTextBytes + 1, ' ')), Contains("the text is too large"));
}

TEST_CASE("nesting, lists and the number of errors are limited") {
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "a {\n";
  CHECK_THAT(only(deep + std::string(100000, '}')), Contains("nested too deeply"));
  std::string list = "a { b [";
  for (std::size_t i = 0; i <= kMaximumListItems; ++i) list += "1 ";
  CHECK_THAT(only(list + "] }"), Contains("the list is too long"));
  std::string slips;
  for (int i = 0; i < 100000; ++i) slips += "=\n";
  const Document document = parse(slips, "a.scene");
  CHECK(document.findings.size() == kMaximumFindings + 1);
  CHECK_THAT(document.findings.back().text(), Contains("too many errors"));
  CHECK(parse(std::string(1000000, '}'), "a.scene").findings.size() <= kMaximumFindings + 1);
  CHECK(parse(std::string(1000000, '['), "a.scene").findings.size() <= kMaximumFindings + 1);
}

TEST_CASE("an error in a line of a million columns does not print the line") {
  const Document document = parse("a { b " + std::string(1000000, '1') + " = }", "a.scene");
  REQUIRE_FALSE(document.findings.empty());
  for (const Diagnostic& finding : document.findings) CHECK(finding.text().size() < 1000);
}

TEST_CASE("an included file's items take the place of the include") {
  const test::TemporaryDirectory directory;
  directory.write("parts/red.part", "material red { diffuse 1 0 0 }\n");
  const auto file = directory.write(
      "a.scene", "scene \"x\" {\n  include \"parts/red.part\"\n  mesh m { file \"m.obj\" }\n}\n");
  const Document document = parseFile(file);
  CHECK(document.findings.empty());
  const Block& scene = *document.items.at(0).block;
  REQUIRE(scene.items.size() == 2);
  CHECK(scene.items[0].block->word == "material");
  CHECK(scene.items[0].block->place.file == (directory.path() / "parts/red.part").string());
  CHECK(document.includedFiles.size() == 1);
}

TEST_CASE("an error in an included file carries that file's place and line") {
  const test::TemporaryDirectory directory;
  directory.write("b.part", "material red {\n  diffuse = 1 0 0\n}\n");
  const Document document = parseFile(directory.write("a.scene", "scene \"x\" {\n include \"b.part\"\n}\n"));
  REQUIRE(document.findings.size() == 1);
  CHECK(document.findings[0].place.file == (directory.path() / "b.part").string());
  CHECK(document.findings[0].place.line == 2);
  CHECK(document.findings[0].sourceLine == "  diffuse = 1 0 0");
}

TEST_CASE("an include cycle is named with its chain") {
  const test::TemporaryDirectory directory;
  directory.write("b.part", "include \"c.part\"\n");
  directory.write("c.part", "include \"a.scene\"\n");
  const Document document = parseFile(directory.write("a.scene", "include \"b.part\"\n"));
  REQUIRE(document.findings.size() == 1);
  CHECK_THAT(document.findings[0].text(), Contains("include cycle: a.scene -> b.part -> c.part -> a.scene"));
  CHECK(document.findings[0].place.file == (directory.path() / "c.part").string());
}

TEST_CASE("a missing included file is a finding at the include") {
  const test::TemporaryDirectory directory;
  const Document document =
      parseFile(directory.write("a.scene", "scene \"x\" {\n  include \"none.part\"\n}\n"));
  REQUIRE(document.findings.size() == 1);
  CHECK_THAT(document.findings[0].text(),
             Contains("a.scene:2:11: included file") && Contains("none.part' does not exist"));
}

TEST_CASE("an include without a file name and one of a directory are findings") {
  const test::TemporaryDirectory directory;
  CHECK_THAT(parseFile(directory.write("a.scene", "include 3\n")).findings.at(0).text(),
             Contains("'include' without a file"));
  std::filesystem::create_directory(directory.path() / "folder");
  CHECK_THAT(parseFile(directory.write("a.scene", "include \"folder\"\n")).findings.at(0).text(),
             Contains("is a directory"));
}

TEST_CASE("includes that double at every level stop at a limit") {
  const test::TemporaryDirectory directory;
  constexpr int kLevels = 20;  // 2^20 files when followed
  for (int i = 0; i < kLevels; ++i) {
    const std::string line = fmt::format("include \"{}.part\"\n", i + 1);
    directory.write(fmt::format("{}.part", i), line + line);
  }
  directory.write(fmt::format("{}.part", kLevels), "a { }\n");
  const Document document = parseFile(directory.path() / "0.part");
  REQUIRE_FALSE(document.findings.empty());
  CHECK_THAT(document.findings.front().text(), Contains("too many included files"));
}

TEST_CASE("a missing text is an error that names it") {
  CHECK_THAT(test::messageOf<Error>([] { parseFile("no/such.scene"); }), Contains("no/such.scene"));
}

TEST_CASE("one line of the largest text is read once, whatever it is made of") {
  /// Seconds of this process's own time; what is linear in a text's length takes a small part of these.
  constexpr double kSoon = 30.0;
  const auto secondsToParse = [](const std::string& part, std::size_t bytes) {
    std::string text;
    while (text.size() + part.size() <= bytes) text += part;
    const std::clock_t start = std::clock();
    parse(text, "a.scene");
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  };
  for (const char* part : {"@", "'a' ", "'", "/*", "]", "1q ", "\"a\" ", "$ "}) {
    CAPTURE(part);
    CHECK(secondsToParse(part, kMaximumTextBytes) < kSoon);
  }
  CHECK(secondsToParse("word ", kMaximumTextBytes / 8) < kSoon);
}

TEST_CASE("strings in single quotes are found up to the end of their line, and no further") {
  CHECK_THAT(only("scene 'x' { }"), Contains("a string in single quotes; expected \"x\""));
  CHECK_THAT(only("scene x { ' }\n# don't\n"), Contains("unexpected character"));
}

TEST_CASE("the line of a finding is that of its own text, to the last one") {
  const Document document = parse("scene x {\n  a 1\n}\n@", "a.scene");
  REQUIRE(document.findings.size() == 1);
  CHECK(document.findings.front().sourceLine == "@");
  CHECK(document.line(1) == "scene x {");
  CHECK(document.line(3) == "}");
  CHECK(document.line(5).empty());
  CHECK(document.line(0).empty());
}
