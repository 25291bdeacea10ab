// Work in shares: by hand, killed and resumed, claimed by several, and on a cluster of one node.
#include <sys/resource.h>

#include <algorithm>
#include <random>
#include <set>

#include "lumivox/base/image.h"
#include "lumivox/results/store.h"
#include "tools/cluster.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// The values of the points of a store, in order; one that is there twice shows.
std::vector<double> valuesIn(const std::filesystem::path& store) {
  std::vector<double> values;
  for (const StoredRun& run : ResultsStore(store, ResultsStore::Mode::read).runs())
    values.push_back(run.point.parameters.at("value").number);
  std::sort(values.begin(), values.end());
  return values;
}
const std::vector<double> kAll{1.0, 2.0, 3.0, 4.0};

/// A folder with a program `name` that is found before all others.
class Instead {
 public:
  Instead(const Place& place, const std::string& name, const std::string& script) : path_(getenv("PATH")) {
    std::filesystem::create_directories(place / "bin");
    const auto file = place / ("bin/" + name);
    writeFileAtomically(file, "#!/bin/sh\n" + script);
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    setenv("PATH", ((place / "bin").string() + ":" + path_).c_str(), 1);
  }
  ~Instead() { setenv("PATH", path_.c_str(), 1); }

 private:
  std::string path_;
};

std::string storeOf(const Place& place, int share) {
  return place.file("part_" + std::to_string(share) + ".sqlite");
}

}  // namespace

TEST_CASE("the shares of a sweep hold each of its points once, and merge to the store of one run") {
  const Place place;
  REQUIRE(place.run("sweep", {"fast"}, {"--store", place.file("whole.sqlite")}).exitCode == 0);
  std::size_t points = 0;
  for (int share = 1; share <= 3; ++share) {
    const std::vector<std::string> more{"--shard", std::to_string(share) + "/3", "--store",
                                        storeOf(place, share)};
    const CommandResult result = place.run("sweep", {"fast"}, more);
    INFO(result.errors);
    REQUIRE(result.exitCode == 0);
    points += valuesIn(storeOf(place, share)).size();
    // Once more, it has nothing to do.
    CHECK(contains(place.run("sweep", {"fast"}, more).output, "0 measured"));
  }
  CHECK(points == 4);
  ran("results merge --store", place.file("all.sqlite"), storeOf(place, 1), storeOf(place, 2),
      storeOf(place, 3));
  CHECK(valuesIn(place.file("all.sqlite")) == kAll);
  const ResultsStore whole(place.file("whole.sqlite"), ResultsStore::Mode::read),
      all(place.file("all.sqlite"), ResultsStore::Mode::read);
  for (const StoredRun& run : whole.runs()) {
    const auto same = all.find(run.identity.key());
    REQUIRE(same);
    REQUIRE(same->point.errors.size() == run.point.errors.size());
    for (std::size_t i = 0; i < run.point.errors.size(); ++i)
      CHECK(same->point.errors[i].error.rmse.value == run.point.errors[i].error.rmse.value);
    CHECK_FALSE(same->node.empty());
    CHECK(same->seconds > 0.0);
    CHECK(same->before.load >= 0.0);
    CHECK(same->after.load >= 0.0);
  }
}

TEST_CASE("shares of what a store lacks are written to a file, and a file of another plan is refused") {
  const Place place;
  const std::string into = place.file("all.sqlite"), plan = place.file("plan.txt");
  REQUIRE(place.run("sweep", {"fast"}, {"--store", into, "--set", "value=2"}).exitCode == 0);
  const CommandResult written =
      place.run("sweep", {"fast"}, {"--into", into, "--points", plan, "--tasks", "2"});
  INFO(written.errors);
  REQUIRE(written.exitCode == 0);
  CHECK(contains(written.output, "3 of 4 points are missing"));
  for (int share = 1; share <= 2; ++share)
    REQUIRE(place
                .run("sweep", {"fast"},
                     {"--into", into, "--points", plan, "--shard", std::to_string(share) + "/2", "--store",
                      storeOf(place, share)})
                .exitCode == 0);
  CHECK(valuesIn(storeOf(place, 1)).size() + valuesIn(storeOf(place, 2)).size() == 3);
  const CommandResult other =
      place.run("sweep", {"slow"}, {"--points", plan, "--shard", "1/2", "--store", storeOf(place, 1)});
  CHECK(other.exitCode == 2);
  CHECK_THAT(other.errors, Tells("plan.txt", "another plan"));
  const CommandResult fewer =
      place.run("sweep", {"fast"}, {"--points", plan, "--shard", "1/3", "--store", storeOf(place, 1)});
  CHECK(fewer.exitCode == 2);
  CHECK_THAT(fewer.errors, Tells("plan.txt", "2 shares", "1/3"));
  ran("results merge --store", into, storeOf(place, 1), storeOf(place, 2));
  CHECK(valuesIn(into) == kAll);
  CHECK(contains(place.run("sweep", {"fast"}, {"--into", into, "--points", plan}).output, "0 of 4 points"));
}

TEST_CASE("two shares of one plan at once share its points through the store that they are merged into") {
  const Place place;
  const std::string into = place.file("all.sqlite");
  const auto share = [&](int number) {
    return place.words("sweep", {"slow"},
                       {"--shard", "1/1", "--into", into, "--store", storeOf(place, number)});
  };
  // The first holds a batch; the second finds all four claimed.
  Started first(share(1), place.file("said.txt"), "3");
  REQUIRE(place.comesTo("3"));
  const CommandResult second =
      place.run("sweep", {"slow"}, {"--shard", "1/1", "--into", into, "--store", storeOf(place, 2)});
  INFO(second.errors);
  CHECK(second.exitCode == 0);
  CHECK(contains(second.output, "left to other shares: 4 points"));
  first.signalAfter(std::chrono::milliseconds(0), SIGKILL);
  first.wait();
  // Its process is gone, and with it its claims: the second takes the points over.
  CHECK(place.run("sweep", {"slow"}, {"--shard", "1/1", "--into", into, "--store", storeOf(place, 2)})
            .exitCode == 0);
  CHECK(valuesIn(storeOf(place, 2)) == kAll);
  // Delivered points stand until they are merged.
  CHECK(contains(
      place.run("sweep", {"slow"}, {"--shard", "1/1", "--into", into, "--store", storeOf(place, 3)}).output,
      "left to other shares: 4 points"));
  ran("results merge --store", into, storeOf(place, 1), storeOf(place, 2));
  CHECK(valuesIn(into) == kAll);
}

TEST_CASE(
    "a share that SIGTERM ends loses the point at work, says what it keeps, and the same command goes on") {
  const Place place;
  const std::vector<std::string> words =
      place.words("sweep", {"slow"},
                  {"--shard", "1/1", "--into", place.file("all.sqlite"), "--store", storeOf(place, 1)});
  const int status = place.endedAt("3", words, SIGTERM);
  CHECK(WIFSIGNALED(status));
  CHECK(WTERMSIG(status) == SIGTERM);
  CHECK_THAT(place.read("said.txt"), Tells("interrupted:", "part_1.sqlite", "to go on: lumivox"));
  CHECK(ResultsStore(storeOf(place, 1)).count().untimed == 2);
  const CommandResult again =
      place.run("sweep", {"slow"},
                {"--shard", "1/1", "--into", place.file("all.sqlite"), "--store", storeOf(place, 1)});
  INFO(again.errors);
  CHECK(again.exitCode == 0);
  CHECK_THAT(again.errors, Tells("value=2", "taken up"));
  CHECK(valuesIn(storeOf(place, 1)) == kAll);
}

namespace {

/// Kills two shares of a plan at random moments so many times, then lets them end; all points are there once.
void killAtRandom(int kills) {
  const Place place;
  const std::string into = place.file("all.sqlite");
  std::mt19937 random(4);
  const auto words = [&](int share) {
    return place.words(
        "sweep", {"fast"},
        {"--shard", std::to_string(share) + "/2", "--into", into, "--store", storeOf(place, share)});
  };
  for (int i = 0; i < kills; ++i) {
    Started one(words(1 + i % 2));
    one.signalAfter(std::chrono::milliseconds(random() % 2500), SIGKILL);
    one.wait();
    // A merge in between, killed as well, changes nothing in the end.
    std::vector<std::string> merge{"results", "merge", "--store", into};
    for (int share = 1; share <= 2; ++share)
      if (std::filesystem::exists(storeOf(place, share))) merge.push_back(storeOf(place, share));
    if (i % 3 != 2 || merge.size() == 4) continue;
    Started merging(merge);
    merging.signalAfter(std::chrono::milliseconds(random() % 60), SIGKILL);
    merging.wait();
  }
  for (int share = 1; share <= 2; ++share) {
    Started last(words(share));
    CHECK(last.wait() == 0);
  }
  ran("results merge --store", into, storeOf(place, 1), storeOf(place, 2));
  CHECK(valuesIn(into) == kAll);
}

}  // namespace

TEST_CASE("shares that are killed at random moments are complete after they go on, with no point twice") {
  killAtRandom(6);
}

TEST_CASE("shares that are killed at 200 random moments are complete after they go on, with no point twice",
          "[.]") {
  killAtRandom(200);
}

TEST_CASE(
    "a plan of 100000 points is shared in ten seconds and a gigabyte, and a share knows its points as fast",
    "[.]") {
  const Place place;
  std::string seeds;
  for (int seed = 1; seed <= 25000; ++seed) seeds += " " + std::to_string(seed);
  std::string text = place.read("fast.pipeline");
  text.insert(text.rfind('}'), "  seeds [" + seeds + " ] ");
  place.write("fast.pipeline", text);
  const auto measured = [&](const std::vector<std::string>& more) {
    const auto start = std::chrono::steady_clock::now();
    Started command(place.words("sweep", {"fast"}, more), place.file("said.txt"));
    rusage usage{};
    int status = 0;
    wait4(command.process(), &status, 0, &usage);
    INFO(place.read("said.txt"));
    CHECK(status == 0);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    WARN(seconds << " s, " << usage.ru_maxrss / 1024 << " MiB");
    CHECK(seconds < 10.0);
    CHECK(usage.ru_maxrss < 1024 * 1024);
  };
  const std::string into = place.file("all.sqlite"), plan = place.file("plan.txt");
  measured({"--into", into, "--points", plan, "--tasks", "1000"});
  CHECK(contains(place.read("plan.txt"), " 100000 1000\n"));
  // A share of two points.
  std::string few = place.read("plan.txt").substr(0, place.read("plan.txt").find('\n', 20) + 1);
  few.replace(few.rfind("1000"), 4, "1");
  place.write("few.txt", few + "0-1\n");
  measured(
      {"--into", into, "--points", place.file("few.txt"), "--shard", "1/1", "--store", storeOf(place, 1)});
}

TEST_CASE("a full disk ends a share with the name of its store, and it keeps what it had") {
  const Place place;
  std::filesystem::create_directory(place.path() / "disk");
  std::string line = "'" + (binaryDirectory() / "bin/lumivox").string() + "'";
  for (const std::string& word :
       place.words("sweep", {"fast"}, {"--shard", "1/1", "--store", place.file("disk/part.sqlite")}))
    line += " '" + word + "'";
  const std::string disk = place.quoted("disk");
  place.write("script.sh",
              "mount -t tmpfs -o size=512k none " + disk + "\ncd " + disk + "\n" + line +
                  " --set value=1 > /dev/null 2>&1\nhead -c 1m /dev/zero > filler 2>/dev/null\n" + line +
                  " > /dev/null 2> " + place.quoted("said") + "\necho $? > " + place.quoted("status") +
                  "\nrm filler\n" + line + " > " + place.quoted("again") + " 2>&1\ncp part.sqlite " +
                  place.quoted("part.sqlite") + "\n");
  if (runCommand("unshare -rm mount -t tmpfs none " + disk).exitCode != 0)
    return skip("this process may mount no file system of its own (unshare -rm, tmpfs)");
  runCommand("unshare -rm sh " + place.quoted("script.sh"));
  INFO(place.read("said") << place.read("again"));
  CHECK(place.read("status") == "2\n");
  CHECK_THAT(place.read("said"), Tells("part.sqlite", "full"));
  CHECK(valuesIn(place.file("part.sqlite")) == kAll);
}

TEST_CASE("the parts of a reference merge to the bits of one run, by samples and by tiles") {
  const Workplace place;
  // Two tiles, and three blocks of samples.
  const std::vector<std::string> options{"--resolution", "17x4", "--spp",      "9000",
                                         "--bounces",    "2",    "--no-cache", "-q"};
  std::string words;
  for (const std::string& word : options) words += " " + word;
  ran("reference", place.scene(), Raw{words}, "-o", place.file("whole.exr"));
  std::string merge;
  for (int part = 4; part >= 1; --part) {
    const std::string file = place.file(std::to_string(part) + ".part");
    ran("reference", place.scene(), Raw{words}, "--shard", Raw{std::to_string(part) + "/4"}, "-o", file);
    merge += " --merge '" + file + "'";
  }
  ran("reference", place.scene(), Raw{words + merge}, "-o", place.file("merged.exr"));
  const LayeredImage whole = readExr(place / "whole.exr"), merged = readExr(place / "merged.exr");
  REQUIRE(whole.layers.size() == merged.layers.size());
  for (const auto& [name, layer] : whole.layers) {
    INFO(name);
    CHECK(layer.values() == merged.layers.at(name).values());
  }
  CHECK(whole.attributes.at("cut_off") == merged.attributes.at("cut_off"));
  // One missing, of another seed, cut off, or something else.
  const auto refused = [&](const std::string& parts, const std::string& more, const std::string& what) {
    const CommandResult result =
        typed("reference", place.scene(), Raw{words + parts + more}, "-o", place.file("no.exr"));
    INFO(result.errors);
    CHECK(result.exitCode == 2);
    CHECK(contains(result.errors, what));
    CHECK_FALSE(place.has("no.exr"));
  };
  refused(merge.substr(0, merge.rfind(" --merge")), "", "no part has its samples from 0 on in tile 1 of 2");
  refused(merge, " --seed 2", "4.part: it is part of another reference");
  std::string text = place.read("2.part");
  text[text.size() - 3] ^= 1;
  place.write("2.part", text);
  refused(merge, "", "2.part: its numbers are not what was written");
  place.write("2.part", text.substr(0, text.size() - 8));
  refused(merge, "", "2.part: it ends too early");
  place.write("2.part", "something else");
  refused(merge, "", "2.part: this is no part of a reference");
}

TEST_CASE("the cells of a battery and the points of a report are shared as those of a sweep") {
  const Place place;
  const std::string battery = "--quick --case 'closed_box_one_bounce' --case 'no_triangles' --pipeline '" +
                              committedPipeline("direct_lighting") + "' --store ";
  const nlohmann::json all = answered("-q stress --json", Raw{battery + place.quoted("whole.sqlite")});
  std::size_t cells = 0;
  for (int share = 1; share <= 2; ++share) {
    const std::string words =
        battery + "'" + storeOf(place, share) + "' --shard " + std::to_string(share) + "/2";
    cells += answered("-q stress --json", Raw{words}).size();
    CHECK(answered("-q stress --json", Raw{words}).empty());
  }
  CHECK(cells == all.size());
  CHECK(cells >= 1);

  for (int share = 1; share <= 2; ++share)
    REQUIRE(place
                .run("report", {"fast"},
                     {"-o", place.file("page.html"), "--shard", std::to_string(share) + "/2", "--store",
                      place.file("r" + std::to_string(share) + ".sqlite")})
                .exitCode == 0);
  CHECK_FALSE(place.has("page.html"));
  ran("results merge --store", place.file("page.unfinished.sqlite"), place.file("r1.sqlite"),
      place.file("r2.sqlite"));
  const CommandResult page = place.run("report", {"fast"}, {"-o", place.file("page.html")});
  INFO(page.errors);
  CHECK(page.exitCode == 0);
  CHECK_THAT(page.output, Tells("4 of 4 points were taken up"));
}

TEST_CASE("wrong wishes for shares and clusters are refused before any work") {
  const Place place;
  const auto refused = [&](const std::vector<std::string>& more, const std::string& what) {
    const CommandResult result = place.run("sweep", {"fast"}, more);
    INFO(result.errors);
    CHECK(result.exitCode == 2);
    CHECK(contains(unwrapped(result.errors), what));
  };
  refused({"--shard", "3/2", "--store", place.file("a.sqlite")}, "--shard '3/2': expected a share");
  refused({"--shard", "1/2"}, "expected --store with a store of its own");
  refused({"--tasks", "3"}, "expected one of these");
  refused({"--tasks", "5000", "--slurm"}, "--tasks");
  refused({"--wait"}, "expected --slurm");
  refused({"--points", place.file("plan.txt")}, "expected --into");
  refused({"--shard", "1/2", "--store", place.file("a.sqlite"), "--slurm"}, "not both");
  CHECK_FALSE(place.has("a.sqlite"));
  {
    const std::string path = getenv("PATH");
    setenv("PATH", place.file("nowhere").c_str(), 1);
    refused({"--store", place.file("a.sqlite"), "--slurm"}, "sbatch");
    setenv("PATH", path.c_str(), 1);
  }
  const Instead sbatch(place, "sbatch",
                       "echo 'sbatch: error: invalid partition specified: gpu' >&2\nexit 1\n");
  refused({"--store", place.file("a.sqlite"), "--slurm", "--partition=gpu"},
          "invalid partition specified: gpu");
  refused({"--store", place.file("a.sqlite"), "--slurm", "--array=1-3"}, "--array=1-3 is set by lumivox");
}

TEST_CASE(
    "what is submitted asks for nodes of its own where times are taken, and shares them for references") {
  const Place place;
  const Instead sbatch(place, "sbatch",
                       "echo \"$@\" >> " + place.quoted("asked") +
                           "\nfor last; do :; done\ncat \"$last\" >> " + place.quoted("scripts") +
                           "\nwc -l < " + place.quoted("asked") + "\n");
  const CommandResult sweep = place.run(
      "sweep", {"fast"},
      {"--store", place.file("all.sqlite"), "--tasks", "2", "--slurm", "--partition=gpu", "--time=2:00:00"});
  INFO(sweep.errors);
  REQUIRE(sweep.exitCode == 0);
  CHECK(contains(sweep.output, "job 1: 2 tasks; job 2: merges them"));
  CHECK_THAT(place.read("asked"), Tells("--parsable", "--partition=gpu", "--time=2:00:00", "task.sh"));
  CHECK(contains(place.read("asked"), "--dependency=afterany:1"));
  CHECK_THAT(place.read("scripts"),
             Tells("#SBATCH --array=1-2", "#SBATCH --exclusive", "$SLURM_ARRAY_TASK_ID/2", "results merge"));
  std::filesystem::remove(place / "scripts");
  ran("reference", place.scene(), "-q -o", place.file("a.exr"), "--tasks 3 --slurm");
  CHECK_THAT(place.read("scripts"), Tells("#SBATCH --array=1-3", ".part"));
  CHECK_FALSE(contains(place.read("scripts"), "--exclusive"));
}

TEST_CASE("waiting tells by accounting how many tasks ended and which did not end well") {
  const Place place;
  // Waiting tasks stand in one line; a cancelled one says by whom; parts of a job are no tasks.
  const Instead sacct(
      place, "sacct",
      "printf '1_1|COMPLETED|60\\n1_2|CANCELLED by 1000|5\\n1_3|RUNNING|7\\n1_[4]|PENDING|0\\n'\n");
  const Instead squeue(place, "squeue", "exit 0\n");
  const Instead sbatch(place, "sbatch", "echo 1\n");
  const CommandResult swept = place.run(
      "sweep", {"fast"}, {"--store", place.file("all.sqlite"), "--tasks", "4", "--wait", "--slurm"});
  INFO(swept.output << swept.errors);
  CHECK(contains(swept.output, "2 of 4 tasks ended, 1 of them not well"));
  CHECK(swept.exitCode == 1);
}

TEST_CASE("a battery and a report on a cluster, and a task that is sent back to the queue and goes on") {
  const Place place;
  const Cluster cluster(place / "cluster");
  if (!cluster.whyNot.empty()) return skip(cluster.whyNot);
  const std::string battery = "--quick --case no_triangles --pipeline '" +
                              committedPipeline("direct_lighting") + "' --store " +
                              place.quoted("cells.sqlite");
  const CommandResult cells = typed("-q stress", Raw{battery + " --tasks 1 --wait --slurm"});
  INFO(cells.output << cells.errors);
  REQUIRE(cells.exitCode == 0);
  CHECK(contains(typed("-q stress", Raw{battery + " --tasks 1 --wait --slurm"}).output,
                 "0 of 1 cells are missing"));

  const CommandResult page =
      place.run("report", {"fast"}, {"-o", place.file("page.html"), "--tasks", "2", "--wait", "--slurm"});
  INFO(page.output << page.errors);
  REQUIRE(page.exitCode == 0);
  CHECK(contains(place.read("page.html"), "</html>"));

  // The queue takes a running task back by SIGTERM and starts it again.
  setenv("LUMIVOX_TEST_HOLD_AT", "1", 1);
  const CommandResult held =
      place.run("sweep", {"slow"}, {"--store", place.file("slow.sqlite"), "--tasks", "1", "--slurm"});
  unsetenv("LUMIVOX_TEST_HOLD_AT");
  REQUIRE(held.exitCode == 0);
  const std::string job = held.output.substr(held.output.find("job ") + 4),
                    number = job.substr(0, job.find(':'));
  const auto state = [&] { return runCommand("squeue -h -j " + number + " -o %t 2>&1").output; };
  REQUIRE(becomes([&] { return contains(state(), "R"); }));
  REQUIRE(runCommand("scontrol requeue " + number + "_1 2>&1").exitCode == 0);
  REQUIRE(becomes([&] { return contains(state(), "PD"); }));
  runCommand("scancel " + number);
}

TEST_CASE("a sweep, a reference and a killed array on a cluster of one node") {
  const Place place;
  const Cluster cluster(place / "cluster");
  if (!cluster.whyNot.empty()) return skip(cluster.whyNot);
  const std::vector<std::string> waiting{"--store", place.file("all.sqlite"), "--tasks", "2", "--wait",
                                         "--slurm"};
  const CommandResult swept = place.run("sweep", {"fast"}, waiting);
  INFO(swept.output << swept.errors);
  REQUIRE(swept.exitCode == 0);
  CHECK(contains(swept.output, "2 of 2 tasks ended"));
  CHECK(valuesIn(place / "all.sqlite") == kAll);
  CHECK(contains(place.run("sweep", {"fast"}, waiting).output, "0 of 4 points are missing"));

  // An array whose tasks are killed leaves what it had; the same command plans what lacks.
  const std::string into = place.file("slow.sqlite");
  const std::vector<std::string> slow{"--store", into, "--tasks", "2", "--slurm"};
  setenv("LUMIVOX_TEST_HOLD_AT", "3", 1);
  const CommandResult killed = place.run("sweep", {"slow"}, slow);
  unsetenv("LUMIVOX_TEST_HOLD_AT");
  REQUIRE(killed.exitCode == 0);
  const std::string job = killed.output.substr(killed.output.find("job ") + 4);
  const std::string number = job.substr(0, job.find(':'));
  // The first share ends; the second holds at its first point.
  REQUIRE(becomes(
      [&] { return contains(runCommand("squeue -h -j " + number + " -o %t_%K 2>&1").output, "R_2"); }));
  runCommand("scancel --signal=KILL --full " + number);
  REQUIRE(becomes([&] { return runCommand("squeue -h -o %i").output.empty(); }));
  CHECK(valuesIn(into) == std::vector<double>{1.0, 2.0});
  std::vector<std::string> again = slow;
  again.insert(again.begin(), "--wait");
  const CommandResult rest = place.run("sweep", {"slow"}, again);
  INFO(rest.output << rest.errors);
  CHECK(contains(rest.output, "2 of 4 points are missing"));
  CHECK(valuesIn(into) == kAll);

  const std::string reference =
      "reference '" + place.scene() + "' -q --resolution 33x8 --spp 16 --no-cache -o ";
  ran(Raw{reference + place.quoted("one.exr")});
  ran(Raw{reference + place.quoted("many.exr") + " --tasks 2 --wait --slurm"});
  CHECK(readExr(place / "one.exr").layers.at("full").values() ==
        readExr(place / "many.exr").layers.at("full").values());
}
