// The schema of the results store: earlier ones, foreign files, and the guide.
#include <sqlite3.h>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "stored_records.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

void execute(const std::filesystem::path& file, const std::string& sql) {
  sqlite3* handle = nullptr;
  REQUIRE(sqlite3_open(file.c_str(), &handle) == SQLITE_OK);
  REQUIRE(sqlite3_exec(handle, sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK);
  sqlite3_close(handle);
}

/// Undoes schema 8.
const std::string kWithout8 = "DROP TABLE wanted; DROP TABLE reports; ";

/// Undoes schemas 8 and 7.
const std::string kWithout7 = kWithout8 + "DROP TABLE voxels; ";

/// Undoes schemas 8 to 6.
const std::string kWithout6 = kWithout7 + "ALTER TABLE runs DROP COLUMN complete; ";

/// Undoes schemas 8 to 5.
const std::string kWithout5 =
    kWithout6 +
    "ALTER TABLE images RENAME COLUMN reference TO truth; ALTER TABLE images RENAME TO pictures; "
    "ALTER TABLE peak_rates RENAME TO ceilings; ALTER TABLE stress_cells RENAME COLUMN image TO picture; "
    "UPDATE stress_cells SET family = 'picture_and_camera' WHERE family = 'image_and_camera'; "
    "ALTER TABLE errors RENAME COLUMN reference TO truth; "
    "ALTER TABLE runs RENAME COLUMN reference_samples TO truth_samples; "
    "UPDATE metrics SET name = 'non_finite_truth' WHERE name = 'non_finite_reference'; "
    "UPDATE metrics SET name = 'non_finite_picture' WHERE name = 'non_finite_image'; ";

/// Undoes schemas 8 to 4.
const std::string kWithout4 =
    kWithout5 +
    "DROP TABLE notes; DROP TABLE pictures; DROP TABLE controls; DROP TABLE claims; "
    "ALTER TABLE errors DROP COLUMN per_seed; ";

/// A store as an earlier version left it.
std::filesystem::path oldStore(const TemporaryDirectory& directory) {
  const auto file = directory.path() / "old.sqlite";
  execute(file, readFile(sourceDirectory() / "tests/laboratory/data/results_schema_1.sql"));
  return file;
}

std::int64_t schemaOf(const std::filesystem::path& file) {
  sqlite3* handle = nullptr;
  REQUIRE(sqlite3_open(file.c_str(), &handle) == SQLITE_OK);
  std::int64_t version = 0;
  const auto read = [](void* result, int, char** values, char**) {
    *static_cast<std::int64_t*>(result) = std::atoll(values[0]);
    return 0;
  };
  REQUIRE(sqlite3_exec(handle, "PRAGMA user_version", read, &version, nullptr) == SQLITE_OK);
  sqlite3_close(handle);
  return version;
}

}  // namespace

TEST_CASE("a store of the schema before is read as it is, and gets the new tables when it is written") {
  const TemporaryDirectory directory;
  const auto file = oldStore(directory);
  {
    const ResultsStore store(file, ResultsStore::Mode::read);
    const std::vector<StoredRun> runs = store.runs();
    REQUIRE(runs.size() == 1);
    CHECK(runs[0].sceneName == "Cornell box");
    CHECK(runs[0].identity.width == 8);
    CHECK(runs[0].point.passOrder == std::vector<std::string>{"gbuffer", "shadow", "direct"});
    REQUIRE_FALSE(runs[0].point.errors.empty());
    // Its RMSE is over the seeds, the other numbers are of the first seed alone.
    CHECK_FALSE(runs[0].point.errors[0].everyMetricPerSeed);
    CHECK(runs[0].point.notes.empty());
    CHECK(store.images(runs[0].identity.key()).empty());
    CHECK(store.controls(runs[0].identity).empty());
    CHECK_FALSE(store.claimedByOther(runs[0].identity.key()));
    CHECK(store.stressCells().empty());
    CHECK(store.peakRates().empty());
  }
  CHECK(schemaOf(file) == 1);
  // A merge reads it without touching it.
  ResultsStore other(directory.path() / "new.sqlite");
  CHECK(other.merge(ResultsStore(file, ResultsStore::Mode::read)).runs == 1);
  CHECK(schemaOf(file) == 1);
  {
    ResultsStore store(file);
    CHECK(store.runs().size() == 1);
    store.add({cellNumber(1)});
    CHECK(store.stressCells().size() == 1);
  }
  CHECK(schemaOf(file) == 8);
  CHECK(ResultsStore(file, ResultsStore::Mode::read).runs().size() == 1);
}

TEST_CASE("the RMSE of a store of schema 3 is that over the seeds with both uncertainties") {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "old.sqlite";
  StoredRun run = runNumber(1);
  run.point.errors[0].deterministic = false;
  run.point.errors[0].seeds = 5;
  {
    ResultsStore store(file);
    store.add(run);
  }
  // As schema 3 was: the first seed's RMSE with the reference's noise, and beside it mean and spread over
  // seeds.
  execute(file, kWithout4 +
                    "UPDATE metrics SET value = 7, uncertainty = 0.03 WHERE name = 'rmse';"
                    "INSERT INTO metrics VALUES (1, 0, 'rmse_over_seeds', 8, 0.04, 1);"
                    "PRAGMA user_version = 3");
  const auto check = [](const StoredRun& found) {
    const ComponentError& error = found.point.errors.at(0);
    CHECK(error.error.rmse.value == 8.0);
    CHECK(error.error.rmse.uncertainty == Approx(0.05));
    for (const NamedMetric& metric : metricsOf(error)) {
      INFO(metric.name);
      if (metric.name == "rmse") CHECK(metric.measured.enoughRepeats);
      if (metric.name == "flip") CHECK_FALSE(metric.measured.enoughRepeats);
    }
  };
  check(ResultsStore(file, ResultsStore::Mode::read).runs().at(0));
  CHECK(schemaOf(file) == 3);
  ResultsStore merged(directory.path() / "new.sqlite");
  merged.merge(ResultsStore(file, ResultsStore::Mode::read));
  check(merged.runs().at(0));
  ResultsStore upgraded(file);
  CHECK(schemaOf(file) == 8);
  check(upgraded.runs().at(0));
  upgraded.add(runNumber(2));
  CHECK(upgraded.runs().at(1).point.errors.at(0).everyMetricPerSeed);
}

TEST_CASE("a store without work is read as it is, and keeps work when it is written") {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "old.sqlite";
  {
    ResultsStore store(file);
    store.add(runNumber(1));
    store.add({cellNumber(1)});
  }
  // As schema 2 was.
  execute(file, kWithout4 + "DROP TABLE work; PRAGMA user_version = 2");
  {
    const ResultsStore store(file, ResultsStore::Mode::read);
    REQUIRE(store.runs().size() == 1);
    CHECK(store.runs()[0].point.passWork.empty());
    CHECK(store.runs()[0].point.errors.size() == 1);
    CHECK(store.stressCells().size() == 1);
  }
  CHECK(schemaOf(file) == 2);
  ResultsStore store(file);
  CHECK(schemaOf(file) == 8);
  CHECK(store.add(runNumber(2)));
  const std::vector<StoredRun> runs = store.runs();
  REQUIRE(runs.size() == 2);
  CHECK(runs[0].point.passWork.empty());
  CHECK(runs[1].point.passWork == runNumber(2).point.passWork);
  CHECK(store.stressCells().size() == 1);
}

TEST_CASE("a store of schema 4, which had other words for the same things, is read, merged and written on") {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "old.sqlite";
  StoredRun run = runNumber(1);
  run.point.errors[0].error.nonFiniteReference = 3;
  run.identity.referenceSamples = 37;
  StressCell cell = cellNumber(1);
  cell.family = "image_and_camera";
  {
    ResultsStore store(file);
    store.add(run, {{"final", "full", "full", 0.25, "png"}});
    store.add({cell});
    PeakRate rate;
    rate.name = "writes";
    store.add(std::vector{rate});
  }
  execute(file, kWithout5 + "PRAGMA user_version = 4");
  const auto check = [&](const ResultsStore& store) {
    const StoredRun found = store.runs().at(0);
    CHECK(found.identity.referenceSamples == 37);
    CHECK(found.identity.key() == run.identity.key());
    CHECK(found.point.errors.at(0).reference == run.point.errors[0].reference);
    CHECK(found.point.errors.at(0).error.nonFiniteImage == 7);
    CHECK(found.point.errors.at(0).error.nonFiniteReference == 3);
    REQUIRE(store.images(run.identity.key()).size() == 1);
    CHECK(store.images(run.identity.key())[0].reference == "full");
    CHECK(store.stressCells().at(0).family == "image_and_camera");
    CHECK(store.stressCells().at(0).image == cell.image);
    CHECK(store.peakRates().at(0).name == "writes");
  };
  check(ResultsStore(file, ResultsStore::Mode::read));
  CHECK(schemaOf(file) == 4);
  ResultsStore merged(directory.path() / "new.sqlite");
  merged.merge(ResultsStore(file, ResultsStore::Mode::read));
  check(merged);
  CHECK(schemaOf(file) == 4);
  ResultsStore upgraded(file);
  CHECK(schemaOf(file) == 8);
  check(upgraded);
}

TEST_CASE("a store of schema 5 has no runs without times, and gets them when it is written") {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "old.sqlite";
  {
    ResultsStore store(file);
    store.add(runNumber(1));
  }
  execute(file, kWithout6 + "PRAGMA user_version = 5");
  {
    const ResultsStore store(file, ResultsStore::Mode::read);
    CHECK(store.runs().size() == 1);
    CHECK(store.contains(runNumber(1).identity.key()));
    CHECK_FALSE(store.findUntimed(runNumber(1).identity.key()));
    CHECK(store.count().runs == 1);
    CHECK(store.count().untimed == 0);
  }
  CHECK(schemaOf(file) == 5);
  ResultsStore store(file);
  CHECK(schemaOf(file) == 8);
  store.addUntimed(runNumber(2));
  CHECK(store.runs().size() == 1);
  CHECK(store.findUntimed(runNumber(2).identity.key()));
}

TEST_CASE("a store of schema 6 has no voxels beside its errors, and keeps them when it is written") {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "old.sqlite";
  {
    ResultsStore store(file);
    store.add(runNumber(1));
  }
  execute(file, kWithout7 + "PRAGMA user_version = 6");
  {
    const ResultsStore store(file, ResultsStore::Mode::read);
    REQUIRE(store.runs().size() == 1);
    CHECK_FALSE(store.runs()[0].point.voxels);
  }
  CHECK(schemaOf(file) == 6);
  ResultsStore store(file);
  CHECK(schemaOf(file) == 8);
  store.add(runNumber(2));
  CHECK_FALSE(store.runs().at(0).point.voxels);
  CHECK(store.runs().at(1).point.voxels);
}

TEST_CASE("the guide names every table and column of the store") {
  const std::string guide = readFile(sourceDirectory() / "docs/results.md");
  const TemporaryDirectory directory;
  const auto file = directory.path() / "results.sqlite";
  { ResultsStore store(file); }
  sqlite3* handle = nullptr;
  REQUIRE(sqlite3_open(file.c_str(), &handle) == SQLITE_OK);
  std::vector<std::string> names;
  const auto read = [](void* result, int, char** values, char**) {
    static_cast<std::vector<std::string>*>(result)->push_back(std::string(values[0]) + " " + values[1]);
    return 0;
  };
  REQUIRE(sqlite3_exec(handle,
                       "SELECT m.name, c.name FROM sqlite_schema m JOIN pragma_table_info(m.name) c WHERE "
                       "m.type = 'table'",
                       read, &names, nullptr) == SQLITE_OK);
  sqlite3_close(handle);
  CHECK(names.size() > 60);
  for (const std::string& name : names) {
    const std::string table = name.substr(0, name.find(' ')), column = name.substr(name.find(' ') + 1);
    INFO(name);
    CHECK(guide.find("`" + table + "`") != std::string::npos);
    CHECK(guide.find("`" + column + "`") != std::string::npos);
  }
}

TEST_CASE("what is no results store is refused and stays as it was") {
  const TemporaryDirectory directory;
  const auto text = directory.write(
      "notes.txt", "This is no database, but long enough to look like one. " + std::string(2000, 'x'));
  const std::string before = readFile(text);
  CHECK(messageOf<Error>([&] { ResultsStore store(text); }).find("notes.txt") != std::string::npos);
  CHECK(readFile(text) == before);
  CHECK(messageOf<Error>([&] {
          ResultsStore store(directory.path() / "absent", ResultsStore::Mode::read);
        }).find("there is no results store") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(directory.path() / "absent"));

  const auto foreign = directory.path() / "foreign.sqlite";
  execute(foreign, "CREATE TABLE a (b); PRAGMA user_version = 1");
  CHECK(messageOf<Error>([&] { ResultsStore store(foreign); }).find("another kind") != std::string::npos);

  const auto later = directory.path() / "later.sqlite";
  { ResultsStore store(later); }
  execute(later, "PRAGMA user_version = 99");
  CHECK(messageOf<Error>([&] { ResultsStore store(later); }).find("schema 99") != std::string::npos);

  CHECK(messageOf<Error>([&] { ResultsStore store("/proc/results.sqlite"); }).find("/proc") !=
        std::string::npos);
}
