// Converts records to table rows by the lists of their fields: a column for each value, and a JSON column for
// each list or map.
#pragma once

#include <cstdlib>

#include "results/database.h"
#include "results/field_json.h"

namespace lumivox::results {

template <class T>
inline constexpr bool kIsDerived = false;
template <class T>
inline constexpr bool kIsDerived<Derived<T>> = true;

/// Calls visit(name, about, member) for each column. A time has a column for each of its numbers.
template <class T>
void eachColumn(T& record, auto&& visit) {
  fields(record, [&]<class M>(const Field& field, M&& member) {
    using Member = std::remove_cvref_t<M>;
    if constexpr (std::same_as<Member, TimingStatistics>) {
      fields(member, [&](const Field& part, auto& number) {
        visit(std::string(field.column) + "_" + part.name, part.about == nullptr ? nullptr : field.about,
              number);
      });
    } else if constexpr (!kIsDerived<Member>) {
      visit(std::string(field.column), field.about, member);
    }
  });
}

/// "created, version, ..."
template <class T>
const std::string& columnNames() {
  static const std::string names = [] {
    std::string text;
    T record;
    eachColumn(record, [&](const std::string& name, const char*, auto&&) {
      text += (text.empty() ? "" : ", ") + name;
    });
    return text;
  }();
  return names;
}

/// The INSERT statement with the columns `first` and those of a record.
template <class T>
std::string insertSql(const char* table, const std::string& first) {
  const std::string names = first + ", " + columnNames<T>();
  std::string values = "?";
  for (const char c : names)
    if (c == ',') values += ",?";
  return fmt::format("INSERT OR IGNORE INTO {} ({}) VALUES ({})", table, names, values);
}

/// Binds the values of the columns from `index` on.
template <class T>
void bindRecord(Statement& statement, int index, const T& record) {
  eachColumn(record, [&]<class M>(const std::string&, const char*, const M& value) {
    Json json = jsonOf(value);
    // Metrics have a table of their own.
    if constexpr (std::same_as<M, std::vector<ComponentError>>)
      for (Json& error : json) error.erase("metrics");
    statement.bindJson(index++, json);
  });
}

/// Reads a record from the columns of columnNames() from `column` on.
template <class T>
T recordAt(const Statement& row, int column) {
  T record;
  try {
    eachColumn(record, [&]<class M>(const std::string&, const char*, M& value) {
      const int at = column++;
      if constexpr (std::same_as<M, double>) {
        value = row.number(at);
      } else if constexpr (std::same_as<M, std::uint64_t>) {
        value = std::strtoull(row.text(at).c_str(), nullptr,
                              10);  // values from 2^63 on are stored as negative numbers
      } else if constexpr (std::integral<M>) {
        value = static_cast<M>(row.integer(at));
      } else if constexpr (std::same_as<M, std::string>) {
        value = row.text(at);
      } else if (const std::string text = row.text(at); !text.empty() && text != "[]" && text != "{}") {
        read(std::same_as<M, StressOutcome> ? Json(text) : Json::parse(text), value);
      }
    });
  } catch (const Json::exception& error) {
    row.fail(error.what());
  }
  return record;
}

}  // namespace lumivox::results
