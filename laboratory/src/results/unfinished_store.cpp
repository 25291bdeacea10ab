#include "results/unfinished_store.h"

#include <algorithm>

#include "base/process.h"
#include "lumivox/base/hash.h"
#include "lumivox/base/log.h"
#include "results/store_state.h"

namespace lumivox::results {

struct UnfinishedStore::Report {
  std::int64_t id = 0;
  std::string points;
  RunClaim claim;  ///< of the process; its command line identifies the report
};

UnfinishedStore::UnfinishedStore(const std::filesystem::path& file, const std::string& command)
    : command_(command) {
  // Another report may end and remove the file after it was opened here but before this one has joined.
  do store_.emplace(file);
  while (!join());
}

UnfinishedStore::~UnfinishedStore() {
  if (left_) return;
  try {
    leave(/*finished=*/false);
  } catch (const std::exception& error) {
    logWarning("{}", error.what());
  }
}

const Database& UnfinishedStore::database() const {
  return store_->state_->database;
}

bool UnfinishedStore::join() {
  Transaction transaction(database());
  // Files are removed under the same lock, so this file stays.
  if (database().isMoved()) return false;
  const RunClaim own = ownClaim();
  Statement(
      database(),
      "INSERT INTO reports (points, command, machine, process, started, expires) VALUES ('', ?, ?, ?, ?, ?)")
      .run(command_, own.machine, own.process, own.started, own.expires);
  report_ = database().lastRow();
  transaction.commit();
  return true;
}

void UnfinishedStore::want(const std::vector<std::string>& keys) {
  wanted_.insert(wanted_.end(), keys.begin(), keys.end());
  std::sort(wanted_.begin(), wanted_.end());
  wanted_.erase(std::unique(wanted_.begin(), wanted_.end()), wanted_.end());
  Hasher hasher;
  for (const std::string& key : wanted_) hasher.add(key);
  points_ = hasher.finish().text();
  Transaction transaction(database());
  Statement insert(database(), "INSERT OR IGNORE INTO wanted VALUES (?, ?)");
  for (const std::string& key : wanted_) insert.run(report_, key);
  Statement(database(), "UPDATE reports SET points = ? WHERE id = ?").run(points_, report_);
  // The same report continues: its earlier measurements with other versions are no longer needed.
  for (const Report& other : others())
    if (!command_.empty() && other.claim.command == command_ && !lives(other.claim)) removeReport(other.id);
  transaction.commit();
}

void UnfinishedStore::renew() {
  Transaction transaction(database());
  Statement(database(), "UPDATE reports SET expires = ? WHERE id = ?").run(ownClaim().expires, report_);
  transaction.commit();
}

std::vector<UnfinishedStore::Report> UnfinishedStore::others() const {
  std::vector<Report> reports;
  Statement row(database(),
                "SELECT id, points, command, machine, process, started, expires FROM reports WHERE id <> ?");
  for (row.bind(report_); row.step();)
    reports.push_back({row.integer(0), row.text(1),
                       RunClaim{row.text(3), static_cast<int>(row.integer(4)),
                                static_cast<std::uint64_t>(row.integer(5)), row.text(2), row.integer(6)}});
  return reports;
}

std::size_t UnfinishedStore::runsOf(std::int64_t report) const {
  Statement row(database(),
                "SELECT count(*) FROM runs WHERE key IN (SELECT key FROM wanted WHERE report = ?)");
  row.bind(report).step();
  return static_cast<std::size_t>(row.integer(0));
}

/// Removes a report with the runs that only it wants. Call it inside a transaction.
void UnfinishedStore::removeReport(std::int64_t report) {
  Statement(database(),
            "DELETE FROM runs WHERE key IN (SELECT key FROM wanted WHERE report = ?) AND key NOT IN (SELECT "
            "key FROM wanted WHERE report <> ?)")
      .run(report, report);
  Statement(database(), "DELETE FROM reports WHERE id = ?").run(report);
}

void UnfinishedStore::finish() {
  try {
    leave(/*finished=*/true);
    sayWhatStays();
  } catch (const std::exception& error) {
    logWarning("{}: what is no longer needed in it cannot be removed: {}", store_->file().string(),
               error.what());
  }
}

void UnfinishedStore::leave(bool finished) {
  left_ = true;
  Transaction transaction(database());
  if (database().isMoved()) return;  // somebody removed it by hand
  if (!finished && runsOf(report_) > 0) {
    // Marks the report as ended; the process may go on.
    Statement(database(), "UPDATE reports SET process = 0, started = 0, expires = 0 WHERE id = ?")
        .run(report_);
    transaction.commit();
    return;
  }
  for (const Report& other : others()) {
    if (lives(other.claim)) continue;
    const bool same = other.points == points_ || (!command_.empty() && other.claim.command == command_);
    if ((finished && same) || runsOf(other.id) == 0) removeReport(other.id);
  }
  removeReport(report_);
  transaction.commit();
  removeIfUnused();
}

void UnfinishedStore::removeIfUnused() {
  // A process that opens the file meanwhile waits for this lock, finds the file removed and creates another.
  const Transaction transaction(database());
  Statement row(database(),
                "SELECT (SELECT count(*) FROM runs) + (SELECT count(*) FROM stress_cells) + (SELECT count(*) "
                "FROM peak_rates)");
  row.step();
  const std::int64_t rows = row.integer(0);
  row.reset();
  if (rows > 0 || database().isMoved()) return;
  for (const Report& other : others())
    if (lives(other.claim)) return;
  std::filesystem::remove(store_->file());
}

void UnfinishedStore::sayWhatStays() const {
  if (database().isMoved()) return;
  const std::string file = store_->file().string();
  const std::vector<Report> reports = others();
  for (const Report& other : reports) {
    if (lives(other.claim)) {
      const std::string before = file + ": stays, it keeps the points of ";
      logInformation("{}{}", before, processText(other.claim.process, other.claim.command, before.size()));
    } else if (const std::size_t runs = runsOf(other.id); runs > 0) {
      logInformation("{}: stays, it keeps {} point{} of an interrupted report{}", file, runs,
                     runs == 1 ? "" : "s",
                     other.claim.command.empty() ? "" : "; to go on: " + other.claim.command);
    }
  }
  if (reports.empty()) logInformation("{}: stays, it holds results that no report has measured", file);
}

}  // namespace lumivox::results
