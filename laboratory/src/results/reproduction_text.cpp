// Reads texts of published tables and figures.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <regex>
#include <tuple>
#include <utility>

#include "dsl/consequences.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "lumivox/results/reproduction.h"
#include "lumivox/scene/text.h"
#include "pipeline/text_values.h"

namespace lumivox {
namespace {

namespace fs = std::filesystem;
using dsl::BlockSpecification;
using dsl::PropertySpecification;
using dsl::PropertyType;

constexpr double kLargestImage = 16384;  // the widest image of OpenGL 4.5's guaranteed minimum texture size
constexpr double kSmallestScale = 1.0 / 64;
PropertySpecification property(const char* word, PropertyType type, const char* meaning) {
  PropertySpecification specification;
  specification.word = word;
  specification.type = type;
  specification.meaning = meaning;
  return specification;
}

PropertySpecification required(PropertySpecification specification) {
  specification.required = true;
  return specification;
}

constexpr double kLargestPublished = 1e18;
constexpr double kMostSubdivisions = 6;  // 4096 triangles of one
/// Layers of the path tracer (reference/path_tracer.h).
constexpr const char* kReferenceLayers[] = {
    "direct", "one_bounce_diffuse", "one_bounce_glossy", "one_bounce", "indirect_diffuse", "indirect_glossy",
    "full",   "ambient_occlusion",  "scattered_single",  "scattered"};

/// Properties that a text may give for all of its rows, points and panels, or for each.
std::vector<PropertySpecification> setUpProperties() {
  PropertySpecification measures = property(
      "measures", PropertyType::word,
      "what the published numbers are: time in ms, frame_rate in 1/s (of the whole frame, or of `passes` "
      "where others are made in advance), fragments (voxel fragments of `output`), "
      "memory in MB of 10^6 bytes (of `passes`, of what `output` holds, or of the whole frame at its peak), "
      "voxel_bytes (of what `output` holds, for each of its finest voxels that has an opacity)");
  for (const PublishedQuantity quantity : kPublishedQuantities) measures.choices.push_back(name(quantity));
  measures.defaultText = name(PublishedQuantity::time);
  PropertySpecification time = property("time", PropertyType::number, "time in the scene's animation");
  time.dimension = dsl::kTime;
  time.low = 0.0;
  time.high = kLongestTime;
  time.defaultText = "0 s";
  PropertySpecification subdivisions =
      property("subdivisions", PropertyType::integer,
               "how many times every triangle of the scene is split into four first");
  subdivisions.low = 0;
  subdivisions.high = kMostSubdivisions;
  subdivisions.defaultText = "0";
  return {
      property("scene", PropertyType::text, "file of the scene, beside the text"),
      property("pipeline", PropertyType::text, "file of the pipeline, beside the text"),
      property("camera", PropertyType::name, "camera of the scene; without it the first"),
      time,
      subdivisions,
      measures,
      property("passes", PropertyType::list,
               "passes whose times or bytes are added up; without them the whole frame"),
      property(
          "output", PropertyType::output,
          "an output that is kept alive, for passes that no image needs; its fragments or bytes are counted, or a panel shows its image in place of the pipeline's whole image"),
      property("absent", PropertyType::text, "why nothing can be measured or shown here: not comparable"),
      property("substitute", PropertyType::text,
               "the stand-in for a published set-up that is unknown or unavailable: measured, but not "
               "comparable")};
}

BlockSpecification setSpecification() {
  BlockSpecification set;
  set.word = "set";
  set.repeatable = false;
  set.open = true;
  set.meaning =
      "parameters of the pipeline, each with its value; those of a row, point or panel override those of a curve, and "
      "these over those of the whole text";
  return set;
}

/// The specification of a part, with the set-up properties that it may override.
BlockSpecification partSpecification(const char* word, dsl::HeaderUse name, const char* meaning,
                                     std::vector<PropertySpecification> properties,
                                     std::vector<BlockSpecification> blocks = {}) {
  BlockSpecification part;
  part.word = word;
  part.name = name;
  part.meaning = meaning;
  part.properties = std::move(properties);
  for (PropertySpecification& one : setUpProperties()) part.properties.push_back(std::move(one));
  part.blocks = {setSpecification()};
  for (BlockSpecification& block : blocks) part.blocks.push_back(std::move(block));
  return part;
}

BlockSpecification rowSpecification() {
  PropertySpecification published =
      required(property("published", PropertyType::number, "the number, in the unit of `measures`"));
  published.low = 1e-9;
  published.high = kLargestPublished;
  return partSpecification(
      "row", dsl::HeaderUse::required,
      "one published number. Properties that it lacks are those of the whole text.",
      {published,
       property("over", PropertyType::text,
                "name of the row that this one is divided by; without it the first one that is comparable")});
}

BlockSpecification curveSpecification() {
  PropertySpecification growth =
      property("growth", PropertyType::word,
               "the growth that the paper states for the curve; without it there is no verdict");
  for (const Growth one : {Growth::sublinear, Growth::linear, Growth::superlinear})
    growth.choices.push_back(name(one));
  BlockSpecification point = partSpecification(
      "point", dsl::HeaderUse::none,
      "one point of the curve. Properties that it lacks are those of the curve, or of the whole text.", {});
  point.required = true;
  return partSpecification(
      "curve", dsl::HeaderUse::required,
      "one curve of a figure: a measured quantity over one that changes from point to point",
      {required(property("over", PropertyType::name,
                         "the horizontal axis: triangles (of the scene), or a parameter of the pipeline")),
       growth},
      {point});
}

BlockSpecification panelSpecification() {
  PropertySpecification reference =
      property("reference", PropertyType::word,
               "layer of the path-traced reference that is shown in place of a pipeline");
  for (const char* layer : kReferenceLayers) reference.choices.push_back(layer);
  return partSpecification("panel", dsl::HeaderUse::required,
                           "one image of a figure. Properties that it lacks are those of the whole text.",
                           {reference});
}

PropertySpecification claimedQuantity() {
  PropertySpecification quantity = property(
      "of", PropertyType::word,
      "the compared quantity; luminance: the mean; colour: the mean difference of the largest and the smallest channel over the mean luminance; detail: the mean difference of neighbouring pixels over the mean luminance");
  for (const ClaimedQuantity one : kClaimedQuantities) quantity.choices.push_back(name(one));
  quantity.defaultText = name(ClaimedQuantity::luminance);
  return quantity;
}

BlockSpecification claimSpecification() {
  PropertySpecification times = property("times", PropertyType::number, "factor on the quantity of `than`");
  times.low = 1e-9;
  times.high = 1e9;
  times.defaultText = "1";
  BlockSpecification claim;
  claim.word = "claim";
  claim.name = dsl::HeaderUse::required;
  claim.meaning =
      "`claim \"SENTENCE\" { ... }`: a statement of the paper about its images, tested on the panels: one has less of a quantity than another";
  claim.properties = {
      required(property("less", PropertyType::text, "the panel that has less")),
      required(property("than", PropertyType::text, "the panel that has more")), claimedQuantity(), times,
      property(
          "dark_in", PropertyType::text,
          "a panel; only the quarter of the pixels that is darkest in it is compared, where leaking light shows")};
  return claim;
}

BlockSpecification makeSpecification() {
  BlockSpecification result;
  result.word = "reproduction";
  result.name = dsl::HeaderUse::required;
  result.repeatable = false;
  result.required = true;
  result.meaning =
      "`reproduction \"ID\" { ... }`: one table or figure of a paper. `lumivox reproduce ID` measures its rows and compares "
      "them as ratios to the first row, measures its curves and how they grow, and shows its panels on one sheet under one "
      "exposure.";
  PropertySpecification image = property("image", PropertyType::resolution,
                                         "width and height of the published image; without it the camera's");
  image.low = 1;
  image.high = kLargestImage;
  PropertySpecification picture = image;
  picture.word = "picture";
  picture.meaning = "the name of `image` in older texts";
  PropertySpecification softwareScale =
      property("software_scale", PropertyType::number,
               "factor of image sides and scaled parameters on a software rasteriser, unless --scale says "
               "otherwise");
  softwareScale.low = kSmallestScale;
  softwareScale.high = 1.0;
  softwareScale.defaultText = "1";
  PropertySpecification differs = property(
      "differs", PropertyType::text,
      "a difference of the set-up from the published one, or something unknown about it; it does not change the verdict");
  differs.repeatable = true;
  PropertySpecification columns =
      property("columns", PropertyType::integer,
               "columns of the sheet of panels; without it the sheet is as square as possible");
  columns.low = 1;
  columns.high = 64;
  result.properties = {
      required(property("title", PropertyType::text, "what the table or figure shows")),
      required(property("paper", PropertyType::text, "authors, year, number of the table or figure")),
      property("device", PropertyType::text, "device on which the published numbers were measured"),
      image,
      picture,
      property("scaled", PropertyType::list,
               "parameters that a reduced set-up reduces with the image, such as voxels along a side"),
      softwareScale,
      differs,
      columns};
  for (PropertySpecification& one : setUpProperties()) result.properties.push_back(std::move(one));
  result.blocks = {setSpecification(), rowSpecification(), curveSpecification(), panelSpecification(),
                   claimSpecification()};
  return result;
}

const BlockSpecification& resultSpecification() {
  return reproductionSpecifications().front();
}

/// The accumulated set-up: the text's, overridden by a curve's, then by that of a row, point or panel.
struct SetUp {
  const dsl::Property* scene = nullptr;
  const dsl::Property* pipeline = nullptr;
  const dsl::Property* passes = nullptr;
  const dsl::Property* output = nullptr;
  std::string camera, absent, substitute;
  double time = 0.0, subdivisions = 0.0;
  PublishedQuantity quantity = PublishedQuantity::time;
  std::vector<const dsl::Property*> settings;
};

class ResultReader : TextFindings {
 public:
  ResultReader(PublishedResult& result, const dsl::Document& document, std::vector<Diagnostic>& findings)
      : TextFindings(document, findings), result_(result) {}

  void read() {
    dsl::check(document_, reproductionSpecifications(), findings_);
    const dsl::Block* main = nullptr;
    for (const dsl::Item& item : document_.items)
      if (item.block && item.block->word == "reproduction" && main == nullptr) main = item.block.get();
    // A block with findings is not read.
    if (main == nullptr || !findings_.empty()) return;
    const dsl::CheckedBlock block(*main, resultSpecification());
    result_.id = block.name();
    result_.title = block.text("title", "");
    result_.paper = block.text("paper", "");
    result_.device = block.text("device", "");
    if (const auto image = block.numbers("image", block.numbers("picture", {})); image.size() == 2) {
      result_.width = static_cast<int>(image[0]);
      result_.height = static_cast<int>(image[1]);
    }
    result_.softwareScale = block.number("software_scale", 1.0);
    result_.columns = static_cast<int>(block.number("columns", 0.0));
    for (const dsl::Property* one : block.findAll("differs"))
      result_.differences.push_back(one->values.front().text);
    const SetUp common = setUp(block, {});
    for (const dsl::Block* row : block.blocks("row")) readRow(*row, common);
    readOver(block.blocks("row"));
    for (const dsl::Block* curve : block.blocks("curve")) readCurve(*curve, common);
    for (const dsl::Block* panel : block.blocks("panel")) readPanel(*panel, common);
    for (const dsl::Block* claim : block.blocks("claim")) readClaim(*claim);
    if (result_.setUps().empty())
      report(main->place, main->word, fmt::format("reproduction '{}' has nothing to reproduce", result_.id),
             "a row, a curve or a panel");
    if (const dsl::Property* scaled = block.find("scaled")) readScaled(*scaled);
  }

 private:
  static SetUp setUp(const dsl::CheckedBlock& block, SetUp result) {
    for (const auto& [word, target] :
         {std::pair("scene", &SetUp::scene), std::pair("pipeline", &SetUp::pipeline),
          std::pair("passes", &SetUp::passes), std::pair("output", &SetUp::output)})
      if (const dsl::Property* found = block.find(word)) result.*target = found;
    result.camera = block.text("camera", result.camera);
    result.absent = block.text("absent", result.absent);
    result.substitute = block.text("substitute", result.substitute);
    result.time = block.number("time", result.time);
    result.subdivisions = block.number("subdivisions", result.subdivisions);
    for (const PublishedQuantity quantity : kPublishedQuantities)
      if (block.text("measures", "") == name(quantity)) result.quantity = quantity;
    for (const dsl::Block* set : block.blocks("set"))
      for (const dsl::Item& item : set->items)
        if (item.property) result.settings.push_back(&*item.property);
    return result;
  }

  static const BlockSpecification& part(const std::string& word) {
    for (const BlockSpecification& one : resultSpecification().blocks)
      if (one.word == word) return one;
    return resultSpecification().blocks.front();
  }

  void readRow(const dsl::Block& block, const SetUp& common) {
    const dsl::CheckedBlock checked(block, part("row"));
    PublishedRow row;
    row.name = checked.name();
    row.published = checked.number("published", 0.0);
    row.over = checked.text("over", "");
    readSetUp(block, setUp(checked, common), fmt::format("row '{}'", row.name), row);
    result_.rows.push_back(std::move(row));
  }

  /// Checks the divisor of a row: it must be in the same text, have the same quantity, and have no divisor
  /// itself.
  void readOver(const std::vector<const dsl::Block*>& blocks) {
    std::vector<std::string> names;
    for (const PublishedRow& row : result_.rows) names.push_back(row.name);
    for (std::size_t i = 0; i < result_.rows.size(); ++i) {
      const PublishedRow& row = result_.rows[i];
      if (row.over.empty()) continue;
      const auto found = std::find(names.begin(), names.end(), row.over);
      const PublishedRow* other =
          found == names.end() ? nullptr : &result_.rows[static_cast<std::size_t>(found - names.begin())];
      const dsl::Property& property = *dsl::CheckedBlock(*blocks[i], part("row")).find("over");
      const dsl::Value& value = property.values.front();
      if (other == nullptr)
        report(value.place, value.length, fmt::format("there is no row '{}'", row.over),
               "the name of another row", nearestWord(row.over, names));
      else if (other == &row || !other->over.empty() || other->quantity != row.quantity)
        report(value.place, value.length,
               fmt::format("row '{}' cannot be divided by '{}'", row.name, row.over),
               "another row that measures the same and is over none");
    }
  }

  void readCurve(const dsl::Block& block, const SetUp& common) {
    const BlockSpecification& specification = part("curve");
    const dsl::CheckedBlock checked(block, specification);
    const SetUp shared = setUp(checked, common);
    PublishedCurve curve;
    curve.name = checked.name();
    curve.place = block.place;
    curve.over = checked.text("over", "");
    for (const Growth growth : {Growth::sublinear, Growth::linear, Growth::superlinear})
      if (checked.text("growth", "") == name(growth)) curve.growth = growth;
    for (const dsl::Block* point : checked.blocks("point")) {
      const dsl::CheckedBlock inside(*point, specification.blocks.at(1));
      PublishedSetUp one;
      readSetUp(*point, setUp(inside, shared), fmt::format("a point of curve '{}'", curve.name), one);
      if (one.quantity != shared.quantity)
        report(point->place, point->word, "this point measures something other than its curve",
               fmt::format("{}, as the others", name(shared.quantity)));
      requireAxis(*checked.find("over"), curve.over, one);
      curve.points.push_back(std::move(one));
    }
    result_.curves.push_back(std::move(curve));
  }

  void requireAxis(const dsl::Property& property, const std::string& over, const PublishedSetUp& point) {
    if (over == "triangles" || !point.pipeline) return;
    const dsl::Value& value = property.values.front();
    std::vector<std::string> names = parameterNames(*point.pipeline);
    if (const PipelineParameter* parameter = findParameter(*point.pipeline, over)) {
      const auto set = point.settings.find(over);
      if ((set == point.settings.end() ? parameter->value : set->second).word.empty()) return;
      return reportOnce(value.place, value.length, fmt::format("the parameter '{}' is a word", over),
                        "triangles, or a parameter that is a number");
    }
    names.push_back("triangles");
    reportOnce(value.place, value.length,
               fmt::format("pipeline \"{}\" has no parameter '{}'", point.pipeline->name, over),
               oneOf(names, ""), nearestWord(over, names));
  }

  void readPanel(const dsl::Block& block, const SetUp& common) {
    const dsl::CheckedBlock checked(block, part("panel"));
    SetUp setting = setUp(checked, common);
    PublishedPanel panel;
    panel.name = checked.name();
    panel.reference = checked.text("reference", "");
    if (!panel.reference.empty()) setting.pipeline = setting.passes = setting.output = nullptr;
    readSetUp(block, setting, fmt::format("panel '{}'", panel.name), panel, panel.reference.empty());
    result_.panels.push_back(std::move(panel));
  }

  void readClaim(const dsl::Block& block) {
    const dsl::CheckedBlock checked(block, part("claim"));
    PublishedClaim claim;
    claim.name = checked.name();
    claim.times = checked.number("times", claim.times);
    for (const ClaimedQuantity quantity : kClaimedQuantities)
      if (checked.text("of", "") == name(quantity)) claim.quantity = quantity;
    std::vector<std::string> panels;
    for (const PublishedPanel& panel : result_.panels) panels.push_back(panel.name);
    for (const auto& [word, target] :
         {std::pair("less", &PublishedClaim::less), std::pair("than", &PublishedClaim::than),
          std::pair("dark_in", &PublishedClaim::darkIn)}) {
      claim.*target = checked.text(word, "");
      const dsl::Property* property = checked.find(word);
      if (property == nullptr || std::find(panels.begin(), panels.end(), claim.*target) != panels.end())
        continue;
      const dsl::Value& value = property->values.front();
      report(value.place, value.length, fmt::format("there is no panel '{}'", value.text),
             "the name of a panel", nearestWord(value.text, panels));
    }
    if (!claim.less.empty() && claim.less == claim.than)
      report(block.place, block.word, fmt::format("claim '{}' compares a panel with itself", claim.name),
             "two panels");
    result_.claims.push_back(std::move(claim));
  }

  void readSetUp(const dsl::Block& block, const SetUp& setting, const std::string& what,
                 PublishedSetUp& target, bool needsPipeline = true) {
    target.place = block.place;
    target.quantity = setting.quantity;
    target.camera = setting.camera;
    target.time = setting.time;
    target.subdivisions = static_cast<int>(setting.subdivisions);
    target.absent = setting.absent;
    target.substitute = setting.substitute;
    if (!target.absent.empty()) return;
    for (const auto& [word, found] :
         {std::pair("scene", setting.scene), std::pair("pipeline", setting.pipeline)})
      if (found == nullptr && (needsPipeline || word == std::string("scene")))
        report(block.place, block.word, fmt::format("{} has no {}", what, word),
               fmt::format("{} \"...\" here or for the whole text, or why it is absent", word));
    if (setting.scene != nullptr) target.scene = fileOf(*setting.scene);
    if (setting.pipeline == nullptr) return;
    target.pipeline = pipelineOf(*setting.pipeline);
    if (!target.pipeline) return;
    for (const dsl::Property* one : setting.settings) readSetting(*one, *target.pipeline, target.settings);
    if (setting.passes != nullptr)
      for (const dsl::Value& value : setting.passes->values.front().items) {
        requirePass(value, value.text, *target.pipeline);
        target.passes.push_back(value.text);
      }
    if (setting.output != nullptr) {
      const dsl::Value& value = setting.output->values.front();
      if (const auto parts = splitDotted(value)) {
        std::tie(target.pass, target.port) = *parts;
        requirePass(value, target.pass, *target.pipeline);
      } else {
        report(value.place, value.length, "this is not an output of a pass", "pass.port");
      }
    }
    if (target.quantity == PublishedQuantity::fragments && target.pass.empty())
      report(block.place, block.word, fmt::format("{} does not say whose fragments are counted", what),
             "output pass.port");
    if (target.quantity == PublishedQuantity::voxelBytes && target.pass.empty())
      report(block.place, block.word, fmt::format("{} does not say whose bytes are counted", what),
             "output pass.port");
  }

  fs::path fileOf(const dsl::Property& property) {
    const dsl::Value& value = property.values.front();
    const fs::path file = besideText(value);
    std::error_code failure;
    if (fs::is_regular_file(file, failure)) return file;
    if (known_.insert({file, nullptr}).second)  // once, not for every row
      report(value.place, value.length, fmt::format("there is no file {}", file.string()),
             "a path beside the text");
    return {};
  }

  std::shared_ptr<const Pipeline> pipelineOf(const dsl::Property& property) {
    const fs::path file = fileOf(property);
    if (file.empty()) return nullptr;
    const auto [known, isNew] = known_.insert({file, nullptr});
    if (!isNew) return known->second;
    try {
      known->second = std::make_shared<const Pipeline>(Pipeline::load(file));
    } catch (const DiagnosticsError& error) {
      findings_.insert(findings_.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
    return known->second;
  }

  void readSetting(const dsl::Property& property, const Pipeline& pipeline, ParameterValues& settings) {
    const PipelineParameter* parameter = findParameter(pipeline, property.word);
    if (parameter == nullptr) {
      const std::vector<std::string> names = parameterNames(pipeline);
      return reportOnce(property.place, static_cast<int>(property.word.size()),
                        fmt::format("pipeline \"{}\" has no parameter '{}'", pipeline.name, property.word),
                        oneOf(names, "no setting, since it declares none"),
                        nearestWord(property.word, names));
    }
    const auto value = property.values.size() == 1 ? parameterValue(property.values[0]) : std::nullopt;
    const std::string misfit = value ? parameter->misfit(*value) : std::string("must be a number or a word");
    if (!misfit.empty())
      return reportOnce(property.place, static_cast<int>(property.word.size()),
                        fmt::format("this value does not fit the parameter '{}'", property.word),
                        misfitExpectation(misfit));
    settings[property.word] = *value;
    settings[property.word].dimension = parameter->value.dimension;
  }

  void requirePass(const dsl::Value& value, const std::string& name, const Pipeline& pipeline) {
    std::vector<std::string> names;
    for (const PassText& pass : pipeline.passes) names.push_back(pass.name);
    if (std::find(names.begin(), names.end(), name) == names.end())
      reportOnce(value.place, value.length,
                 fmt::format("pipeline \"{}\" has no pass '{}'", pipeline.name, name),
                 oneOf(names, "no pass"), nearestWord(name, names));
  }

  /// Properties of the table are read for every row but their findings are reported once.
  void reportOnce(const SourcePlace& place, int length, std::string what, std::string expected,
                  std::string suggestion = {}) {
    const bool known = std::any_of(findings_.begin(), findings_.end(), [&](const Diagnostic& other) {
      return other.place.text() == place.text() && other.what == what;
    });
    if (!known) report(place, length, std::move(what), std::move(expected), std::move(suggestion));
  }

  void readScaled(const dsl::Property& property) {
    const std::vector<const PublishedSetUp*> setUps = std::as_const(result_).setUps();
    for (const dsl::Value& value : property.values.front().items) {
      result_.scaled.push_back(value.text);
      const bool known = std::any_of(setUps.begin(), setUps.end(), [&](const PublishedSetUp* one) {
        return one->pipeline && findParameter(*one->pipeline, value.text) != nullptr;
      });
      if (!known)
        report(value.place, value.length, fmt::format("no pipeline here has a parameter '{}'", value.text),
               "a parameter that counts voxels or pixels along a side");
    }
  }

  PublishedResult& result_;
  std::map<fs::path, std::shared_ptr<const Pipeline>> known_;
};

}  // namespace

const std::vector<BlockSpecification>& reproductionSpecifications() {
  static const std::vector<BlockSpecification> specifications = {makeSpecification()};
  return specifications;
}

PublishedResult PublishedResult::load(const fs::path& file) {
  PublishedResult result;
  result.file = file;
  result.document = std::make_shared<const dsl::Document>(dsl::parseFile(file));
  std::vector<Diagnostic> findings = result.document->findings;
  ResultReader(result, *result.document, findings).read();
  dsl::dropConsequences(*result.document, findings);
  throwOrLog(std::move(findings));
  return result;
}

std::vector<const PublishedSetUp*> PublishedResult::setUps() const {
  std::vector<const PublishedSetUp*> all;
  for (const PublishedRow& row : rows) all.push_back(&row);
  for (const PublishedCurve& curve : curves)
    for (const PublishedSetUp& point : curve.points) all.push_back(&point);
  for (const PublishedPanel& panel : panels) all.push_back(&panel);
  return all;
}

std::string citedName(const PublishedResult& result) {
  const std::size_t dash = result.id.find_first_not_of("0123456789");
  if (dash == 0 || dash == std::string::npos || result.id[dash] != '-') return result.id;
  // "Gomes 2015 (thesis)", "Lensing and Broll 2013", "Slides on Thiedemann et al. 2011".
  static const std::regex pattern(R"((?:^|\s)([^\s,]+)(?:,[^0-9]*| and [^0-9]*| et al\.|) (\d{4})\b)");
  std::smatch found;
  if (!std::regex_search(result.paper, found, pattern)) return result.id;
  std::string author = found[1];
  for (char& c : author)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return author + found[2].str() + result.id.substr(dash);
}

void checkReproduction(const PublishedResult& result, TechniqueSource& techniques) {
  std::map<std::string, Pipeline> swept;  // each pipeline with the settings of its set-ups as sweeps
  for (const PublishedSetUp* one : result.setUps()) {
    if (!one->pipeline) continue;
    Pipeline& pipeline = swept.emplace(one->pipeline->file.string(), *one->pipeline).first->second;
    Sweep settings;
    settings.name = one->place.text();
    for (const auto& [name, value] : one->settings) settings.axes.push_back({name, {value}});
    pipeline.sweeps.push_back(std::move(settings));
  }
  std::vector<Diagnostic> findings;
  for (const auto& [file, pipeline] : swept) {
    try {
      checkPipeline(pipeline, techniques);
    } catch (const DiagnosticsError& error) {
      findings.insert(findings.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
  }
  throwOrLog(std::move(findings));
}

}  // namespace lumivox
