// The tables and views of the results store: their SQL, and their description in docs/results.md.
#pragma once

#include <cstdint>
#include <string>

namespace lumivox::results {

/// PRAGMA user_version. A new field of a record needs no new one.
inline constexpr std::int64_t kSchemaVersion = 9;
/// The last schema with a column for each field, see earlier_store.h.
inline constexpr std::int64_t kLastEarlierSchema = 8;
inline constexpr std::int64_t kApplicationId = 0x4c4d5658;  // PRAGMA application_id: "LMVX"

std::string schemaSql();
/// A list in Markdown: each table and view with its columns.
std::string schemaMarkdown();

}  // namespace lumivox::results
