#include "viewer/actions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <numbers>

#include "lumivox/base/error.h"
#include "viewer/port_view.h"

namespace lumivox::viewer {
namespace {

using dsl::PropertySpecification;
using dsl::PropertyType;

constexpr double kDegree = std::numbers::pi / 180.0;

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
      one("swap", PropertyType::flag, "exchanges the two"),
      one("camera", PropertyType::name, "looks through a camera of the scene"),
      measured("eye", PropertyType::vector3, dsl::kLength, "where one looks from, with a free camera"),
      measured("target", PropertyType::vector3, dsl::kLength, "what a free camera looks at"),
      measured("fov", PropertyType::number, dsl::kAngle, "the full vertical angle of a free camera"),
      measured("move", PropertyType::vector3, dsl::kLength, "right, up and forward, as the camera looks"),
      measured("turn", PropertyType::vector2, dsl::kAngle, "to the right and up, about the eye"),
      measured("orbit", PropertyType::vector2, dsl::kAngle, "to the right and up, about the target"),
      ranged("zoom", PropertyType::number, 1e-3, 1e3, "distance from the target, as a factor"),
      measured("time", PropertyType::number, dsl::kTime, "the moment that is shown"),
      one("play", PropertyType::flag, "whether time goes on by itself"),
      ranged("speed", PropertyType::number, 1e-3, 1e3, "of time, beside that of the clock"),
      measured("loop", PropertyType::number, dsl::kTime, "after which playing begins anew; 0: it goes on"),
      one("frame", PropertyType::name, "steps back until an object is seen whole, or `all`"),
      one("size", PropertyType::resolution, "of the image"),
      one("output", PropertyType::name, "which output is shown; \"whole image\": the sum of all light"),
      one("port", PropertyType::name, "an output of a pass, as PASS.PORT, or `nothing`"),
      one("texture", PropertyType::name, "which texture of the port"),
      one("voxels", PropertyType::name,
          "a field of the port's voxels, drawn as cubes, or `lobes` of its spherical harmonics; `nothing`: a "
          "texture"),
      ranged("above", PropertyType::number, 0, 1e30, "voxels whose values are not above it are left out"),
      ranged("see_through", PropertyType::number, 0, 1, "how much of the picture is seen behind voxels"),
      chosen("channel", channelWords(), "the components of the texture that are shown"),
      ranged("level", PropertyType::integer, 0, 32, "which level of the port's texture or voxels"),
      ranged("slice", PropertyType::integer, 0, 65535, "which slice of a volume, or layer of an array"),
      chosen("layout", {"picture", "reference", "split", "side_by_side", "flicker", "error"},
             "what is shown of picture, second picture, reference and error"),
      chosen("error_map", {"relative", "flip", "squared"}, "which error is shown"),
      ranged("split", PropertyType::number, 0, 1, "where the picture ends and the reference begins"),
      one("exposure", PropertyType::any, "in EV, or `auto`"),
      chosen("tone", {"srgb", "linear", "filmic", "false_colour"}, "how radiance becomes colours"),
      ranged("samples", PropertyType::integer, 2, 1 << 20,
             "per pixel, at which the reference is good enough"),
      one("reference", PropertyType::flag, "whether a reference is traced in the background"),
      ranged("seed", PropertyType::integer, 0, 9007199254740992.0, "of the random numbers of techniques"),
      one("keep_everything", PropertyType::flag, "leaves nothing out"),
      one("times", PropertyType::flag, "whether each pass is timed"),
      one("work", PropertyType::flag, "whether what each pass does and holds is counted"),
  };
}

std::vector<PropertySpecification> changeProperties() {
  return {
      one("reset", PropertyType::name,
          "a parameter back to its default, a part of the scene (\"light NAME\", \"material NAME\", "
          "\"medium NAME\", \"camera NAME\", \"environment\") to its text, or `all`, or `scene`"),
      one("off", PropertyType::name,
          "switches a part of the scene off: \"light NAME\", \"gloss\", \"environment\" ..."),
      one("on", PropertyType::name, "switches it on again"),
      ranged("environment", PropertyType::oneOrThree, 0, 1e30, "radiance of the sky"),
      ranged("undo", PropertyType::integer, 1, 1000, "so many changes"),
      ranged("redo", PropertyType::integer, 1, 1000, "so many changes"),
      one("reload", PropertyType::flag, "reads all texts and libraries again"),
  };
}

std::vector<PropertySpecification> keepProperties() {
  return {
      one("save_image", PropertyType::name, "the picture (.png), or every output (.exr)"),
      one("save_pipeline", PropertyType::name, "the pipeline's text with the values as they are"),
      one("save_scene", PropertyType::name,
          "the scene's text with what was changed in it, and a free camera as `view`"),
      chosen("answer", {"yes", "no"}, "whether a file that was there already is overwritten"),
      one("export_grid", PropertyType::name, "the voxels of the port that is shown, a .vdb"),
      one("add_point", PropertyType::name,
          "measures the pipeline as it is, as `sweep` does, into a results store"),
      one("record", PropertyType::name, "what the panels show, as JSON"),
      one("shot", PropertyType::name, "the window as it is, a .png"),
  };
}

std::vector<PropertySpecification> windowProperties() {
  PropertySpecification wait = one(
      "wait", PropertyType::any,
      "for `frame`, `judged`, `problem`, `mended`, `kept`, or `reference` and so many samples, at most a minute");
  return {
      std::move(wait),
      one("click", PropertyType::name, "a control, by its name"),
      one("key", PropertyType::name, "presses a key, by its name"),
      one("panel", PropertyType::name, "opens a panel"),
      one("window", PropertyType::resolution, "size of the window"),
      one("panels", PropertyType::flag, "shows the panels"),
      ranged("panel_width", PropertyType::number, 120, 4000, "of the panels, in pixels of a scale of 1"),
      ranged("scale", PropertyType::number, 0.25, 8,
             "as a monitor of so many times the usual density has it"),
      one("copy_command", PropertyType::flag, "puts the command that repeats the picture into the clipboard"),
      one("minimise", PropertyType::flag, "puts the window away, or brings it back"),
      chosen("focus", {"picture", "panels"}, "which of the two the keyboard moves in"),
      ranged("random", PropertyType::integer, 1, 100000, "so many random actions, by the seed"),
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
  material.properties = {ranged("diffuse", PropertyType::oneOrThree, 0, 1, "albedo"),
                         ranged("specular", PropertyType::oneOrThree, 0, 1, "Phong albedo"),
                         ranged("exponent", PropertyType::number, 0, 1e30, "of the Phong lobe"),
                         ranged("emission", PropertyType::oneOrThree, 0, 1e30, "radiance")};
  dsl::BlockSpecification light = block("light", dsl::HeaderUse::required, "another power of a light");
  light.properties = {ranged("power", PropertyType::oneOrThree, 0, 1e30,
                             "irradiance, intensity, or an area light's radiance")};
  dsl::BlockSpecification medium = block("medium", dsl::HeaderUse::required, "another make of a medium");
  PropertySpecification extinction =
      measured("extinction", PropertyType::oneOrThree, dsl::kInverseLength, "at density 1");
  extinction.low = 0.0;
  medium.properties = {
      std::move(extinction), ranged("albedo", PropertyType::oneOrThree, 0, 1, "scattering / extinction"),
      ranged("anisotropy", PropertyType::number, -0.999, 0.999, "mean cosine of scattering")};
  dsl::BlockSpecification camera =
      block("camera", dsl::HeaderUse::required, "puts a camera of the scene elsewhere");
  PropertySpecification fov = measured("fov", PropertyType::number, dsl::kAngle, "the full vertical angle");
  fov.low = 0.1 * kDegree;
  fov.high = 179.0 * kDegree;
  camera.properties = {measured("eye", PropertyType::vector3, dsl::kLength, "where it is"),
                       measured("target", PropertyType::vector3, dsl::kLength, "what it looks at"),
                       std::move(fov)};
  view.blocks = {std::move(set), std::move(material), std::move(light), std::move(medium), std::move(camera)};
  return {std::move(view)};
}

std::vector<Action> actionsOf(dsl::Document parsed) {
  std::vector<Diagnostic> findings = parsed.findings;
  if (findings.empty()) dsl::check(parsed, viewSpecifications(), findings);
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
