// SQL on a results store, past the store's own classes.
#pragma once

#include <sqlite3.h>

#include <filesystem>
#include <string>

#include "lumivox/base/file.h"
#include "support/support.h"

namespace lumivox::test {

inline void execute(const std::filesystem::path& file, const std::string& sql) {
  sqlite3* handle = nullptr;
  REQUIRE(sqlite3_open(file.c_str(), &handle) == SQLITE_OK);
  const int status = sqlite3_exec(handle, sql.c_str(), nullptr, nullptr, nullptr);
  INFO(sql << "\n" << sqlite3_errmsg(handle));
  CHECK(status == SQLITE_OK);
  sqlite3_close(handle);
}

/// Values of a row with a space between them, rows with a line break.
inline std::string selected(const std::filesystem::path& file, const std::string& sql) {
  sqlite3* handle = nullptr;
  REQUIRE(sqlite3_open(file.c_str(), &handle) == SQLITE_OK);
  std::string text;
  const auto read = [](void* result, int columns, char** values, char**) {
    auto& into = *static_cast<std::string*>(result);
    if (!into.empty()) into += "\n";
    for (int i = 0; i < columns; ++i)
      into += (i == 0 ? "" : " ") + std::string(values[i] ? values[i] : "null");
    return 0;
  };
  const int status = sqlite3_exec(handle, sql.c_str(), read, &text, nullptr);
  INFO(sql << "\n" << sqlite3_errmsg(handle));
  CHECK(status == SQLITE_OK);
  sqlite3_close(handle);
  return text;
}

/// A store as an earlier version wrote it, with schema 8.
inline void writeEarlierStore(const std::filesystem::path& file, int schema) {
  std::filesystem::create_directories(file.parent_path());
  execute(file, readFile(sourceDirectory() /
                         ("tests/laboratory/data/results_schema_" + std::to_string(schema) + ".sql")));
}

}  // namespace lumivox::test
