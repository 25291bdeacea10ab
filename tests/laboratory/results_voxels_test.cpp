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
  ResultsStore store(directory.path() / "results.sqlite");
  for (const StoredRun& run : {plainRun(), runNotJudged(), runWithout()}) store.add(run);
  const auto voxels = [&](const StoredRun& run) {
    return store.find(run.identity.key()).value().point.voxels;
  };
  const GatheredVoxels wanted = someVoxels(), back = voxels(plainRun()).value();
  CHECK(back.output == wanted.output);
  CHECK(back.kind == wanted.kind);
  CHECK(back.whyNot.empty());
  CHECK(back.resolution == wanted.resolution);
  CHECK(back.occupied == wanted.occupied);
  CHECK(back.reference == wanted.reference);
  CHECK(back.undecided == wanted.undecided);
  CHECK(back.error.truePositive == 80);
  CHECK(back.error.falsePositive == 20);
  CHECK(back.error.falseNegative == 20);
  CHECK(back.holes.axisCrossings == 400);
  CHECK(back.holes.axisHoles == 10);
  CHECK(back.holes.obliqueCrossings == 300);
  CHECK(back.holes.obliqueHoles == 3);
  CHECK(voxels(runNotJudged()).value().whyNot == "too many");
  CHECK_FALSE(voxels(runWithout()));

  // A merge takes them along.
  ResultsStore other(directory.path() / "other.sqlite");
  other.merge(store);
  CHECK(other.find(plainRun().identity.key()).value().point.voxels->error.truePositive == 80);
  RunFilter all;
  CHECK(store.remove(all) == 3);
  store.add(runWithout());
  CHECK_FALSE(voxels(runWithout()));
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
  CHECK(fieldOf(csv, 1, "voxels") == "voxels.fragments");
  CHECK(fieldOf(csv, 1, "recall") == "0.8");
  CHECK(fieldOf(csv, 1, "precision") == "0.8");
  CHECK(fieldOf(csv, 1, "axis_holes") == "0.025");
  CHECK(fieldOf(csv, 1, "oblique_holes") == "0.01");
  CHECK(fieldOf(csv, 1, "voxels_not_judged").empty());
  CHECK(fieldOf(csv, 2, "voxels") == "voxels.fragments");
  CHECK(fieldOf(csv, 2, "voxels_not_judged") == "too many");
  CHECK(fieldOf(csv, 2, "recall").empty());
  CHECK(fieldOf(csv, 3, "voxels").empty());
  CHECK(fieldOf(csv, 3, "recall").empty());
  // The header does not depend on the runs.
  CHECK(runsCsv({}).find(",recall,precision,axis_holes,oblique_holes,") != std::string::npos);
}

TEST_CASE("a point says its voxels as JSON: numbers, or why they were not judged") {
  const auto json = toJson(plainRun()).at("voxels");
  CHECK(json.at("output") == "voxels.fragments");
  CHECK(json.at("kind") == "VoxelFragments");
  CHECK(json.at("resolution").dump() == "[32,16,8]");
  CHECK(json.at("recall") == 0.8);
  CHECK(json.at("precision") == 0.8);
  CHECK(json.at("axis_share") == 0.025);
  CHECK(json.at("oblique_share") == 0.01);
  CHECK(json.at("occupied") == 103);
  CHECK(json.at("reference") == 100);
  CHECK(json.at("undecided") == 7);
  CHECK(json.at("why_not") == "");
  CHECK(json.at("true_positive") == 80);
  CHECK(json.at("axis_holes") == 10);
  const auto notJudged = toJson(runNotJudged()).at("voxels");
  CHECK(notJudged.at("why_not") == "too many");
  CHECK_FALSE(notJudged.contains("recall"));
  CHECK_FALSE(notJudged.contains("occupied"));
  CHECK_FALSE(toJson(runWithout()).contains("voxels"));
}
