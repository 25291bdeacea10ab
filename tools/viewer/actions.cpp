#include "viewer/actions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <numbers>
#include <set>

#include "lumivox/base/display.h"
#include "lumivox/base/error.h"
#include "lumivox/scene/text.h"
#include "viewer/channel.h"

namespace lumivox::viewer {
namespace {

using dsl::PropertySpecification;
using dsl::PropertyType;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kLongest = kLongestTime;          // s, either way
constexpr double kLargestAngle = 360.0 * kDegree;  // of one turn
constexpr double kLargestSide = 16384;             // pixels, of images and windows: what OpenGL 4.5 promises
constexpr double kLeastFactor = 1e-3, kMostFactor = 1e3;
constexpr double kBrightest = 1e30;       // W in the unit of the statement
constexpr double kDensest = 1e9;          // 1/m
constexpr double kSharpest = 1e30;        // exponents of Phong lobes
constexpr double kMostSamples = 1 << 20;  // per pixel of the reference

PropertySpecification one(std::string word, PropertyType type, std::string meaning) {
  PropertySpecification made;
  made.word = std::move(word);
  made.type = type;
  made.meaning = std::move(meaning);
  made.repeatable = true;
  return made;
}
PropertySpecification measured(std::string word, PropertyType type, dsl::Dimension dimension,
                               std::string meaning) {
  PropertySpecification made = one(std::move(word), type, std::move(meaning));
  made.dimension = dimension;
  return made;
}
PropertySpecification ranged(std::string word, PropertyType type, double low, double high,
                             std::string meaning) {
  PropertySpecification made = one(std::move(word), type, std::move(meaning));
  made.low = low;
  made.high = high;
  return made;
}
PropertySpecification between(double low, double high, PropertySpecification made) {
  made.low = std::max(made.low, low);
  made.high = std::min(made.high, high);
  return made;
}
/// Narrows the range to that of the same word in the scene text, in a block or any of its kinds, so that
/// every edit can be saved as text.
PropertySpecification asInScene(const std::string& block, const std::string& word,
                                PropertySpecification made) {
  const auto narrow = [&](const std::vector<PropertySpecification>& properties) {
    for (const PropertySpecification& one : properties)
      if (one.word == word) made = between(one.low, one.high, std::move(made));
  };
  for (const dsl::BlockSpecification& one : sceneSpecifications().front().blocks) {
    if (one.word != block) continue;
    narrow(one.properties);
    for (const auto& [kind, properties] : one.kindProperties) narrow(properties);
  }
  return made;
}
/// A position or a displacement in metres.
PropertySpecification place(std::string word, std::string meaning) {
  return between(-kFarthest, kFarthest,
                 measured(std::move(word), PropertyType::vector3, dsl::kLength, std::move(meaning)));
}
PropertySpecification angles(std::string word, std::string meaning) {
  return between(-kLargestAngle, kLargestAngle,
                 measured(std::move(word), PropertyType::vector2, dsl::kAngle, std::move(meaning)));
}
PropertySpecification fieldOfView(std::string meaning) {
  return asInScene("camera", "fov", measured("fov", PropertyType::number, dsl::kAngle, std::move(meaning)));
}
PropertySpecification chosen(std::string word, std::vector<std::string> choices, std::string meaning) {
  PropertySpecification made = one(std::move(word), PropertyType::word, std::move(meaning));
  made.choices = std::move(choices);
  return made;
}

std::vector<PropertySpecification> lookProperties() {
  return {
      one("show", PropertyType::name, "the pipeline that is shown, by its name or its file"),
      one("beside", PropertyType::name,
          "a second pipeline, `copy` of the first with values of its own, or `nothing`"),
      one("swap", PropertyType::flag, "exchanges the two pipelines"),
      one("camera", PropertyType::name, "looks through a camera of the scene"),
      place("eye", "position of a free camera"),
      place("target", "what a free camera looks at"),
      fieldOfView("the full vertical angle of a free camera"),
      place("move", "right, up and forward, as the camera looks"),
      angles("turn", "to the right and up, about the eye"),
      angles("orbit", "to the right and up, about the target"),
      ranged("zoom", PropertyType::number, kLeastFactor, kMostFactor,
             "distance from the target, as a factor"),
      between(-kLongest, kLongest,
              measured("time", PropertyType::number, dsl::kTime, "the moment that is shown")),
      one("play", PropertyType::flag, "whether time goes on by itself"),
      ranged("speed", PropertyType::number, kLeastFactor, kMostFactor,
             "speed of time, relative to the clock"),
      between(0, kLongest,
              measured("loop", PropertyType::number, dsl::kTime,
                       "time after which playing starts again; 0: it goes on")),
      one("frame", PropertyType::name, "steps back until an object, or `all`, is visible as a whole"),
      asInScene("camera", "resolution",
                ranged("size", PropertyType::resolution, 1, kLargestSide, "size of the image")),
      one("output", PropertyType::name, "the output that is shown; \"whole image\": the sum of all light"),
      one("port", PropertyType::name, "an output of a pass, as PASS.PORT, or `nothing`"),
      one("texture", PropertyType::name, "the texture of the port that is shown"),
      one("voxels", PropertyType::name,
          "a field of the port's voxels, drawn as cubes, or `lobes` of its spherical harmonics; `nothing`: a "
          "texture"),
      ranged("above", PropertyType::number, 0, kBrightest,
             "voxels are shown only if their value is above it"),
      ranged("see_through", PropertyType::number, 0, 1, "share of the picture that shows through voxels"),
      chosen("channel", channelWords(), "the components of the texture that are shown"),
      ranged("level", PropertyType::integer, 0, 32, "level of the port's texture or voxels"),
      ranged("slice", PropertyType::integer, 0, 65535, "slice of a volume, or layer of an array"),
      chosen("layout", {"picture", "reference", "split", "side_by_side", "flicker", "error"},
             "arrangement of picture, second picture, reference and error"),
      chosen("error_map", {"relative", "flip", "squared"}, "the error that is shown"),
      ranged("split", PropertyType::number, 0, 1, "where the picture ends and the reference begins"),
      one("exposure", PropertyType::any,
          fmt::format("exposure in EV, from {} to {}, or `auto`", -kLargestExposure, kLargestExposure)),
      chosen("tone", {"srgb", "linear", "filmic", "false_colour"}, "how radiance becomes colours"),
      ranged("samples", PropertyType::integer, 2, kMostSamples,
             "samples per pixel at which the reference is complete"),
      one("reference", PropertyType::flag, "whether a reference is traced in the background"),
      ranged("seed", PropertyType::integer, 0, 9007199254740992.0, "seed of the techniques' random numbers"),
      one("keep_everything", PropertyType::flag, "leaves nothing out"),
      one("times", PropertyType::flag, "whether each pass is timed"),
      one("work", PropertyType::flag, "whether the work and the contents of each pass are counted"),
  };
}

std::vector<PropertySpecification> changeProperties() {
  return {
      one("reset", PropertyType::name,
          "resets a parameter to its default; a part of the scene (\"light NAME\", \"material NAME\", \"medium NAME\", \"camera NAME\", \"environment\") to its text; or `all`; or `scene`"),
      one("off", PropertyType::name,
          "switches a part of the scene off: \"light NAME\", \"gloss\", \"environment\" ..."),
      one("on", PropertyType::name, "switches it on again"),
      asInScene("environment", "radiance",
                ranged("environment", PropertyType::oneOrThree, 0, kBrightest, "radiance of the sky")),
      ranged("undo", PropertyType::integer, 1, 1000, "undoes so many changes"),
      ranged("redo", PropertyType::integer, 1, 1000, "makes so many undone changes again"),
      one("reload", PropertyType::flag, "reads all texts and libraries again"),
  };
}

std::vector<PropertySpecification> keepProperties() {
  return {
      one("save_image", PropertyType::name, "the picture (.png), or every output (.exr)"),
      one("save_pipeline", PropertyType::name, "the pipeline's text with the present values"),
      one("save_scene", PropertyType::name, "the scene's text with all edits, and a free camera as `view`"),
      chosen("answer", {"yes", "no"}, "whether an existing file is overwritten"),
      one("export_grid", PropertyType::name, "the voxels of the shown port, a .vdb"),
      one("add_point", PropertyType::name,
          "measures the present pipeline, as `sweep` does, into a results store"),
      one("record", PropertyType::name, "what the panels show, as JSON"),
      one("shot", PropertyType::name, "the window as it is, a .png"),
  };
}

std::vector<PropertySpecification> windowProperties() {
  PropertySpecification wait = one(
      "wait", PropertyType::any,
      fmt::format(
          "waits for `frame`, `judged`, `problem`, `mended`, `kept`, or `reference` and a number of samples, 1 to "
          "{:.0f}; at most a minute",
          kMostSamples));
  return {
      std::move(wait),
      one("click", PropertyType::name, "a control, by its name"),
      one("key", PropertyType::name, "presses a key, by its name"),
      one("panel", PropertyType::name, "opens a panel"),
      ranged("window", PropertyType::resolution, 1, kLargestSide, "size of the window"),
      one("panels", PropertyType::flag, "shows the panels"),
      ranged("panel_width", PropertyType::number, 120, 4000, "width of the panels, in pixels at scale 1"),
      ranged("scale", PropertyType::number, 0.25, 8,
             "scale of the window, as on a monitor of so many times the usual density"),
      one("copy_command", PropertyType::flag, "puts the command that repeats the picture into the clipboard"),
      one("minimise", PropertyType::flag, "puts the window away, or brings it back"),
      chosen("focus", {"picture", "panels"}, "the part that the keyboard controls"),
      ranged("random", PropertyType::integer, 1, 100000, "performs so many random actions, from the seed"),
      one("quit", PropertyType::flag, "closes the window"),
  };
}

dsl::BlockSpecification block(std::string word, dsl::HeaderUse name, std::string meaning) {
  dsl::BlockSpecification made;
  made.word = std::move(word);
  made.name = name;
  made.meaning = std::move(meaning);
  return made;
}

std::vector<dsl::BlockSpecification> makeSpecifications() {
  dsl::BlockSpecification view =
      block("view", dsl::HeaderUse::required, "what is done in the window, in order");
  for (const auto& list : {lookProperties(), changeProperties(), keepProperties(), windowProperties()})
    view.properties.insert(view.properties.end(), list.begin(), list.end());
  dsl::BlockSpecification set =
      block("set", dsl::HeaderUse::optional, "parameters of the pipeline, or of the pass that is named");
  set.open = true;
  dsl::BlockSpecification material =
      block("material", dsl::HeaderUse::required, "other values of a material");
  const auto ofMaterial = [](const char* word, PropertyType type, double high, const char* meaning) {
    return asInScene("material", word, ranged(word, type, 0, high, meaning));
  };
  material.properties = {ofMaterial("diffuse", PropertyType::oneOrThree, 1, "albedo"),
                         ofMaterial("specular", PropertyType::oneOrThree, 1, "Phong albedo"),
                         ofMaterial("exponent", PropertyType::number, kSharpest, "of the Phong lobe"),
                         ofMaterial("emission", PropertyType::oneOrThree, kBrightest, "radiance")};
  dsl::BlockSpecification light = block("light", dsl::HeaderUse::required, "the power of a light");
  PropertySpecification power = ranged("power", PropertyType::oneOrThree, 0, kBrightest,
                                       "irradiance, intensity, or an area light's radiance");
  for (const char* word : {"irradiance", "intensity", "radiance"})
    power = asInScene("light", word, std::move(power));
  light.properties = {std::move(power)};
  dsl::BlockSpecification medium = block("medium", dsl::HeaderUse::required, "other values of a medium");
  medium.properties = {
      asInScene(
          "medium", "extinction",
          between(0, kDensest,
                  measured("extinction", PropertyType::oneOrThree, dsl::kInverseLength, "at density 1"))),
      asInScene("medium", "albedo",
                ranged("albedo", PropertyType::oneOrThree, 0, 1, "scattering / extinction")),
      asInScene("medium", "anisotropy",
                ranged("anisotropy", PropertyType::number, -1, 1, "mean cosine of scattering"))};
  dsl::BlockSpecification camera = block("camera", dsl::HeaderUse::required, "moves a camera of the scene");
  camera.properties = {asInScene("camera", "eye", place("eye", "where it is")),
                       asInScene("camera", "target", place("target", "what it looks at")),
                       fieldOfView("the full vertical angle")};
  view.blocks = {std::move(set), std::move(material), std::move(light), std::move(medium), std::move(camera)};
  return {std::move(view)};
}

/// Reports parameters, which pipeline texts may use but scripts have not.
void checkUnbound(const dsl::Document& document, const std::vector<dsl::Value>& values,
                  std::vector<Diagnostic>& findings) {
  for (const dsl::Value& value : values) {
    checkUnbound(document, value.items, findings);
    if (value.kind == dsl::ValueKind::parameter)
      findings.push_back(document.finding(value.place, value.length,
                                          fmt::format("'{}': scripts have no parameters", value.written()),
                                          "the value itself"));
  }
}
void checkUnbound(const dsl::Document& document, const dsl::Block& block, std::vector<Diagnostic>& findings) {
  checkUnbound(document, block.header, findings);
  for (const dsl::Item& item : block.items) {
    if (item.property) checkUnbound(document, item.property->values, findings);
    if (item.block) checkUnbound(document, *item.block, findings);
  }
}

/// The statement with this value alone.
dsl::Property only(const dsl::Property& property, std::size_t value) {
  dsl::Property one = property;
  one.values = {property.values[value]};
  return one;
}

/// Checks the statements that take either a word or a number, which the table of properties cannot express.
void checkMixed(const dsl::Document& document, const dsl::Property& property,
                std::vector<Diagnostic>& findings) {
  const std::size_t count = property.values.size();
  const auto report = [&](std::string what, std::string expected) {
    const dsl::Value* last = count > 0 ? &property.values.back() : nullptr;
    findings.push_back(
        document.finding(last != nullptr ? last->place : property.place,
                         last != nullptr ? last->length : static_cast<int>(property.word.size()),
                         std::move(what), std::move(expected)));
  };
  if (property.word == "exposure") {
    const bool isAuto =
        count == 1 && property.values[0].kind == dsl::ValueKind::word && property.values[0].text == "auto";
    if (count != 1 || (property.values[0].kind != dsl::ValueKind::number && !isAuto))
      return report("'exposure' takes one value",
                    fmt::format("auto, or a number from {} to {} EV", -kLargestExposure, kLargestExposure));
    if (!isAuto)
      dsl::checkProperty(document, property,
                         ranged("exposure", PropertyType::number, -kLargestExposure, kLargestExposure, {}),
                         findings);
  }
  if (property.word == "wait") {
    const PropertySpecification what =
        chosen("wait", {"frame", "judged", "problem", "mended", "kept", "reference"}, {});
    if (count == 0) return report("'wait' has no value", dsl::expectation(what));
    const std::size_t before = findings.size();
    dsl::checkProperty(document, only(property, 0), what, findings);
    if (count == 1 || findings.size() != before) return;
    if (count > 2 || property.values[0].text != "reference")
      return report(fmt::format("'wait {}' takes nothing more", property.values[0].text),
                    "a number of samples behind `reference` alone");
    dsl::checkProperty(document, only(property, 1),
                       ranged("wait", PropertyType::integer, 1, kMostSamples, {}), findings);
  }
}

/// Reports empty names: one would mean the first of its kind, or a wrong file.
void checkNamed(const dsl::Document& document, const dsl::Property& property,
                std::vector<Diagnostic>& findings) {
  const auto& known = viewSpecifications().front().properties;
  const auto found = std::ranges::find(known, property.word, &PropertySpecification::word);
  if (found == known.end() || found->type != PropertyType::name) return;
  for (const dsl::Value& value : property.values)
    if (value.kind == dsl::ValueKind::text && value.text.empty())
      findings.push_back(document.finding(value.place, value.length,
                                          fmt::format("'{}' names nothing", property.word),
                                          dsl::expectation(*found)));
}

/// Removes the findings of repeated blocks: other texts may have a block of one name once, but a script may
/// repeat an action.
void allowRepeated(const dsl::Document& document, std::vector<Diagnostic>& findings) {
  for (const dsl::Item& item : document.items) {
    if (!item.block) continue;
    std::set<std::string> done;
    for (const dsl::Item& statement : item.block->items) {
      if (!statement.block) continue;
      const auto& header = statement.block->header;
      const std::string name = header.empty() ? std::string() : header.front().text;
      if (done.insert(statement.block->word + ' ' + name).second) continue;
      // The word of a known block has no other finding: the first block of that name had none either.
      const SourcePlace& place = statement.block->place;
      const auto& known = viewSpecifications().front().blocks;
      if (std::ranges::find(known, statement.block->word, &dsl::BlockSpecification::word) != known.end())
        std::erase_if(findings,
                      [&](const Diagnostic& finding) { return finding.place.text() == place.text(); });
    }
  }
}

std::vector<Action> actionsOf(dsl::Document parsed) {
  std::vector<Diagnostic> findings = parsed.findings;
  if (findings.empty()) {
    dsl::check(parsed, viewSpecifications(), findings);
    allowRepeated(parsed, findings);
    for (const dsl::Item& item : parsed.items) {
      if (!item.block) continue;
      checkUnbound(parsed, *item.block, findings);
      for (const dsl::Item& statement : item.block->items) {
        if (!statement.property) continue;
        checkMixed(parsed, *statement.property, findings);
        checkNamed(parsed, *statement.property, findings);
      }
    }
  }
  if (!findings.empty()) throw DiagnosticsError(std::move(findings));
  const auto document = std::make_shared<const dsl::Document>(std::move(parsed));
  std::vector<Action> actions;
  for (const dsl::Item& item : document->items)
    for (const dsl::Item& statement : item.block->items)
      actions.push_back(
          {document, statement.property ? &*statement.property : nullptr, statement.block.get()});
  return actions;
}

}  // namespace

const std::vector<dsl::BlockSpecification>& viewSpecifications() {
  static const std::vector<dsl::BlockSpecification> specifications = makeSpecifications();
  return specifications;
}

double Action::number(std::size_t value) const {
  return property->values[value].inBaseUnits();
}
std::string Action::text(std::size_t value) const {
  return property->values[value].text;
}
std::vector<double> Action::numbers() const {
  return dsl::numbersInBaseUnits(*property);
}
bool Action::flag() const {
  return text() == "on";
}
std::string Action::written() const {
  if (property != nullptr) {
    std::string text = property->word;
    for (const dsl::Value& value : property->values) text += " " + value.written();
    return text;
  }
  std::string text = block->title() + " {";
  for (const dsl::Item& item : block->items) {
    if (!item.property) continue;
    text += " " + item.property->word;
    for (const dsl::Value& value : item.property->values) text += " " + value.written();
  }
  return text + " }";
}

std::vector<Action> readScript(const std::filesystem::path& file) {
  dsl::Document document = dsl::parseFile(file);
  return actionsOf(std::move(document));
}

std::vector<Action> parseActions(const std::string& statements) {
  return actionsOf(dsl::parse("view \"typed\" {\n" + statements + "\n}\n", "typed"));
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + "\"";
}

std::string choiceValue(const std::string& choice) {
  const bool plain = std::all_of(choice.begin(), choice.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '.';
  });
  return plain && !choice.empty() ? choice : quoted(choice);
}

}  // namespace lumivox::viewer
