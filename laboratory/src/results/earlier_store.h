// Shows stores of other versions with the tables of this version.
#pragma once

#include <map>
#include <string>

#include "results/database.h"

namespace lumivox::results {

/// How a table of this version is read from another store.
struct Shown {
  std::string from;                                ///< "main.runs r"; empty if the store has no such table
  std::map<std::string, std::string> expressions;  ///< of columns that do not exist under their names
};
/// Creates a temporary view that shadows the table of this name. Columns without an expression get the
/// default of the record.
void show(const Database& database, const std::string& table, const Shown& shown);

/// Shows a store of schemas 1 to 9. Error if the file is no results store or has another schema.
void showEarlierStore(const Database& database);

}  // namespace lumivox::results
