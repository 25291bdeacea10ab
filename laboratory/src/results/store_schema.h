// The tables and views of the results store: their SQL, and their description in docs/results.md.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lumivox::results {

/// PRAGMA user_version. A new field of a record does not change it.
inline constexpr std::int64_t kSchemaVersion = 10;
inline constexpr std::int64_t kApplicationId = 0x4c4d5658;  // PRAGMA application_id: "LMVX"

struct Column {
  std::string name, definition;  ///< of a table: type and constraints; of a view: the expression
  std::string about{};           ///< empty: the next column's sentence covers this one too
};

struct Table {
  const char* name;
  const char* about;
  std::vector<Column> columns;
  std::string rest;               ///< of a table: further constraints; of a view: its FROM clause
  const char* options = nullptr;  ///< of a table; null: it is a view
  std::string sql() const;        ///< CREATE
};
const std::vector<Table>& storeTables();

/// SQL of all tables and views, with indices.
std::string schemaSql();
/// A list in Markdown: each table and view with its columns.
std::string schemaMarkdown();

}  // namespace lumivox::results
