// Stores cells of the stress battery and peak rates of devices.
#include <fmt/format.h>

#include <algorithm>

#include "lumivox/base/hash.h"
#include "lumivox/results/store.h"
#include "results/record_rows.h"
#include "results/store_state.h"

namespace lumivox {

using results::Statement;
using results::Transaction;

namespace results {

bool namesFile(const std::string& wanted, const std::string& file) {
  return wanted == file || std::filesystem::path(file).stem() == wanted;
}

}  // namespace results

namespace {

std::string keyOf(const StressCell& cell) {
  return cell.key();
}

std::string keyOf(const PeakRate& rate) {
  Hasher hasher;
  hasher.add(rate.device).add(rate.driver).add(rate.shaderInput).add(rate.host).add(rate.name);
  return hasher.finish().text();
}

bool matches(const CellFilter& filter, const StressCell& cell) {
  const auto same = [](const std::string& wanted, const std::string& found) {
    return wanted.empty() || wanted == found;
  };
  return same(filter.family, cell.family) && same(filter.name, cell.name) &&
         same(filter.technique, cell.technique) &&
         (filter.pipeline.empty() || results::namesFile(filter.pipeline, cell.pipeline)) &&
         cell.device.find(filter.device) != std::string::npos && cell.created >= filter.since &&
         (!filter.outcome || *filter.outcome == cell.outcome) &&
         (filter.ids.empty() || std::find(filter.ids.begin(), filter.ids.end(), cell.id) != filter.ids.end());
}

}  // namespace

bool CellFilter::everything() const {
  return family.empty() && name.empty() && pipeline.empty() && technique.empty() && device.empty() &&
         since.empty() && !outcome && ids.empty();
}

template <class T>
std::size_t ResultsStore::State::put(const char* table, const std::vector<T>& records, bool olderAlone) {
  Statement newer(database, fmt::format("SELECT created, {} FROM {} WHERE key = ? AND created >= ?",
                                        results::columnNames<T>(), table));
  Statement remove(database, fmt::format("DELETE FROM {} WHERE key = ?", table));
  Statement insert(database, results::insertSql<T>(table, "key"));
  std::size_t count = 0;
  for (const T& record : records) {
    const std::string key = keyOf(record);
    // Of two of one second the same one stays, whichever came first.
    const bool stays =
        olderAlone && newer.bind(key, record.created).step() &&
        (newer.text(0) > record.created ||
         results::jsonOf(results::recordAt<T>(newer, 1)).dump() >= results::jsonOf(record).dump());
    newer.reset();
    if (stays) continue;
    remove.run(key);
    insert.bindOne(1, key);
    results::bindRecord(insert, 2, record);
    insert.run();
    ++count;
  }
  return count;
}

template std::size_t ResultsStore::State::put(const char*, const std::vector<StressCell>&, bool);
template std::size_t ResultsStore::State::put(const char*, const std::vector<PeakRate>&, bool);

void ResultsStore::add(const std::vector<StressCell>& cells) {
  Transaction transaction(state_->database);
  state_->put("stress_cells", cells, /*olderAlone=*/false);
  transaction.commit();
}

std::vector<StressCell> ResultsStore::stressCells(const CellFilter& filter) const {
  std::vector<StressCell> cells;
  Statement row(state_->database, fmt::format("SELECT id, {} FROM stress_cells ORDER BY id",
                                              results::columnNames<StressCell>()));
  while (row.step()) {
    auto cell = results::recordAt<StressCell>(row, 1);
    cell.id = row.integer(0);
    if (matches(filter, cell)) cells.push_back(std::move(cell));
  }
  return cells;
}

bool ResultsStore::hasCell(const std::string& key) const {
  Statement row(state_->database, "SELECT 1 FROM stress_cells WHERE key = ?");
  return row.bind(key).step();
}

std::size_t ResultsStore::removeCells(const CellFilter& filter) {
  const std::vector<StressCell> chosen = stressCells(filter);
  Transaction transaction(state_->database);
  Statement statement(state_->database, "DELETE FROM stress_cells WHERE id = ?");
  for (const StressCell& cell : chosen) statement.run(cell.id);
  transaction.commit();
  return chosen.size();
}

void ResultsStore::add(const std::vector<PeakRate>& peakRates) {
  Transaction transaction(state_->database);
  state_->put("peak_rates", peakRates, /*olderAlone=*/false);
  transaction.commit();
}

std::vector<PeakRate> ResultsStore::peakRates() const {
  std::vector<PeakRate> peakRates;
  Statement row(state_->database, fmt::format("SELECT {} FROM peak_rates ORDER BY device, name, id",
                                              results::columnNames<PeakRate>()));
  while (row.step()) peakRates.push_back(results::recordAt<PeakRate>(row, 0));
  return peakRates;
}

std::vector<PeakRate> ResultsStore::peakRates(const std::string& device, const std::string& driver,
                                              const std::string& shaderInput, const std::string& host) const {
  std::vector<PeakRate> result = peakRates();
  std::erase_if(result, [&](const PeakRate& one) {
    return one.device != device || one.driver != driver || one.shaderInput != shaderInput || one.host != host;
  });
  return result;
}

}  // namespace lumivox
