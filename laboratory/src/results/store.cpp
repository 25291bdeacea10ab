// The results store on SQLite. Each run is one transaction, so that a killed process leaves all of it or
// nothing.
#include "lumivox/results/store.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "results/database.h"
#include "results/earlier_store.h"
#include "results/record_rows.h"
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

/// The value of a setting's text.
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

/// Reads complete runs one by one.
class RunReader {
 public:
  RunReader(const results::Database& database, const std::string& where)
      : rows(database,
             fmt::format("SELECT id, {} FROM runs WHERE {}", results::columnNames<StoredRun>(), where)),
        metrics_(database, fmt::format("SELECT position, name, {} FROM metrics WHERE run = ?",
                                       results::columnNames<NamedMetric>())) {}
  std::optional<StoredRun> next() {
    if (!rows.step()) return std::nullopt;
    auto run = results::recordAt<StoredRun>(rows, 1);
    run.id = rows.integer(0);
    for (const auto& [name, text] : run.identity.parameters) run.point.parameters[name] = valueOf(text);
    for (metrics_.bind(run.id); metrics_.step();) {
      auto metric = results::recordAt<NamedMetric>(metrics_, 2);
      metric.name = metrics_.text(1);
      setMetric(run.point.errors.at(static_cast<std::size_t>(metrics_.integer(0))), metric);
    }
    return run;
  }

  Statement rows;  ///< to be bound

 private:
  Statement metrics_;
};

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

ResultsStore::ResultsStore(std::unique_ptr<State> state) : state_(std::move(state)) {}
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
    // Another process may have created it meanwhile.
    if (isEmpty()) {
      database.execute(results::schemaSql());
      database.execute(fmt::format("PRAGMA user_version = {}", results::kSchemaVersion));
      database.execute(fmt::format("PRAGMA application_id = {}", results::kApplicationId));
    }
    transaction.commit();
  }
  const std::string file = database.file().string();
  if (database.pragma("application_id") != results::kApplicationId)
    throw Error(fmt::format("{}: this is another kind of database; expected a results store", file));
  const std::int64_t schema = database.pragma("user_version");
  if (schema >= 1 && schema < results::kSchemaVersion)
    throw Error(fmt::format(
        "{}: an earlier version wrote it, with schema {}; lumivox results import {} --store NEW copies "
        "what it holds into a store of this version",
        file, schema, file));
  if (schema != results::kSchemaVersion)
    throw Error(fmt::format("{}: it has schema {}; expected a results store with schema {}", file, schema,
                            results::kSchemaVersion));
  addNewFields();
}

/// Adds columns for fields that the version which made the store did not have, and renews the views.
void ResultsStore::State::addNewFields() {
  std::map<std::string, std::string> present;
  Statement row(database, "SELECT name, sql FROM sqlite_schema");
  while (row.step()) present[row.text(0)] = row.text(1);
  for (const results::Table& table : results::storeTables()) {
    if (present[table.name] == table.sql()) continue;
    const bool isView = table.options == nullptr;
    const auto lacking = [&] {
      std::vector<const results::Column*> columns;
      Statement there(database, "SELECT 1 FROM pragma_table_info(?) WHERE name = ?");
      for (const results::Column& column : table.columns)
        if (!isView && !there.bind(table.name, column.name).step()) columns.push_back(&column);
      return columns;
    };
    if (!isView && lacking().empty()) continue;
    if (mode == Mode::read) {
      if (!isView) results::show(database, table.name, {fmt::format("main.{} r", table.name), {}});
      continue;
    }
    Transaction transaction(database);
    if (isView) database.execute(fmt::format("DROP VIEW IF EXISTS {}; {}", table.name, table.sql()));
    // Another process may have added them while this one waited.
    for (const results::Column* column : lacking())
      database.execute(
          fmt::format("ALTER TABLE {} ADD COLUMN {} {}", table.name, column->name, column->definition));
    transaction.commit();
  }
}

const fs::path& ResultsStore::file() const {
  return state_->database.file();
}

bool ResultsStore::contains(const std::string& key) const {
  Statement statement(state_->database, "SELECT 1 FROM runs WHERE key = ? AND complete");
  return statement.bind(key).step();
}

bool ResultsStore::State::add(const StoredRun& run, const std::vector<StoredImage>& images, bool complete) {
  const std::string key = run.identity.key();
  if (complete) Statement(database, "DELETE FROM claims WHERE key = ?").run(key);
  // A run keeps its number when its times are added.
  Statement untimed(database, "SELECT id FROM runs WHERE key = ? AND NOT complete");
  const bool known = untimed.bind(key).step();
  const std::int64_t number = known ? untimed.integer(0) : 0;
  untimed.reset();
  if (known) Statement(database, "DELETE FROM runs WHERE id = ?").run(number);
  // A result replaces a failure, whose cause may be gone.
  if (run.point.failure.empty() && complete)
    Statement(database, "DELETE FROM runs WHERE key = ? AND failure <> ''").run(key);
  Statement row(database, results::insertSql<StoredRun>("runs", "id, key, complete"));
  row.bindJson(1, known ? results::Json(number) : results::Json());
  row.bindOne(2, key);
  row.bindOne(3, complete);
  results::bindRecord(row, 4, run);
  row.run();
  if (database.changes() == 0) return false;
  const std::int64_t id = database.lastRow();
  Statement metric(database, results::insertSql<NamedMetric>("metrics", "run, position, name"));
  for (std::size_t position = 0; position < run.point.errors.size(); ++position)
    for (const NamedMetric& one : metricsOf(run.point.errors[position])) {
      metric.bind(id, position, one.name);
      results::bindRecord(metric, 4, one);
      metric.run();
    }
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

std::optional<bool> ResultsStore::succeeded(const std::string& key) const {
  Statement statement(state_->database, "SELECT failure = '' FROM runs WHERE key = ? AND complete");
  if (!statement.bind(key).step()) return std::nullopt;
  return statement.integer(0) != 0;
}

void ResultsStore::forEachMeasured(const std::function<void(const RunIdentity&, const std::string&,
                                                            const std::string&, double)>& visit) const {
  Statement row(
      state_->database,
      fmt::format("SELECT scene, pipeline, measuring_seconds, {} FROM runs WHERE complete AND failure = ''",
                  results::columnNames<RunIdentity>()));
  while (row.step()) visit(results::recordAt<RunIdentity>(row, 3), row.text(0), row.text(1), row.number(2));
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
  RunReader reader(database, "key = ? AND complete = ?");
  reader.rows.bind(key, complete);
  return reader.next();
}

std::optional<StoredRun> ResultsStore::find(const std::string& key) const {
  return state_->find(key, /*complete=*/true);
}

std::vector<StoredRun> ResultsStore::State::runs(const RunFilter& filter, bool complete) const {
  std::vector<StoredRun> result;
  // Non-matching rows are not read.
  RunReader reader(database,
                   "complete = ? AND (scene_name = ? OR instr(scene, ?)) AND (pipeline_name = ? OR "
                   "instr(pipeline, ?)) AND instr(device, ?) AND created >= ? ORDER BY id");
  reader.rows.bind(complete, filter.scene, filter.scene, filter.pipeline, filter.pipeline, filter.device,
                   filter.since);
  while (std::optional<StoredRun> run = reader.next())
    if (matches(filter, *run)) result.push_back(std::move(*run));
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

std::string ResultsStore::describe() {
  return results::schemaMarkdown();
}

fs::path ResultsStore::defaultFile() {
  const char* given = std::getenv("LUMIVOX_RESULTS");
  return given != nullptr && *given != '\0' ? fs::path(given) : cacheDirectory() / "results.sqlite";
}

}  // namespace lumivox
