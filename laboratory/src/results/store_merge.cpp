// Takes over the contents of other results stores.
#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <unordered_map>

#include "lumivox/base/error.h"
#include "lumivox/results/json.h"
#include "results/earlier_store.h"
#include "results/record_rows.h"
#include "results/row_stream.h"
#include "results/store_state.h"

namespace lumivox {

using results::Statement;
using results::Transaction;

namespace {

namespace fs = std::filesystem;

/// A run, by what decides which of two with one key stays.
struct Candidate {
  std::string created, key;
  std::int64_t id = 0;
  bool failed = false;
};

/// All columns of a run but its number, as one text.
std::string contentOf(const results::Database& database, std::int64_t id) {
  Statement row(database, fmt::format("SELECT {} FROM runs WHERE id = ?", results::columnNames<StoredRun>()));
  if (!row.bind(id).step()) return {};
  return textOf(results::jsonOf(results::recordAt<StoredRun>(row, 0)), -1);
}

/// Copies rows as they are, values unread. The first column is one of the copy's own.
class RowCopy {
 public:
  RowCopy(const results::Database& from, const results::Database& to, const std::string& table,
          const std::string& first, const std::string& columns, const std::string& where)
      : columns_(1 + static_cast<int>(std::count(columns.begin(), columns.end(), ','))),
        rows(from, fmt::format("SELECT {}, {} FROM {} {}", first, columns, table, where)),
        insert_(to, fmt::format("INSERT OR IGNORE INTO {} ({}, {}) VALUES (?{})", table, first, columns,
                                commas(columns_))) {}
  /// Copies the present row.
  template <class First>
  void copy(const First& first) {
    insert_.bindOne(1, first);
    for (int column = 1; column <= columns_; ++column) insert_.bindColumn(column + 1, rows, column);
    insert_.run();
  }

 private:
  static std::string commas(int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += ",?";
    return text;
  }
  int columns_;

 public:
  Statement rows;  ///< to be bound

 private:
  Statement insert_;
};

/// Rows of a table of runs, with the numbers that the runs have elsewhere.
class RowsOfRuns : public results::RowStream {
 public:
  RowsOfRuns(const results::Database& from, const std::string& table, const std::string& columns,
             const std::unordered_map<std::int64_t, std::int64_t>& numbers)
      : numbers_(numbers),
        rows_(from, fmt::format("SELECT run, {} FROM {} ORDER BY run, position", columns, table)) {}
  bool next() override {
    while (rows_.step())
      if (const auto found = numbers_.find(rows_.integer(0)); found != numbers_.end()) {
        run_ = found->second;
        return true;
      }
    return false;
  }
  void giveColumn(sqlite3_context* to, int column) override {
    if (column == 0)
      sqlite3_result_int64(to, run_);
    else
      rows_.giveColumn(to, column);
  }

 private:
  const std::unordered_map<std::int64_t, std::int64_t>& numbers_;
  Statement rows_;
  std::int64_t run_ = 0;
};

/// Copies the rows of a table of runs that belong to these runs, by their old and new numbers.
void copyOfRuns(const results::Database& from, const results::Database& to, const std::string& table,
                const std::string& columns, const std::unordered_map<std::int64_t, std::int64_t>& numbers) {
  if (numbers.empty()) return;
  RowsOfRuns rows(from, table, columns, numbers);
  results::Incoming(to, 2 + static_cast<int>(std::count(columns.begin(), columns.end(), ',')))
      .insert(table, "run, " + columns, rows);
}

std::vector<Candidate> candidatesOf(const results::Database& database,
                                    const std::function<bool(const std::string&)>& isWanted) {
  std::vector<Candidate> candidates;
  Statement row(database, "SELECT created, key, id, failure <> '' FROM runs WHERE complete");
  while (row.step())
    if (std::string key = row.text(1); isWanted(key))
      candidates.push_back({row.text(0), std::move(key), row.integer(2), row.integer(3) != 0});
  // The order decides the numbers in the store that takes them over.
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.created, a.key) < std::tie(b.created, b.key);
  });
  return candidates;
}

}  // namespace

MergeCount ResultsStore::mergeRows(const ResultsStore& other,
                                   const std::function<bool(const std::string&)>& isWanted) {
  const results::Database &from = other.state_->database, &to = state_->database;
  // One look at the file: it is locked, and its changes are looked for, once.
  const Transaction reading(from, Transaction::For::reading);
  Statement known(to, "SELECT created, id, failure <> '', complete FROM runs WHERE key = ?");
  // With what belongs to the run: whoever merges many stores checks no references.
  std::vector<Statement> removals;
  for (const char* where : {"metrics WHERE run", "images WHERE run", "controls WHERE run", "runs WHERE id"})
    removals.emplace_back(to, fmt::format("DELETE FROM {} = ?", where));
  RowCopy runs(from, to, "runs", "id", "key, complete, " + results::columnNames<StoredRun>(), "WHERE id = ?");
  MergeCount count;
  std::unordered_map<std::int64_t, std::int64_t> numbers;
  for (const Candidate& theirs : candidatesOf(from, isWanted)) {
    std::vector<std::pair<std::string, results::Control>> controls;
    if (known.bind(theirs.key).step()) {
      const auto rank = [](bool failed, const std::string& created) { return std::pair(failed, created); };
      const auto own = rank(known.integer(2) != 0, known.text(0)),
                 their = rank(theirs.failed, theirs.created);
      const std::int64_t id = known.integer(1);
      const bool complete = known.integer(3) != 0;
      known.reset();
      if (complete && (own < their || (own == their && contentOf(to, id) <= contentOf(from, theirs.id))))
        continue;
      // Times that were measured twice belong to the point, whichever run of it stays.
      controls = state_->controls(theirs.key);
      for (Statement& removal : removals) removal.run(id);
    }
    known.reset();
    runs.rows.bind(theirs.id).step();
    runs.copy(nullptr);
    numbers[theirs.id] = to.lastRow();
    for (const auto& [key, control] : controls) state_->add(key, control);
    ++count.runs;
  }
  copyOfRuns(from, to, "metrics", "position, name, " + results::columnNames<NamedMetric>(), numbers);
  copyOfRuns(from, to, "images", "position, output, component, reference, flip, png", numbers);
  count.cells = state_->put("stress_cells", other.stressCells(), /*olderAlone=*/true);
  count.peakRates = state_->put("peak_rates", other.peakRates(), /*olderAlone=*/true);
  for (const auto& [key, control] : other.state_->controls()) state_->add(key, control);
  std::error_code ignored;
  Statement(
      to,
      "DELETE FROM claims WHERE command = ? OR EXISTS (SELECT 1 FROM runs r WHERE r.key = claims.key AND "
      "complete) OR key IN (SELECT key FROM stress_cells)")
      .run(fs::absolute(other.file(), ignored).string());
  return count;
}

MergeCount ResultsStore::merge(const ResultsStore& other) {
  Transaction transaction(state_->database);
  const MergeCount count = mergeRows(other, [](const std::string&) { return true; });
  transaction.commit();
  return count;
}

MergeCount ResultsStore::merge(const ResultsStore& other, const std::vector<std::string>& keys) {
  const std::set<std::string> wanted(keys.begin(), keys.end());
  Transaction transaction(state_->database);
  const MergeCount count = mergeRows(other, [&](const std::string& key) { return wanted.count(key) > 0; });
  transaction.commit();
  return count;
}

std::map<std::string, std::set<std::string>> ResultsStore::versions() const {
  std::map<std::string, std::set<std::string>> versions;
  for (const char* table : {"runs WHERE complete", "stress_cells"}) {
    Statement row(state_->database,
                  fmt::format("SELECT DISTINCT version, framework, techniques FROM {}", table));
    while (row.step()) {
      versions["lumivox"].insert(fmt::format("{}, libraries {}", row.text(0), row.text(1)));
      const results::Json techniques = results::Json::parse(row.text(2), nullptr, /*allow_exceptions=*/false);
      for (const auto& [name, hash] : techniques.items())
        versions["technique " + name].insert(hash.is_string() ? hash.get<std::string>() : hash.dump());
    }
  }
  return versions;
}

namespace {

/// Refuses a second version of anything that made results; remembers the first, with its file.
class OneVersion {
 public:
  void require(const ResultsStore& store) {
    const std::string file = store.file().string();
    for (const auto& [what, versions] : store.versions())
      for (const std::string& version : versions) {
        const auto [known, isNew] = known_.try_emplace(what, version, file);
        if (isNew || known->second.first == version) continue;
        throw Error(fmt::format(
            "{}: holds results of {} {}, and {} of {}; expected one version, as times and errors of different "
            "ones do not belong together; --mixed merges them all the same",
            file, what, version, known->second.second, known->second.first));
      }
  }

 private:
  std::map<std::string, std::pair<std::string, std::string>> known_;  ///< version and file
};

}  // namespace

namespace {

/// While it lives, SQLite checks no references between rows.
class WithoutReferences {
 public:
  explicit WithoutReferences(const results::Database& database) : database_(database) {
    database.execute("PRAGMA foreign_keys = OFF");
  }
  ~WithoutReferences() {
    sqlite3_exec(database_.handle(), "PRAGMA foreign_keys = ON", nullptr, nullptr, nullptr);
  }
  WithoutReferences(const WithoutReferences&) = delete;
  WithoutReferences& operator=(const WithoutReferences&) = delete;

 private:
  const results::Database& database_;
};

}  // namespace

std::vector<MergeCount> ResultsStore::merge(const std::vector<fs::path>& files, bool mixed) {
  // Each store is opened when its turn comes: there may be more of them than a process may open files.
  OneVersion one;
  if (!mixed) one.require(*this);
  using First = std::tuple<std::string, std::string, std::size_t>;
  std::vector<First> order;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const ResultsStore store(files[i], Mode::read);
    if (!mixed) one.require(store);
    Statement first(store.state_->database,
                    "SELECT created, key FROM runs WHERE complete ORDER BY created, key LIMIT 1");
    const bool any = first.step();
    order.emplace_back(any ? first.text(0) : "", any ? first.text(1) : "", i);
  }
  std::sort(order.begin(), order.end());
  constexpr int kCacheKiB = 256 << 10;  // the index of the keys stays in memory
  state_->database.execute(fmt::format("PRAGMA cache_size = -{}", kCacheKiB));
  std::vector<MergeCount> counts(files.size());
  // Each row that is copied has its run; looking it up for each would take half of the time.
  const WithoutReferences unchecked(state_->database);
  Transaction transaction(state_->database);
  for (const auto& [created, key, i] : order) {
    std::error_code failure;
    if (fs::equivalent(files[i], file(), failure)) continue;
    counts[i] = mergeRows(ResultsStore(files[i], Mode::read), [](const std::string&) { return true; });
  }
  transaction.commit();
  return counts;
}

MergeCount ResultsStore::import(const fs::path& file) {
  const ResultsStore earlier(std::make_unique<State>(file, Mode::read));
  results::showEarlierStore(earlier.state_->database);
  // They are read before this store is locked.
  const std::vector<StoredRun> theirs = earlier.runs();
  const std::vector<StressCell> cells = earlier.stressCells();
  const std::vector<PeakRate> peakRates = earlier.peakRates();
  const auto controls = earlier.state_->controls();
  Transaction transaction(state_->database);
  MergeCount count;
  for (const StoredRun& run : theirs) {
    const std::string key = run.identity.key();
    if (succeeded(key).value_or(false)) continue;
    count.runs += state_->add(run, earlier.images(key), /*complete=*/true) ? 1 : 0;
  }
  count.cells = state_->put("stress_cells", cells, /*olderAlone=*/true);
  count.peakRates = state_->put("peak_rates", peakRates, /*olderAlone=*/true);
  for (const auto& [key, control] : controls) state_->add(key, control);
  transaction.commit();
  return count;
}

}  // namespace lumivox
