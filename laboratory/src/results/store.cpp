// The results store on SQLite. One transaction per run: a process that dies leaves all of it or nothing.
#include "lumivox/results/store.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <set>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "results/database.h"
#include "results/earlier_store.h"
#include "results/field_json.h"
#include "results/store_schema.h"
#include "results/store_state.h"

namespace lumivox {

using results::Statement;
using results::Transaction;

namespace {

namespace fs = std::filesystem;

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

StoredRun runFrom(std::int64_t id, const std::string& json) {
  auto run = results::recordFrom<StoredRun>(json);
  run.id = id;
  for (const auto& [name, text] : run.identity.parameters) run.point.parameters[name] = valueOf(text);
  return run;
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
  const auto isEmpty = [&] {
    Statement any(database, "SELECT count(*) FROM sqlite_schema");
    return any.step() && any.integer(0) == 0;
  };
  if (mode == Mode::write && isEmpty()) {
    Transaction transaction(database);
    // Another process may have made it while this one waited.
    if (isEmpty()) {
      database.execute(results::schemaSql().c_str());
      database.execute(fmt::format("PRAGMA user_version = {}", results::kSchemaVersion).c_str());
      database.execute(fmt::format("PRAGMA application_id = {}", results::kApplicationId).c_str());
    }
    transaction.commit();
  }
  const std::string file = database.file().string();
  if (database.pragma("application_id") != results::kApplicationId)
    throw Error(fmt::format("{}: this is another kind of database; expected a results store", file));
  const std::int64_t schema = database.pragma("user_version");
  if (schema >= 1 && schema <= results::kLastEarlierSchema)
    throw Error(fmt::format(
        "{}: an earlier version wrote it, with schema {}; lumivox results import {} --store NEW copies "
        "what it holds into a store of this version",
        file, schema, file));
  if (schema != results::kSchemaVersion)
    throw Error(fmt::format("{}: it has schema {}; expected a results store with schema {}", file, schema,
                            results::kSchemaVersion));
}

const fs::path& ResultsStore::file() const {
  return state_->database.file();
}

bool ResultsStore::contains(const std::string& key) const {
  Statement statement(state_->database, "SELECT 1 FROM runs WHERE key = ? AND complete");
  return statement.bind(key).step();
}

/// Inside a transaction.
bool ResultsStore::State::add(const RunRecord& run, const std::vector<StoredImage>& images) {
  if (run.complete) Statement(database, "DELETE FROM claims WHERE key = ?").run(run.key);
  // A run keeps its number when its times are there.
  Statement untimed(database, "SELECT id FROM runs WHERE key = ? AND NOT complete");
  const bool known = untimed.bind(run.key).step();
  const std::int64_t number = known ? untimed.integer(0) : 0;
  untimed.reset();
  if (known) Statement(database, "DELETE FROM runs WHERE id = ?").run(number);
  // A failure may have had causes that are gone; it gives way to a result.
  if (!run.failed && run.complete)
    Statement(database, "DELETE FROM runs WHERE key = ? AND failure <> ''").run(run.key);
  Statement(database, "INSERT OR IGNORE INTO runs (id, key, complete, record) VALUES (nullif(?, 0), ?, ?, ?)")
      .run(number, run.key, run.complete, run.json);
  if (database.changes() == 0) return false;
  const std::int64_t id = database.lastRow();
  Statement insert(database, "INSERT INTO images VALUES (?,?,?,?,?,?,?)");
  int position = 0;
  for (const StoredImage& image : images)
    insert.run(id, position++, image.output, image.component, image.reference, image.flip,
               results::Blob{image.png});
  return true;
}

bool ResultsStore::State::add(const StoredRun& run, const std::vector<StoredImage>& images, bool complete) {
  return add({run.identity.key(), results::recordText(run), !run.point.failure.empty(), complete}, images);
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

std::optional<StoredRun> ResultsStore::State::find(const std::string& key, bool complete) const {
  Statement row(database, "SELECT id, record FROM runs WHERE key = ? AND complete = ?");
  if (!row.bind(key, complete).step()) return std::nullopt;
  return runFrom(row.integer(0), row.text(1));
}

std::optional<StoredRun> ResultsStore::find(const std::string& key) const {
  return state_->find(key, /*complete=*/true);
}

std::vector<StoredRun> ResultsStore::State::runs(const RunFilter& filter, bool complete) const {
  std::vector<StoredRun> result;
  Statement row(database, "SELECT id, record FROM runs WHERE complete = ? ORDER BY id");
  for (row.bind(complete); row.step();)
    if (StoredRun run = runFrom(row.integer(0), row.text(1)); matches(filter, run))
      result.push_back(std::move(run));
  return result;
}

std::vector<StoredRun> ResultsStore::runs(const RunFilter& filter) const {
  return state_->runs(filter, /*complete=*/true);
}

std::vector<StoredImage> ResultsStore::images(const std::string& key) const {
  std::vector<StoredImage> images;
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
  return merge(other, [](const std::string&) { return true; });
}

MergeCount ResultsStore::merge(const ResultsStore& other, const std::vector<std::string>& keys) {
  const std::set<std::string> wanted(keys.begin(), keys.end());
  return merge(other, [&](const std::string& key) { return wanted.count(key) > 0; });
}

MergeCount ResultsStore::merge(const ResultsStore& other,
                               const std::function<bool(const std::string&)>& isWanted) {
  // The other store is read before this one is locked.
  std::vector<State::RunRecord> theirs;
  Statement row(other.state_->database,
                "SELECT key, record, failure <> '' FROM runs WHERE complete ORDER BY id");
  while (row.step())
    if (isWanted(row.text(0))) theirs.push_back({row.text(0), row.text(1), row.integer(2) != 0});
  const std::vector<results::Record> cells = other.state_->records("stress_cells"),
                                     peakRates = other.state_->records("peak_rates");
  const auto controls = other.state_->controls();
  Transaction transaction(state_->database);
  MergeCount count;
  for (const State::RunRecord& run : theirs) count.runs += state_->add(run, other.images(run.key)) ? 1 : 0;
  count.cells = state_->putNewer("stress_cells", cells);
  count.peakRates = state_->putNewer("peak_rates", peakRates);
  for (const auto& [key, control] : controls) state_->add(key, control);
  transaction.commit();
  return count;
}

MergeCount ResultsStore::import(const fs::path& file) {
  const results::EarlierStore earlier(file);
  Transaction transaction(state_->database);
  MergeCount count;
  for (const results::EarlierStore::Run& run : earlier.runs()) {
    count.runs += state_->add(run.run, run.images, /*complete=*/true) ? 1 : 0;
    for (const results::Control& control : run.controls) state_->add(run.run.identity.key(), control);
  }
  count.cells = state_->putNewer("stress_cells", results::records(earlier.cells()));
  count.peakRates = state_->putNewer("peak_rates", results::records(earlier.peakRates()));
  transaction.commit();
  return count;
}

std::string ResultsStore::describe() {
  return results::schemaMarkdown();
}

fs::path ResultsStore::defaultFile() {
  const char* given = std::getenv("LUMIVOX_RESULTS");
  return given != nullptr && *given != '\0' ? fs::path(given) : cacheDirectory() / "results.sqlite";
}

}  // namespace lumivox
