// Tables that slow tests measure, as they are kept and as cards quote them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lumivox {

struct MeasuredTable {
  struct Column {
    std::string name;
    int decimals = 3;  ///< that are kept and shown
    /// A figure is as before when it differs from the kept one by at most margin + share * |kept|.
    double margin = 0.0, share = 0.0;
    bool ofTimes = false;  ///< compared only with figures of the same device
  };
  struct Row {
    std::string name;
    std::vector<double> values;  ///< of the columns; NaN: none
  };
  std::string name;  ///< "imperfect_volumes.errors"
  std::string test, device, date;
  double seconds = 0.0;  ///< that the test took; 0: not known
  std::vector<Column> columns;
  std::vector<Row> rows;
};

/// Error that names the file and what is wrong in it.
std::vector<MeasuredTable> readMeasuredTables(const std::filesystem::path& file);
/// One line for each row, values rounded to the decimals of their columns.
std::string measuredTablesAsJson(const std::vector<MeasuredTable>& tables);

/// In what a table differs from the kept one: figures beyond their tolerance, with both numbers; rows that
/// only one of them has, but for those whose name begins with one of `absent`; other columns.
std::vector<std::string> differences(const MeasuredTable& kept, const MeasuredTable& measured,
                                     const std::vector<std::string>& absent = {});

}  // namespace lumivox
