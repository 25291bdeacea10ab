// The schema of the results store: its SQL and the guide, earlier ones, and foreign files.
#include <cmath>
#include <cstdlib>
#include <map>
#include <sstream>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/results/json.h"
#include "results_sql.h"
#include "stored_records.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// Undoes schemas 8 to 2, one after the other.
const std::map<int, std::string> kWithout = {
    {8, "DROP TABLE wanted; DROP TABLE reports; "},
    {7, "DROP TABLE voxels; "},
    {6, "DELETE FROM runs WHERE NOT complete; ALTER TABLE runs DROP COLUMN complete; "},
    {5,
     "ALTER TABLE images RENAME COLUMN reference TO truth; ALTER TABLE images RENAME TO pictures; "
     "ALTER TABLE peak_rates RENAME TO ceilings; ALTER TABLE stress_cells RENAME COLUMN image TO picture; "
     "UPDATE stress_cells SET family = 'picture_and_camera' WHERE family = 'image_and_camera'; "
     "ALTER TABLE errors RENAME COLUMN reference TO truth; "
     "ALTER TABLE runs RENAME COLUMN reference_samples TO truth_samples; "
     "UPDATE metrics SET name = 'non_finite_truth' WHERE name = 'non_finite_reference'; "
     "UPDATE metrics SET name = 'non_finite_picture' WHERE name = 'non_finite_image'; "},
    // The first seed's RMSE with the reference's noise, and beside it mean and spread over seeds.
    {4,
     "DROP TABLE notes; DROP TABLE pictures; DROP TABLE controls; DROP TABLE claims; "
     "ALTER TABLE errors DROP COLUMN per_seed; UPDATE errors SET seeds = 5, deterministic = 0; "
     "UPDATE metrics SET value = 7, uncertainty = 0.03 WHERE name = 'rmse'; "
     "INSERT INTO metrics VALUES (1, 0, 'rmse_over_seeds', 8, 0.04, 1); "},
    {3, "DROP TABLE work; "},
    {2, "DROP TABLE stress_provenance; DROP TABLE stress_cells; DROP TABLE ceilings; "}};

/// A store as an earlier version left it, with the schema of that version.
std::filesystem::path earlierStore(const TemporaryDirectory& directory, int schema) {
  const auto file = directory.path() / ("earlier_" + std::to_string(schema) + ".sqlite");
  writeEarlierStore(file, 8);
  for (int undone = 8; undone > schema; --undone) execute(file, kWithout.at(undone));
  execute(file, "PRAGMA user_version = " + std::to_string(schema));
  return file;
}

}  // namespace

TEST_CASE("a store of every earlier schema is imported: all that it holds, once, and it stays as it was") {
  const int schema = GENERATE(range(1, 9));
  CAPTURE(schema);
  const TemporaryDirectory directory;
  const auto file = earlierStore(directory, schema);
  const std::string before = readFile(file);
  ResultsStore store(directory.path() / "new.sqlite");
  const MergeCount count = store.import(file);
  CHECK(count.runs == 2);
  CHECK(count.cells == (schema >= 2 ? 2u : 0u));
  CHECK(count.peakRates == (schema >= 2 ? 1u : 0u));
  const MergeCount again = store.import(file);
  CHECK(again.runs + again.cells + again.peakRates == 0);
  CHECK(readFile(file) == before);

  const std::vector<StoredRun> runs = store.runs();
  REQUIRE(runs.size() == 2);
  CHECK(store.count().untimed == 0);
  CHECK(runs[1].point.failure == "it did not fit");
  const StoredRun& run = runs[0];
  REQUIRE(run.point.errors.size() == 1);
  const ComponentError& error = run.point.errors[0];
  // What this schema had: the run as it was stored, but for what came later.
  StoredRun wanted = runNumber(1);
  wanted.identity.referenceSamples = 37;
  CHECK(run.identity.key() == wanted.identity.key());
  wanted.id = run.id;
  wanted.point.notes = run.point.notes;
  wanted.point.errors[0].error.nonFiniteReference = 3;
  wanted.point.errors[0].everyMetricPerSeed = schema >= 4;
  if (schema < 3) wanted.point.passWork.clear();
  if (schema < 7) wanted.point.voxels.reset();
  if (schema < 4) {
    // Mean and both uncertainties; the other numbers are of the first seed alone.
    CHECK(error.error.rmse.value == 8.0);
    CHECK(error.error.rmse.uncertainty == Approx(0.05));
    wanted.point.errors[0].error.rmse = error.error.rmse;
    wanted.point.errors[0].seeds = 5;
    wanted.point.errors[0].deterministic = false;
    for (const NamedMetric& metric : metricsOf(error))
      if (metric.name == "rmse" || metric.name == "flip")
        CHECK(metric.measured.enoughRepeats == (metric.name == "rmse"));
  } else {
    CHECK(run.point.notes == std::vector<std::string>{"6 of 8 layers were used"});
    const std::vector<StoredImage> images = store.images(run.identity.key());
    REQUIRE(images.size() == 1);
    CHECK((images[0].png == "png" && images[0].reference == "full"));
    const std::vector<RepeatedControl> controls = store.controls(run.identity);
    REQUIRE(controls.size() == 1);
    CHECK((controls[0].frameMs.value == 10.0 && controls[0].frameMsAgain.value == 12.0));
  }
  CHECK(runsJson({run}).dump(1) == runsJson({wanted}).dump(1));
  if (schema < 2) return;
  StressCell cell = cellNumber(1), found = store.stressCells().at(0);
  cell.family = "image_and_camera";
  found.id = 0;
  CHECK(stressCellJson(found) == stressCellJson(cell));
  CHECK(store.peakRates().at(0).rate.largest == 7.0);
  CHECK(store.peakRates().at(0).shaderInput == "spirv");
}

TEST_CASE("a store of an earlier schema is refused with the command that imports it, and stays as it was") {
  const TemporaryDirectory directory;
  const auto file = earlierStore(directory, 8), present = directory.path() / "new.sqlite";
  const std::string before = readFile(file);
  for (const auto mode : {ResultsStore::Mode::read, ResultsStore::Mode::write})
    CHECK_THROWS_MATCHES(ResultsStore(file, mode), Error,
                         Tells("schema 8", "lumivox results import " + file.string() + " --store NEW"));
  CHECK(readFile(file) == before);
  ResultsStore store(present);
  CHECK_THROWS_MATCHES(store.import(present), Error, Tells("results merge"));
  const auto text = directory.write("text.sqlite", std::string(4096, 'x'));
  CHECK_THROWS_MATCHES(store.import(text), Error, Tells("text.sqlite"));
}

TEST_CASE("the columns of the last schema are still there under SQL, with the same values") {
  const TemporaryDirectory directory;
  const auto earlier = earlierStore(directory, 8), file = directory.path() / "new.sqlite";
  ResultsStore(file).import(earlier);
  // Of runs that lack their times nothing is imported; they have the number 3 there.
  const std::map<std::string, std::string> tables = {
      {"runs",
       "SELECT id, key, created, version, scene, scene_name, pipeline, pipeline_name, sweep, is_default, camera, time, width, height, "
       "seeds, repeats, subpixels, reference_samples, device, driver, shader_input, host, framework_share, failure, command, complete "
       "FROM runs WHERE id < 3 ORDER BY id"},
      {"parameters", "SELECT run, name, value FROM parameters WHERE run < 3 ORDER BY 1, 2"},
      {"provenance", "SELECT run, kind, name, hash FROM provenance WHERE run < 3 ORDER BY 1, 2, 3"},
      {"timings",
       "SELECT run, what, pass, median_ms, lower_quartile_ms, upper_quartile_ms, smallest_ms, largest_ms, repeats FROM timings "
       "WHERE run < 3 ORDER BY 1, 2, 3"},
      {"passes", "SELECT run, position, name FROM passes WHERE run < 3 ORDER BY 1, 2"},
      {"resources", "SELECT run, what, pass, bytes FROM resources WHERE run < 3 ORDER BY 1, 2, 3"},
      {"errors",
       "SELECT run, position, output, component, reference, against, seeds, deterministic, noise_rmse, per_seed FROM errors WHERE "
       "run < 3 ORDER BY 1, 2"},
      {"metrics",
       "SELECT run, position, name, value, uncertainty, of_nothing FROM metrics WHERE run < 3 ORDER BY 1, 2, 3"},
      {"voxels",
       "SELECT run, output, kind, why_not, width, height, depth, occupied, reference, undecided, true_positive, false_positive, "
       "false_negative, axis_crossings, axis_holes, oblique_crossings, oblique_holes, recall, precision FROM voxels WHERE run < 3"},
      {"health", "SELECT run, position, finding FROM health WHERE run < 3 ORDER BY 1, 2"},
      {"notes", "SELECT run, position, note FROM notes WHERE run < 3 ORDER BY 1, 2"},
      {"images", "SELECT * FROM images"},
      {"controls", "SELECT * FROM controls ORDER BY what"},
      {"work", "SELECT run, pass, name, amount FROM work WHERE run < 3 ORDER BY 1, 2, 3"},
      {"stress_cells",
       "SELECT id, key, created, version, family, name, pipeline, technique, size, outcome, measure, unit, value, "
       "uncertainty, limit_value, detail, explanation, image, command, seconds, pipeline_hash, framework, device, driver, "
       "shader_input, host FROM stress_cells ORDER BY id"},
      {"stress_provenance", "SELECT cell, technique, hash FROM stress_provenance ORDER BY 1, 2"},
      {"peak_rates",
       "SELECT device, driver, shader_input, host, name, unit, created, version, median, lower_quartile, upper_quartile, "
       "smallest, largest, repeats FROM peak_rates"}};
  for (const auto& [table, sql] : tables) {
    INFO(table);
    const std::string before = selected(earlier, sql);
    CHECK_FALSE(before.empty());
    CHECK(selected(file, sql) == before);
  }
  CHECK(selected(file, "SELECT json_extract(record, '$.identity.seed') > 1e19 FROM runs WHERE id = 1") ==
        "1");
}

TEST_CASE("a record of an earlier version, which lacks a field, is read with what a record begins with") {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "results.sqlite";
  ResultsStore store(file);
  store.add(runNumber(1));
  execute(
      file,
      "UPDATE runs SET record = json_insert(json_remove(record, '$.identity.display', '$.notes', '$.errors[0].metrics.ssim'), "
      "'$.of_a_later_version', 1)");
  const StoredRun run = store.runs().at(0);
  CHECK(run.identity.display.empty());
  CHECK(run.point.errors.at(0).error.ssim == 1.0);
  CHECK(run.point.errors.at(0).error.flip == 0.125);
  execute(file, "UPDATE runs SET record = '{\"frame\": 1}'");
  CHECK_THROWS_MATCHES(store.runs(), Error, Tells("record"));
}

TEST_CASE("the guide lists every table, view and column of the store") {
  const std::filesystem::path file = sourceDirectory() / "docs/results.md";
  const std::string mark = "<!-- results store -->\n", guide = readFile(file);
  const std::size_t from = guide.find(mark), to = guide.find("<!-- end -->", from);
  REQUIRE(from != std::string::npos);
  REQUIRE(to != std::string::npos);
  const std::size_t begin = from + mark.size();
  const std::string wanted =
      guide.substr(0, begin) + "\n" + ResultsStore::describe() + "\n" + guide.substr(to);
  if (const char* keep = std::getenv("LUMIVOX_KEEP_TABLES"); keep != nullptr && std::string(keep) == "1")
    writeFileAtomically(file, wanted);
  INFO("bring it up to date: LUMIVOX_KEEP_TABLES=1 ./test -R 'the guide lists every table'");
  CHECK((readFile(file) == wanted));
  // And it is what a store has.
  const TemporaryDirectory directory;
  const auto store = directory.path() / "results.sqlite";
  { ResultsStore made(store); }
  std::istringstream names(
      selected(store,
               "SELECT m.name, c.name FROM sqlite_schema m JOIN pragma_table_xinfo(m.name) c WHERE "
               "m.type IN ('table', 'view')"));
  int count = 0;
  for (std::string table, column; names >> table >> column; ++count) {
    INFO(table << " " << column);
    CHECK(wanted.find("`" + table + "`") != std::string::npos);
    CHECK(wanted.find("`" + column + "`") != std::string::npos);
  }
  CHECK(count > 120);
}

TEST_CASE("what is no results store is refused and stays as it was") {
  const TemporaryDirectory directory;
  const auto text = directory.write(
      "notes.txt", "This is no database, but long enough to look like one. " + std::string(2000, 'x'));
  const auto absent = directory.path() / "absent", foreign = directory.path() / "foreign.sqlite",
             later = directory.path() / "later.sqlite";
  const std::string before = readFile(text);
  execute(foreign, "CREATE TABLE a (b); PRAGMA user_version = 1");
  { ResultsStore store(later); }
  execute(later, "PRAGMA user_version = 99");
  CHECK_THROWS_MATCHES(ResultsStore(text), Error, Tells("notes.txt"));
  CHECK(readFile(text) == before);
  CHECK_THROWS_MATCHES(ResultsStore(absent, ResultsStore::Mode::read), Error, Tells(absent.string()));
  CHECK_FALSE(std::filesystem::exists(absent));
  CHECK_THROWS_MATCHES(ResultsStore(foreign), Error, Tells(foreign.string(), "another kind"));
  CHECK_THROWS_MATCHES(ResultsStore(later), Error, Tells(later.string(), "schema 99"));
  CHECK_THROWS_MATCHES(ResultsStore("/proc/results.sqlite"), Error, Tells("/proc"));
}
