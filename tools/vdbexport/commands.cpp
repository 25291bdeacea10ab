#include "vdbexport/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/named_texts.h"
#include "common/outputs.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "lumivox/experiment/report.h"
#include "vdbexport/difference.h"
#include "vdbexport/export.h"
#include "vdbexport/preview.h"
#include "vdbexport/vdb_file.h"

namespace lumivox::vdb {

using command::GlobalOptions;
using command::Json;
namespace fs = std::filesystem;

constexpr double kLargestTolerance = 1e37;

void Options::addTo(CLI::App& app) {
  command::takesNames(
      app.add_option(
             "INPUTS", inputs,
             "SCENE PIPELINE; with --list also a pipeline or a .vdb file alone; with --diff two .vdb files")
          ->required(),
      command::NamedText::sceneOrPipeline);
  app.add_option("-o,--out", output, "the .vdb file");
  run.addTo(app);
  app.add_option("--frames", frames,
                 "F or FIRST..LAST: a range gives numbered files, out_0007.vdb or a run of # in the name");
  command::addFrameRate(app, framesPerSecond);
  auto* grid = command::addRepeatable(app, "--grid", grids,
                                      "an output PASS.PORT to export (default: all); with --diff a grid's "
                                      "name, or NAME=NAME for two with different names; may be repeated");
  app.add_flag("--all", all, "every output that can be exported")->excludes(grid);
  command::addRepeatable(app, "--level", levels,
                         "a level of the grids, 0 the finest, or 'all' (default: 0); may be repeated");
  app.add_option("--preview", preview, "a .png of the exported grids, seen along the three axes");
  display.addTo(app);
  app.add_flag("--half", half, "store floats with 16 bits");
  auto* listing = app.add_flag("--list", list, "list what can be exported, or what a .vdb file contains");
  app.add_flag("--diff", diff, "compare two .vdb files grid by grid, voxel by voxel")->excludes(listing);
  app.add_option("--tolerance", tolerance, "of --diff: differences up to this are ignored (default 0)")
      ->check(command::numberBetween(0.0, kLargestTolerance));
  app.add_flag("--json", json, "print JSON (--list, --diff)");
}

namespace {

void requireInputs(const Options& options, std::size_t count, const std::string& expected) {
  if (options.inputs.size() != count)
    throw Error(fmt::format("{} inputs given; expected {}", options.inputs.size(), expected));
}

/// Empty: every level.
std::vector<int> levelsOf(const Options& options) {
  if (options.levels.empty()) return {0};
  std::vector<int> levels;
  for (const std::string& text : options.levels) {
    if (text == "all") return {};
    constexpr std::size_t kMostDigits = 3;
    if (text.empty() || text.size() > kMostDigits ||
        text.find_first_not_of("0123456789") != std::string::npos)
      throw Error(fmt::format("--level '{}': expected a whole number from 0, or 'all'", text));
    levels.push_back(std::stoi(text));
  }
  std::sort(levels.begin(), levels.end());
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  return levels;
}

/// One rendered pipeline with everything that it needs.
struct Session {
  Pipeline pipeline;
  RenderOptions renderOptions;
  TechniqueSet techniques;
  Scene scene;
  std::unique_ptr<gpu::Device> device;
  Exporter exporter;

  Session(const Options& options, const GlobalOptions& global, const std::vector<int>& levels)
      : pipeline(Pipeline::load(options.inputs[1])),
        renderOptions(options.run.renderOptions(pipeline)),
        techniques(global.techniqueSet()),
        scene(sceneOnceChecked(options.inputs[0], global)),
        device(global.openDevice()),
        exporter(*device, techniques, scene, pipeline, renderOptions, {options.grids, levels, options.half}) {
  }

 private:
  /// Loads the scene only after the pipeline was checked, so that its findings come before the work of
  /// loading models.
  Scene sceneOnceChecked(const fs::path& file, const GlobalOptions& global) {
    checkPipeline(pipeline, techniques);
    return global.loadScene(file);
  }
};

}  // namespace

// ---- export --------------------------------------------------------------------------------------------

namespace {

/// Grids without active voxels: an Error if all grids of a single frame are empty, else a warning, since a
/// frame of a sequence may be without smoke.
void refuseEmpty(const std::vector<openvdb::GridBase::ConstPtr>& grids, bool sequence, const fs::path& file) {
  std::vector<std::string> empty;
  for (const auto& grid : grids)
    if (grid->empty() || grid->activeVoxelCount() == 0) empty.push_back(grid->getName());
  if (empty.empty()) return;
  const std::string text =
      fmt::format("{}: no voxel is occupied in {}", file.string(), fmt::join(empty, ", "));
  if (!sequence && empty.size() == grids.size()) throw Error(text + "; nothing is written");
  logWarning("{}", text);
}

std::vector<openvdb::GridBase::ConstPtr> convert(Session& session, const GlobalOptions& global, double time,
                                                 std::vector<NamedField>& fields) {
  const auto provenance = command::provenance(global, session.scene, session.pipeline, session.renderOptions,
                                              *session.device, time);
  std::vector<openvdb::GridBase::ConstPtr> grids;
  for (NamedField& field : fields) {
    grids.push_back(session.exporter.grid(field, provenance));
    field.field.values = {};  // frees what it downloaded
  }
  return grids;
}

}  // namespace

int exportGrids(const Options& options, const GlobalOptions& global) {
  requireInputs(options, 2, "SCENE PIPELINE");
  if (options.output.empty()) throw Error("-o: expected a name that ends in .vdb");
  const auto [first, last] =
      options.frames.empty() ? std::pair(0, 0) : command::parseFrames("--frames", options.frames);
  const bool sequence = options.frames.find("..") != std::string::npos;
  const auto fileOf = [&](int frame) {
    return sequence ? command::numberedName(options.output, frame) : options.output;
  };
  const std::vector<int> levels = levelsOf(options);
  options.display.given();  // throws for a wrong --exposure before the work
  command::Outputs outputs;
  outputs.add("-o", fileOf(first), {".vdb"}).add("--preview", options.preview, {".png"});
  if (first != last) outputs.add("-o", fileOf(last), {".vdb"});
  outputs.check(options.inputs);

  openvdb::initialize();
  Session session(options, global, levels);
  outputs.requireUnread();
  for (int frame = first + 1; frame < last; ++frame) command::Outputs::requireUnread("-o", fileOf(frame));
  Preview preview(*session.device);
  for (int frame = first; frame <= last; ++frame) {
    const double time = options.run.time + frame / options.framesPerSecond;
    std::vector<NamedField> fields = session.exporter.render(time, frame);
    const auto grids = convert(session, global, time, fields);
    const fs::path file = fileOf(frame);
    refuseEmpty(grids, sequence, file);
    writeVdb(file, grids);
    if (!options.preview.empty()) preview.add(fields, sequence ? fmt::format("frame {}", frame) : "");
    std::vector<std::string> names;
    for (const auto& grid : grids) names.push_back(grid->getName());
    logInformation("{}: {} ({})", file.string(), fmt::join(names, ", "), formatBytes(fs::file_size(file)));
  }
  if (!options.preview.empty()) preview.write(options.preview, options.display);
  return command::kGood;
}

// ---- --list --------------------------------------------------------------------------------------------

namespace {

std::string resolutionText(const glm::ivec3& size) {
  return fmt::format("{}x{}x{}", size.x, size.y, size.z);
}

std::string sizeText(const glm::dvec3& size) {
  return size == glm::dvec3(size.x) ? fmt::format("{:.6g}", size.x)
                                    : fmt::format("{:.6g} {:.6g} {:.6g}", size.x, size.y, size.z);
}

Json listOfPipeline(const fs::path& file, const GlobalOptions& global) {
  const Pipeline pipeline = Pipeline::load(file);
  TechniqueSet techniques = global.techniqueSet();
  Json list = Json::array();
  for (const Source& source : exportableSources(pipeline, techniques))
    list.push_back({{"grid", source.text()},
                    {"kind", source.portKind},
                    {"made_by", source.technique + "." + source.techniquePass},
                    {"meaning", source.meaning}});
  return list;
}

Json listOfRun(const Options& options, const GlobalOptions& global) {
  Session session(options, global, options.levels.empty() ? std::vector<int>{} : levelsOf(options));
  const int frame = options.frames.empty() ? 0 : command::parseFrames("--frames", options.frames).first;
  const double time = options.run.time + frame / options.framesPerSecond;
  Json list = Json::array();
  for (const NamedField& named : session.exporter.render(time, frame)) {
    const Field& field = named.field;
    list.push_back({{"grid", named.source.text()},
                    {"kind", named.source.portKind},
                    {"field", field.name},
                    {"level", field.level},
                    {"type", field.type},
                    {"resolution", resolutionText(field.resolution)},
                    {"voxel_m", sizeText(field.voxelSize)},
                    {"bytes", field.deviceBytes},
                    {"unit", field.unit},
                    {"quantity", field.quantity}});
  }
  return list;
}

Json listOfFile(const fs::path& file) {
  Json list = Json::array();
  for (const openvdb::GridBase::Ptr& grid : readVdb(file)) {
    const auto meta = [&](const char* name) {
      const openvdb::Metadata::ConstPtr value = (*grid)[name];
      return value ? value->str() : std::string();
    };
    const openvdb::Vec3d size = grid->voxelSize();
    const openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
    const openvdb::Coord extent = box.empty() ? openvdb::Coord() : box.dim();
    list.push_back({{"grid", grid->getName()},
                    {"type", grid->valueType()},
                    {"class", openvdb::GridBase::gridClassToString(grid->getGridClass())},
                    {"voxel_m", sizeText({size.x(), size.y(), size.z()})},
                    {"active_voxels", grid->activeVoxelCount()},
                    {"active_box", resolutionText({extent.x(), extent.y(), extent.z()})},
                    {"bytes", grid->memUsage()},
                    {"made_by", meta("lumivox.technique")},
                    {"unit", meta("lumivox.unit")},
                    {"quantity", meta("lumivox.quantity")}});
  }
  return list;
}

/// Columns in the order of the JSON; bytes in words.
std::string asTable(const Json& list) {
  if (list.empty()) return {};
  std::vector<std::vector<std::string>> rows(1);
  for (const auto& column : list.front().items()) rows.front().push_back(column.key());
  for (const Json& entry : list) {
    std::vector<std::string>& row = rows.emplace_back();
    for (const auto& column : entry.items())
      row.push_back(column.value().is_string() ? column.value().get<std::string>()
                    : column.key() == "bytes"  ? formatBytes(column.value().get<std::uint64_t>())
                                               : column.value().dump());
  }
  return command::textTable(rows);
}

}  // namespace

int list(const Options& options, const GlobalOptions& global) {
  const std::string expected = "SCENE PIPELINE, a pipeline or a .vdb file";
  if (options.inputs.size() != 2) requireInputs(options, 1, expected);
  openvdb::initialize();
  const Json found = options.inputs.size() == 2 ? listOfRun(options, global)
                     : options.inputs[0].extension() == ".pipeline"
                         ? listOfPipeline(options.inputs[0], global)
                         : listOfFile(options.inputs[0]);
  if (options.json)
    command::printJson(found);
  else
    command::print(asTable(found));
  return command::kGood;
}

// ---- --diff --------------------------------------------------------------------------------------------

namespace {

using Grids = std::vector<openvdb::GridBase::Ptr>;

openvdb::GridBase::Ptr findGrid(const Grids& grids, const std::string& name) {
  for (const auto& grid : grids)
    if (grid->getName() == name) return grid;
  return nullptr;
}

openvdb::GridBase::Ptr requireGrid(const Grids& grids, const std::string& name, const fs::path& file) {
  if (auto grid = findGrid(grids, name)) return grid;
  std::vector<std::string> names;
  for (const auto& grid : grids) names.push_back(grid->getName());
  const std::string nearest = nearestWord(name, names);
  throw Error(fmt::format("{}: has no grid '{}'; expected {}{}", file.string(), name,
                          names.empty() ? "a file with grids, this one has none"
                                        : fmt::format("one of {}", fmt::join(names, ", ")),
                          nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
}

struct Pair {
  std::string name;
  openvdb::GridBase::Ptr first, second;  ///< null: only the other file has it
};

std::vector<Pair> pairsOf(const Options& options, const Grids& first, const Grids& second) {
  std::vector<Pair> pairs;
  for (const std::string& text : options.grids) {
    const std::size_t sign = text.find('=');
    const std::string one = text.substr(0, sign),
                      other = sign == std::string::npos ? one : text.substr(sign + 1);
    pairs.push_back(
        {text, requireGrid(first, one, options.inputs[0]), requireGrid(second, other, options.inputs[1])});
  }
  if (!options.grids.empty()) return pairs;
  for (const auto& grid : first) pairs.push_back({grid->getName(), grid, findGrid(second, grid->getName())});
  for (const auto& grid : second)
    if (!findGrid(first, grid->getName())) pairs.push_back({grid->getName(), nullptr, grid});
  return pairs;
}

Json numberOrWord(double value) {
  return std::isfinite(value) ? Json(value) : Json(std::isnan(value) ? "nan" : "infinite");
}

Json asJson(const std::string& grid, const GridDifference& found, bool same) {
  return {{"grid", grid},
          {"same", same},
          {"lattice", found.lattice},
          {"voxels", found.voxels},
          {"differing", found.differing},
          {"only_first", found.onlyFirst},
          {"only_second", found.onlySecond},
          {"largest", numberOrWord(found.largest)},
          {"rms", numberOrWord(found.rms)},
          {"at", {found.where.x(), found.where.y(), found.where.z()}}};
}

std::string diffText(const Json& list) {
  std::vector<std::vector<std::string>> rows{{"grid", "same", "lattice of", "voxels", "differing",
                                              "only first", "only second", "largest", "RMS", "at"}};
  const auto number = [](const Json& value) {
    return value.is_number_float() ? command::threeDigits(value.get<double>())
           : value.is_string()     ? value.get<std::string>()
                                   : value.dump();
  };
  for (const Json& one : list) {
    if (!one.contains("voxels")) {
      rows.push_back({one["grid"], "NO", one["missing"], "", "", "", "", "", "", ""});
      continue;
    }
    rows.push_back({one["grid"], one["same"] ? "yes" : "NO",
                    one["lattice"] == "same" ? "both" : one["lattice"].get<std::string>(),
                    number(one["voxels"]), number(one["differing"]), number(one["only_first"]),
                    number(one["only_second"]), number(one["largest"]), number(one["rms"]),
                    fmt::format("{}", fmt::join(one["at"].get<std::vector<int>>(), " "))});
  }
  return command::textTable(rows);
}

}  // namespace

int diff(const Options& options, const GlobalOptions&) {
  requireInputs(options, 2, "two .vdb files");
  const Grids first = readVdb(options.inputs[0]), second = readVdb(options.inputs[1]);
  const std::string what = options.inputs[0].string() + " and " + options.inputs[1].string();
  Json list = Json::array();
  bool allSame = true;
  for (const Pair& pair : pairsOf(options, first, second)) {
    if (!pair.first || !pair.second) {
      list.push_back({{"grid", pair.name},
                      {"same", false},
                      {"missing", pair.first ? "only the first has it" : "only the second has it"}});
      allSame = false;
      continue;
    }
    const GridDifference found = difference(*pair.first, *pair.second, options.tolerance, what);
    const bool same = found.same(options.tolerance);
    allSame = allSame && same;
    list.push_back(asJson(pair.name, found, same));
  }
  if (list.empty()) throw Error(what + ": neither has a grid; expected some to compare");
  if (options.json)
    command::printJson(list);
  else
    command::print(diffText(list));
  return allSame ? command::kGood : command::kNotGood;
}

}  // namespace lumivox::vdb
