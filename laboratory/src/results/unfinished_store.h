// The results store in which reports keep their points until their pages are written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/results/store.h"

namespace lumivox::results {

class Database;

/// A results store beside a page, shared by the reports that write this page, at once or one after another.
/// Each says which runs it wants. A report that ends removes those that no other wants, and the file once it
/// is empty and no report is at work with it. What an interrupted report wants stays until a report with the
/// same points, or with the same command, has ended.
class UnfinishedStore {
 public:
  /// Opens or makes the file and joins those who use it.
  UnfinishedStore(const std::filesystem::path& file, const std::string& command);
  /// Without finish(): interrupted. What was measured stays.
  ~UnfinishedStore();
  UnfinishedStore(const UnfinishedStore&) = delete;
  UnfinishedStore& operator=(const UnfinishedStore&) = delete;

  ResultsStore& store() { return *store_; }
  /// Before the store is asked for any of these runs: from then on no other report removes them.
  void want(const std::vector<std::string>& keys);
  const std::vector<std::string>& wanted() const { return wanted_; }
  /// Tells those on other machines that this process is at work.
  void renew();
  /// The page is written. What cannot be removed is a warning.
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
