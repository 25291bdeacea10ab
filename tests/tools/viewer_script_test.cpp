// Scripts with numbers that nobody can show: each is refused at its place, with its range, before a window
// opens.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <regex>

#include "lumivox/scene/text.h"
#include "tools/started.h"
#include "tools/viewer_support.h"
#include "viewer/actions.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::viewer;

namespace {

using dsl::PropertySpecification;
using dsl::PropertyType;

/// How many numbers a word takes; 0: none.
int numbersOf(const PropertySpecification& word) {
  switch (word.type) {
    case PropertyType::number:
    case PropertyType::integer:
    case PropertyType::oneOrThree:
      return 1;
    case PropertyType::vector2:
    case PropertyType::resolution:
      return 2;
    case PropertyType::vector3:
      return 3;
    default:
      return 0;
  }
}

bool isWhole(const PropertySpecification& word) {
  return word.type == PropertyType::integer || word.type == PropertyType::resolution;
}

std::string unitOf(const PropertySpecification& word) {
  for (const dsl::Unit& unit : dsl::knownUnits())
    if (!(word.dimension == dsl::kNoDimension) && unit.dimension == word.dimension && unit.toBase == 1.0)
      return " " + unit.name;
  return "";
}

/// A statement with the same number in all places; `block` is what is before it, with its brace.
std::string statement(const std::string& block, const PropertySpecification& word, double number) {
  std::string text = block + word.word;
  for (int i = 0; i < numbersOf(word); ++i)
    text += " " + (isWhole(word) ? fmt::format("{:.0f}", number) : fmt::format("{}", number)) + unitOf(word);
  return text + (block.empty() ? "" : " }");
}

/// Every word that takes numbers, with the block that it stands in.
std::vector<std::pair<std::string, PropertySpecification>> numericWords() {
  std::vector<std::pair<std::string, PropertySpecification>> words;
  const dsl::BlockSpecification& view = viewSpecifications().front();
  const auto add = [&](const std::string& block, const std::vector<PropertySpecification>& properties) {
    for (const PropertySpecification& one : properties)
      if (numbersOf(one) > 0) words.emplace_back(block, one);
  };
  add("", view.properties);
  for (const dsl::BlockSpecification& block : view.blocks) add(block.word + " \"x\" { ", block.properties);
  return words;
}

std::string script(const std::vector<std::string>& statements) {
  std::string text = "view \"numbers\" {\n";
  for (const std::string& one : statements) text += one + "\n";
  return text + "}\n";
}

/// The line of a message about a place; empty: there is none.
std::string saidAt(const std::string& errors, const std::string& place) {
  const std::size_t found = errors.find(place);
  return found == std::string::npos ? "" : errors.substr(found, errors.find('\n', found) - found);
}

/// Far enough that a double tells them apart.
double beyond(const PropertySpecification& word, double end, double sign) {
  const double step = 0.01 * std::abs(end);
  return end + sign * (isWhole(word) ? std::max(1.0, std::floor(step)) : std::max(1e-3, step));
}

}  // namespace

TEST_CASE(
    "every number of a script has a range, and what is beyond either end is refused at its line and column") {
  const Workplace place;
  const auto words = numericWords();
  CHECK(words.size() > 30);
  std::vector<std::string> good, bad, named;
  std::vector<std::size_t> columns;
  int blocks = 0;
  for (const auto& [block, word] : words) {
    INFO(block << word.word);
    REQUIRE(std::isfinite(word.low));
    REQUIRE(std::isfinite(word.high));
    // Blocks of one name would be one too many.
    const auto headOf = [&] {
      std::string head = block;
      if (const std::size_t at = head.find("\"x\""); at != std::string::npos)
        head.replace(at, 3, fmt::format("\"x{}\"", ++blocks));
      return head;
    };
    for (const double end : {word.low, word.high}) {
      good.push_back(statement(headOf(), word, end));
      const std::string head = headOf();
      bad.push_back(statement(head, word, beyond(word, end, end == word.low ? -1.0 : 1.0)));
      columns.push_back(head.size() + word.word.size() + 2);
      named.push_back(word.word);
    }
  }
  place.write("good.view", script(good));
  const CommandResult taken = typed("check", place.file("good.view"));
  INFO(taken.errors);
  CHECK(taken.exitCode == 0);
  place.write("bad.view", script(bad));
  const CommandResult checked = typed("check", place.file("bad.view"));
  CHECK(checked.exitCode == 2);
  for (std::size_t i = 0; i < bad.size(); ++i) {
    // Lines are counted from 1, and the first is that of the block.
    const std::string at = fmt::format("bad.view:{}:{}: ", i + 2, columns[i]);
    INFO(bad[i] << "\n" << at);
    const std::string line = saidAt(checked.errors, at);
    INFO(line);
    CHECK(contains(line, fmt::format("of property '{}' is out of range", named[i])));
    CHECK(std::regex_search(line, std::regex("from \\S+.* to \\S+")));
  }
}

TEST_CASE("what ended the window or went on in silence is refused before it opens") {
  const Workplace place;
  const Tells size("size", 1, 16384), parameter("scripts have no parameters"),
      exposure("exposure", "auto", -100, 100),
      wait("wait", "frame, judged, problem, mended, kept, reference"),
      more("takes nothing more", "reference"), name("names nothing");
  const std::vector<std::pair<std::string, Tells>> wrong{
      {"size 0 0", size},
      {"size -4 4", size},
      {"size 4 100000", size},
      {"window 0 10", Tells("window", 1, 16384)},
      {"size $a $b", parameter},
      {"zoom $a", parameter},
      {"light \"bulb\" { power $a }", parameter},
      {"set { samples $a }", parameter},
      {"exposure", exposure},
      {"exposure 1 2", exposure},
      {"exposure 1000", Tells("exposure", -100, 100)},
      {"exposure bright", exposure},
      {"wait", wait},
      {"wait frmae", wait},
      {"wait reference 0", Tells("wait", 1, "1.04858e+06")},
      {"wait reference 1 2", more},
      {"wait frame 3", more},
      {"add_point \"\"", name},
      {"camera \"\"", name},
      {"move nan 0 0", Tells("move", "three numbers")},
      {"material \"room/grey\" { exponent 1e20 }", Tells("exponent", 0, "1e+06")}};
  const auto refused = [&](const std::vector<std::string>& statements) {
    place.write("wrong.view", script(statements));
    const CommandResult result =
        runCommand("env -u DISPLAY -u WAYLAND_DISPLAY '" + (binaryDirectory() / "bin/lumivox-view").string() +
                   "' '" + place.scene() + "' '" + committedPipeline("direct_lighting") + "' --script '" +
                   place.file("wrong.view") + "'");
    checkRefused(result);
    CHECK_FALSE(contains(result.errors, "no display"));
    return result.errors;
  };
  std::vector<std::string> statements;
  for (const auto& [line, facts] : wrong) statements.push_back(line);
  const std::string errors = refused(statements);
  for (std::size_t i = 0; i < wrong.size(); ++i)
    CHECK_THAT(saidAt(errors, fmt::format("wrong.view:{}:", i + 2)), wrong[i].second);
  CHECK(contains(refused({"time 1e999"}), "wrong.view:2:"));  // no number at all: the rest is not read
}

TEST_CASE("a camera is never moved to where numbers end, however many steps it takes") {
  const Workplace place;
  const auto session = sessionOf(place.scene(), "direct_lighting");
  for (const char* step : {"zoom 1000", "zoom 0.001", "move 1e9 0 0", "move 0 0 1e9"}) {
    session->perform("camera main");
    for (int i = 0; i < 200; ++i) session->perform(step);
    INFO(step << ": " << session->message());
    CHECK(session->messageIsError());
    CHECK(contains(session->message(), "the camera stays where it is"));
    const Camera camera = cameraOf(session->state(), session->scene());
    for (const glm::dvec3& at : {camera.eye, camera.target})
      CHECK(std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}) <= kFarthest);
    CHECK(glm::distance(camera.eye, camera.target) >= kNearest);
  }
}

TEST_CASE("a reference so bright that its variance is no number is told, and ends nothing") {
  Rendered rendered;
  RenderedSide& side = rendered.sides.emplace_back();
  side.frame.outputs["direct"] = ImageBuffer(2, 1, 3, 1.0f);
  side.frame.components["direct"] = Contributes::direct;
  ConvergingReference reference;
  reference.image.layers["direct"] = ImageBuffer(2, 1, 3, 1.0f);
  reference.image.layers["direct.variance"] = ImageBuffer(2, 1, 3, std::numeric_limits<float>::infinity());
  JudgeWorker worker(makeJudgeWork, [] {});
  worker.want({std::make_shared<const Rendered>(rendered),
               std::make_shared<const ConvergingReference>(reference),
               {}});
  std::optional<std::shared_ptr<const Judged>> judged;
  CHECK(becomes([&] { return (judged = worker.take()).has_value(); }));
  REQUIRE(judged);
  CHECK(contains((*judged)->error, "the reference's variance is inf"));
  CHECK((*judged)->sides.size() == 1);
}

TEST_CASE("a window is kept as the picture that its name says, and what goes wrong names the statement") {
  if (!canShowWindows()) return;
  const Workplace place;
  const CommandResult done = shown(place, "wait frame\n shot 'window.exr'\n quit on",
                                   committedPipeline("direct_lighting"), "--resolution 8x8");
  INFO(done.errors);
  CHECK(done.exitCode == 2);
  CHECK(contains(unwrapped(done.errors), "script.view:3:2: shot"));
  CHECK(contains(unwrapped(done.errors), "expected a name that ends in .png"));
  CHECK_FALSE(place.has("window.exr"));
}

TEST_CASE("what a statement writes has the ending of its kind, and no text is lost to another") {
  const Workplace place;
  place.write("own.pipeline", readFile(committedPipeline("direct_lighting")));
  const std::string scene = place.scene(), before = place.read("room.scene"),
                    pipeline = place.read("own.pipeline");
  const auto session = sessionOf(scene, place.file("own.pipeline"));
  for (const auto& [statement, ending] : std::vector<std::pair<std::string, std::string>>{
           {"record \"" + scene + "\"", ".json"},
           {"record " + quotedFile(place, "own.pipeline"), ".json"},
           {"save_pipeline \"" + scene + "\"", ".pipeline"},
           {"save_scene " + quotedFile(place, "room.pipeline"), ".scene"},
           {"save_image " + quotedFile(place, "room.obj"), ".png or .exr"},
           {"export_grid " + quotedFile(place, "room.obj"), ".vdb"}}) {
    session->perform(statement);
    INFO(statement << ": " << session->message());
    CHECK(session->messageIsError());
    CHECK(contains(session->message(), "': expected a name that ends in " + ending));
    CHECK(session->question().empty());
  }
  // Nor is what the scene reads, whatever its ending; what the window wrote itself may be written again.
  place.write("map.json", "");
  readFile(place.path() / "map.json");
  session->perform("record " + quotedFile(place, "map.json"));
  CHECK(contains(session->message(), "was read for the same work"));
  for (int time = 0; time < 2; ++time) {
    session->perform("record " + quotedFile(place, "record.json"));
    INFO(session->message());
    CHECK_FALSE(session->messageIsError());
  }
  CHECK(place.read("room.scene") == before);
  CHECK(place.read("own.pipeline") == pipeline);
  CHECK_FALSE(place.has("room.pipeline"));
}

TEST_CASE("a script may do again what it did: edit one light twice, and set one pass twice") {
  const std::string twice =
      "light \"bulb\" { power 1 }\nlight \"bulb\" { power 2 }\nset gather { cones 6 }\nset gather { cones 8 }";
  CHECK(parseActions(twice).size() == 4);
  CHECK_THROWS_WITH(parseActions(twice + "\nlight \"bulb\" { power -1 }"),
                    Catch::Contains("typed:6:22") && !Catch::Contains("given twice"));
  CHECK_THROWS_WITH(parseActions("lihgt \"bulb\" { power 1 }\nlihgt \"bulb\" { power 2 }"),
                    Catch::Contains("did you mean 'light'"));
}

TEST_CASE("what a script may edit is what the scene's text can say") {
  const dsl::BlockSpecification& view = viewSpecifications().front();
  int compared = 0;
  const auto isWithin = [&](const PropertySpecification& word, const PropertySpecification& same) {
    INFO(word.word << " beside " << same.word);
    CHECK(word.low >= same.low);
    CHECK(word.high <= same.high);
    ++compared;
  };
  for (const dsl::BlockSpecification& block : view.blocks)
    for (const dsl::BlockSpecification& ofScene : sceneSpecifications().front().blocks) {
      if (ofScene.word != block.word) continue;
      for (const PropertySpecification& word : block.properties) {
        for (const PropertySpecification& same : ofScene.properties)
          if (same.word == word.word) isWithin(word, same);
        // `power` of a light is the word of its kind.
        for (const auto& [kind, properties] : ofScene.kindProperties)
          for (const PropertySpecification& same : properties)
            if (word.word == "power" &&
                (same.word == "irradiance" || same.word == "intensity" || same.word == "radiance"))
              isWithin(word, same);
      }
    }
  // Four of materials, one of each of four kinds of lights, three of media, three of cameras.
  CHECK(compared == 4 + 4 + 3 + 3);
}
