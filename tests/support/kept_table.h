// Tables that slow tests measure, compared with the kept ones in docs/benchmarks/measured_tables.json.
#pragma once

#include <chrono>
#include <initializer_list>
#include <string>
#include <vector>

#include "lumivox/results/measured_table.h"

namespace lumivox::test {

/// A table of a slow test. The destructor compares it with the kept table: a figure beyond its tolerance, or
/// a row that only one of them has, fails the test. With LUMIVOX_KEEP_TABLES=1 (`./test --slow --keep`) it
/// replaces the kept table instead.
class KeptTable {
 public:
  KeptTable(const std::string& name, std::vector<MeasuredTable::Column> columns);
  ~KeptTable() noexcept(false);  // with --abort a failed comparison throws
  KeptTable(const KeptTable&) = delete;
  KeptTable& operator=(const KeptTable&) = delete;

  void row(const std::string& name, std::initializer_list<double> values);
  /// Rows whose names begin with this text cannot be measured here; the kept ones stay.
  void absent(const std::string& beginning) { absent_.push_back(beginning); }

 private:
  void compare(const MeasuredTable* kept) const;
  void keep(std::vector<MeasuredTable> all) const;

  MeasuredTable table_;
  std::vector<std::string> absent_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace lumivox::test
