#include "results/earlier_store.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "lumivox/base/error.h"
#include "results/fields.h"
#include "results/store_schema.h"

namespace lumivox::results {
namespace {

/// The names of schema 8 for a store of an earlier one: views of this connection, before the tables.
struct NamesOfOlder {
  std::int64_t until;  ///< the last schema that needs it
  std::int64_t since;  ///< the first that has the table
  const char* view;
};
constexpr NamesOfOlder kNamesOfOlder[] = {
    {4, 1, "runs AS SELECT *, truth_samples AS reference_samples, 1 AS complete FROM main.runs"},
    {5, 5, "runs AS SELECT *, 1 AS complete FROM main.runs"},
    {4, 1, "errors AS SELECT *, truth AS reference FROM main.errors"},
    {4, 1,
     "metrics AS SELECT run, position, CASE name WHEN 'non_finite_truth' THEN 'non_finite_reference' WHEN "
     "'non_finite_picture' THEN 'non_finite_image' ELSE name END AS name, value, uncertainty, of_nothing FROM main.metrics"},
    {4, 2, "stress_cells AS SELECT *, picture AS image FROM main.stress_cells"},
    {4, 2, "peak_rates AS SELECT * FROM main.ceilings"},
    {4, 4, "images AS SELECT *, truth AS reference FROM main.pictures"},
};

/// The fields of a record that the row has a column for.
template <class T>
void readRow(const Statement& row, T& record) {
  fields(record, [&]<class M>(const Field& field, M&& member) {
    using Member = std::remove_cvref_t<M>;
    const auto at = [&](const std::string& column) { return row.columnNamed(column); };
    if constexpr (std::same_as<Member, RunIdentity> || std::same_as<Member, RayHoles>) {
      readRow(row, member);
    } else if constexpr (std::same_as<Member, glm::ivec3>) {
      for (int axis = 0; axis < 3; ++axis)
        member[axis] = static_cast<int>(row.integer(*at(axis == 0   ? "width"
                                                        : axis == 1 ? "height"
                                                                    : "depth")));
    } else if (const auto column = at(field.column)) {
      if constexpr (std::same_as<Member, std::string>) member = row.text(*column);
      if constexpr (std::same_as<Member, double>) member = row.number(*column);
      if constexpr (std::integral<Member>) member = static_cast<Member>(row.integer(*column));
      if constexpr (std::same_as<Member, Against<bool>>) member.bias = row.text(*column) == "bias";
      if constexpr (std::same_as<Member, StressOutcome>)
        member = stressOutcomeNamed(row.text(*column)).value_or(StressOutcome::broken);
    }
  });
}

template <class Work>
void eachRow(const Database& database, const std::string& sql, std::int64_t id, Work work) {
  Statement row(database, sql.c_str());
  for (row.bind(id); row.step();) work(row);
}

}  // namespace

EarlierStore::EarlierStore(const std::filesystem::path& file) : database_(file, /*write=*/false) {
  if (database_.pragma("application_id") != kApplicationId)
    throw Error(fmt::format("{}: this is another kind of database; expected a results store", file.string()));
  schema_ = database_.pragma("user_version");
  if (schema_ == kSchemaVersion)
    throw Error(fmt::format(
        "{}: it has the schema of this version; lumivox results merge copies what it holds", file.string()));
  if (schema_ < 1 || schema_ > kLastEarlierSchema)
    throw Error(fmt::format("{}: it has schema {}; expected one from 1 to {}", file.string(), schema_,
                            kLastEarlierSchema));
  for (const NamesOfOlder& names : kNamesOfOlder)
    if (schema_ >= names.since && schema_ <= names.until)
      database_.execute(fmt::format("CREATE TEMP VIEW {}", names.view).c_str());
}

std::vector<EarlierStore::Run> EarlierStore::runs() const {
  std::vector<Run> runs;
  Statement row(database_, "SELECT * FROM runs WHERE complete ORDER BY id");
  while (row.step()) {
    Run run;
    const std::int64_t id = run.run.id = row.integer(0);
    readRow(row, run.run);
    readNames(run.run);
    readTimes(run.run.point, id);
    readErrors(run.run.point, id);
    if (schema_ >= 7)
      eachRow(database_, "SELECT * FROM voxels WHERE run = ?", id,
              [&](const Statement& voxels) { readRow(voxels, run.run.point.voxels.emplace()); });
    if (schema_ >= 4) {
      eachRow(database_,
              "SELECT output, component, reference, flip, png FROM images WHERE run = ? ORDER BY position",
              id, [&](const Statement& image) {
                run.images.push_back(
                    {image.text(0), image.text(1), image.text(2), image.number(3), image.bytes(4)});
              });
      eachRow(
          database_,
          "SELECT created, what, median_ms, lower_quartile_ms, upper_quartile_ms, repeats FROM controls WHERE run = ?",
          id, [&](const Statement& control) {
            TimingStatistics time;
            time.median = control.number(2);
            time.lowerQuartile = control.number(3);
            time.upperQuartile = control.number(4);
            time.repeats = static_cast<int>(control.integer(5));
            run.controls.push_back({control.text(0), control.text(1), time});
          });
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

void EarlierStore::readNames(StoredRun& run) const {
  RunIdentity& identity = run.identity;
  eachRow(database_, "SELECT name, value FROM parameters WHERE run = ?", run.id,
          [&](const Statement& row) { identity.parameters[row.text(0)] = row.text(1); });
  eachRow(database_, "SELECT kind, name, hash FROM provenance WHERE run = ?", run.id,
          [&](const Statement& row) {
            const std::string kind = row.text(0), name = row.text(1), hash = row.text(2);
            if (kind == "flicker") identity.flickerPairs = std::atoi(name.c_str());
            if (kind == "not_counted") run.point.whyNotCounted = name;
            if (kind == "kept") identity.kept.push_back(name);
            if (kind == "display") identity.display = name;
            if (kind == "scene") identity.sceneHash = hash;
            if (kind == "pipeline") identity.pipelineHash = hash;
            if (kind == "framework") identity.framework = hash;
            if (kind == "technique") identity.techniques[name] = hash;
          });
  eachRow(database_, "SELECT finding FROM health WHERE run = ? ORDER BY position", run.id,
          [&](const Statement& row) { run.point.healthFindings.push_back(row.text(0)); });
  if (schema_ >= 4)
    eachRow(database_, "SELECT note FROM notes WHERE run = ? ORDER BY position", run.id,
            [&](const Statement& row) { run.point.notes.push_back(row.text(0)); });
}

void EarlierStore::readTimes(ReportPoint& point, std::int64_t id) const {
  eachRow(database_, "SELECT * FROM timings WHERE run = ?", id, [&](const Statement& row) {
    const TimingStatistics time{row.number(3), row.number(4), row.number(5),
                                row.number(6), row.number(7), static_cast<int>(row.integer(8))};
    const std::string what = row.text(1), pass = row.text(2);
    if (what == "frame") point.frameMs = time;
    if (what == "next_frame") point.nextFrameMs = time;
    if (what == "still_frame") point.stillFrameMs = time;
    if (what == "moved_frame") point.movedFrameMs = time;
    if (what == "pass_device") point.passDeviceMs[pass] = time;
    if (what == "pass_host") point.passHostMs[pass] = time;
  });
  eachRow(database_, "SELECT name FROM passes WHERE run = ? ORDER BY position", id,
          [&](const Statement& row) { point.passOrder.push_back(row.text(0)); });
  eachRow(database_, "SELECT what, pass, bytes FROM resources WHERE run = ?", id, [&](const Statement& row) {
    (row.text(0) == "peak" ? point.peakBytes : point.passBytes[row.text(1)]) =
        static_cast<std::uint64_t>(row.integer(2));
  });
  if (schema_ >= 3)
    eachRow(database_, "SELECT pass, name, amount FROM work WHERE run = ?", id,
            [&](const Statement& row) { point.passWork[row.text(0)][row.text(1)] = row.number(2); });
}

void EarlierStore::readErrors(ReportPoint& point, std::int64_t id) const {
  Statement metric(
      database_,
      "SELECT name, value, uncertainty, of_nothing FROM metrics WHERE run = ? AND position = ? ORDER BY name");
  eachRow(database_, "SELECT * FROM errors WHERE run = ? ORDER BY position", id, [&](const Statement& row) {
    ComponentError error;
    error.everyMetricPerSeed = false;
    readRow(row, error);
    for (metric.bind(id, row.integer(1)); metric.step();) {
      const NamedMetric one{metric.text(0), {metric.number(1), metric.number(2)}, metric.number(3)};
      // Up to schema 3 mean and standard error over the seeds stood beside the RMSE of the first one, whose
      // uncertainty is the reference's noise. It comes after it by name.
      if (one.name == "rmse_over_seeds")
        error.error.rmse = {one.measured.value,
                            std::hypot(error.error.rmse.uncertainty, one.measured.uncertainty)};
      else
        setMetric(error, one);
    }
    point.errors.push_back(std::move(error));
  });
}

std::vector<StressCell> EarlierStore::cells() const {
  std::vector<StressCell> cells;
  if (schema_ < 2) return cells;
  Statement row(database_, "SELECT * FROM stress_cells ORDER BY id");
  while (row.step()) {
    StressCell cell;
    readRow(row, cell);
    if (cell.family == "picture_and_camera") cell.family = "image_and_camera";
    eachRow(database_, "SELECT technique, hash FROM stress_provenance WHERE cell = ?", row.integer(0),
            [&](const Statement& used) { cell.techniques[used.text(0)] = used.text(1); });
    cells.push_back(std::move(cell));
  }
  return cells;
}

std::vector<PeakRate> EarlierStore::peakRates() const {
  std::vector<PeakRate> rates;
  if (schema_ < 2) return rates;
  Statement row(database_, "SELECT * FROM peak_rates");
  while (row.step()) readRow(row, rates.emplace_back());
  return rates;
}

}  // namespace lumivox::results
