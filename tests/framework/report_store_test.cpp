#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <regex>
#include <set>
#include <sstream>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/report/changes.h"
#include "lumivox/report/store.h"
#include "lumivox/report/stress_cells.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

ComponentError errorOf(double rmse) {
  ComponentError error;
  error.output = "indirect_diffuse";
  error.component = "indirect_diffuse";
  error.truth = "one_bounce_diffuse";
  error.error.rmse = {rmse, 0.01 * rmse};
  error.error.meanRatio = {0.9, kNan};
  error.error.flip = 0.125;
  error.error.flipUncertainty = 0.001;
  error.error.nonFinitePicture = 7;
  error.rmseOverSeeds = {rmse, 0.0};
  error.seeds = 2;
  error.deterministic = true;
  error.parts.bias = {0.5 * rmse, 0.02};
  error.parts.noise = {kNan, 0.0};
  error.flicker = {0.25, 0.001};
  error.errorOfNothing.rmse.value = 1.0 / 3.0;
  return error;
}

/// Runs with other `number`s are other points.
StoredRun runNumber(int number) {
  StoredRun run;
  run.identity.sceneHash = "5ce";
  run.identity.pipelineHash = "919e";
  run.identity.techniques = {{"voxel_cone_tracing", "1a"}, {"voxelization", "2b"}};
  run.identity.framework = "f0";
  run.identity.parameters = {{"cones", std::to_string(number)}, {"distribution", "cosine"}};
  run.identity.camera = "main";
  run.identity.time = 0.1;
  run.identity.width = 64;
  run.identity.height = 48;
  run.identity.seed = 0xffffffffffffffffull;
  run.identity.flickerPairs = 4;
  run.identity.device = "a device, 'quoted'";
  run.identity.host = "a host";
  run.created = "2026-01-31 12:00:00 UTC";
  run.version = "0.1.0";
  run.sceneName = "Cornell box";
  run.pipelineName = "Voxel cone tracing";
  run.isDefault = true;
  run.point.scene = "scenes/cornell.scene";
  run.point.pipeline = "scenes/pipelines/voxel_cone_tracing.pipeline";
  run.point.sweep = "quality";
  run.point.parameters["cones"].number = number;
  run.point.parameters["distribution"].word = "cosine";
  run.point.frameMs = {10.0, 9.5, 10.5, 9.0, 12.0, 5};
  run.point.nextFrameMs = {4.0, 3.9, 4.1, 3.8, 5.0, 5};
  run.point.passOrder = {"gbuffer", "gather"};
  run.point.passDeviceMs["gather"] = {6.0, 5.9, 6.1, 5.8, 6.4, 5};
  run.point.passHostMs["gather"] = {6.5, 6.4, 6.6, 6.3, 6.9, 5};
  run.point.passBytes["gather"] = 1u << 20;
  run.point.frameworkShare = kNan;
  run.point.peakBytes = std::uint64_t{5} << 32;
  run.point.errors = {errorOf(0.02 + number)};
  run.point.healthFindings = {"pass gather, port diffuse: 3 NaN, first at pixel (12, 40)"};
  run.point.command = "lumivox report scenes/cornell.scene";
  return run;
}

bool sameNumber(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}
bool sameTime(const TimingStatistics& a, const TimingStatistics& b) {
  return a.median == b.median && a.lowerQuartile == b.lowerQuartile && a.upperQuartile == b.upperQuartile &&
         a.smallest == b.smallest && a.largest == b.largest && a.repeats == b.repeats;
}

}  // namespace

TEST_CASE("a stored run comes back with every number, NaN and 64-bit seeds included") {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "results.sqlite";
  const StoredRun run = runNumber(6);
  CHECK(ResultsStore(file).add(run));

  const ResultsStore store(file, ResultsStore::Mode::read);
  REQUIRE(store.contains(run.identity.key()));
  const StoredRun back = store.find(run.identity.key()).value();
  CHECK(back.identity.key() == run.identity.key());
  CHECK(back.identity.seed == run.identity.seed);
  CHECK(back.identity.techniques == run.identity.techniques);
  CHECK(back.identity.parameters == run.identity.parameters);
  CHECK(back.point.parameters == run.point.parameters);
  CHECK(back.isDefault);
  CHECK(back.sceneName == run.sceneName);
  CHECK(back.point.command == run.point.command);
  CHECK(back.point.healthFindings == run.point.healthFindings);
  CHECK(sameTime(back.point.frameMs, run.point.frameMs));
  CHECK(sameTime(back.point.nextFrameMs, run.point.nextFrameMs));
  CHECK(sameTime(back.point.passDeviceMs.at("gather"), run.point.passDeviceMs.at("gather")));
  CHECK(sameTime(back.point.passHostMs.at("gather"), run.point.passHostMs.at("gather")));
  CHECK(back.point.passOrder == run.point.passOrder);
  CHECK(back.point.passBytes == run.point.passBytes);
  CHECK(back.point.peakBytes == run.point.peakBytes);
  CHECK(std::isnan(back.point.frameworkShare));
  REQUIRE(back.point.errors.size() == 1);
  const std::vector<NamedMetric> before = metricsOf(run.point.errors[0]),
                                 after = metricsOf(back.point.errors[0]);
  REQUIRE(before.size() == after.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    INFO(before[i].name);
    CHECK(sameNumber(before[i].measured.value, after[i].measured.value));
    CHECK(sameNumber(before[i].measured.uncertainty, after[i].measured.uncertainty));
    CHECK(sameNumber(before[i].ofNothing, after[i].ofNothing));
  }
  CHECK(back.point.errors[0].deterministic);
  CHECK(back.point.errors[0].bias);
}

TEST_CASE("a key changes with each thing that a result depends on and with nothing else") {
  const RunIdentity base = runNumber(6).identity;
  std::set<std::string> keys{base.key()};
  const auto changed = [&](const auto& change) {
    RunIdentity other = base;
    change(other);
    keys.insert(other.key());
  };
  changed([](RunIdentity& i) { i.sceneHash += "1"; });
  changed([](RunIdentity& i) { i.pipelineHash += "1"; });
  changed([](RunIdentity& i) { i.techniques["voxelization"] = "3c"; });
  changed([](RunIdentity& i) { i.techniques.erase("voxelization"); });
  changed([](RunIdentity& i) { i.framework += "1"; });
  changed([](RunIdentity& i) { i.parameters["cones"] = "7"; });
  changed([](RunIdentity& i) { i.camera = "other"; });
  changed([](RunIdentity& i) { i.time += 1.0; });
  changed([](RunIdentity& i) { i.width += 1; });
  changed([](RunIdentity& i) { i.height += 1; });
  changed([](RunIdentity& i) { i.seed -= 1; });
  changed([](RunIdentity& i) { i.seeds += 1; });
  changed([](RunIdentity& i) { i.repeats += 1; });
  changed([](RunIdentity& i) { i.subpixels += 1; });
  changed([](RunIdentity& i) { i.truthSamples += 1; });
  changed([](RunIdentity& i) { i.flickerPairs = 0; });
  changed([](RunIdentity& i) { i.flickerPairs += 1; });
  changed([](RunIdentity& i) { i.device += "1"; });
  changed([](RunIdentity& i) { i.driver += "1"; });
  changed([](RunIdentity& i) { i.shaderInput = "glsl"; });
  changed([](RunIdentity& i) { i.host += "1"; });
  CHECK(keys.size() == 22);
  StoredRun same = runNumber(6);
  same.created = "2026-02-01 00:00:00 UTC";
  same.point.frameMs.median = 99.0;
  same.point.command = "another";
  CHECK(same.identity.key() == base.key());
}

TEST_CASE("a second run with the same key is not stored, but a result takes the place of a failure") {
  const TemporaryDirectory directory;
  ResultsStore store(directory.path() / "results.sqlite");
  StoredRun failed = runNumber(6);
  failed.point.failure = "4 GiB do not fit";
  failed.point.errors.clear();
  CHECK(store.add(failed));
  CHECK_FALSE(store.add(failed));
  CHECK(store.add(runNumber(6)));
  CHECK_FALSE(store.add(failed));
  CHECK_FALSE(store.add(runNumber(6)));
  const std::vector<StoredRun> runs = store.runs();
  REQUIRE(runs.size() == 1);
  CHECK(runs[0].point.failure.empty());
  CHECK(runs[0].point.errors.size() == 1);
}

TEST_CASE("four processes write into one store at once and nothing is lost or doubled") {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "results.sqlite";
  constexpr int kProcesses = 4, kRuns = 8;
  std::vector<pid_t> children;
  for (int process = 0; process < kProcesses; ++process) {
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      // Each also makes the store, and neighbours share half of their runs.
      int status = 0;
      try {
        for (int i = 0; i < kRuns; ++i) ResultsStore(file).add(runNumber(process * kRuns / 2 + i));
      } catch (...) {
        status = 1;
      }
      _exit(status);
    }
    children.push_back(child);
  }
  for (const pid_t child : children) {
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    CHECK(WEXITSTATUS(status) == 0);
  }
  std::set<std::string> cones;
  for (const StoredRun& run : ResultsStore(file, ResultsStore::Mode::read).runs()) {
    CHECK(cones.insert(run.identity.parameters.at("cones")).second);
    CHECK(run.point.errors.size() == 1);
  }
  CHECK(cones.size() == (kProcesses + 1) * kRuns / 2);
}

TEST_CASE("a process that is killed while it writes leaves a whole store") {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "results.sqlite";
  ResultsStore(file).add(runNumber(0));
  for (int attempt = 0; attempt < 5; ++attempt) {
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      for (int i = 1;; ++i) ResultsStore(file).add(runNumber(i + 100000 * attempt));
    }
    usleep(20'000 + 7'000 * static_cast<unsigned>(attempt));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    const std::vector<StoredRun> runs = ResultsStore(file).runs();
    CHECK_FALSE(runs.empty());
    for (const StoredRun& run : runs) {
      CHECK(run.point.errors.size() == 1);
      CHECK(run.point.passOrder.size() == 2);
      CHECK(run.point.healthFindings.size() == 1);
    }
  }
}

TEST_CASE("filters choose runs by scene, pipeline, parameter, device, day, number and state") {
  const TemporaryDirectory directory;
  ResultsStore store(directory.path() / "results.sqlite");
  for (int number : {1, 2, 3}) store.add(runNumber(number));
  StoredRun failed = runNumber(4);
  failed.point.failure = "no";
  failed.point.scene = "scenes/arcade.scene";
  failed.sceneName = "Arcade";
  failed.created = "2026-03-01 00:00:00 UTC";
  failed.identity.device = "another device";
  store.add(failed);
  const auto count = [&](const auto& set) {
    RunFilter filter;
    set(filter);
    CHECK_FALSE(filter.everything());
    return store.runs(filter).size();
  };
  CHECK(count([](RunFilter& f) { f.scene = "cornell"; }) == 3);
  CHECK(count([](RunFilter& f) { f.scene = "Cornell box"; }) == 3);
  CHECK(count([](RunFilter& f) { f.scene = "scenes/arcade.scene"; }) == 1);
  CHECK(count([](RunFilter& f) { f.scene = "corn"; }) == 0);
  CHECK(count([](RunFilter& f) { f.pipeline = "voxel_cone_tracing"; }) == 4);
  CHECK(count([](RunFilter& f) { f.parameters = {"cones=2"}; }) == 1);
  CHECK(count([](RunFilter& f) { f.parameters = {"cones=2", "distribution=published"}; }) == 0);
  CHECK(count([](RunFilter& f) { f.device = "another"; }) == 1);
  CHECK(count([](RunFilter& f) { f.since = "2026-02-01"; }) == 1);
  CHECK(count([](RunFilter& f) { f.failed = true; }) == 1);
  CHECK(count([](RunFilter& f) { f.failed = false; }) == 3);
  CHECK(count([](RunFilter& f) { f.ids = {2, 3}; }) == 2);
  RunFilter broken;
  broken.parameters = {"cones"};
  CHECK(messageOf<Error>([&] { store.runs(broken); }).find("name=value") != std::string::npos);
  RunFilter one;
  one.ids = {1};
  CHECK(store.remove(one) == 1);
  CHECK(store.runs().size() == 3);
}

TEST_CASE("removing a run removes all that belongs to it") {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "results.sqlite";
  {
    ResultsStore store(file);
    store.add(runNumber(1));
    CHECK(store.remove({}) == 1);
  }
  sqlite3* handle = nullptr;
  REQUIRE(sqlite3_open(file.c_str(), &handle) == SQLITE_OK);
  for (const char* table : {"runs", "parameters", "provenance", "timings", "passes", "resources", "errors",
                            "metrics", "health"}) {
    INFO(table);
    int rows = -1;
    const auto read = [](void* result, int, char** values, char**) {
      *static_cast<int*>(result) = std::atoi(values[0]);
      return 0;
    };
    REQUIRE(sqlite3_exec(handle, ("SELECT count(*) FROM " + std::string(table)).c_str(), read, &rows,
                         nullptr) == SQLITE_OK);
    CHECK(rows == 0);
  }
  sqlite3_close(handle);
}

TEST_CASE("merging takes over what is not there, once") {
  const TemporaryDirectory directory;
  ResultsStore mine(directory.path() / "mine.sqlite"), theirs(directory.path() / "theirs.sqlite");
  for (int number : {1, 2}) mine.add(runNumber(number));
  for (int number : {2, 3, 4}) theirs.add(runNumber(number));
  CHECK(mine.merge(theirs).runs == 2);
  CHECK(mine.merge(theirs).runs == 0);
  CHECK(mine.runs().size() == 4);
  CHECK(theirs.runs().size() == 3);
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
  sqlite3* handle = nullptr;
  REQUIRE(sqlite3_open(foreign.c_str(), &handle) == SQLITE_OK);
  REQUIRE(sqlite3_exec(handle, "CREATE TABLE a (b); PRAGMA user_version = 1", nullptr, nullptr, nullptr) ==
          SQLITE_OK);
  sqlite3_close(handle);
  CHECK(messageOf<Error>([&] { ResultsStore store(foreign); }).find("another kind") != std::string::npos);

  const auto later = directory.path() / "later.sqlite";
  { ResultsStore store(later); }
  REQUIRE(sqlite3_open(later.c_str(), &handle) == SQLITE_OK);
  REQUIRE(sqlite3_exec(handle, "PRAGMA user_version = 99", nullptr, nullptr, nullptr) == SQLITE_OK);
  sqlite3_close(handle);
  CHECK(messageOf<Error>([&] { ResultsStore store(later); }).find("schema 99") != std::string::npos);

  CHECK(messageOf<Error>([&] { ResultsStore store("/proc/results.sqlite"); }).find("/proc") !=
        std::string::npos);
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

TEST_CASE("a change is significant beyond three standard uncertainties of the difference") {
  StoredRun before = runNumber(6), after = runNumber(6);
  before.point.errors[0].error.rmse.uncertainty = after.point.errors[0].error.rmse.uncertainty = 0.01;
  before.point.errors[0].rmseOverSeeds = {1.0, 0.0};
  const auto change = [&](double rmse) {
    after.point.errors[0].rmseOverSeeds = {rmse, 0.0};
    const RunComparison comparison = compareResults({before}, {after});
    for (const RunChange& one : comparison.changes)
      if (one.quantity == "indirect_diffuse rmse against one_bounce_diffuse") return one;
    FAIL("the error was not compared");
    return RunChange{};
  };
  // sigma of the difference: sqrt(2) 0.01.
  CHECK(change(1.04).sigmas == Approx(0.04 / (std::sqrt(2.0) * 0.01)));
  CHECK_FALSE(change(1.04).significant);
  CHECK(change(1.05).significant);
  CHECK_FALSE(change(1.05).better);
  CHECK(change(0.9).better);
  CHECK(change(1.0).sigmas == 0.0);
}

TEST_CASE("a time changed when its median moved beyond its spread and by a twentieth") {
  StoredRun before = runNumber(6), after = runNumber(6);
  const auto frame = [&](double median, double spread) {
    before.point.frameMs = {10.0, 10.0 - spread, 10.0 + spread, 9.0, 12.0, 25};
    after.point.frameMs = {median, median - spread, median + spread, 9.0, 12.0, 25};
    return compareResults({before}, {after}).changes.front();
  };
  // Quartiles 1.349 sigma apart; a median of 25 values is uncertain by 1.2533 sigma / 5.
  CHECK(frame(11.0, 0.6745).before.uncertainty == Approx(1.2533 / 5.0).epsilon(1e-3));
  CHECK_FALSE(frame(11.0, 0.6745).significant);
  CHECK(frame(11.5, 0.6745).significant);
  CHECK_FALSE(frame(10.4, 0.001).significant);
  CHECK(frame(9.4, 0.001).better);
}

TEST_CASE("points are matched by what they are called, and what cannot be compared is named") {
  StoredRun old = runNumber(1), now = runNumber(1);
  now.identity.device = "another device";
  const RunComparison times =
      compareResults({old, runNumber(2), runNumber(3)}, {now, runNumber(2), runNumber(4)});
  CHECK(times.compared == 2);
  REQUIRE(times.onlyBefore.size() == 1);
  CHECK(times.onlyBefore[0].find("cones=3") != std::string::npos);
  REQUIRE(times.onlyAfter.size() == 1);
  CHECK(times.onlyAfter[0].find("cones=4") != std::string::npos);
  REQUIRE(times.incomparable.size() == 1);
  CHECK(times.incomparable[0].find("different devices") != std::string::npos);
  for (const RunChange& change : times.changes) CHECK_FALSE(change.significant);

  now = runNumber(1);
  now.identity.sceneHash = "other";
  CHECK(compareResults({old}, {now}).incomparable.size() == 1);
  now.point.failure = "4 GiB do not fit";
  CHECK(compareResults({old}, {now}).incomparable.at(0).find("it fails now") != std::string::npos);
}

namespace {

/// A store as an earlier version left it.
std::filesystem::path oldStore(const TemporaryDirectory& directory) {
  const auto file = directory.path() / "old.sqlite";
  sqlite3* handle = nullptr;
  REQUIRE(sqlite3_open(file.c_str(), &handle) == SQLITE_OK);
  const std::string dump = readFile(sourceDirectory() / "tests/framework/data/results_schema_1.sql");
  REQUIRE(sqlite3_exec(handle, dump.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK);
  sqlite3_close(handle);
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

StressCell cellNumber(int number) {
  StressCell cell;
  cell.created = "2015-10-21 16:29:00 UTC";
  cell.version = "0.1.0";
  cell.family = number % 2 == 0 ? "light" : "geometry";
  cell.name = "case_" + std::to_string(number);
  cell.pipeline = "scenes/pipelines/one.pipeline";
  cell.technique = "one";
  cell.size = "quick";
  cell.outcome = number == 3 ? StressOutcome::broken : StressOutcome::biased;
  cell.measure = "RMSE, of the mean";
  cell.unit = "m";
  cell.value = {0.25 * number, 0.5};
  cell.limit = 0.125;
  cell.detail = "pass a, port b: 1 NaN";
  cell.explanation = "the method has no sides";
  cell.picture = "pictures/a.png";
  cell.command = "lumivox stress --case a";
  cell.seconds = 1.5;
  cell.pipelineHash = "cafe";
  cell.framework = "beef";
  cell.techniques = {{"one", "1+2"}, {"two", "3+4"}};
  cell.device = "a device";
  cell.driver = "a driver";
  cell.shaderInput = "spirv";
  cell.host = "a host";
  return cell;
}

DeviceCeiling ceilingNamed(const std::string& name, double rate, const std::string& created) {
  return {name,    "writes/s", {rate, rate, rate, rate, rate, 3}, created, "0.1.0", "a device", "a driver",
          "spirv", "a host"};
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
    CHECK_FALSE(runs[0].point.errors.empty());
    CHECK(store.stressCells().empty());
    CHECK(store.ceilings().empty());
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
  CHECK(schemaOf(file) == 2);
  CHECK(ResultsStore(file, ResultsStore::Mode::read).runs().size() == 1);
}

TEST_CASE("a cell of the stress battery comes back as it was stored") {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "results.sqlite";
  StressCell cell = cellNumber(1);
  cell.value = {kNan, kNan};
  ResultsStore(file).add({cell});
  const std::vector<StressCell> cells = ResultsStore(file, ResultsStore::Mode::read).stressCells();
  REQUIRE(cells.size() == 1);
  CHECK(cells[0].key() == cell.key());
  CHECK(std::isnan(cells[0].value.value));
  // Everything else in one: the JSON holds all of a cell but its number.
  StressCell numberless = cells[0];
  numberless.id = 0;
  CHECK(stressCellJson(numberless) == stressCellJson(cell));
  CHECK(stressCellJson(stressCellFrom(stressCellJson(cell))) == stressCellJson(cell));
  CHECK(messageOf<Error>([] { stressCellFrom("{\"case\": 1}"); }).find("no cell") != std::string::npos);
}

TEST_CASE("a newer cell takes the place of the older, and cells are chosen and removed by what they are") {
  const TemporaryDirectory directory;
  ResultsStore store(directory.path() / "results.sqlite");
  store.add({cellNumber(1), cellNumber(2), cellNumber(3)});
  StressCell again = cellNumber(2);
  again.outcome = StressOutcome::stable;
  store.add({again});
  CHECK(store.stressCells().size() == 3);
  const auto count = [&](auto set) {
    CellFilter filter;
    set(filter);
    CHECK_FALSE(filter.everything());
    return store.stressCells(filter).size();
  };
  CHECK(count([](CellFilter& f) { f.outcome = StressOutcome::stable; }) == 1);
  CHECK(count([](CellFilter& f) { f.outcome = StressOutcome::broken; }) == 1);
  CHECK(count([](CellFilter& f) { f.family = "geometry"; }) == 2);
  CHECK(count([](CellFilter& f) { f.name = "case_2"; }) == 1);
  CHECK(count([](CellFilter& f) { f.pipeline = "one"; }) == 3);
  CHECK(count([](CellFilter& f) { f.pipeline = "two"; }) == 0);
  CHECK(count([](CellFilter& f) { f.technique = "two"; }) == 0);
  CHECK(count([](CellFilter& f) { f.device = "dev"; }) == 3);
  CHECK(count([](CellFilter& f) { f.since = "2016-01-01"; }) == 0);
  CellFilter geometry;
  geometry.family = "geometry";
  CHECK(store.removeCells(geometry) == 2);
  CHECK(store.stressCells().size() == 1);
  CHECK(store.stressCells()[0].techniques.size() == 2);
}

TEST_CASE("merging takes over stress cells and ceilings that are newer, once") {
  const TemporaryDirectory directory;
  ResultsStore mine(directory.path() / "mine.sqlite"), theirs(directory.path() / "theirs.sqlite");
  StressCell newer = cellNumber(2), older = cellNumber(3);
  newer.created = "2016-10-21 16:29:00 UTC";
  older.created = "2014-10-21 16:29:00 UTC";
  mine.add({cellNumber(1), cellNumber(2), cellNumber(3)});
  theirs.add({newer, older, cellNumber(4)});
  mine.add({ceilingNamed("writes", 1.0, "2015"), ceilingNamed("atomics", 1.0, "2015")});
  theirs.add({ceilingNamed("writes", 2.0, "2016"), ceilingNamed("atomics", 2.0, "2014"),
              ceilingNamed("samples", 2.0, "2014")});
  theirs.add(runNumber(1));
  const MergeCount first = mine.merge(theirs), second = mine.merge(theirs);
  CHECK(first.runs == 1);
  CHECK(first.cells == 2);
  CHECK(first.ceilings == 2);
  CHECK(second.runs + second.cells + second.ceilings == 0);
  CHECK(mine.stressCells().size() == 4);
  for (const DeviceCeiling& ceiling : mine.ceilings("a device", "a driver", "spirv", "a host"))
    CHECK(ceiling.rate.median == (ceiling.name == "atomics" ? 1.0 : 2.0));
  CHECK(mine.ceilings("a device", "another driver", "spirv", "a host").empty());
}

TEST_CASE("the newest cells are full ones where there are any") {
  StressCell quick = cellNumber(1), full = cellNumber(1), later = cellNumber(1);
  full.size = "full";
  later.created = "2016-10-21 16:29:00 UTC";
  CHECK(newestCells({quick, later}).at(0).created == later.created);
  CHECK(newestCells({full, later}).at(0).size == "full");
  CHECK(newestCells({later, full}).at(0).size == "full");
  CHECK(newestCells({quick, cellNumber(2)}).size() == 2);
}
