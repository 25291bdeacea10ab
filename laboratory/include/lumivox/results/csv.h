// Comma-separated values (RFC 4180). Runs have one header, whichever command writes them, so that files of
// several commands can be put together: docs/reading_results.md.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "lumivox/results/runs.h"

namespace lumivox {

/// One field of a row, quoted where it needs it.
std::string csvField(const std::string& text);

/// Rows whose fields are named as they are added. Columns stand in the order in which they were named first,
/// those of parameters behind them by name; a row that lacks one has an empty field.
class CsvTable {
 public:
  void beginRow() { rows_.emplace_back(); }
  void add(const std::string& column, const std::string& value);
  void add(const std::string& column, const char* value) { add(column, std::string(value)); }
  void add(const std::string& column, double value);  ///< that reads back as the same bits; empty for NaN
  void add(const std::string& column, std::uint64_t value);
  void add(const std::string& column, int value);
  void add(const std::string& column, bool value);             ///< 1 or 0
  void add(const std::string& column, const Measured& value);  ///< and COLUMN_uncertainty
  /// COLUMN, COLUMN_lower_quartile and COLUMN_upper_quartile; empty when nothing was timed.
  void add(const std::string& column, const TimingStatistics& time);
  /// A column `parameter_NAME`.
  void addParameter(const std::string& name, const std::string& value);
  /// Without rows the columns stay: the header of an empty table.
  void clearRows() { rows_.clear(); }
  /// Lines end in CR LF, as RFC 4180 has it.
  std::string text() const;

 private:
  void put(const std::string& column, std::string field);
  std::vector<std::string> columns_;
  std::set<std::string> parameters_;
  std::vector<std::map<std::string, std::string>> rows_;  ///< fields, quoted
};

/// One row per run and error; a run without errors, one that failed for instance, has one row. The header is
/// the same for all runs but for the parameters.
std::string runsCsv(const std::vector<StoredRun>& runs);

}  // namespace lumivox
