// Stores which process is measuring which point, and repeated measurements of times.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "base/process.h"
#include "results/database.h"
#include "results/store_state.h"

namespace lumivox {

using results::Statement;
using results::Transaction;

using results::ownClaim;

namespace results {

RunClaim ownClaim() {
  RunClaim claim;
  claim.machine = machineIdentity();
  claim.process = static_cast<int>(getpid());
  claim.started = startOf(claim.process);
  claim.command = commandOf(claim.process);
  claim.expires = static_cast<std::int64_t>(std::time(nullptr)) + ResultsStore::kClaimSeconds;
  return claim;
}

bool lives(const RunClaim& claim) {
  if (claim.machine == kDelivered) {
    std::error_code failure;
    return std::filesystem::exists(claim.command, failure);
  }
  if (claim.machine == machineIdentity())
    return claim.started != 0 && startOf(claim.process) == claim.started;
  return claim.expires > static_cast<std::int64_t>(std::time(nullptr));
}

}  // namespace results

namespace {

bool same(const RunClaim& a, const RunClaim& b) {
  return a.machine == b.machine && a.process == b.process && a.started == b.started;
}

bool stands(const RunClaim& claim) {
  if (claim.machine == results::kDelivered) return results::lives(claim);
  return claim.expires > static_cast<std::int64_t>(std::time(nullptr)) && results::lives(claim);
}

std::optional<RunClaim> claimIn(const results::Database& database, const std::string& key) {
  Statement row(database, "SELECT machine, process, started, command, expires FROM claims WHERE key = ?");
  if (!row.bind(key).step()) return std::nullopt;
  return RunClaim{row.text(0), static_cast<int>(row.integer(1)), static_cast<std::uint64_t>(row.integer(2)),
                  row.text(3), row.integer(4)};
}

}  // namespace

std::vector<bool> ResultsStore::claim(const std::vector<std::string>& keys) {
  const RunClaim own = ownClaim();
  std::vector<bool> claimed;
  Transaction transaction(state_->database);
  Statement insert(state_->database, "INSERT OR REPLACE INTO claims VALUES (?,?,?,?,?,?)");
  for (const std::string& key : keys) {
    const std::optional<RunClaim> there = claimIn(state_->database, key);
    claimed.push_back(!there || same(*there, own) || !stands(*there));
    if (claimed.back()) insert.run(key, own.machine, own.process, own.started, own.command, own.expires);
  }
  transaction.commit();
  return claimed;
}

void ResultsStore::release(const std::vector<std::string>& keys) {
  const RunClaim own = ownClaim();
  Transaction transaction(state_->database);
  Statement remove(state_->database,
                   "DELETE FROM claims WHERE key = ? AND machine = ? AND process = ? AND started = ?");
  for (const std::string& key : keys) remove.run(key, own.machine, own.process, own.started);
  transaction.commit();
}

namespace {

std::string claimantOf(const std::filesystem::path& part) {
  std::error_code ignored;
  return std::filesystem::absolute(part, ignored).string();
}

}  // namespace

std::vector<bool> ResultsStore::claimFor(const std::filesystem::path& part,
                                         const std::vector<std::string>& keys) {
  RunClaim own = ownClaim();
  own.command = claimantOf(part);
  std::vector<bool> claimed;
  Transaction transaction(state_->database);
  Statement insert(state_->database, "INSERT OR REPLACE INTO claims VALUES (?,?,?,?,?,?)");
  for (const std::string& key : keys) {
    const std::optional<RunClaim> there = claimIn(state_->database, key);
    // A task that goes on elsewhere takes up what it had claimed for the same file.
    claimed.push_back(!there || there->command == own.command || !stands(*there));
    if (claimed.back()) insert.run(key, own.machine, own.process, own.started, own.command, own.expires);
  }
  transaction.commit();
  return claimed;
}

void ResultsStore::releaseFor(const std::filesystem::path& part, const std::vector<std::string>& keys) {
  Transaction transaction(state_->database);
  Statement remove(state_->database, "DELETE FROM claims WHERE key = ? AND command = ? AND machine <> ?");
  for (const std::string& key : keys) remove.run(key, claimantOf(part), results::kDelivered);
  transaction.commit();
}

void ResultsStore::deliver(const std::filesystem::path& part, const std::vector<std::string>& keys) {
  const std::int64_t now = std::time(nullptr);
  Transaction transaction(state_->database);
  Statement insert(state_->database, "INSERT OR REPLACE INTO claims VALUES (?,?,0,0,?,?)");
  for (const std::string& key : keys) insert.run(key, results::kDelivered, claimantOf(part), now);
  transaction.commit();
}

void ResultsStore::releaseElsewhere() {
  Transaction transaction(state_->database);
  Statement(state_->database, "DELETE FROM claims WHERE machine <> ?").run(machineIdentity());
  transaction.commit();
}

std::optional<RunClaim> ResultsStore::claimedByOther(const std::string& key) const {
  const std::optional<RunClaim> there = claimIn(state_->database, key);
  return there && !same(*there, ownClaim()) && stands(*there) ? there : std::nullopt;
}

void ResultsStore::State::add(const std::string& key, const results::Control& control) {
  const TimingStatistics& time = control.time;
  if (time.repeats > 0)
    Statement(
        database,
        "INSERT INTO controls SELECT id, ?, ?, ?, ?, ?, ? FROM runs WHERE key = ? ON CONFLICT DO UPDATE SET "
        "median_ms = excluded.median_ms, lower_quartile_ms = excluded.lower_quartile_ms, upper_quartile_ms "
        "= excluded.upper_quartile_ms, repeats = excluded.repeats WHERE excluded.median_ms < median_ms")
        .run(control.created, control.what, time.median, time.lowerQuartile, time.upperQuartile, time.repeats,
             key);
}

void ResultsStore::addControl(const std::string& key, const TimingStatistics& frameMs,
                              const TimingStatistics& nextFrameMs) {
  Transaction transaction(state_->database);
  const std::string created = dateText();
  state_->add(key, {created, "frame", frameMs});
  state_->add(key, {created, "next_frame", nextFrameMs});
  transaction.commit();
}

std::vector<std::pair<std::string, results::Control>> ResultsStore::State::controls(
    const std::string& key) const {
  std::vector<std::pair<std::string, results::Control>> controls;
  Statement row(
      database,
      std::string("SELECT r.key, c.created, c.what, c.median_ms, c.lower_quartile_ms, "
                  "c.upper_quartile_ms, c.repeats FROM controls c JOIN runs r ON r.id = c.run WHERE ") +
          (key.empty() ? "? = ''" : "r.key = ?"));
  for (row.bind(key); row.step();) {
    results::Control control{row.text(1), row.text(2), {}};
    control.time.median = row.number(3);
    control.time.lowerQuartile = row.number(4);
    control.time.upperQuartile = row.number(5);
    control.time.repeats = static_cast<int>(row.integer(6));
    controls.emplace_back(row.text(0), std::move(control));
  }
  return controls;
}

std::vector<RepeatedControl> ResultsStore::controls(const RunIdentity& where) const {
  std::vector<RepeatedControl> controls;
  Statement row(
      state_->database,
      "SELECT c.run, c.created, c.what, t.median_ms, t.lower_quartile_ms, t.upper_quartile_ms, t.repeats, "
      "c.median_ms, c.lower_quartile_ms, c.upper_quartile_ms, c.repeats FROM controls c JOIN runs r ON r.id = "
      "c.run LEFT JOIN timings t ON t.run = c.run AND t.what = c.what AND t.pass = '' WHERE "
      "r.device = ? AND r.driver = ? AND r.shader_input = ? AND r.host = ? ORDER BY c.created DESC, c.run, c.what");
  std::int64_t run = -1;
  for (row.bind(where.device, where.driver, where.shaderInput, where.host); row.step();) {
    if (controls.empty() || run != row.integer(0) || controls.back().created != row.text(1)) {
      if (controls.size() == static_cast<std::size_t>(kControls)) break;
      run = row.integer(0);
      controls.push_back({row.text(1), {}, {}, {}, {}});
    }
    const auto timeAt = [&](int column) {
      TimingStatistics time;
      time.median = row.number(column);
      time.lowerQuartile = row.number(column + 1);
      time.upperQuartile = row.number(column + 2);
      time.repeats = static_cast<int>(row.integer(column + 3));
      return medianOf(time);
    };
    const bool frame = row.text(2) == "frame";
    (frame ? controls.back().frameMs : controls.back().nextFrameMs) = timeAt(3);
    (frame ? controls.back().frameMsAgain : controls.back().nextFrameMsAgain) = timeAt(7);
  }
  return controls;
}

}  // namespace lumivox
