// The voxels that a run's indirect light is gathered from: in the store, in JSON and in tables.
#include <cmath>
#include <sstream>

#include "lumivox/base/file.h"
#include "lumivox/results/csv.h"
#include "lumivox/results/json.h"
#include "results_sql.h"
#include "stored_records.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// Of a row of a table without quoted fields.
std::string fieldOf(const std::string& csv, std::size_t row, const std::string& column) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    rows.emplace_back();
    std::istringstream fields(line + ",");
    for (std::string field; std::getline(fields, field, ',');) rows.back().push_back(field);
  }
  for (std::size_t i = 0; i < rows.at(0).size(); ++i)
    if (rows[0][i] == column) return rows.at(row).at(i);
  return "no column " + column;
}

StoredRun plainRun() {
  StoredRun run = runNumber(1);
  run.identity.device = "device";  // without a comma
  run.identity.display.clear();
  run.point.whyNotCounted.clear();
  run.point.healthFindings.clear();
  return run;
}

StoredRun runNotJudged() {
  StoredRun run = plainRun();
  run.identity.parameters["cones"] = "2";
  run.point.voxels = GatheredVoxels();
  run.point.voxels->output = "voxels.fragments";
  run.point.voxels->kind = "VoxelFragments";
  run.point.voxels->resolution = {512, 512, 512};
  run.point.voxels->whyNot = "too many";
  return run;
}

StoredRun runWithout() {
  StoredRun run = plainRun();
  run.identity.parameters["cones"] = "3";
  run.point.voxels.reset();
  return run;
}

}  // namespace

TEST_CASE("voxels beside errors come back from the store with every count, and go with their run") {
  const TemporaryDirectory directory;
  ResultsStore store(directory.path() / "results.sqlite"), other(directory.path() / "other.sqlite");
  for (const StoredRun& run : {plainRun(), runNotJudged(), runWithout()}) store.add(run);
  other.merge(store);
  const auto voxels = [](const ResultsStore& in, const StoredRun& run) {
    return in.find(run.identity.key()).value().point.voxels;
  };
  for (const ResultsStore* in : {&store, &other}) {
    CHECK(toJson(voxels(*in, plainRun())) == toJson(std::optional(someVoxels())));
    CHECK(voxels(*in, runNotJudged()).value().whyNot == "too many");
    CHECK_FALSE(voxels(*in, runWithout()));
  }
  CHECK(store.remove({}) == 3);
  store.add(runWithout());
  CHECK_FALSE(voxels(store, runWithout()));
}

TEST_CASE("the store says recall and precision in columns, and none of voxels that were not judged") {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "results.sqlite";
  {
    ResultsStore store(file);
    for (const StoredRun& run : {plainRun(), runNotJudged()}) store.add(run);
  }
  CHECK(selected(file, "SELECT recall, precision FROM voxels ORDER BY run") == "0.8 0.8\nnull null");
}

TEST_CASE("a table of runs has recall, precision and holes beside every error, empty where there are none") {
  const std::string csv = runsCsv({plainRun(), runNotJudged(), runWithout()});
  const auto [column, judged, notJudged] = GENERATE(table<const char*, const char*, const char*>({
      {"voxels", "voxels.fragments", "voxels.fragments"},
      {"recall", "0.8", ""},
      {"precision", "0.8", ""},
      {"axis_holes", "0.025", ""},
      {"oblique_holes", "0.01", ""},
      {"voxels_not_judged", "", "too many"},
  }));
  CHECK(fieldOf(csv, 1, column) == judged);
  CHECK(fieldOf(csv, 2, column) == notJudged);
  CHECK(fieldOf(csv, 3, column).empty());
  // The header does not depend on the runs.
  CHECK(runsCsv({}).find(std::string(",") + column + ",") != std::string::npos);
}

TEST_CASE("a point says its voxels as JSON: numbers, why they were not judged, or null") {
  const auto voxelsOf = [](const StoredRun& run) { return toJson(run.point, true).at("voxels"); };
  const auto [path, judged, notJudged] = GENERATE(table<const char*, nlohmann::json, nlohmann::json>({
      {"/output", "voxels.fragments", "voxels.fragments"},
      {"/kind", "VoxelFragments", "VoxelFragments"},
      {"/resolution/1", 16, 512},
      {"/recall", 0.8, nullptr},
      {"/precision", 0.8, nullptr},
      {"/axis_holes", 0.025, nullptr},
      {"/oblique_holes", 0.01, nullptr},
      {"/occupied", 103, 0},
      {"/reference", 100, 0},
      {"/undecided", 7, 0},
      {"/why_not", "", "too many"},
      {"/true_positive", 80, 0},
      {"/holes/axis_holes", 10, 0},
  }));
  CAPTURE(path);
  CHECK(voxelsOf(plainRun()).at(nlohmann::ordered_json::json_pointer(path)) == judged);
  CHECK(voxelsOf(runNotJudged()).at(nlohmann::ordered_json::json_pointer(path)) == notJudged);
  CHECK(voxelsOf(runWithout()).is_null());
}
