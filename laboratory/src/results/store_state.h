// The inside of a results store, shared by the files that read and write its tables.
#pragma once

#include <string>

#include "lumivox/results/store.h"
#include "results/database.h"

namespace lumivox::results {

/// Whether a word of a filter stands for a file: its whole path as given, or its stem.
bool namesFile(const std::string& wanted, const std::string& file);

/// A claim of this process, from now on.
RunClaim ownClaim();
/// Whether the process of a claim still runs: on this machine it is looked for, of one elsewhere only the
/// clock tells.
bool lives(const RunClaim& claim);

}  // namespace lumivox::results

namespace lumivox {

struct ResultsStore::State {
  results::Database database;
  Mode mode;
  std::int64_t schema = 0;  ///< of the file; an older one has fewer tables

  State(const std::filesystem::path& file, Mode openMode)
      : database(file, openMode == Mode::write), mode(openMode) {}
  void requireSchema();
  std::int64_t insertRun(const StoredRun& run, bool complete);
  void insertTimes(std::int64_t id, const ReportPoint& point);
  void insertWork(std::int64_t id, const ReportPoint& point);
  void insertErrors(std::int64_t id, const ReportPoint& point);
  void insertVoxels(std::int64_t id, const ReportPoint& point);
  void insertNames(std::int64_t id, const StoredRun& run);
  bool add(const StoredRun& run, const std::vector<StoredImage>& images, bool complete);
  std::optional<StoredRun> find(const std::string& key, bool complete) const;
  std::vector<StoredRun> runs(const RunFilter& filter, bool complete) const;
  void addCells(const std::vector<StressCell>& cells);
  void addPeakRates(const std::vector<PeakRate>& peakRates);
  void addControls(const State& other);  ///< of runs that are here
  StoredRun runAt(const results::Statement& row) const;
  void readTimes(StoredRun& run) const;
  void readWork(StoredRun& run) const;
  void readErrors(StoredRun& run) const;
  void readVoxels(StoredRun& run) const;
  void readAll(StoredRun& run) const;  ///< all but what runAt() and readNames() give
  void readNames(StoredRun& run) const;
};

}  // namespace lumivox
