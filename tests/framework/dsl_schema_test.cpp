// The checker: every rule of the tables has its own message. And the descriptions made from the same tables.
#include <algorithm>
#include <numbers>

#include "lumivox/dsl/schema.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::dsl;
using lumivox::test::Tells;

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

/// Of these values of one property.
std::vector<Diagnostic> findingsOf(const PropertySpecification& property, const std::string& values) {
  const Document document = parse("block { " + property.word + " " + values + " }", "a.scene");
  std::vector<Diagnostic> findings;
  checkProperty(document, *document.items.at(0).block->items.at(0).property, property, findings);
  return findings;
}

/// The only finding of a text.
std::string finding(const std::string& source) {
  const auto findings = findingsOf(source);
  for (const Diagnostic& one : findings) UNSCOPED_INFO(one.text());
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

TEST_CASE("each mistake in a block is told with its place, what is known there, and the nearest of that") {
  const auto [inside, told] = GENERATE(table<const char*, Tells>({
      {"eyes 1 2 3", Tells("a.scene:2:1", "property", "eyes", "camera main", "fov, eye,", "mean", "eye")},
      {"fov 50 deg", Tells("a.scene:2:1", "fov", "twice", "a.scene:1:25")},
      {"fov { }", Tells("fov", "property", "block")},
      // Numbers of values.
      {"count", Tells("count", "no value", "whole", 1, 100)},
      {"count 1 2", Tells("count", 2)},
      {"eye 1 2", Tells("eye", 2, "three")},
      {"albedo 1 2", Tells("albedo", 2, "one number or three")},
      // Kinds of values.
      {"speed fast", Tells("word fast", "speed")},
      {"count \"3\"", Tells("string \"3\"", "count")},
      {"count 2.5", Tells(2.5, "whole")},
      {"resolution 2.5 3", Tells(2.5, "whole")},
      {"file name", Tells("word name", "file", "string")},
      {"target 3", Tells("number 3", "target", "name")},
      {"sizes 3", Tells("number 3", "sizes", "list")},
      {"frames [1 2]", Tells("list [1 2]", "frames", "LOW..HIGH")},
      {"eye far", Tells("word far", "eye")},
      {"source 3", Tells("number 3", "source", "PASS.PORT")},
      {"filter liner", Tells("liner", "linear, nearest", "mean", "linear")},
      {"loop yes", Tells("yes", "on, off")},
      // Units: angles must carry theirs, lengths and times need not.
      {"speed 3 m", Tells("m", "length", "length/time", "m/s", "cm/s")},
      {"eye 1 2 3 s", Tells("s", "time", "length")},
      {"eye 1 2 3 cmm", Tells("unit", "cmm", "mean", "cm")},
      {"eye 1 m 2 3", Tells("some", "eye", "unit")},
      {"count 3 m", Tells("m", "length", "plain number")},
      {"extinction 3 m", Tells("m", "length", "1/length")},
      {"spin 0 1 0 30 deg", Tells("deg", "angle", "angle/time")},
      {"spin 0 1 0 30", Tells(30, "spin", "no unit", "30 deg/s")},
      // Ranges.
      {"count 101", Tells(101, "count", "range", 1, 100)},
      {"resolution 0 4", Tells(0, "resolution", "range")},
      {"frames 3..1", Tells("3..1", "backwards")},
  }));
  CAPTURE(inside);
  CHECK_THAT(finding(std::string("scene s { camera main { fov 40 deg\n") + inside + "\n} }"), told);
}

TEST_CASE("each mistake in blocks and their headers is told with what is known there") {
  const auto [inside, told] = GENERATE(table<const char*, Tells>({
      {"lihgt lamp point { }", Tells("block", "lihgt", "mean", "light")},
      {"light 3", Tells("light", "block")},
      {"light a point { }\nlight a spot { }", Tells("a.scene:3:1", "light", "a", "twice", "a.scene:2:1")},
      {"environment { }\nenvironment { }", Tells("environment", "twice")},
      {"camera { fov 40 deg }", Tells("camera", "name")},
      {"light lamp { }", Tells("light lamp", "kind", "point, spot")},
      {"light lamp pont { }", Tells("kind", "pont", "mean", "point")},
      {"environment sky { }", Tells("unexpected", "sky", "header")},
      {"pass p { }", Tells("pass p", "kind")},
      {"light lamp point { outer 3 deg }", Tells("unknown", "outer")},  // a property of another kind
  }));
  CAPTURE(inside);
  CHECK_THAT(finding(std::string("scene s { camera main { fov 40 deg }\n") + inside + "\n}"), told);
}

TEST_CASE("what is missing or twice at the top is named with its meaning, or with what it expects") {
  CHECK_THAT(finding("scnee s { }"), Tells("block", "scnee", "mean", "scene"));
  CHECK_THAT(findingsOf("garden s { }").at(1).text(), Tells("lacks", "scene"));
  CHECK_THAT(
      findingsOf("scene a { camera m { fov 1 deg } }\nscene b { camera m { fov 1 deg } }").at(0).text(),
      Tells("scene", "twice"));
  CHECK_THAT(finding("scene s { }"), Tells("scene s", "lacks", "camera", "where it is seen from"));
  CHECK_THAT(finding("scene s { camera main { } }"),
             Tells("camera main", "lacks", "fov", "1 deg", "179 deg"));
  CHECK_THAT(finding("scene s { camera main { fov 40  eye 1 2 3 } }"), Tells(40, "fov", "no unit", "39 deg"));
  CHECK_THAT(finding("scene s { camera main { fov 180 deg } }"),
             Tells("180 deg", "fov", "range", "1 deg", "179 deg"));
}

TEST_CASE("what stands behind the end of a truncated text is not called missing") {
  const Document document = parse("scene s {\n camera main {\n eye 1 2 3", "a.scene");
  REQUIRE(document.findings.size() == 1);
  std::vector<Diagnostic> findings;
  check(document, grammar(), findings);
  CHECK(findings.empty());
}

TEST_CASE("the ends of a range are allowed in any unit, and the unit of the last component holds for all") {
  for (const char* fov : {"1 deg", "179 deg"})
    CHECK(findingsOf(std::string("scene s { camera main { fov ") + fov + " } }").empty());
  PropertySpecification eye = specify("eye", PropertyType::vector3, kLength);
  eye.low = -1000;
  eye.high = 1000;
  for (const char* inside : {"900 0 1", "0.9 0 1 km", "90000 0 1 cm"}) CHECK(findingsOf(eye, inside).empty());
  for (const char* beyond : {"900 0 1 km", "1100 m 0 m 1 m"}) CHECK(findingsOf(eye, beyond).size() == 1);
}

TEST_CASE("a unit behind the last component holds for all, and each component may have its own") {
  const Document document = parse("a { v 1 2 3 cm  w 1 m 2 m 3 cm  x 1 2 3 }", "a");
  const auto number = [&](std::size_t property, std::size_t component) {
    return numbersInBaseUnits(*document.items.at(0).block->items[property].property)[component];
  };
  CHECK(number(0, 0) == Approx(0.01));
  CHECK((number(1, 0) == 1.0 && number(2, 0) == 1.0));
  CHECK(number(1, 2) == Approx(0.03));
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
  const std::string fov = describe(grammar(), "fov");
  for (const char* fact : {"scene > camera", "meaning of fov", "1 deg", "179 deg", "required"})
    CHECK_THAT(fov, Catch::Contains(fact));
  CHECK_THAT(describe(grammar(), "light"), Tells("light [NAME] point|spot { ... }", "light spot:"));
  CHECK(describe(grammar(), "nonsense").empty());
}

TEST_CASE("the reference holds every word of the tables") {
  const auto all = words(grammar());
  for (const std::string& word : all) CHECK_THAT(describeAsMarkdown(grammar()), Catch::Contains("`" + word));
  CHECK(std::is_sorted(all.begin(), all.end()));
}

TEST_CASE("a number that single precision does not hold is refused, whatever its table allows") {
  const PropertySpecification power = specify("power", PropertyType::oneOrThree);
  for (const char* good : {"0", "1e37", "-1e37", "1e-37", "0 0 0", "-0.0"}) {
    CAPTURE(good);
    CHECK(findingsOf(power, good).empty());
  }
  for (const char* wrong : {"1e39", "-1e200", "1e-38", "-1e-300", "1 1e39 1"}) {
    CAPTURE(wrong);
    const auto found = findingsOf(power, wrong);
    REQUIRE(found.size() == 1);
    CHECK_THAT(found.front().text(), Tells("single precision", 0, "1e-37", "1e+37"));
  }
}
