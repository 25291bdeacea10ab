// Stores of schemas 1 to 8, in which every field of a record had a column: what `lumivox results import`
// reads.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "results/database.h"
#include "results/store_state.h"

namespace lumivox::results {

class EarlierStore {
 public:
  /// Error for a file that is no results store, or one of another schema.
  explicit EarlierStore(const std::filesystem::path& file);

  struct Run {
    StoredRun run;
    std::vector<StoredImage> images;
    std::vector<Control> controls;
  };
  /// Without those that lack their times.
  std::vector<Run> runs() const;
  std::vector<StressCell> cells() const;
  std::vector<PeakRate> peakRates() const;

 private:
  void readNames(StoredRun& run) const;
  void readTimes(ReportPoint& point, std::int64_t id) const;
  void readErrors(ReportPoint& point, std::int64_t id) const;

  Database database_;
  std::int64_t schema_ = 0;
};

}  // namespace lumivox::results
