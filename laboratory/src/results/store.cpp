// The results store on SQLite. One transaction per run: a process that dies leaves all of it or nothing.
#include "lumivox/results/store.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <optional>
#include <tuple>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "results/database.h"
#include "results/store_schema.h"
#include "results/store_state.h"

namespace lumivox {

using results::Statement;
using results::Transaction;

namespace {

namespace fs = std::filesystem;

constexpr const char* kRunColumns =
    "key, created, version, scene, scene_name, pipeline, pipeline_name, sweep, is_default, camera, time, "
    "width, height, seed, seeds, repeats, subpixels, reference_samples, device, driver, shader_input, host, "
    "framework_share, failure, command";
const std::string kColumnsWritten = std::string(kRunColumns) + ", complete";
constexpr const char* kTimings[] = {"frame",     "next_frame",  "pass_device",
                                    "pass_host", "still_frame", "moved_frame"};

bool hasNamed(const std::string& wanted, const std::string& file, const std::string& title) {
  return wanted.empty() || wanted == title || results::namesFile(wanted, file);
}

bool matches(const RunFilter& filter, const StoredRun& run) {
  if (!hasNamed(filter.scene, run.point.scene, run.sceneName)) return false;
  if (!hasNamed(filter.pipeline, run.point.pipeline, run.pipelineName)) return false;
  if (run.identity.device.find(filter.device) == std::string::npos) return false;
  if (run.created < filter.since) return false;
  if (filter.failed && *filter.failed != !run.point.failure.empty()) return false;
  if (!filter.ids.empty() && std::find(filter.ids.begin(), filter.ids.end(), run.id) == filter.ids.end())
    return false;
  return std::all_of(filter.parameters.begin(), filter.parameters.end(), [&](const std::string& setting) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos)
      throw Error(fmt::format("'{}' is not a setting; expected name=value", setting));
    const auto found = run.identity.parameters.find(setting.substr(0, equals));
    return found != run.identity.parameters.end() && found->second == setting.substr(equals + 1);
  });
}

/// The value that a setting's text stands for.
ParameterValue valueOf(const std::string& text) {
  ParameterValue value;
  char* end = nullptr;
  value.number = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0') {
    value.number = 0.0;
    value.word = text;
  }
  return value;
}

}  // namespace

bool RunFilter::everything() const {
  return scene.empty() && pipeline.empty() && device.empty() && since.empty() && parameters.empty() &&
         ids.empty() && !failed;
}

ResultsStore::ResultsStore(const fs::path& file, Mode mode) {
  std::error_code ignored;
  if (mode == Mode::read && !fs::exists(file, ignored))
    throw Error(
        fmt::format("{}: there is no results store; expected a file that lumivox sweep or stress has written",
                    file.string()));
  if (mode == Mode::write) createParentDirectories(file);
  state_ = std::make_unique<State>(file, mode);
  state_->requireSchema();
}

ResultsStore::~ResultsStore() = default;
ResultsStore::ResultsStore(ResultsStore&&) noexcept = default;
ResultsStore& ResultsStore::operator=(ResultsStore&&) noexcept = default;

void ResultsStore::State::requireSchema() {
  const auto refuse = [&](const std::string& what) {
    throw Error(fmt::format("{}: {}; expected a results store with schema {}", database.file().string(), what,
                            results::kSchemaVersion));
  };
  const auto isEmpty = [&] {
    Statement any(database, "SELECT count(*) FROM sqlite_schema");
    return any.step() && any.integer(0) == 0;
  };
  if (mode == Mode::write && isEmpty()) {
    Transaction transaction(database);
    // Another process may have made it while this one waited.
    if (isEmpty()) {
      database.execute(results::kSchema);
      database.execute(results::kSchema2);
      database.execute(results::kSchema3);
      database.execute(results::kSchema4);
      database.execute(results::kSchema5);
      database.execute(results::kSchema6);
      database.execute(results::kSchema7);
      database.execute(results::kSchema8);
      database.execute(fmt::format("PRAGMA user_version = {}", results::kSchemaVersion).c_str());
      database.execute(fmt::format("PRAGMA application_id = {}", results::kApplicationId).c_str());
    }
    transaction.commit();
  }
  if (database.pragma("application_id") != results::kApplicationId)
    refuse("this is another kind of database");
  schema = database.pragma("user_version");
  if (schema >= 1 && schema < results::kSchemaVersion && mode == Mode::write) {
    Transaction transaction(database);
    // Another process may have done it while this one waited.
    schema = database.pragma("user_version");
    if (schema < 2) database.execute(results::kSchema2);
    if (schema < 3) database.execute(results::kSchema3);
    if (schema < 4) database.execute(results::kSchema4);
    if (schema < 5) database.execute(results::kSchema5);
    if (schema < 6) database.execute(results::kSchema6);
    if (schema < 7) database.execute(results::kSchema7);
    if (schema < 8) database.execute(results::kSchema8);
    if (schema < results::kSchemaVersion)
      database.execute(fmt::format("PRAGMA user_version = {}", results::kSchemaVersion).c_str());
    transaction.commit();
    schema = database.pragma("user_version");
  }
  if (schema < 1 || schema > results::kSchemaVersion) refuse(fmt::format("it has schema {}", schema));
  for (const results::NamesOfOlder& names : results::kNamesOfOlder)
    if (schema >= names.since && schema <= names.until) database.execute(names.view);
}

const fs::path& ResultsStore::file() const {
  return state_->database.file();
}

bool ResultsStore::contains(const std::string& key) const {
  Statement statement(state_->database, "SELECT 1 FROM runs WHERE key = ? AND complete");
  return statement.bind(key).step();
}

std::int64_t ResultsStore::State::insertRun(const StoredRun& run, bool complete) {
  const RunIdentity& identity = run.identity;
  Statement insert(
      database,
      fmt::format("INSERT INTO runs ({}) VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)",
                  kColumnsWritten)
          .c_str());
  insert.run(identity.key(), run.created, run.version, run.point.scene, run.sceneName, run.point.pipeline,
             run.pipelineName, run.point.sweep, run.isDefault, identity.camera, identity.time, identity.width,
             identity.height, identity.seed, identity.seeds, identity.repeats, identity.subpixels,
             identity.referenceSamples, identity.device, identity.driver, identity.shaderInput, identity.host,
             run.point.frameworkShare, run.point.failure, run.point.command, complete);
  return database.lastRow();
}

void ResultsStore::State::insertNames(std::int64_t id, const StoredRun& run) {
  Statement parameter(database, "INSERT INTO parameters VALUES (?,?,?)");
  for (const auto& [name, value] : run.identity.parameters) parameter.run(id, name, value);
  Statement provenance(database, "INSERT INTO provenance VALUES (?,?,?,?)");
  provenance.run(id, "scene", run.point.scene, run.identity.sceneHash);
  provenance.run(id, "pipeline", run.point.pipeline, run.identity.pipelineHash);
  provenance.run(id, "framework", "lumivox", run.identity.framework);
  if (run.identity.flickerPairs > 0)
    provenance.run(id, "flicker", fmt::format("{} pairs", run.identity.flickerPairs), "");
  if (!run.point.whyNotCounted.empty()) provenance.run(id, "not_counted", run.point.whyNotCounted, "");
  for (const std::string& output : run.identity.kept) provenance.run(id, "kept", output, "");
  if (!run.identity.display.empty()) provenance.run(id, "display", run.identity.display, "");
  for (const auto& [name, hash] : run.identity.techniques) provenance.run(id, "technique", name, hash);
  Statement health(database, "INSERT INTO health VALUES (?,?,?)");
  int position = 0;
  for (const std::string& finding : run.point.healthFindings) health.run(id, position++, finding);
  Statement note(database, "INSERT INTO notes VALUES (?,?,?)");
  position = 0;
  for (const std::string& text : run.point.notes) note.run(id, position++, text);
}

void ResultsStore::State::insertTimes(std::int64_t id, const ReportPoint& point) {
  Statement timing(database, "INSERT INTO timings VALUES (?,?,?,?,?,?,?,?,?)");
  const auto add = [&](const char* what, const std::string& pass, const TimingStatistics& t) {
    if (t.repeats > 0)
      timing.run(id, what, pass, t.median, t.lowerQuartile, t.upperQuartile, t.smallest, t.largest,
                 t.repeats);
  };
  add(kTimings[0], "", point.frameMs);
  add(kTimings[1], "", point.nextFrameMs);
  add(kTimings[4], "", point.stillFrameMs);
  add(kTimings[5], "", point.movedFrameMs);
  for (const auto& [pass, time] : point.passDeviceMs) add(kTimings[2], pass, time);
  for (const auto& [pass, time] : point.passHostMs) add(kTimings[3], pass, time);
  Statement pass(database, "INSERT INTO passes VALUES (?,?,?)");
  int position = 0;
  for (const std::string& name : point.passOrder) pass.run(id, position++, name);
  Statement resource(database, "INSERT INTO resources VALUES (?,?,?,?)");
  resource.run(id, "peak", "", point.peakBytes);
  for (const auto& [name, bytes] : point.passBytes) resource.run(id, "pass", name, bytes);
}

void ResultsStore::State::insertWork(std::int64_t id, const ReportPoint& point) {
  Statement insert(database, "INSERT INTO work VALUES (?,?,?,?)");
  for (const auto& [pass, work] : point.passWork)
    for (const auto& [name, amount] : work) insert.run(id, pass, name, amount);
}

void ResultsStore::State::insertErrors(std::int64_t id, const ReportPoint& point) {
  Statement insert(database, "INSERT INTO errors VALUES (?,?,?,?,?,?,?,?,?,?)");
  Statement insertMetric(database, "INSERT INTO metrics VALUES (?,?,?,?,?,?)");
  int position = 0;
  for (const ComponentError& error : point.errors) {
    insert.run(id, position, error.output, error.component, error.reference, error.bias ? "bias" : "misses",
               error.seeds, error.deterministic, error.noiseRmse, error.everyMetricPerSeed);
    for (const NamedMetric& metric : metricsOf(error))
      insertMetric.run(id, position, metric.name, metric.measured.value, metric.measured.uncertainty,
                       metric.ofNothing);
    ++position;
  }
}

void ResultsStore::State::insertVoxels(std::int64_t id, const ReportPoint& point) {
  if (!point.voxels) return;
  const GatheredVoxels& v = *point.voxels;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const bool judged = v.whyNot.empty();
  Statement(database, "INSERT INTO voxels VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)")
      .run(id, v.output, v.kind, v.whyNot, v.resolution.x, v.resolution.y, v.resolution.z, v.occupied,
           v.reference, v.undecided, v.error.truePositive, v.error.falsePositive, v.error.falseNegative,
           v.holes.axisCrossings, v.holes.axisHoles, v.holes.obliqueCrossings, v.holes.obliqueHoles,
           judged ? v.error.recall() : kNone, judged ? v.error.precision() : kNone);
}

/// Inside a transaction.
bool ResultsStore::State::add(const StoredRun& run, const std::vector<StoredImage>& images, bool complete) {
  if (complete) Statement(database, "DELETE FROM claims WHERE key = ?").run(run.identity.key());
  // A run keeps its number when its times are there.
  std::optional<std::int64_t> number;
  if (Statement untimed(database, "SELECT id FROM runs WHERE key = ? AND NOT complete");
      untimed.bind(run.identity.key()).step())
    number = untimed.integer(0);
  if (number) Statement(database, "DELETE FROM runs WHERE id = ?").run(*number);
  // A failure may have had causes that are gone; it gives way to a result.
  if (run.point.failure.empty() && complete)
    Statement(database, "DELETE FROM runs WHERE key = ? AND failure <> ''").run(run.identity.key());
  Statement there(database, "SELECT 1 FROM runs WHERE key = ?");
  if (there.bind(run.identity.key()).step()) return false;
  std::int64_t id = insertRun(run, complete);
  if (number) {
    Statement(database, "UPDATE runs SET id = ? WHERE id = ?").run(*number, id);
    id = *number;
  }
  insertNames(id, run);
  insertTimes(id, run.point);
  insertWork(id, run.point);
  insertErrors(id, run.point);
  insertVoxels(id, run.point);
  Statement insert(database, "INSERT INTO images VALUES (?,?,?,?,?,?,?)");
  int position = 0;
  for (const StoredImage& image : images)
    insert.run(id, position++, image.output, image.component, image.reference, image.flip,
               results::Blob{image.png});
  return true;
}

bool ResultsStore::add(const StoredRun& run, const std::vector<StoredImage>& images) {
  Transaction transaction(state_->database);
  const bool added = state_->add(run, images, /*complete=*/true);
  transaction.commit();
  return added;
}

void ResultsStore::addUntimed(const StoredRun& run, const std::vector<StoredImage>& images) {
  Transaction transaction(state_->database);
  state_->add(run, images, /*complete=*/false);
  transaction.commit();
}

std::optional<StoredRun> ResultsStore::findUntimed(const std::string& key) const {
  return state_->find(key, /*complete=*/false);
}

ResultsStore::Count ResultsStore::count() const {
  Statement row(state_->database, "SELECT count(*) FILTER (WHERE complete), count(*) FROM runs");
  row.step();
  const auto complete = static_cast<std::size_t>(row.integer(0)),
             all = static_cast<std::size_t>(row.integer(1));
  return {complete, all - complete};
}

/// Column 0 is the id, then kRunColumns.
StoredRun ResultsStore::State::runAt(const Statement& row) const {
  StoredRun run;
  RunIdentity& identity = run.identity;
  run.id = row.integer(0);
  run.created = row.text(2);
  run.version = row.text(3);
  run.point.scene = row.text(4);
  run.sceneName = row.text(5);
  run.point.pipeline = row.text(6);
  run.pipelineName = row.text(7);
  run.point.sweep = row.text(8);
  run.isDefault = row.integer(9) != 0;
  identity.camera = row.text(10);
  identity.time = row.number(11);
  identity.width = static_cast<int>(row.integer(12));
  identity.height = static_cast<int>(row.integer(13));
  identity.seed = static_cast<std::uint64_t>(row.integer(14));
  identity.seeds = static_cast<int>(row.integer(15));
  identity.repeats = static_cast<int>(row.integer(16));
  identity.subpixels = static_cast<int>(row.integer(17));
  identity.referenceSamples = static_cast<int>(row.integer(18));
  identity.device = row.text(19);
  identity.driver = row.text(20);
  identity.shaderInput = row.text(21);
  identity.host = row.text(22);
  run.point.frameworkShare = row.number(23);
  run.point.failure = row.text(24);
  run.point.command = row.text(25);
  return run;
}

void ResultsStore::State::readNames(StoredRun& run) const {
  Statement parameter(database, "SELECT name, value FROM parameters WHERE run = ?");
  for (parameter.bind(run.id); parameter.step();) {
    run.identity.parameters[parameter.text(0)] = parameter.text(1);
    run.point.parameters[parameter.text(0)] = valueOf(parameter.text(1));
  }
  Statement provenance(database, "SELECT kind, name, hash FROM provenance WHERE run = ?");
  for (provenance.bind(run.id); provenance.step();) {
    const std::string kind = provenance.text(0), hash = provenance.text(2);
    if (kind == "flicker") run.identity.flickerPairs = std::atoi(provenance.text(1).c_str());
    if (kind == "not_counted") run.point.whyNotCounted = provenance.text(1);
    if (kind == "kept") run.identity.kept.push_back(provenance.text(1));
    if (kind == "display") run.identity.display = provenance.text(1);
    if (kind == "scene") run.identity.sceneHash = hash;
    if (kind == "pipeline") run.identity.pipelineHash = hash;
    if (kind == "framework") run.identity.framework = hash;
    if (kind == "technique") run.identity.techniques[provenance.text(1)] = hash;
  }
  Statement health(database, "SELECT finding FROM health WHERE run = ? ORDER BY position");
  for (health.bind(run.id); health.step();) run.point.healthFindings.push_back(health.text(0));
  if (schema < 4) return;
  Statement note(database, "SELECT note FROM notes WHERE run = ? ORDER BY position");
  for (note.bind(run.id); note.step();) run.point.notes.push_back(note.text(0));
}

void ResultsStore::State::readTimes(StoredRun& run) const {
  ReportPoint& point = run.point;
  Statement timing(database, "SELECT * FROM timings WHERE run = ?");
  for (timing.bind(run.id); timing.step();) {
    const TimingStatistics time{timing.number(3), timing.number(4), timing.number(5),
                                timing.number(6), timing.number(7), static_cast<int>(timing.integer(8))};
    const std::string what = timing.text(1), pass = timing.text(2);
    if (what == kTimings[0]) point.frameMs = time;
    if (what == kTimings[1]) point.nextFrameMs = time;
    if (what == kTimings[2]) point.passDeviceMs[pass] = time;
    if (what == kTimings[3]) point.passHostMs[pass] = time;
    if (what == kTimings[4]) point.stillFrameMs = time;
    if (what == kTimings[5]) point.movedFrameMs = time;
  }
  Statement pass(database, "SELECT name FROM passes WHERE run = ? ORDER BY position");
  for (pass.bind(run.id); pass.step();) point.passOrder.push_back(pass.text(0));
  Statement resource(database, "SELECT what, pass, bytes FROM resources WHERE run = ?");
  for (resource.bind(run.id); resource.step();) {
    const auto bytes = static_cast<std::uint64_t>(resource.integer(2));
    if (resource.text(0) == "peak")
      point.peakBytes = bytes;
    else
      point.passBytes[resource.text(1)] = bytes;
  }
}

void ResultsStore::State::readWork(StoredRun& run) const {
  if (schema < 3) return;
  Statement work(database, "SELECT pass, name, amount FROM work WHERE run = ?");
  for (work.bind(run.id); work.step();) run.point.passWork[work.text(0)][work.text(1)] = work.number(2);
}

void ResultsStore::State::readErrors(StoredRun& run) const {
  Statement row(database, "SELECT * FROM errors WHERE run = ? ORDER BY position");
  Statement metric(database,
                   "SELECT name, value, uncertainty, of_nothing FROM metrics WHERE run = ? AND position = ? "
                   "ORDER BY name");
  for (row.bind(run.id); row.step();) {
    ComponentError error;
    error.output = row.text(2);
    error.component = row.text(3);
    error.reference = row.text(4);
    error.bias = row.text(5) == "bias";
    error.seeds = static_cast<int>(row.integer(6));
    error.deterministic = row.integer(7) != 0;
    error.noiseRmse = row.number(8);
    error.everyMetricPerSeed = schema >= 4 && row.integer(9) != 0;
    // A metric of a later version is passed over.
    for (metric.bind(run.id, row.integer(1)); metric.step();)
      setMetric(error, {metric.text(0), {metric.number(1), metric.number(2)}, metric.number(3)});
    run.point.errors.push_back(std::move(error));
  }
}

void ResultsStore::State::readVoxels(StoredRun& run) const {
  if (schema < 7) return;
  Statement row(database,
                "SELECT output, kind, why_not, width, height, depth, occupied, reference, undecided, "
                "true_positive, false_positive, false_negative, axis_crossings, axis_holes, "
                "oblique_crossings, oblique_holes FROM voxels WHERE run = ?");
  if (!row.bind(run.id).step()) return;
  const auto count = [&](int column) { return static_cast<std::uint64_t>(row.integer(column)); };
  GatheredVoxels v;
  v.output = row.text(0);
  v.kind = row.text(1);
  v.whyNot = row.text(2);
  for (int axis = 0; axis < 3; ++axis) v.resolution[axis] = static_cast<int>(row.integer(3 + axis));
  v.occupied = count(6);
  v.reference = count(7);
  v.undecided = count(8);
  v.error = {count(9), count(10), count(11)};
  v.holes = {count(12), count(13), count(14), count(15)};
  run.point.voxels = std::move(v);
}

void ResultsStore::State::readAll(StoredRun& run) const {
  readTimes(run);
  readWork(run);
  readErrors(run);
  readVoxels(run);
}

std::optional<StoredRun> ResultsStore::State::find(const std::string& key, bool complete) const {
  Statement row(database,
                fmt::format("SELECT id, {} FROM runs WHERE key = ? AND complete = ?", kRunColumns).c_str());
  if (!row.bind(key, complete).step()) return std::nullopt;
  StoredRun run = runAt(row);
  readNames(run);
  readAll(run);
  return run;
}

std::optional<StoredRun> ResultsStore::find(const std::string& key) const {
  return state_->find(key, /*complete=*/true);
}

std::vector<StoredRun> ResultsStore::State::runs(const RunFilter& filter, bool complete) const {
  std::vector<StoredRun> result;
  Statement row(database,
                fmt::format("SELECT id, {} FROM runs WHERE complete = ? ORDER BY id", kRunColumns).c_str());
  for (row.bind(complete); row.step();) {
    StoredRun run = runAt(row);
    readNames(run);
    if (!matches(filter, run)) continue;
    readAll(run);
    result.push_back(std::move(run));
  }
  return result;
}

std::vector<StoredRun> ResultsStore::runs(const RunFilter& filter) const {
  return state_->runs(filter, /*complete=*/true);
}

std::vector<StoredImage> ResultsStore::images(const std::string& key) const {
  std::vector<StoredImage> images;
  if (state_->schema < 4) return images;
  Statement row(
      state_->database,
      "SELECT p.output, p.component, p.reference, p.flip, p.png FROM images p JOIN runs r ON r.id = p.run "
      "WHERE r.key = ? ORDER BY p.position");
  for (row.bind(key); row.step();)
    images.push_back({row.text(0), row.text(1), row.text(2), row.number(3), row.bytes(4)});
  return images;
}

std::size_t ResultsStore::remove(const RunFilter& filter) {
  const std::vector<StoredRun> chosen = runs(filter);
  Transaction transaction(state_->database);
  Statement statement(state_->database, "DELETE FROM runs WHERE id = ?");
  for (const StoredRun& run : chosen) statement.run(run.id);
  for (const StoredRun& run : state_->runs(filter, /*complete=*/false)) statement.run(run.id);
  transaction.commit();
  return chosen.size();
}

MergeCount ResultsStore::merge(const ResultsStore& other) {
  return mergeRuns(other, other.runs());
}

MergeCount ResultsStore::merge(const ResultsStore& other, const std::vector<std::string>& keys) {
  std::vector<StoredRun> theirs = other.runs();
  std::erase_if(theirs, [&](const StoredRun& run) {
    return std::find(keys.begin(), keys.end(), run.identity.key()) == keys.end();
  });
  return mergeRuns(other, theirs);
}

MergeCount ResultsStore::mergeRuns(const ResultsStore& other, const std::vector<StoredRun>& theirs) {
  const std::vector<StressCell> theirCells = other.stressCells();
  const std::vector<PeakRate> theirPeakRates = other.peakRates();
  Transaction transaction(state_->database);
  MergeCount count;
  for (const StoredRun& run : theirs)
    count.runs += state_->add(run, other.images(run.identity.key()), /*complete=*/true) ? 1 : 0;
  std::map<std::string, std::string> created;
  for (const StressCell& cell : stressCells()) created[cell.key()] = cell.created;
  std::vector<StressCell> cells;
  for (const StressCell& cell : theirCells)
    if (created[cell.key()] < cell.created) cells.push_back(cell);
  state_->addCells(cells);
  count.cells = cells.size();
  const auto identity = [](const PeakRate& peakRate) {
    return std::tie(peakRate.device, peakRate.driver, peakRate.shaderInput, peakRate.host, peakRate.name);
  };
  const std::vector<PeakRate> mine = peakRates();
  std::vector<PeakRate> newer;
  for (const PeakRate& peakRate : theirPeakRates)
    if (std::none_of(mine.begin(), mine.end(), [&](const PeakRate& one) {
          return identity(one) == identity(peakRate) && one.created >= peakRate.created;
        }))
      newer.push_back(peakRate);
  state_->addPeakRates(newer);
  count.peakRates = newer.size();
  state_->addControls(*other.state_);
  transaction.commit();
  return count;
}

fs::path ResultsStore::defaultFile() {
  const char* given = std::getenv("LUMIVOX_RESULTS");
  return given != nullptr && *given != '\0' ? fs::path(given) : cacheDirectory() / "results.sqlite";
}

}  // namespace lumivox
