// Rows from elsewhere as a table, so that one INSERT .. SELECT takes all of them: a statement for each row
// would take several times as long.
#pragma once

#include "results/database.h"

namespace lumivox::results {

/// Gives rows one by one.
class RowStream {
 public:
  virtual ~RowStream() = default;
  virtual bool next() = 0;  ///< false: there is none left
  /// Hands a column of the present row to sqlite3_result_*.
  virtual void giveColumn(sqlite3_context* to, int column) = 0;
};

/// The rows of a stream as the table `incoming` of a database, columns c0, c1 .., while it lives.
class Incoming {
 public:
  Incoming(const Database& database, int columns);
  ~Incoming();
  Incoming(const Incoming&) = delete;
  Incoming& operator=(const Incoming&) = delete;
  /// INSERT OR IGNORE INTO table (names) SELECT all columns.
  void insert(const std::string& table, const std::string& names, RowStream& rows);

  struct State;

 private:
  const Database& database_;
  std::unique_ptr<State> state_;
};

}  // namespace lumivox::results
