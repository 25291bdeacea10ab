#include "results/database.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <limits>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/results/json.h"

namespace lumivox::results {
namespace {

/// Longest wait for another process that is writing.
constexpr int kPatienceMs = 60'000;

}  // namespace

Database::Database(const std::filesystem::path& file, bool write) : file_(file) {
  requireRegularFile(file);
  // A process that was killed while it wrote leaves a journal, which only a writer may roll back.
  std::error_code ignored;
  if (!write && std::filesystem::exists(file.string() + "-journal", ignored) &&
      access(file.c_str(), W_OK) == 0)
    Database(file, true).pragma("user_version");
  sqlite3* handle = nullptr;
  const int flags =
      SQLITE_OPEN_NOMUTEX | (write ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READONLY);
  const int status = sqlite3_open_v2(file.c_str(), &handle, flags, nullptr);
  handle_.reset(handle);
  if (status != SQLITE_OK) fail();
  sqlite3_busy_timeout(handle, kPatienceMs);
  execute("PRAGMA foreign_keys = ON");
}

void Database::fail() const {
  throw Error(fmt::format("{}: {}", file_.string(),
                          handle_ ? sqlite3_errmsg(handle_.get()) : "not enough memory to open it"));
}

void Database::execute(const std::string& sql) const {
  if (sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

std::int64_t Database::pragma(const char* name) const {
  Statement statement(*this, fmt::format("PRAGMA {}", name));
  return statement.step() ? statement.integer(0) : 0;
}

bool Database::isMoved() const {
  int moved = 0;
  if (sqlite3_file_control(handle_.get(), "main", SQLITE_FCNTL_HAS_MOVED, &moved) != SQLITE_OK) fail();
  return moved != 0;
}

Statement::Statement(const Database& database, const std::string& sql) : database_(database) {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(database.handle(), sql.c_str(), -1, &statement, nullptr) != SQLITE_OK)
    database.fail();
  statement_.reset(statement);
}

bool Statement::step() {
  const int status = sqlite3_step(statement_.get());
  if (status != SQLITE_ROW && status != SQLITE_DONE) database_.fail();
  return status == SQLITE_ROW;
}

void Statement::run() {
  while (step()) {
  }
  // An unreset statement would keep its lock on the file.
  reset();
}

void Statement::fail(const std::string& why) const {
  throw Error(fmt::format("{}: '{}' gave what is no record of a results store: {}", database_.file().string(),
                          sqlite3_sql(statement_.get()), why));
}

double Statement::number(int column) const {
  if (sqlite3_column_type(statement_.get(), column) == SQLITE_NULL)
    return std::numeric_limits<double>::quiet_NaN();
  return sqlite3_column_double(statement_.get(), column);
}

std::string Statement::text(int column) const {
  const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
  return bytes == nullptr
             ? std::string()
             : std::string(bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column)));
}

void Statement::bindOne(int index, const std::string& text) {
  if (sqlite3_bind_text(statement_.get(), index, text.c_str(), static_cast<int>(text.size()),
                        SQLITE_TRANSIENT) != SQLITE_OK)
    database_.fail();
}

std::string Statement::bytes(int column) const {
  const auto* bytes = static_cast<const char*>(sqlite3_column_blob(statement_.get(), column));
  return bytes == nullptr
             ? std::string()
             : std::string(bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column)));
}

void Statement::bindJson(int index, const nlohmann::ordered_json& json) {
  if (json.is_number_float() || json.is_null())
    bindOne(index, json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>());
  else if (json.is_number() || json.is_boolean())
    bindInteger(index, json.is_boolean() ? json.get<bool>() : json.get<std::int64_t>());
  else
    bindOne(index, json.is_string() ? json.get<std::string>() : textOf(json, -1));
}

void Statement::bindOne(int index, const Blob& blob) {
  if (sqlite3_bind_blob64(statement_.get(), index, blob.bytes.data(), blob.bytes.size(), SQLITE_TRANSIENT) !=
      SQLITE_OK)
    database_.fail();
}

void Statement::bindOne(int index, double number) {
  const int status = std::isnan(number) ? sqlite3_bind_null(statement_.get(), index)
                                        : sqlite3_bind_double(statement_.get(), index, number);
  if (status != SQLITE_OK) database_.fail();
}

void Statement::bindColumn(int index, const Statement& from, int column) {
  sqlite3_stmt* const to = statement_.get();
  sqlite3_stmt* const row = from.statement_.get();
  int status = SQLITE_OK;
  switch (sqlite3_column_type(row, column)) {
    case SQLITE_INTEGER:
      status = sqlite3_bind_int64(to, index, sqlite3_column_int64(row, column));
      break;
    case SQLITE_FLOAT:
      status = sqlite3_bind_double(to, index, sqlite3_column_double(row, column));
      break;
    case SQLITE_NULL:
      status = sqlite3_bind_null(to, index);
      break;
    case SQLITE_BLOB:
      status = sqlite3_bind_blob(to, index, sqlite3_column_blob(row, column),
                                 sqlite3_column_bytes(row, column), SQLITE_STATIC);
      break;
    default: {
      const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(row, column));
      status = sqlite3_bind_text(to, index, text, sqlite3_column_bytes(row, column), SQLITE_STATIC);
    }
  }
  if (status != SQLITE_OK) database_.fail();
}

void Statement::giveColumn(sqlite3_context* to, int column) const {
  sqlite3_stmt* const row = statement_.get();
  switch (sqlite3_column_type(row, column)) {
    case SQLITE_INTEGER:
      sqlite3_result_int64(to, sqlite3_column_int64(row, column));
      break;
    case SQLITE_FLOAT:
      sqlite3_result_double(to, sqlite3_column_double(row, column));
      break;
    case SQLITE_NULL:
      sqlite3_result_null(to);
      break;
    case SQLITE_BLOB:
      sqlite3_result_blob(to, sqlite3_column_blob(row, column), sqlite3_column_bytes(row, column),
                          SQLITE_STATIC);
      break;
    default: {
      const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(row, column));
      sqlite3_result_text(to, text, sqlite3_column_bytes(row, column), SQLITE_STATIC);
    }
  }
}

void Statement::bindInteger(int index, std::int64_t value) {
  if (sqlite3_bind_int64(statement_.get(), index, value) != SQLITE_OK) database_.fail();
}

Transaction::~Transaction() {
  // An error of the rollback can be ignored: SQLite rolls back when the file is opened again.
  if (open_) sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
}

void Transaction::commit() {
  database_.execute("COMMIT");
  open_ = false;
}

}  // namespace lumivox::results
