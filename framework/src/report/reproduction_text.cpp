// Reading the texts of published tables.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "lumivox/report/reproduce.h"
#include "pipeline/text_values.h"

namespace lumivox {
namespace {

namespace fs = std::filesystem;
using dsl::BlockSpecification;
using dsl::PropertySpecification;
using dsl::PropertyType;

constexpr double kLargestPicture =
    16384;  // the widest picture of OpenGL 4.5's guaranteed minimum texture size
constexpr double kSmallestScale = 1.0 / 64;
constexpr PublishedQuantity kQuantities[] = {PublishedQuantity::time, PublishedQuantity::frameRate,
                                             PublishedQuantity::fragments, PublishedQuantity::memory};

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

/// What a table says for all of its rows and a row for itself.
std::vector<PropertySpecification> setUpProperties() {
  PropertySpecification measures = property(
      "measures", PropertyType::word,
      "what the published numbers are: time in ms, frame_rate in 1/s, fragments (voxel fragments of `output`), "
      "memory in MB of 10^6 bytes");
  for (const PublishedQuantity quantity : kQuantities) measures.choices.push_back(name(quantity));
  measures.defaultText = name(PublishedQuantity::time);
  PropertySpecification time = property("time", PropertyType::number, "of the scene");
  time.dimension = dsl::kTime;
  time.low = 0.0;
  time.defaultText = "0 s";
  return {
      property("scene", PropertyType::text, "file of the scene, beside the text"),
      property("pipeline", PropertyType::text, "file of the pipeline, beside the text"),
      property("camera", PropertyType::name, "of the scene; without it the first"),
      time,
      measures,
      property("passes", PropertyType::list,
               "whose times or bytes are added up; without them the whole frame"),
      property("output", PropertyType::output,
               "an output that is kept, for passes that no picture needs, and whose fragments are counted"),
      property("absent", PropertyType::text,
               "why there is nothing to measure here: the row is not comparable"),
      property("substitute", PropertyType::text,
               "what stands in for a published set-up that is unknown or not here: measured, but not "
               "comparable")};
}

BlockSpecification makeSpecification() {
  BlockSpecification set;
  set.word = "set";
  set.repeatable = false;
  set.open = true;
  set.meaning = "parameters of the pipeline, each with its value; a row's come over those of the table";

  BlockSpecification row;
  row.word = "row";
  row.name = dsl::HeaderUse::required;
  row.required = true;
  row.meaning = "one published number. What it does not say itself the table says.";
  PropertySpecification published =
      required(property("published", PropertyType::number, "the number, in the unit of `measures`"));
  published.low = 1e-9;
  row.properties = {published};
  for (PropertySpecification& one : setUpProperties()) row.properties.push_back(std::move(one));
  row.blocks = {set};

  BlockSpecification table;
  table.word = "reproduction";
  table.name = dsl::HeaderUse::required;
  table.repeatable = false;
  table.required = true;
  table.meaning =
      "`reproduction \"ID\" { ... }`: one table of a paper. `lumivox reproduce ID` measures its rows and compares them "
      "as ratios to the first row.";
  PropertySpecification picture =
      property("picture", PropertyType::resolution,
               "width and height of the published picture; without it the camera's");
  picture.low = 1;
  picture.high = kLargestPicture;
  PropertySpecification softwareScale = property(
      "software_scale", PropertyType::number,
      "what picture sides and scaled parameters are multiplied by on a software rasteriser, unless --scale says "
      "otherwise");
  softwareScale.low = kSmallestScale;
  softwareScale.high = 1.0;
  softwareScale.defaultText = "1";
  PropertySpecification differs = property(
      "differs", PropertyType::text,
      "how the set-up differs from the published one, or what is not known of it, without changing the verdict");
  differs.repeatable = true;
  table.properties = {
      required(property("title", PropertyType::text, "what the table shows")),
      required(property("paper", PropertyType::text, "authors, year, number of the table")),
      property("device", PropertyType::text, "on which the published numbers were measured"),
      picture,
      property("scaled", PropertyType::list,
               "parameters that a reduced set-up makes smaller with the picture: voxels along a side"),
      softwareScale,
      differs};
  for (PropertySpecification& one : setUpProperties()) table.properties.push_back(std::move(one));
  table.blocks = {set, row};
  return table;
}

const BlockSpecification& tableSpecification() {
  return reproductionSpecifications().front();
}

/// What is known of the set-up so far: the table's, then the row's over it.
struct SetUp {
  const dsl::Property* scene = nullptr;
  const dsl::Property* pipeline = nullptr;
  const dsl::Property* passes = nullptr;
  const dsl::Property* output = nullptr;
  std::string camera, absent, substitute;
  double time = 0.0;
  PublishedQuantity quantity = PublishedQuantity::time;
  std::vector<const dsl::Property*> settings;
};

class TableReader : TextFindings {
 public:
  TableReader(PublishedTable& table, const dsl::Document& document, std::vector<Diagnostic>& findings)
      : TextFindings(document, findings), table_(table) {}

  void read() {
    dsl::check(document_, reproductionSpecifications(), findings_);
    const dsl::Block* main = nullptr;
    for (const dsl::Item& item : document_.items)
      if (item.block && item.block->word == "reproduction" && main == nullptr) main = item.block.get();
    // What the tables refuse has no meaning to read.
    if (main == nullptr || !findings_.empty()) return;
    const dsl::CheckedBlock block(*main, tableSpecification());
    table_.id = block.name();
    table_.title = block.text("title", "");
    table_.paper = block.text("paper", "");
    table_.device = block.text("device", "");
    if (const auto picture = block.numbers("picture", {}); picture.size() == 2) {
      table_.width = static_cast<int>(picture[0]);
      table_.height = static_cast<int>(picture[1]);
    }
    table_.softwareScale = block.number("software_scale", 1.0);
    for (const dsl::Property* one : block.findAll("differs"))
      table_.differences.push_back(one->values.front().text);
    const SetUp common = setUp(block, {});
    for (const dsl::Block* row : block.blocks("row")) readRow(*row, common);
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
    for (const PublishedQuantity quantity : kQuantities)
      if (block.text("measures", "") == name(quantity)) result.quantity = quantity;
    for (const dsl::Block* set : block.blocks("set"))
      for (const dsl::Item& item : set->items)
        if (item.property) result.settings.push_back(&*item.property);
    return result;
  }

  void readRow(const dsl::Block& block, const SetUp& common) {
    static const BlockSpecification& specification = tableSpecification().blocks.at(1);
    const dsl::CheckedBlock checked(block, specification);
    const SetUp setting = setUp(checked, common);
    PublishedRow row;
    row.name = checked.name();
    row.place = block.place;
    row.published = checked.number("published", 0.0);
    row.quantity = setting.quantity;
    row.camera = setting.camera;
    row.time = setting.time;
    row.absent = setting.absent;
    row.substitute = setting.substitute;
    if (row.absent.empty()) readSetUp(block, setting, row);
    table_.rows.push_back(std::move(row));
  }

  void readSetUp(const dsl::Block& block, const SetUp& setting, PublishedRow& row) {
    for (const auto& [word, found] :
         {std::pair("scene", setting.scene), std::pair("pipeline", setting.pipeline)})
      if (found == nullptr)
        report(block.place, block.word, fmt::format("row '{}' has no {}", row.name, word),
               fmt::format("{} \"...\" in the row or in the table, or why it is absent", word));
    if (setting.scene != nullptr) row.scene = fileOf(*setting.scene);
    if (setting.pipeline == nullptr) return;
    row.pipeline = pipelineOf(*setting.pipeline);
    if (!row.pipeline) return;
    for (const dsl::Property* one : setting.settings) readSetting(*one, *row.pipeline, row.settings);
    if (row.quantity == PublishedQuantity::frameRate) {
      for (const dsl::Item& item : block.items)
        if (item.property && item.property->word == "passes")
          report(item.property->place, item.property->word, "a frame rate is that of the frame",
                 "measures time, or no passes");
    } else if (setting.passes != nullptr) {
      for (const dsl::Value& value : setting.passes->values.front().items) {
        requirePass(value, value.text, *row.pipeline);
        row.passes.push_back(value.text);
      }
    }
    if (setting.output != nullptr) {
      const dsl::Value& value = setting.output->values.front();
      if (const auto parts = splitDotted(value)) {
        std::tie(row.pass, row.port) = *parts;
        requirePass(value, row.pass, *row.pipeline);
      } else {
        report(value.place, value.length, "this names no output of a pass", "pass.port");
      }
    }
    if (row.quantity == PublishedQuantity::fragments && row.pass.empty())
      report(block.place, block.word,
             fmt::format("row '{}' does not say whose fragments are counted", row.name), "output pass.port");
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

  /// What stands in the table is read for every row.
  void reportOnce(const SourcePlace& place, int length, std::string what, std::string expected,
                  std::string suggestion = {}) {
    const bool known = std::any_of(findings_.begin(), findings_.end(), [&](const Diagnostic& other) {
      return other.place.text() == place.text() && other.what == what;
    });
    if (!known) report(place, length, std::move(what), std::move(expected), std::move(suggestion));
  }

  void readScaled(const dsl::Property& property) {
    for (const dsl::Value& value : property.values.front().items) {
      table_.scaled.push_back(value.text);
      const bool known = std::any_of(table_.rows.begin(), table_.rows.end(), [&](const PublishedRow& row) {
        return row.pipeline && findParameter(*row.pipeline, value.text) != nullptr;
      });
      if (!known)
        report(value.place, value.length, fmt::format("no row's pipeline has a parameter '{}'", value.text),
               "a parameter that counts voxels or pixels along a side");
    }
  }

  PublishedTable& table_;
  std::map<fs::path, std::shared_ptr<const Pipeline>> known_;
};

}  // namespace

const std::vector<BlockSpecification>& reproductionSpecifications() {
  static const std::vector<BlockSpecification> specifications = {makeSpecification()};
  return specifications;
}

PublishedTable PublishedTable::load(const fs::path& file) {
  PublishedTable table;
  table.file = file;
  table.document = std::make_shared<const dsl::Document>(dsl::parseFile(file));
  std::vector<Diagnostic> findings = table.document->findings;
  TableReader(table, *table.document, findings).read();
  throwOrLog(std::move(findings));
  return table;
}

void checkReproduction(const PublishedTable& table, TechniqueSource& techniques) {
  std::map<std::string, Pipeline> swept;  // each pipeline with the settings of its rows as sweeps
  for (const PublishedRow& row : table.rows) {
    if (!row.pipeline) continue;
    Pipeline& pipeline = swept.emplace(row.pipeline->file.string(), *row.pipeline).first->second;
    Sweep settings;
    settings.name = row.name;
    for (const auto& [name, value] : row.settings) settings.axes.push_back({name, {value}});
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

std::vector<fs::path> committedReproductions() {
  std::vector<fs::path> files;
  const auto scenes = committedScenes();
  if (!scenes) return files;
  std::error_code failure;
  for (const fs::directory_entry& entry : fs::directory_iterator(*scenes / "reproductions", failure))
    if (entry.path().extension() == ".reproduction" && entry.is_regular_file(failure))
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace lumivox
