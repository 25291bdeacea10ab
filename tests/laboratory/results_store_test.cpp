// Runs in the results store: written, found, chosen, merged, whatever happens meanwhile.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <functional>
#include <set>

#include "lumivox/base/error.h"
#include "lumivox/results/json.h"
#include "results_sql.h"
#include "stored_records.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

TEST_CASE("a stored run comes back with every number, NaN and 64-bit seeds included") {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "results.sqlite";
  const StoredRun run = runNumber(6);
  CHECK(ResultsStore(file).add(run));

  const ResultsStore store(file, ResultsStore::Mode::read);
  REQUIRE(store.contains(run.identity.key()));
  StoredRun back = store.find(run.identity.key()).value();
  CHECK(back.identity.key() == run.identity.key());
  CHECK(back.identity.seed == run.identity.seed);
  CHECK(std::isnan(back.point.frameworkShare));
  CHECK(std::isnan(back.point.errors.at(0).parts.noise.value));
  CHECK(back.point.passWork == run.point.passWork);
  back.id = run.id;
  CHECK(runsJson({back}).dump(1) == runsJson({run}).dump(1));  // which has every field
}

TEST_CASE("a key changes with each thing that a result depends on and with nothing else") {
  const StoredRun run = runNumber(6);
  using Change = void (*)(RunIdentity&);
  std::set<std::string> keys{run.identity.key()};
  const std::vector<Change> changes{[](RunIdentity& i) { i.sceneHash += "1"; },
                                    [](RunIdentity& i) { i.pipelineHash += "1"; },
                                    [](RunIdentity& i) { i.techniques["voxelization"] = "3c"; },
                                    [](RunIdentity& i) { i.techniques.erase("voxelization"); },
                                    [](RunIdentity& i) { i.framework += "1"; },
                                    [](RunIdentity& i) { i.parameters["cones"] = "7"; },
                                    [](RunIdentity& i) { i.camera = "other"; },
                                    [](RunIdentity& i) { i.time += 1.0; },
                                    [](RunIdentity& i) { i.width += 1; },
                                    [](RunIdentity& i) { i.height += 1; },
                                    [](RunIdentity& i) { i.seed -= 1; },
                                    [](RunIdentity& i) { i.seeds += 1; },
                                    [](RunIdentity& i) { i.repeats += 1; },
                                    [](RunIdentity& i) { i.subpixels += 1; },
                                    [](RunIdentity& i) { i.referenceSamples += 1; },
                                    [](RunIdentity& i) { i.flickerPairs = 0; },
                                    [](RunIdentity& i) { i.flickerPairs += 1; },
                                    [](RunIdentity& i) { i.display = "exposure -1"; },
                                    [](RunIdentity& i) { i.display.clear(); },
                                    [](RunIdentity& i) { i.kept.pop_back(); },
                                    [](RunIdentity& i) { i.kept.clear(); },
                                    [](RunIdentity& i) { i.device += "1"; },
                                    [](RunIdentity& i) { i.driver += "1"; },
                                    [](RunIdentity& i) { i.shaderInput = "glsl"; },
                                    [](RunIdentity& i) { i.host += "1"; }};
  for (const Change change : changes) {
    RunIdentity other = run.identity;
    change(other);
    keys.insert(other.key());
  }
  CHECK(keys.size() == 1 + changes.size());
  StoredRun same = run;
  same.created = "2026-02-01 00:00:00 UTC";
  same.point.frameMs.median = 99.0;
  same.point.command = "another";
  CHECK(same.identity.key() == run.identity.key());
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

TEST_CASE("what passes say and the images of a run come back, and go with it") {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "results.sqlite";
  StoredRun run = runNumber(1);
  run.point.notes = {"6 of 8 layers were used", "a second note"};
  const std::string png("\x89PNG\0\xff", 6);
  ResultsStore store(file);
  CHECK(
      store.add(run, {{"direct", "direct", "", 0.0, png}, {"direct", "direct", "one_bounce", 0.25, "map"}}));
  const std::string key = run.identity.key();
  CHECK(store.find(key)->point.notes == run.point.notes);
  const std::vector<StoredImage> images = store.images(key);
  REQUIRE(images.size() == 2);
  CHECK(images[0].png == png);
  CHECK(images[0].reference.empty());
  CHECK(images[1].reference == "one_bounce");
  CHECK(images[1].flip == 0.25);
  RunFilter filter;
  filter.scene = "cornell";
  CHECK(store.remove(filter) == 1);
  CHECK(store.images(key).empty());
}

TEST_CASE("times that were measured twice are kept with their run, the last twenty of a device") {
  const TemporaryDirectory directory;
  ResultsStore store(directory.path() / "results.sqlite");
  const StoredRun run = runNumber(1);
  store.add(run);
  StoredRun elsewhere = runNumber(2);
  elsewhere.identity.device = "another device";
  store.add(elsewhere);
  store.addControl(run.identity.key(), {12.0, 11.5, 12.5, 11.0, 13.0, 5}, {4.2, 4.1, 4.3, 4.0, 4.4, 5});
  store.addControl(elsewhere.identity.key(), {99.0, 99.0, 99.0, 99.0, 99.0, 5}, {});
  const std::vector<RepeatedControl> controls = store.controls(run.identity);
  REQUIRE(controls.size() == 1);
  CHECK(controls[0].frameMs.value == 10.0);
  CHECK(controls[0].frameMsAgain.value == 12.0);
  CHECK(controls[0].nextFrameMs.value == 4.0);
  CHECK(controls[0].nextFrameMsAgain.value == 4.2);
  const TimeFloor floor = timeFloorOf(controls);
  CHECK(floor.frame == Approx(0.2));
  CHECK(floor.nextFrame == Approx(0.05));
  // A run that is not there has none.
  store.addControl("absent", {1.0, 1.0, 1.0, 1.0, 1.0, 5}, {});
  CHECK(store.controls(run.identity).size() == 1);
  for (int i = 10; i < 10 + 2 * ResultsStore::kControls; ++i) {
    store.add(runNumber(i));
    store.addControl(runNumber(i).identity.key(), {10.1, 10.0, 10.2, 10.0, 10.2, 5}, {});
  }
  CHECK(store.controls(run.identity).size() == ResultsStore::kControls);
}

namespace {

/// A process that claims a point and stays until it is told to go.
class Claimant {
 public:
  Claimant(const std::filesystem::path& file, const std::string& key) {
    int ready[2];
    REQUIRE(pipe(ready) == 0);
    process_ = fork();
    REQUIRE(process_ >= 0);
    if (process_ == 0) {
      const bool got = ResultsStore(file).claim({key}).front();
      const char answer = got ? 'y' : 'n';
      if (write(ready[1], &answer, 1) != 1) _exit(1);
      for (;;) pause();
    }
    char answer = 0;
    REQUIRE(read(ready[0], &answer, 1) == 1);
    claimed = answer == 'y';
    close(ready[0]);
    close(ready[1]);
  }
  ~Claimant() { end(); }
  void end() {
    if (process_ <= 0) return;
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    process_ = -1;
  }
  int process() const { return process_; }
  bool claimed = false;

 private:
  pid_t process_ = -1;
};

}  // namespace

TEST_CASE("a point of another process is not claimed until it is stored, released or dead") {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "results.sqlite";
  ResultsStore store(file);
  const std::string key = runNumber(1).identity.key();
  const auto claimed = [&]() -> bool { return store.claim({key}).front(); };
  {
    Claimant other(file, key);
    CHECK(other.claimed);
    CHECK(store.claim({key, "free"}) == std::vector<bool>{false, true});
    REQUIRE(store.claimedByOther(key));
    CHECK(store.claimedByOther(key)->process == other.process());
    CHECK_FALSE(store.claimedByOther("free"));
    // One's own claim is renewed; others cannot have it.
    CHECK(store.claim({"free"}).front());
    CHECK_FALSE(Claimant(file, "free").claimed);
    store.release({"free", key});  // only one's own
    CHECK(Claimant(file, "free").claimed);
    CHECK_FALSE(claimed());
    // Its time runs out.
    execute(file, "UPDATE claims SET expires = 1");
    CHECK(claimed());
    store.release({key});
  }
  {
    Claimant other(file, key);
    CHECK_FALSE(claimed());
    other.end();
    CHECK_FALSE(store.claimedByOther(key));
    CHECK(claimed());
    store.release({key});
  }
  {
    // Another process has its number by now.
    Claimant other(file, key);
    execute(file, "UPDATE claims SET started = started + 1");
    CHECK(claimed());
    store.release({key});
  }
  {
    // On another machine its number means nothing: only its time tells.
    Claimant other(file, key);
    execute(file, "UPDATE claims SET machine = 'elsewhere'");
    other.end();
    CHECK_FALSE(claimed());
    execute(file, "UPDATE claims SET expires = 1");
    CHECK(claimed());
  }
  store.add(runNumber(1));
  CHECK(Claimant(file, key).claimed);
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
  const std::vector<std::pair<std::function<void(RunFilter&)>, std::size_t>> filters{
      {[](RunFilter& f) { f.scene = "cornell"; }, 3},
      {[](RunFilter& f) { f.scene = "Cornell box"; }, 3},
      {[](RunFilter& f) { f.scene = "scenes/arcade.scene"; }, 1},
      {[](RunFilter& f) { f.scene = "corn"; }, 0},
      {[](RunFilter& f) { f.pipeline = "voxel_cone_tracing"; }, 4},
      {[](RunFilter& f) { f.parameters = {"cones=2"}; }, 1},
      {[](RunFilter& f) {
         f.parameters = {"cones=2", "distribution=published"};
       },
       0},
      {[](RunFilter& f) { f.device = "another"; }, 1},
      {[](RunFilter& f) { f.since = "2026-02-01"; }, 1},
      {[](RunFilter& f) { f.failed = true; }, 1},
      {[](RunFilter& f) { f.failed = false; }, 3},
      {[](RunFilter& f) {
         f.ids = {2, 3};
       },
       2}};
  for (std::size_t i = 0; i < filters.size(); ++i) {
    CAPTURE(i);
    RunFilter filter;
    filters[i].first(filter);
    CHECK_FALSE(filter.everything());
    CHECK(store.runs(filter).size() == filters[i].second);
  }
  RunFilter broken, one;
  broken.parameters = {"cones"};
  CHECK_THROWS_MATCHES(store.runs(broken), Error, Tells("name=value"));
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
  for (const char* table : {"runs", "parameters", "provenance", "timings", "passes", "resources", "errors",
                            "metrics", "health", "work"}) {
    INFO(table);
    CHECK(selected(file, "SELECT count(*) FROM " + std::string(table)) == "0");
  }
}

TEST_CASE("merging takes over what is not there, once") {
  const TemporaryDirectory directory;
  ResultsStore mine(directory.path() / "mine.sqlite"), theirs(directory.path() / "theirs.sqlite");
  for (int number : {1, 2}) mine.add(runNumber(number));
  for (int number : {2, 3, 4}) theirs.add(runNumber(number));
  theirs.addControl(runNumber(3).identity.key(), {12.0, 11.5, 12.5, 11.0, 13.0, 5}, {});
  CHECK(mine.merge(theirs).runs == 2);
  CHECK(mine.merge(theirs).runs == 0);
  CHECK(mine.runs().size() == 4);
  const std::vector<RepeatedControl> controls = mine.controls(runNumber(3).identity);
  REQUIRE(controls.size() == 1);
  CHECK(controls[0].frameMsAgain.value == 12.0);
  CHECK(theirs.runs().size() == 3);
}

TEST_CASE("a run without times is known to nobody but who goes on with it, and goes when the run is added") {
  const TemporaryDirectory directory;
  ResultsStore store(directory.path() / "results.sqlite");
  StoredRun run = runNumber(1);
  const std::string key = run.identity.key();
  store.addUntimed(run, {{"final", "full", "", 0.0, "old"}});
  store.addUntimed(run, {{"final", "full", "", 0.0, "png"}});
  CHECK_FALSE(store.contains(key));
  CHECK_FALSE(store.find(key));
  CHECK(store.runs().empty());
  CHECK(store.count().untimed == 1);
  REQUIRE(store.findUntimed(key));
  CHECK(store.findUntimed(key)->point.errors.size() == 1);
  CHECK(store.findUntimed(key)->point.passWork == run.point.passWork);
  REQUIRE(store.images(key).size() == 1);
  CHECK(store.images(key)[0].png == "png");
  // Whoever measures it goes on claiming it.
  CHECK(store.claim({key}).front());
  ResultsStore other(directory.path() / "other.sqlite");
  CHECK(other.merge(store).runs == 0);
  CHECK(other.count().untimed == 0);

  // A failure takes its place as a result does, and is none that a run without times could push out.
  StoredRun failed = run;
  failed.point.failure = "it did not fit";
  CHECK(store.add(failed));
  CHECK(store.find(key)->id == 1);  // the number that the untimed one had
  CHECK_FALSE(store.findUntimed(key));
  CHECK(store.images(key).empty());
  store.addUntimed(run);
  CHECK_FALSE(store.findUntimed(key));
  CHECK(store.find(key)->point.failure == "it did not fit");
  CHECK(store.add(run));
  CHECK(store.find(key)->point.failure.empty());

  store.addUntimed(runNumber(2));
  CHECK(store.remove({}) == 1);
  CHECK(store.count().runs == 0);
  CHECK(store.count().untimed == 0);
}
