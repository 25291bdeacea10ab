// The checker: every rule of the tables has its own message. And the descriptions made from the same tables.
#include <algorithm>
#include <numbers>

#include "lumivox/dsl/schema.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::dsl;
using Catch::Matchers::Contains;

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

PropertySpecification specify(const std::string& word, PropertyType type,
                              Dimension dimension = kNoDimension) {
  PropertySpecification result;
  result.word = word;
  result.type = type;
  result.dimension = dimension;
  result.meaning = "meaning of " + word;
  return result;
}

/// A small grammar with one of everything.
std::vector<BlockSpecification> grammar() {
  PropertySpecification fov = specify("fov", PropertyType::number, kAngle);
  fov.low = 1 * kDegree;
  fov.high = 179 * kDegree;
  fov.required = true;
  fov.defaultText = "40 deg";
  PropertySpecification file = specify("file", PropertyType::text);
  file.repeatable = true;
  PropertySpecification filter = specify("filter", PropertyType::word);
  filter.choices = {"linear", "nearest"};
  PropertySpecification count = specify("count", PropertyType::integer);
  count.low = 1;
  count.high = 100;
  PropertySpecification sizes = specify("sizes", PropertyType::list, kLength);
  PropertySpecification frames = specify("frames", PropertyType::range);
  frames.low = 0;
  PropertySpecification resolution = specify("resolution", PropertyType::resolution);
  resolution.low = 1;

  BlockSpecification camera;
  camera.word = "camera";
  camera.name = HeaderUse::required;
  camera.meaning = "where it is seen from";
  camera.properties = {fov,
                       specify("eye", PropertyType::vector3, kLength),
                       resolution,
                       specify("speed", PropertyType::number, kSpeed),
                       specify("spin", PropertyType::axisAndNumber, kAngularSpeed),
                       specify("loop", PropertyType::flag),
                       filter,
                       count,
                       sizes,
                       frames,
                       file,
                       specify("target", PropertyType::name),
                       specify("albedo", PropertyType::oneOrThree),
                       specify("extinction", PropertyType::oneOrThree, kInverseLength),
                       specify("source", PropertyType::output),
                       specify("whatever", PropertyType::any)};
  BlockSpecification key;
  key.word = "key";
  key.meaning = "a point of the path";
  key.properties = {specify("time", PropertyType::number, kTime)};
  camera.blocks = {key};

  BlockSpecification light;
  light.word = "light";
  light.name = HeaderUse::optional;
  light.kinds = {"point", "spot"};
  light.kindProperties = {{"point", {specify("intensity", PropertyType::oneOrThree)}},
                          {"spot", {specify("outer", PropertyType::number, kAngle)}}};
  light.meaning = "a light";

  BlockSpecification environment;
  environment.word = "environment";
  environment.repeatable = false;
  environment.meaning = "the sky";

  BlockSpecification pass;
  pass.word = "pass";
  pass.name = HeaderUse::required;
  pass.anyKind = true;
  pass.open = true;
  pass.meaning = "a pass";

  BlockSpecification scene;
  scene.word = "scene";
  scene.name = HeaderUse::required;
  scene.required = true;
  scene.repeatable = false;
  scene.meaning = "everything";
  scene.blocks = {camera, light, environment, pass};
  scene.blocks[0].required = true;
  return {scene};
}

std::vector<Diagnostic> findingsOf(const std::string& source) {
  const Document document = parse(source, "a.scene");
  REQUIRE(document.findings.empty());
  std::vector<Diagnostic> findings;
  check(document, grammar(), findings);
  return findings;
}

/// The only finding for a text inside `camera main { fov 40 deg ... }`.
std::string camera(const std::string& inside) {
  const auto findings = findingsOf("scene s { camera main { fov 40 deg\n" + inside + "\n} }");
  for (const Diagnostic& finding : findings) UNSCOPED_INFO(finding.text());
  REQUIRE(findings.size() == 1);
  return findings.front().text();
}

std::string scene(const std::string& inside) {
  const auto findings = findingsOf("scene s { camera main { fov 40 deg }\n" + inside + "\n}");
  for (const Diagnostic& finding : findings) UNSCOPED_INFO(finding.text());
  REQUIRE(findings.size() == 1);
  return findings.front().text();
}

}  // namespace

TEST_CASE("a text that keeps all rules has no findings") {
  CHECK(findingsOf(R"(scene "s" {
    camera main { fov 40 deg  eye 1 2 3  resolution 4 5  speed 3 cm/s  spin 0 1 0 30 deg/s  loop on  filter linear  count 3
      sizes [1 cm 2]  frames 0..3  file "a"  file "b"  target room/box  albedo 0.5  extinction 1 2 3 /cm  source a.b  whatever 1 [2] x.y
      key { time 3 ms }
      key { }
    }
    light lamp point { intensity 1 2 3 }
    light spot { outer 3 deg }
    environment { }
    pass p any.thing { unknown 1 }
  })")
            .empty());
}

TEST_CASE("an unknown property is named with the known ones and the nearest") {
  CHECK_THAT(camera("eyes 1 2 3"), Contains("a.scene:2:1: unknown property 'eyes' in block 'camera main'") &&
                                       Contains("one of fov, eye,") && Contains("did you mean 'eye'?"));
}

TEST_CASE("an unknown block is named with the known ones and the nearest") {
  CHECK_THAT(scene("lihgt lamp point { }"),
             Contains("unknown block 'lihgt'") && Contains("did you mean 'light'?"));
}

TEST_CASE("an unknown top block and a missing one have their own messages") {
  const auto findings = findingsOf("scnee s { }");
  REQUIRE(findings.size() == 1);
  CHECK_THAT(findings[0].text(), Contains("unknown block 'scnee'") && Contains("did you mean 'scene'?"));
  CHECK_THAT(findingsOf("garden s { }").at(1).text(), Contains("the text lacks a block 'scene'"));
  CHECK_THAT(
      findingsOf("scene a { camera m { fov 1 deg } }\nscene b { camera m { fov 1 deg } }").at(0).text(),
      Contains("is given twice"));
}

TEST_CASE("a block written as a property and a property written as a block are told apart") {
  CHECK_THAT(scene("light 3"), Contains("'light' is a block"));
  CHECK_THAT(camera("fov { }"), Contains("'fov' is a property, not a block"));
}

TEST_CASE("a duplicate property names the place of the first") {
  CHECK_THAT(camera("fov 50 deg"),
             Contains("a.scene:2:1: property 'fov' is given twice") && Contains("first at a.scene:1:25"));
}

TEST_CASE("duplicate blocks are found by name, or by word where only one may stand") {
  CHECK_THAT(scene("light a point { }\nlight a spot { }"),
             Contains("block 'light' named 'a' is given twice") && Contains("a.scene:2:1"));
  CHECK_THAT(scene("environment { }\nenvironment { }"), Contains("block 'environment' is given twice"));
}

TEST_CASE("a missing property is named with what it expects") {
  const auto findings = findingsOf("scene s { camera main { } }");
  REQUIRE(findings.size() == 1);
  CHECK_THAT(findings[0].text(),
             Contains("block 'camera main' lacks the property 'fov'") && Contains("from 1 deg to 179 deg"));
}

TEST_CASE("a missing block is named with its meaning") {
  const auto findings = findingsOf("scene s { }");
  REQUIRE(findings.size() == 1);
  CHECK_THAT(findings[0].text(),
             Contains("block 'scene s' lacks a block 'camera'") && Contains("where it is seen from"));
}

TEST_CASE("what stands behind the end of a truncated text is not called missing") {
  const Document document = parse("scene s {\n camera main {\n eye 1 2 3", "a.scene");
  REQUIRE(document.findings.size() == 1);
  std::vector<Diagnostic> findings;
  check(document, grammar(), findings);
  CHECK(findings.empty());
}

TEST_CASE("headers lack names and kinds or have too many values") {
  CHECK_THAT(scene("camera { fov 40 deg }"), Contains("block 'camera' lacks a name"));
  CHECK_THAT(scene("light lamp { }"),
             Contains("block 'light lamp' lacks its kind") && Contains("one of point, spot"));
  CHECK_THAT(scene("light lamp pont { }"),
             Contains("unknown kind 'pont'") && Contains("did you mean 'point'?"));
  CHECK_THAT(scene("environment sky { }"), Contains("unexpected 'sky' in the header"));
  CHECK_THAT(scene("pass p { }"), Contains("lacks its kind"));
}

TEST_CASE("properties of another kind are unknown") {
  CHECK_THAT(scene("light lamp point { outer 3 deg }"), Contains("unknown property 'outer'"));
}

TEST_CASE("a property without value and one with too many values have their own messages") {
  CHECK_THAT(camera("count"),
             Contains("property 'count' has no value") && Contains("a whole number, from 1 to 100"));
  CHECK_THAT(camera("eye 1 2"), Contains("property 'eye' has 2 values") && Contains("three numbers"));
  CHECK_THAT(camera("count 1 2"), Contains("property 'count' has 2 values"));
  CHECK_THAT(camera("albedo 1 2"), Contains("one number or three"));
}

TEST_CASE("values of the wrong type are named with their kind") {
  CHECK_THAT(camera("speed fast"), Contains("the word fast does not suit property 'speed'"));
  CHECK_THAT(camera("count \"3\""), Contains("the string \"3\" does not suit"));
  CHECK_THAT(camera("file name"), Contains("the word name does not suit property 'file'") &&
                                      Contains("a string in double quotes"));
  CHECK_THAT(camera("target 3"),
             Contains("the number 3 does not suit property 'target'") && Contains("a name"));
  CHECK_THAT(camera("sizes 3"), Contains("a list in brackets"));
  CHECK_THAT(camera("frames [1 2]"),
             Contains("the list [1 2] does not suit") && Contains("a range LOW..HIGH"));
  CHECK_THAT(camera("eye far"), Contains("the word far does not suit property 'eye'"));
  CHECK_THAT(camera("source 3"), Contains("an output PASS.PORT"));
  CHECK_THAT(camera("count 2.5"), Contains("2.5 is not a whole number"));
  CHECK_THAT(camera("resolution 2.5 3"), Contains("2.5 is not a whole number"));
}

TEST_CASE("a word that is none of the choices is named with the nearest") {
  CHECK_THAT(camera("filter liner"), Contains("unknown value 'liner'") &&
                                         Contains("one of linear, nearest") &&
                                         Contains("did you mean 'linear'?"));
  CHECK_THAT(camera("loop yes"), Contains("unknown value 'yes'") && Contains("one of on, off"));
}

TEST_CASE("units are checked by dimension") {
  CHECK_THAT(camera("speed 3 m"),
             Contains("unit 'm' measures length, not length/time") && Contains("a speed in m/s or cm/s"));
  CHECK_THAT(camera("eye 1 2 3 s"), Contains("unit 's' measures time, not length"));
  CHECK_THAT(camera("count 3 m"), Contains("unit 'm' measures length, not a plain number"));
  CHECK_THAT(camera("extinction 3 m"), Contains("unit 'm' measures length, not 1/length"));
  CHECK_THAT(camera("spin 0 1 0 30 deg"), Contains("unit 'deg' measures angle, not angle/time"));
}

TEST_CASE("angles must carry their unit, lengths and times need not") {
  const auto findings = findingsOf("scene s { camera main { fov 40  eye 1 2 3 } }");
  REQUIRE(findings.size() == 1);
  CHECK_THAT(findings[0].text(),
             Contains("40 of property 'fov' has no unit") && Contains("an angle such as 39 deg"));
  CHECK_THAT(camera("spin 0 1 0 30"),
             Contains("30 of property 'spin' has no unit") && Contains("such as 30 deg/s"));
}

TEST_CASE("a misspelt unit behind a blank is taken for a unit, not for a property") {
  CHECK_THAT(camera("eye 1 2 3 cmm"), Contains("unknown unit 'cmm'") && Contains("did you mean 'cm'?"));
}

TEST_CASE("values out of range are named with the range in the unit of readers") {
  const auto findings = findingsOf("scene s { camera main { fov 180 deg } }");
  REQUIRE(findings.size() == 1);
  CHECK_THAT(findings[0].text(),
             Contains("180 deg of property 'fov' is out of range") && Contains("from 1 deg to 179 deg"));
  CHECK_THAT(camera("count 101"), Contains("out of range"));
  CHECK_THAT(camera("resolution 0 4"), Contains("out of range"));
  CHECK_THAT(camera("frames 3..1"), Contains("the range 3..1 runs backwards"));
}

TEST_CASE("the ends of a range are allowed in any unit") {
  CHECK(findingsOf("scene s { camera main { fov 179 deg } }").empty());
  CHECK(findingsOf("scene s { camera main { fov 1 deg } }").empty());
}

TEST_CASE("a unit behind the last component holds for all, a unit on some is an error") {
  const Document document = parse("a { v 1 2 3 cm  w 1 m 2 m 3 cm  x 1 2 3 }", "a");
  const auto& items = document.items.at(0).block->items;
  CHECK(numbersInBaseUnits(*items[0].property)[0] == Approx(0.01));
  CHECK(numbersInBaseUnits(*items[1].property)[0] == 1.0);
  CHECK(numbersInBaseUnits(*items[1].property)[2] == Approx(0.03));
  CHECK(numbersInBaseUnits(*items[2].property)[0] == 1.0);
  CHECK_THAT(camera("eye 1 m 2 3"), Contains("only some components of property 'eye' have a unit"));
}

TEST_CASE("a checked block gives names, kinds and numbers in base units") {
  const Document document = parse(
      "camera main { fov 180 deg  albedo 0.5  spin 0 1 0 90 deg/s  loop on\n key { time 3 ms } key { } "
      "}\nlight spot { }",
      "a");
  const auto specifications = grammar();
  const CheckedBlock camera(*document.items[0].block, specifications[0].blocks[0]);
  CHECK(camera.name() == "main");
  CHECK(camera.number("fov", 0) == Approx(std::numbers::pi));
  CHECK(camera.numbers("albedo", {}) == std::vector<double>{0.5, 0.5, 0.5});
  CHECK(camera.numbers("spin", {})[1] == 1.0);
  CHECK(camera.numbers("spin", {})[3] == Approx(std::numbers::pi / 2));
  CHECK(camera.flag("loop", false));
  CHECK(camera.number("speed", 7.0) == 7.0);
  CHECK(camera.blocks("key").size() == 2);
  CHECK_FALSE(camera.has("eye"));
  const CheckedBlock light(*document.items[1].block, specifications[0].blocks[1]);
  CHECK(light.name().empty());
  CHECK(light.kind() == "spot");
}

TEST_CASE("a description names meaning, unit, range and default, wherever the word occurs") {
  const std::string text = describe(grammar(), "fov");
  CHECK_THAT(text, Contains("scene > camera") && Contains("meaning of fov") &&
                       Contains("from 1 deg to 179 deg") && Contains("required"));
  CHECK_THAT(describe(grammar(), "light"),
             Contains("light [NAME] point|spot { ... }") && Contains("light spot:"));
  CHECK(describe(grammar(), "nonsense").empty());
}

TEST_CASE("the reference holds every word of the tables") {
  const std::string text = describeAsMarkdown(grammar());
  for (const std::string& word : words(grammar())) CHECK_THAT(text, Contains("`" + word));
  const auto all = words(grammar());
  CHECK(std::is_sorted(all.begin(), all.end()));
}

TEST_CASE("a number that single precision does not hold is refused, whatever its table allows") {
  const PropertySpecification any = specify("power", PropertyType::oneOrThree);
  const auto found = [&](const std::string& values) {
    const Document document = parse("block { power " + values + " }", "a.scene");
    std::vector<Diagnostic> findings;
    checkProperty(document, *document.items.at(0).block->items.at(0).property, any, findings);
    return findings;
  };
  for (const char* good : {"0", "1e37", "-1e37", "1e-37", "0 0 0", "-0.0"}) {
    CAPTURE(good);
    CHECK(found(good).empty());
  }
  for (const char* wrong : {"1e39", "-1e200", "1e-38", "-1e-300", "1 1e39 1"}) {
    CAPTURE(wrong);
    REQUIRE(found(wrong).size() == 1);
    CHECK_THAT(found(wrong).front().text(), Contains("has no value in single precision") &&
                                                Contains("0, or a magnitude from 1e-37 to 1e+37"));
  }
}

TEST_CASE("the range holds for every component in the unit that the last one gives for all") {
  PropertySpecification eye = specify("eye", PropertyType::vector3, kLength);
  eye.low = -1000;
  eye.high = 1000;
  const auto count = [&](const std::string& values) {
    const Document document = parse("block { eye " + values + " }", "a.scene");
    std::vector<Diagnostic> findings;
    checkProperty(document, *document.items.at(0).block->items.at(0).property, eye, findings);
    return findings.size();
  };
  CHECK(count("900 0 1") == 0);
  CHECK(count("0.9 0 1 km") == 0);
  CHECK(count("900 0 1 km") == 1);
  CHECK(count("90000 0 1 cm") == 0);
  CHECK(count("1100 m 0 m 1 m") == 1);
}
