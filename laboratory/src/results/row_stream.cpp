#include "results/row_stream.h"

#include <fmt/format.h>

#include <exception>
#include <utility>

namespace lumivox::results {

struct Incoming::State {
  int columns = 0;
  RowStream* rows = nullptr;
  std::exception_ptr failure;  ///< of the stream: SQLite knows no exceptions
};

namespace {

struct TheTable : sqlite3_vtab {
  Incoming::State* state = nullptr;
};
struct TheCursor : sqlite3_vtab_cursor {
  bool there = false;
  sqlite3_int64 row = 0;
};

Incoming::State& stateOf(sqlite3_vtab_cursor* cursor) {
  return *static_cast<TheTable*>(cursor->pVtab)->state;
}

int connect(sqlite3* database, void* data, int, const char* const*, sqlite3_vtab** table, char**) {
  auto* state = static_cast<Incoming::State*>(data);
  std::string columns;
  for (int i = 0; i < state->columns; ++i) columns += fmt::format("{}c{}", i == 0 ? "" : ", ", i);
  const int status =
      sqlite3_declare_vtab(database, fmt::format("CREATE TABLE incoming ({})", columns).c_str());
  if (status != SQLITE_OK) return status;
  auto* made = new TheTable{};
  made->state = state;
  *table = made;
  return SQLITE_OK;
}

int disconnect(sqlite3_vtab* table) {
  delete static_cast<TheTable*>(table);
  return SQLITE_OK;
}

int bestIndex(sqlite3_vtab*, sqlite3_index_info* info) {
  constexpr double kManyRows = 1e6;
  info->estimatedCost = kManyRows;
  return SQLITE_OK;
}

int openCursor(sqlite3_vtab*, sqlite3_vtab_cursor** cursor) {
  *cursor = new TheCursor{};
  return SQLITE_OK;
}

int closeCursor(sqlite3_vtab_cursor* cursor) {
  delete static_cast<TheCursor*>(cursor);
  return SQLITE_OK;
}

int nextRow(sqlite3_vtab_cursor* cursor) {
  Incoming::State& state = stateOf(cursor);
  auto* own = static_cast<TheCursor*>(cursor);
  try {
    own->there = state.rows->next();
    ++own->row;
    return SQLITE_OK;
  } catch (...) {
    state.failure = std::current_exception();
    return SQLITE_ABORT;
  }
}

int filter(sqlite3_vtab_cursor* cursor, int, const char*, int, sqlite3_value**) {
  return nextRow(cursor);
}

int atEnd(sqlite3_vtab_cursor* cursor) {
  return static_cast<TheCursor*>(cursor)->there ? 0 : 1;
}

int giveColumn(sqlite3_vtab_cursor* cursor, sqlite3_context* to, int column) {
  stateOf(cursor).rows->giveColumn(to, column);
  return SQLITE_OK;
}

int rowNumber(sqlite3_vtab_cursor* cursor, sqlite3_int64* number) {
  *number = static_cast<TheCursor*>(cursor)->row;
  return SQLITE_OK;
}

const sqlite3_module& module() {
  static const sqlite3_module all = [] {
    sqlite3_module made{};
    made.xConnect = connect;  // without xCreate it is there by its name alone
    made.xBestIndex = bestIndex;
    made.xDisconnect = disconnect;
    made.xOpen = openCursor;
    made.xClose = closeCursor;
    made.xFilter = filter;
    made.xNext = nextRow;
    made.xEof = atEnd;
    made.xColumn = giveColumn;
    made.xRowid = rowNumber;
    return made;
  }();
  return all;
}

}  // namespace

Incoming::Incoming(const Database& database, int columns)
    : database_(database), state_(std::make_unique<State>()) {
  state_->columns = columns;
  if (sqlite3_create_module(database.handle(), "incoming", &module(), state_.get()) != SQLITE_OK)
    database.fail();
}

Incoming::~Incoming() {
  sqlite3_create_module(database_.handle(), "incoming", nullptr, nullptr);
}

void Incoming::insert(const std::string& table, const std::string& names, RowStream& rows) {
  std::string columns;
  for (int i = 0; i < state_->columns; ++i) columns += fmt::format("{}c{}", i == 0 ? "" : ", ", i);
  state_->rows = &rows;
  try {
    Statement(database_,
              fmt::format("INSERT OR IGNORE INTO {} ({}) SELECT {} FROM incoming", table, names, columns))
        .run();
  } catch (...) {
    // What the stream said tells more than that the statement was given up.
    if (const std::exception_ptr failure = std::exchange(state_->failure, nullptr))
      std::rethrow_exception(failure);
    throw;
  }
}

}  // namespace lumivox::results
