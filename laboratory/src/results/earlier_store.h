// Stores of other versions, shown with the tables of this one.
#pragma once

#include <map>
#include <string>

#include "results/database.h"

namespace lumivox::results {

/// How a table of this version is read from another store.
struct Shown {
  std::string from;                                ///< "main.runs r"; empty: it has no such table
  std::map<std::string, std::string> expressions;  ///< of columns that are not there by their names
};
/// Makes a view of this connection, before the table of this name. What is in neither is what a record
/// begins with.
void show(const Database& database, const std::string& table, const Shown& shown);

/// Shows a store of schemas 1 to 9. Error for a file that is no results store, or one of another schema.
void showEarlierStore(const Database& database);

}  // namespace lumivox::results
