// SQLite with exceptions and values.
#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>

namespace lumivox::results {

class Database;

/// Binary data.
struct Blob {
  const std::string& bytes;
};

/// A prepared statement. Bind all values in order, then step through the rows.
class Statement {
 public:
  Statement(const Database& database, const std::string& sql);
  template <class... Values>
  Statement& bind(const Values&... values) {
    sqlite3_reset(statement_.get());
    int index = 0;
    (bindOne(++index, values), ...);
    return *this;
  }
  void reset() { sqlite3_reset(statement_.get()); }
  bool step();  ///< true if there is a row
  void run();   ///< runs to the end
  template <class... Values>
  void run(const Values&... values) {
    bind(values...);
    run();
  }

  std::int64_t integer(int column) const { return sqlite3_column_int64(statement_.get(), column); }
  /// SQLite has no NaN; NULL stands for it.
  double number(int column) const;
  std::string text(int column) const;
  std::string bytes(int column) const;
  /// Hands a column of the row to a function of SQL or a table of one's own, as it is. Texts are not copied:
  /// the row has to stay until they are used.
  void giveColumn(sqlite3_context* to, int column) const;
  /// Throws Error for an unexpected value.
  [[noreturn]] void fail(const std::string& why) const;

  /// Binds one value; indices start at 1.
  void bindOne(int index, const Blob& blob);
  /// The value of a column of another statement's row, as it is; the row has to stay until this one has run.
  void bindColumn(int index, const Statement& from, int column);
  /// Binds lists and objects as their text.
  void bindJson(int index, const nlohmann::ordered_json& json);
  void bindOne(int index, const std::string& text);
  void bindOne(int index, std::nullptr_t) { bindJson(index, nullptr); }
  void bindOne(int index, const char* text) { bindOne(index, std::string(text)); }
  void bindOne(int index, double number);
  template <class T>
  requires std::is_integral_v<T>
  void bindOne(int index, T value) { bindInteger(index, static_cast<std::int64_t>(value)); }

 private:
  void bindInteger(int index, std::int64_t value);

  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  const Database& database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

class Database {
 public:
  Database(const std::filesystem::path& file, bool write);
  void execute(const std::string& sql) const;
  std::int64_t pragma(const char* name) const;  ///< an integer pragma
  std::int64_t lastRow() const { return sqlite3_last_insert_rowid(handle_.get()); }
  std::size_t changes() const { return static_cast<std::size_t>(sqlite3_changes(handle_.get())); }
  const std::filesystem::path& file() const { return file_; }
  /// Whether the file was removed, renamed or replaced since it was opened.
  bool isMoved() const;
  /// Throws Error with the file and what SQLite says.
  [[noreturn]] void fail() const;
  sqlite3* handle() const { return handle_.get(); }

 private:
  struct Close {
    void operator()(sqlite3* handle) const { sqlite3_close(handle); }
  };
  std::filesystem::path file_;
  std::unique_ptr<sqlite3, Close> handle_;
};

/// Rolled back unless committed.
class Transaction {
 public:
  enum class For { reading, writing };
  explicit Transaction(const Database& database, For purpose = For::writing) : database_(database) {
    database.execute(purpose == For::writing ? "BEGIN IMMEDIATE" : "BEGIN");
  }
  ~Transaction();
  void commit();

 private:
  const Database& database_;
  bool open_ = true;
};

}  // namespace lumivox::results
