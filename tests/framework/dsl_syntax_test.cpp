// Lexer, parser and includes: what the grammar means, and one message for each way to get it wrong.
#include <fmt/format.h>

#include <ctime>
#include <numbers>

#include "lumivox/dsl/document.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::dsl;
using lumivox::test::Tells;

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
  const auto [written, inBaseUnits] = GENERATE(table<const char*, double>({
      {"30 deg/s", std::numbers::pi / 6},
      {"40 /m", 40.0},
      {"40/m", 40.0},
      {"4cm", 0.04},
      {"2 min", 120.0},
      {"90deg", std::numbers::pi / 2},
      {"5 mm", 0.005},
  }));
  CAPTURE(written);
  const Document document = good(std::string("a { b ") + written + " c 1..2 cm }");
  CHECK(property(document, 0).values[0].inBaseUnits() == Approx(inBaseUnits));
  CHECK(property(document, 1).values[0].items[0].inBaseUnits() == Approx(0.01));
  CHECK(property(document, 1).values[0].items[1].inBaseUnits() == Approx(0.02));
  CHECK(property(good("a { b 30 deg/s }"), 0).values[0].unit->dimension == kAngularSpeed);
}

TEST_CASE("every known unit can be written in both ways") {
  for (const Unit& unit : knownUnits()) {
    CHECK(property(good("a { b 3 " + unit.name + " c 1 }"), 0).values.at(0).unit->name == unit.name);
    CHECK(property(good("a { b 3" + unit.name + " c 1 }"), 0).values.at(0).unit->name == unit.name);
  }
}

TEST_CASE("numbers are read as written in decimal") {
  const Document document = good("a { b -0.3 1e-3 .5 +2 6.02E23 7. }");
  std::vector<double> numbers;
  for (const Value& value : property(document, 0).values) numbers.push_back(value.number);
  CHECK(numbers == std::vector<double>{-0.3, 1e-3, 0.5, 2.0, 6.02e23, 7.0});
  CHECK(property(document, 0).values[3].integral);
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

TEST_CASE("each slip of syntax has its own message, and is the only finding") {
  const auto [source, told] = GENERATE(table<std::string, Tells>({
      {"a { b 1, 2 }", Tells("unexpected ','")},
      {"a { b 1; }", Tells("unexpected ';'")},
      {"a { b ~ }", Tells("character '~'")},
      {"a { b - 3 }", Tells("'-'", "number")},
      {"a { b 1.2.3 }", Tells("malformed", "1.2.3")},
      {"a { b 1e999 }", Tells("1e999", "range")},
      {"a { b \"open\n}", Tells("string", "closed")},
      {"scene 'x' { }", Tells("single quotes", "\"x\"")},
      {"scene x { ' }\n# don't\n",
       Tells("a.scene:1:11", "unexpected character")},  // to the end of the line, no further
      {"a { b $ }", Tells("'$'", "name")},
      {"a { b [1 2 }", Tells("list", "closed")},
      {"a { b [1 [2] }", Tells("list in a list")},
      {"a { b 1.. }", Tells("'..'", "upper end")},
      {"a { ..3 }", Tells("unexpected '..'")},
      {"a { ] }", Tells("unexpected ']'")},
      {"a { b 1 }\n}", Tells("a.scene:2:1", "unexpected '}'")},
      {"a { 3 }", Tells("unexpected value")},
      {"a { x.y 3 }", Tells("unexpected 'x.y'")},
      {"a { \"text\" }", Tells("unexpected value")},
      {"a {\n /m }", Tells("unit '/m'", "number")},
      {"a 3 { b 1 }", Tells("unexpected '{'")},
      {"a\n{ b 1 }", Tells("'{'", "line")},
      {"a { b 39dge }", Tells("unit", "dge", "m, cm, mm", "mean", "deg")},
      {"a { b 39 /mm }", Tells("unit", "/mm")},
      {"scene \"x\" {\n  camera main {\n    eye 0 0",
       Tells("a.scene:2:3", "ends", "scene \"x\"", "camera main")},
      {"", Tells("a.scene", "empty")},
      {"# only a comment\n", Tells("empty")},
      {std::string("scene \0 x", 9), Tells("not a text")},
      {"\x7F"
       "ELF",
       Tells("not a text")},
      {std::string(kMaximumTextBytes + 1, ' '), Tells("too large")},
  }));
  CAPTURE(source.substr(0, 60));
  CHECK_THAT(only(source), told);
}

TEST_CASE("nesting, lists and the number of errors are limited") {
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "a {\n";
  CHECK_THAT(only(deep + std::string(100000, '}')), Tells("nested too deeply"));
  std::string list = "a { b [";
  for (std::size_t i = 0; i <= kMaximumListItems; ++i) list += "1 ";
  CHECK_THAT(only(list + "] }"), Tells("list"));
  std::string slips;
  for (int i = 0; i < 100000; ++i) slips += "=\n";
  const Document document = parse(slips, "a.scene");
  CHECK(document.findings.size() == kMaximumFindings + 1);
  CHECK_THAT(document.findings.back().text(), Tells("too many errors"));
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

TEST_CASE("an include that cannot be followed is one finding at its place") {
  const auto [source, told] = GENERATE(table<const char*, Tells>({
      {"scene \"x\" {\n  include \"none.part\"\n}\n", Tells("a.scene:2:11", "none.part", "exist")},
      {"include 3\n", Tells("a.scene:1", "include", "file")},
      {"include \"folder\"\n", Tells("a.scene:1", "folder", "directory")},
      {"include \"b.part\"\n", Tells("c.part:1", "cycle", "a.scene -> b.part -> c.part -> a.scene")},
  }));
  const test::TemporaryDirectory directory;
  directory.write("b.part", "include \"c.part\"\n");
  directory.write("c.part", "include \"a.scene\"\n");
  std::filesystem::create_directory(directory.path() / "folder");
  const Document document = parseFile(directory.write("a.scene", source));
  REQUIRE(document.findings.size() == 1);
  CHECK_THAT(document.findings[0].text(), told);
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
  CHECK_THAT(document.findings.front().text(), Tells("too many included files"));
}

TEST_CASE("a missing text is an error that names it") {
  CHECK_THROWS_MATCHES(parseFile("no/such.scene"), Error, Tells("no/such.scene"));
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

TEST_CASE("the line of a finding is that of its own text, to the last one") {
  const Document document = parse("scene x {\n  a 1\n}\n@", "a.scene");
  REQUIRE(document.findings.size() == 1);
  CHECK(document.findings.front().sourceLine == "@");
  CHECK(document.line(1) == "scene x {");
  CHECK(document.line(3) == "}");
  CHECK(document.line(5).empty());
  CHECK(document.line(0).empty());
}
