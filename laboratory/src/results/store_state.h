// The state of a results store, shared by the files that read and write its tables.
#pragma once

#include <string>

#include "lumivox/results/store.h"
#include "results/database.h"

namespace lumivox::results {

/// Whether a word of a filter names a file: by its path as given, or by its stem.
bool namesFile(const std::string& wanted, const std::string& file);

/// The machine of a claim whose point is measured: its command is the file that holds the run.
inline constexpr const char* kDelivered = "delivered";

/// A claim of this process, from now on.
RunClaim ownClaim();
/// Whether the process of a claim still runs. On other machines, only the age of the claim tells.
bool lives(const RunClaim& claim);

/// A repeated measurement of a run's times.
struct Control {
  std::string created, what;  ///< "frame" or "next_frame"
  TimingStatistics time;
};

}  // namespace lumivox::results

namespace lumivox {

struct ResultsStore::State {
  results::Database database;
  Mode mode;

  State(const std::filesystem::path& file, Mode openMode)
      : database(file, openMode == Mode::write), mode(openMode) {}
  void requireSchema();
  void addNewFields();

  // These are called inside a transaction.
  bool add(const StoredRun& run, const std::vector<StoredImage>& images, bool complete);
  void add(const std::string& key,
           const results::Control& control);  ///< adds it to the run with this key, if the store has it
  /// Puts records; they replace older ones, or all, with the same keys. Returns how many were put.
  template <class T>
  std::size_t put(const char* table, const std::vector<T>& records, bool olderAlone);

  std::optional<StoredRun> find(const std::string& key, bool complete) const;
  std::vector<StoredRun> runs(const RunFilter& filter, bool complete) const;
  /// All repeated measurements, or those of a run, with the keys of their runs.
  std::vector<std::pair<std::string, results::Control>> controls(const std::string& key = {}) const;
};

}  // namespace lumivox
