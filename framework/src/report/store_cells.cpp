// The stress battery's cells and the devices' ceilings in the results store.
#include <fmt/format.h>

#include <array>

#include "lumivox/base/hash.h"
#include "lumivox/report/store.h"
#include "report/database.h"
#include "report/store_state.h"

namespace lumivox {

using report::Statement;
using report::Transaction;

namespace {

constexpr std::array kOutcomes{"stable", "biased", "diverges", "refused", "not_applicable", "broken"};

}  // namespace

const char* name(StressOutcome outcome) {
  return kOutcomes.at(static_cast<std::size_t>(outcome));
}

std::optional<StressOutcome> stressOutcomeNamed(const std::string& name) {
  for (std::size_t i = 0; i < kOutcomes.size(); ++i)
    if (name == kOutcomes[i]) return static_cast<StressOutcome>(i);
  return std::nullopt;
}

std::string StressCell::key() const {
  Hasher hasher;
  hasher.add(family).add(name).add(pipelineHash).add(size).add(framework);
  hasher.add(std::uint64_t{techniques.size()});
  for (const auto& [used, hash] : techniques) hasher.add(used).add(hash);
  hasher.add(device).add(driver).add(shaderInput).add(host);
  return hasher.finish().text();
}

void ResultsStore::add(const std::vector<StressCell>& cells) {
  Transaction transaction(state_->database);
  Statement remove(state_->database, "DELETE FROM stress_cells WHERE key = ?");
  Statement insert(
      state_->database,
      "INSERT INTO stress_cells VALUES (NULL,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
  Statement provenance(state_->database, "INSERT INTO stress_provenance VALUES (?,?,?)");
  for (const StressCell& cell : cells) {
    remove.run(cell.key());
    insert.run(cell.key(), cell.created, cell.version, cell.family, cell.name, cell.pipeline, cell.technique,
               cell.size, lumivox::name(cell.outcome), cell.measure, cell.unit, cell.value.value,
               cell.value.uncertainty, cell.limit, cell.detail, cell.explanation, cell.picture, cell.command,
               cell.seconds, cell.pipelineHash, cell.framework, cell.device, cell.driver, cell.shaderInput,
               cell.host);
    const std::int64_t id = state_->database.lastRow();
    for (const auto& [technique, hash] : cell.techniques) provenance.run(id, technique, hash);
  }
  transaction.commit();
}

std::vector<StressCell> ResultsStore::stressCells() const {
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
    cell.picture = row.text(17);
    cell.command = row.text(18);
    cell.seconds = row.number(19);
    cell.pipelineHash = row.text(20);
    cell.framework = row.text(21);
    cell.device = row.text(22);
    cell.driver = row.text(23);
    cell.shaderInput = row.text(24);
    cell.host = row.text(25);
    for (provenance.bind(cell.id); provenance.step();)
      cell.techniques[provenance.text(0)] = provenance.text(1);
    cells.push_back(std::move(cell));
  }
  return cells;
}

void ResultsStore::add(const std::vector<DeviceCeiling>& ceilings) {
  Transaction transaction(state_->database);
  Statement insert(state_->database, "INSERT OR REPLACE INTO ceilings VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
  for (const DeviceCeiling& ceiling : ceilings)
    insert.run(ceiling.device, ceiling.driver, ceiling.shaderInput, ceiling.host, ceiling.name, ceiling.unit,
               ceiling.created, ceiling.version, ceiling.rate.median, ceiling.rate.lowerQuartile,
               ceiling.rate.upperQuartile, ceiling.rate.smallest, ceiling.rate.largest, ceiling.rate.repeats);
  transaction.commit();
}

std::vector<DeviceCeiling> ResultsStore::ceilings(const std::string& device, const std::string& driver,
                                                  const std::string& shaderInput,
                                                  const std::string& host) const {
  std::vector<DeviceCeiling> ceilings;
  if (state_->schema < 2) return ceilings;
  Statement row(
      state_->database,
      "SELECT name, unit, created, version, median, lower_quartile, upper_quartile, smallest, largest, "
      "repeats FROM ceilings WHERE device = ? AND driver = ? AND shader_input = ? AND host = ? ORDER BY name");
  for (row.bind(device, driver, shaderInput, host); row.step();)
    ceilings.push_back({row.text(0),
                        row.text(1),
                        {row.number(4), row.number(5), row.number(6), row.number(7), row.number(8),
                         static_cast<int>(row.integer(9))},
                        row.text(2),
                        row.text(3),
                        device,
                        driver,
                        shaderInput,
                        host});
  return ceilings;
}

}  // namespace lumivox
