// The stress battery's cells and the devices' peak rates in the results store.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "lumivox/base/hash.h"
#include "lumivox/results/store.h"
#include "results/database.h"
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

void ResultsStore::add(const std::vector<StressCell>& cells) {
  Transaction transaction(state_->database);
  state_->addCells(cells);
  transaction.commit();
}

/// Inside a transaction.
void ResultsStore::State::addCells(const std::vector<StressCell>& cells) {
  Statement remove(database, "DELETE FROM stress_cells WHERE key = ?");
  Statement insert(
      database, "INSERT INTO stress_cells VALUES (NULL,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
  Statement provenance(database, "INSERT INTO stress_provenance VALUES (?,?,?)");
  for (const StressCell& cell : cells) {
    remove.run(cell.key());
    insert.run(cell.key(), cell.created, cell.version, cell.family, cell.name, cell.pipeline, cell.technique,
               cell.size, lumivox::name(cell.outcome), cell.measure, cell.unit, cell.value.value,
               cell.value.uncertainty, cell.limit, cell.detail, cell.explanation, cell.image, cell.command,
               cell.seconds, cell.pipelineHash, cell.framework, cell.device, cell.driver, cell.shaderInput,
               cell.host);
    const std::int64_t id = database.lastRow();
    for (const auto& [technique, hash] : cell.techniques) provenance.run(id, technique, hash);
  }
}

std::vector<StressCell> ResultsStore::stressCells(const CellFilter& filter) const {
  std::vector<StressCell> cells;
  if (state_->schema < 2) return cells;
  Statement row(state_->database, "SELECT * FROM stress_cells ORDER BY id");
  Statement provenance(state_->database, "SELECT technique, hash FROM stress_provenance WHERE cell = ?");
  while (row.step()) {
    StressCell cell;
    cell.id = row.integer(0);
    cell.created = row.text(2);
    cell.version = row.text(3);
    cell.family = row.text(4);
    cell.name = row.text(5);
    cell.pipeline = row.text(6);
    cell.technique = row.text(7);
    cell.size = row.text(8);
    cell.outcome = stressOutcomeNamed(row.text(9)).value_or(StressOutcome::broken);
    cell.measure = row.text(10);
    cell.unit = row.text(11);
    cell.value = {row.number(12), row.number(13)};
    cell.limit = row.number(14);
    cell.detail = row.text(15);
    cell.explanation = row.text(16);
    cell.image = row.text(17);
    cell.command = row.text(18);
    cell.seconds = row.number(19);
    cell.pipelineHash = row.text(20);
    cell.framework = row.text(21);
    cell.device = row.text(22);
    cell.driver = row.text(23);
    cell.shaderInput = row.text(24);
    cell.host = row.text(25);
    if (!matches(filter, cell)) continue;
    for (provenance.bind(cell.id); provenance.step();)
      cell.techniques[provenance.text(0)] = provenance.text(1);
    cells.push_back(std::move(cell));
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
  state_->addPeakRates(peakRates);
  transaction.commit();
}

/// Inside a transaction.
void ResultsStore::State::addPeakRates(const std::vector<PeakRate>& peakRates) {
  Statement insert(database, "INSERT OR REPLACE INTO peak_rates VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
  for (const PeakRate& peakRate : peakRates)
    insert.run(peakRate.device, peakRate.driver, peakRate.shaderInput, peakRate.host, peakRate.name,
               peakRate.unit, peakRate.created, peakRate.version, peakRate.rate.median,
               peakRate.rate.lowerQuartile, peakRate.rate.upperQuartile, peakRate.rate.smallest,
               peakRate.rate.largest, peakRate.rate.repeats);
}

std::vector<PeakRate> ResultsStore::peakRates() const {
  std::vector<PeakRate> peakRates;
  if (state_->schema < 2) return peakRates;
  Statement row(state_->database,
                "SELECT name, unit, created, version, median, lower_quartile, upper_quartile, smallest, "
                "largest, repeats, device, driver, shader_input, host FROM peak_rates "
                "ORDER BY device, driver, shader_input, host, name");
  while (row.step()) {
    PeakRate peakRate{row.text(0),  row.text(1),  {},           row.text(2), row.text(3),
                      row.text(10), row.text(11), row.text(12), row.text(13)};
    peakRate.rate = {row.number(4), row.number(5), row.number(6),
                     row.number(7), row.number(8), static_cast<int>(row.integer(9))};
    peakRates.push_back(std::move(peakRate));
  }
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
