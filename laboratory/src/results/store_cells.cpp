// The stress battery's cells and the devices' peak rates in the results store.
#include <fmt/format.h>

#include <algorithm>

#include "lumivox/base/hash.h"
#include "lumivox/results/store.h"
#include "results/database.h"
#include "results/field_json.h"
#include "results/store_state.h"

namespace lumivox {

using results::Record;
using results::Statement;
using results::Transaction;

namespace results {

bool namesFile(const std::string& wanted, const std::string& file) {
  return wanted == file || std::filesystem::path(file).stem() == wanted;
}

std::vector<Record> records(const std::vector<StressCell>& cells) {
  std::vector<Record> records;
  for (const StressCell& cell : cells) records.push_back({cell.key(), cell.created, recordText(cell)});
  return records;
}

std::vector<Record> records(const std::vector<PeakRate>& peakRates) {
  std::vector<Record> records;
  for (const PeakRate& rate : peakRates) {
    Hasher hasher;
    hasher.add(rate.device).add(rate.driver).add(rate.shaderInput).add(rate.host).add(rate.name);
    records.push_back({hasher.finish().text(), rate.created, recordText(rate)});
  }
  return records;
}

}  // namespace results

namespace {

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

void ResultsStore::State::put(const char* table, const std::vector<Record>& records) {
  Statement remove(database, fmt::format("DELETE FROM {} WHERE key = ?", table).c_str());
  Statement insert(database, fmt::format("INSERT INTO {} (key, record) VALUES (?, ?)", table).c_str());
  for (const Record& record : records) {
    remove.run(record.key);
    insert.run(record.key, record.json);
  }
}

std::size_t ResultsStore::State::putNewer(const char* table, const std::vector<Record>& records) {
  Statement mine(database, fmt::format("SELECT created FROM {} WHERE key = ?", table).c_str());
  std::vector<Record> newer;
  for (const Record& record : records)
    if (!mine.bind(record.key).step() || mine.text(0) < record.created) newer.push_back(record);
  mine.reset();
  put(table, newer);
  return newer.size();
}

std::vector<Record> ResultsStore::State::records(const char* table) const {
  std::vector<Record> records;
  Statement row(database, fmt::format("SELECT key, created, record FROM {} ORDER BY id", table).c_str());
  while (row.step()) records.push_back({row.text(0), row.text(1), row.text(2)});
  return records;
}

void ResultsStore::add(const std::vector<StressCell>& cells) {
  Transaction transaction(state_->database);
  state_->put("stress_cells", results::records(cells));
  transaction.commit();
}

std::vector<StressCell> ResultsStore::stressCells(const CellFilter& filter) const {
  std::vector<StressCell> cells;
  Statement row(state_->database, "SELECT id, record FROM stress_cells ORDER BY id");
  while (row.step()) {
    auto cell = results::recordFrom<StressCell>(row.text(1));
    cell.id = row.integer(0);
    if (matches(filter, cell)) cells.push_back(std::move(cell));
  }
  return cells;
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
  state_->put("peak_rates", results::records(peakRates));
  transaction.commit();
}

std::vector<PeakRate> ResultsStore::peakRates() const {
  std::vector<PeakRate> peakRates;
  Statement row(state_->database,
                "SELECT record FROM peak_rates ORDER BY device, driver, shader_input, host, name");
  while (row.step()) peakRates.push_back(results::recordFrom<PeakRate>(row.text(0)));
  return peakRates;
}

std::vector<PeakRate> ResultsStore::peakRates(const std::string& device, const std::string& driver,
                                              const std::string& shaderInput, const std::string& host) const {
  std::vector<PeakRate> result = peakRates();
  result.erase(std::remove_if(result.begin(), result.end(),
                              [&](const PeakRate& one) {
                                return one.device != device || one.driver != driver ||
                                       one.shaderInput != shaderInput || one.host != host;
                              }),
               result.end());
  return result;
}

}  // namespace lumivox
