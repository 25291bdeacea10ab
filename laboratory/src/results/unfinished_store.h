// The results store that holds the points of reports until their pages are written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/results/store.h"

namespace lumivox::results {

class Database;

/// A results store beside a page, shared by all reports that write this page. Each report lists the runs that
/// it wants. When a report ends, it removes runs that no other report wants, and removes the file if it is
/// empty and unused. Runs of an interrupted report stay until a report with the same points or the same
/// command has ended.
class UnfinishedStore {
 public:
  /// Opens or creates the file and joins its users.
  UnfinishedStore(const std::filesystem::path& file, const std::string& command);
  /// Without finish(), the report counts as interrupted and its runs stay.
  ~UnfinishedStore();
  UnfinishedStore(const UnfinishedStore&) = delete;
  UnfinishedStore& operator=(const UnfinishedStore&) = delete;

  ResultsStore& store() { return *store_; }
  /// Call it before requesting any of these runs: from then on no other report removes them.
  void want(const std::vector<std::string>& keys);
  const std::vector<std::string>& wanted() const { return wanted_; }
  /// Tells processes on other machines that this one is at work.
  void renew();
  /// Call it when the page is written. A failed removal is a warning.
  void finish();

 private:
  struct Report;  ///< a row of the table
  const Database& database() const;
  bool join();
  void leave(bool finished);
  std::vector<Report> others() const;
  std::size_t runsOf(std::int64_t report) const;
  void removeReport(std::int64_t report);
  void removeIfUnused();
  void sayWhatStays() const;

  std::string command_;
  std::optional<ResultsStore> store_;
  std::vector<std::string> wanted_;  ///< sorted
  std::string points_;               ///< hash of them
  std::int64_t report_ = 0;          ///< own row
  bool left_ = false;
};

}  // namespace lumivox::results
