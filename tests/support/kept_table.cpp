#include "support/kept_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "lumivox/base/file.h"
#include "lumivox/results/runs.h"
#include "support/support.h"
#include "support/techniques.h"

namespace lumivox::test {
namespace {

std::filesystem::path keptFile() {
  return sourceDirectory() / "docs/benchmarks/measured_tables.json";
}

bool areKeptAnew() {
  const char* keep = std::getenv("LUMIVOX_KEEP_TABLES");
  return keep != nullptr && std::string(keep) == "1";
}

}  // namespace

KeptTable::KeptTable(const std::string& name, std::vector<MeasuredTable::Column> columns) {
  table_.name = name;
  table_.test = Catch::getResultCapture().getCurrentTestName();
  table_.device = device().info().renderer;
  table_.date = dateText();
  table_.columns = std::move(columns);
}

void KeptTable::row(const std::string& name, std::initializer_list<double> values) {
  REQUIRE(values.size() == table_.columns.size());
  table_.rows.push_back({name, values});
  // Printed as progress.
  std::printf("%s:", name.c_str());
  const char* between = "";
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(table_.rows.back().values[i])) continue;
    std::printf("%s %s %.*f", between, table_.columns[i].name.c_str(), table_.columns[i].decimals,
                table_.rows.back().values[i]);
    between = ",";
  }
  std::printf("\n");
  std::fflush(stdout);
}

KeptTable::~KeptTable() noexcept(false) {
  if (std::uncaught_exceptions() > 0) return;  // the test failed before the table was complete
  try {
    table_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    std::vector<MeasuredTable> all;
    if (std::filesystem::exists(keptFile())) all = readMeasuredTables(keptFile());
    if (areKeptAnew()) {
      keep(std::move(all));
      return;
    }
    const auto kept = std::find_if(all.begin(), all.end(),
                                   [&](const MeasuredTable& one) { return one.name == table_.name; });
    compare(kept == all.end() ? nullptr : &*kept);
  } catch (const std::exception& error) {
    FAIL_CHECK(error.what());
  }
}

void KeptTable::compare(const MeasuredTable* kept) const {
  if (kept == nullptr) {
    FAIL_CHECK(table_.name << " is not kept in " << keptFile().string() << "; ./test --slow --keep keeps it");
    return;
  }
  for (const std::string& difference : differences(*kept, table_, absent_))
    FAIL_CHECK(difference << " (kept " << kept->date << ", " << kept->device << ")");
}

void KeptTable::keep(std::vector<MeasuredTable> all) const {
  MeasuredTable anew = table_;
  const auto place =
      std::lower_bound(all.begin(), all.end(), table_.name,
                       [](const MeasuredTable& one, const std::string& name) { return one.name < name; });
  if (place != all.end() && place->name == table_.name) {
    for (const MeasuredTable::Row& row : place->rows)
      if (std::any_of(absent_.begin(), absent_.end(),
                      [&](const std::string& beginning) { return row.name.rfind(beginning, 0) == 0; }))
        anew.rows.push_back(row);
    *place = std::move(anew);
  } else {
    all.insert(place, std::move(anew));
  }
  writeFileAtomically(keptFile(), measuredTablesAsJson(all));
  SUCCEED("kept");
}

}  // namespace lumivox::test
