// Work that takes hours is kept as it is done: reports go on where they were interrupted, sweeps share a
// store, and a point or a cell that fails costs itself alone.
#include <algorithm>
#include <chrono>
#include <memory>

#include "lumivox/results/store.h"
#include "support/drawn_page.h"
#include "tools/cli_support.h"
#include "tools/started.h"

using namespace lumivox;
using namespace lumivox::test;
using Json = nlohmann::json;

namespace {

std::size_t runsIn(const std::string& store) {
  try {
    return ResultsStore(store, ResultsStore::Mode::read).runs().size();
  } catch (const std::exception&) {
    return 0;  // it is being made
  }
}

std::vector<double> valuesIn(const std::string& store) {
  std::vector<double> values;
  for (const StoredRun& run : ResultsStore(store, ResultsStore::Mode::read).runs())
    values.push_back(run.point.parameters.at("value").number);
  std::sort(values.begin(), values.end());
  return values;
}

}  // namespace

TEST_CASE("a report that is killed goes on where it stopped, says so, and gives the same page") {
  const Place place;
  const std::string checkpoint = place.file("page.unfinished.sqlite");
  // The default point is value=1; of the others the first two are there when the third is begun.
  place.endedAt("4", place.words("report", {"slow"}, {"-o", place.file("page.html")}));
  // A page that is there is whole, and says that more is to come.
  if (place.has("page.json")) CHECK(Json::parse(place.read("page.json")).at("complete") == false);
  std::vector<StoredRun> kept;
  {
    const ResultsStore store(checkpoint, ResultsStore::Mode::read);
    kept = store.runs();
    REQUIRE(kept.size() == 1);
    CHECK(store.count().untimed == 2);
  }
  const CommandResult again = place.run("report", {"slow"}, {"-o", place.file("page.html")});
  INFO(again.errors);
  REQUIRE(again.exitCode == 0);
  CHECK_THAT(again.output, Tells(1, "of", 4, "points", "taken up"));
  CHECK_THAT(again.errors, Tells("value=3", "taken up"));
  CHECK_FALSE(std::filesystem::exists(checkpoint));
  const Json points = place.sceneOf("page.json").at("points");
  REQUIRE(points.size() == 4);
  for (const Json& point : points) {
    CHECK(point.at("errors").size() > 0);
    CHECK(point.at("frame_ms").at("repeats") == 3);
    CHECK(point.at("passes").at(0).at("device_ms").at("median") > 0.0);
  }
  // The kept run is unchanged.
  CHECK(std::any_of(points.begin(), points.end(), [&](const Json& point) {
    return point.at("frame_ms").at("median") == kept[0].point.frameMs.median;
  }));
  // Images of points that were taken up are on the page: an output, a map for each reference.
  REQUIRE(place.run("report", {"slow"}, {"-o", place.file("whole.html")}).exitCode == 0);
  CHECK(pageRecords(place.read("page.html"), "images") == pageRecords(place.read("whole.html"), "images"));
}

TEST_CASE(
    "a report begins nothing that would end beyond its budget, says so in a line, and the same command goes on") {
  const Place place;
  place.writeSlow("long", "1 2 3 4 5 6 7 8 9");
  const std::vector<std::string> toPage{"--budget", "2s", "-o", place.file("page.html")};
  std::size_t before = 0, runs = 0;
  for (bool whole = false; !whole; ++runs) {
    REQUIRE(runs < 20);
    const auto begun = std::chrono::steady_clock::now();
    const CommandResult made = place.run("report", {"long"}, toPage);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    INFO(made.errors << made.output);
    REQUIRE(made.exitCode == 0);
    const Json record = Json::parse(place.read("page.json")), scene = record.at("scenes").at(0);
    CHECK(record.at("complete") == true);
    const std::size_t points = scene.at("points").size(), left = scene.at("left_out_points").size();
    CHECK(points + left == 9);
    // Each time it goes on with what lacks, and ends in time. On a machine with other work the first frame
    // may be so slow that nothing seems to fit.
    if (points == before) {
      CHECK(contains(unwrapped(made.output), "none would have ended in time"));
      continue;
    }
    CHECK(seconds < 12.0);
    CHECK(contains(made.output, std::to_string(before) + " of " + std::to_string(points) +
                                    " points were taken up") == (before > 0));
    CHECK(contains(unwrapped(made.output), "no time for " + std::to_string(left) + " point") == (left > 0));
    CHECK(contains(unwrapped(made.output), "the same command goes on with them: lumivox --techniques") ==
          (left > 0));
    CHECK(place.has("page.unfinished.sqlite") == (left > 0));
    before = points;
    whole = left == 0;
  }
  CHECK(runs > 1);
  // So little time that nothing is begun.
  const CommandResult none =
      place.run("report", {"long"}, {"--budget", "1ms", "--verbose", "-o", place.file("none.html")});
  INFO(none.errors);
  CHECK(none.exitCode == 0);
  // Not even a look at what a frame takes.
  CHECK_FALSE(contains(none.errors + none.output, "a frame takes"));
  CHECK(contains(unwrapped(none.output), "no time for 9 points"));
  CHECK(place.sceneOf("none.json").at("points").empty());
  if (!canDrawPages()) return;
  const Json page = drawnPage(place.file("none.html"));
  CHECK(page.at("problems").empty());
  CHECK(contains(page.at("text"), "no time for 9 points in 0.001 s"));
}

TEST_CASE("a report's page is there before its last point, whole at every moment, and says what is to come") {
  const Place place;
  place.writeSlow("long", "1 2 3 4 5 6 7 8 9");
  Started report(place.words("report", {"long"}, {"-o", place.file("page.html")}), place.file("said.txt"),
                 "5");
  REQUIRE(place.comesTo("5"));
  REQUIRE(place.has("page.html"));
  const Json record = Json::parse(place.read("page.json"));
  CHECK(record.at("complete") == false);
  const Json scene = record.at("scenes").at(0);
  CHECK(scene.at("points").size() >= 1);
  CHECK(scene.at("left_out_points").size() >= 1);
  report.signalAfter(std::chrono::milliseconds(0), SIGKILL);
  report.wait();
  if (!canDrawPages()) return;
  const Json page = drawnPage(place.file("page.html"));
  CHECK(page.at("problems").empty());
  CHECK(contains(page.at("text"), "STILL BEING MEASURED"));
}

TEST_CASE(
    "a report with time enough leaves nothing out, tells how far it is, and stores what a sweep would store") {
  const Place place;
  const std::vector<std::string> store{"--store", place.file("results.sqlite")};
  std::vector<std::string> more = store;
  more.insert(more.end(), {"--budget", "600s", "-o", place.file("page.html")});
  const CommandResult made = place.run("report", {"slow"}, more);
  INFO(made.errors);
  REQUIRE(made.exitCode == 0);
  CHECK(place.sceneOf("page.json").at("left_out_points").empty());
  CHECK_FALSE(contains(made.output, "no time for"));
  CHECK_THAT(made.errors, Tells(1, "of", 4, "points", "about") && Tells(4, "of", 4, "points"));
  const CommandResult sweep = place.run("sweep", {"slow"}, store);
  INFO(sweep.errors);
  CHECK_THAT(sweep.output, Tells(0, "measured", 4, "store"));
  // And the point that was timed twice: with a budget, one.
  const ResultsStore stored(place.file("results.sqlite"), ResultsStore::Mode::read);
  CHECK(stored.controls(stored.runs().front().identity).size() == 1);
  checkRefused(place.run("report", {"slow"}, {"--budget", "0"}), "--budget");
}

TEST_CASE("a budget in which no point would end is told, with one that begins the shortest, which does") {
  const Place place;
  place.writeSlow("long", "1 2 3");
  const auto made = [&](const std::string& budget) {
    const CommandResult result =
        place.run("report", {"long"}, {"--budget", budget, "-o", place.file("page.html")});
    INFO(result.errors);
    REQUIRE(result.exitCode == 0);
    return unwrapped(result.output);
  };
  // A point takes 1.5 s of rests; its own frame has been looked at before the budget is spent.
  const std::string none = made("1s");
  CAPTURE(none);
  const std::string told = "no time for 3 points: none would have ended in time; --budget ";
  REQUIRE(contains(none, told));
  const std::size_t at = none.find(told) + told.size();
  const std::string budget = none.substr(at, none.find(' ', at) - at);
  CAPTURE(budget);
  CHECK(place.sceneOf("page.json").at("points").empty());
  CHECK_FALSE(contains(made(budget), "none would have ended in time"));
  CHECK(place.sceneOf("page.json").at("points").size() >= 1);
}

TEST_CASE("another report on the same page leaves an interrupted one its points, and it goes on with them") {
  const Place place;
  const std::string checkpoint = place.file("page.unfinished.sqlite");
  const std::vector<std::string> toPage{"-o", place.file("page.html")};
  // Killed with one point done and two that lack their times; Ctrl-C tells how to go on.
  for (const int signal : {SIGKILL, SIGINT}) {
    CAPTURE(signal);
    std::filesystem::remove(checkpoint);
    place.endedAt("4", place.words("report", {"slow"}, toPage), signal);
    if (signal == SIGINT)
      CHECK_THAT(place.read("said.txt"),
                 Tells(checkpoint, "keeps", 1, "point", 2, "times", "to go on", "lumivox"));
    // One that shares no point, and one that takes up a point of the other and adds one of its own.
    const CommandResult foreign = place.run("report", {"fast"}, toPage);
    INFO(foreign.errors);
    CHECK(foreign.exitCode == 0);
    CHECK(contains(foreign.output, "page.html"));
    CHECK_FALSE(contains(foreign.output, "taken up"));
    REQUIRE(place.has("page.unfinished.sqlite"));
    CHECK_THAT(unwrapped(foreign.errors),
               Tells("page.unfinished.sqlite", "stays", 3, "points", "to go on", "lumivox --techniques"));
    const CommandResult sharing =
        place.run("report", {"slow", "fast"}, {"-o", place.file("page.html"), "--no-sweep"});
    INFO(sharing.errors);
    CHECK(sharing.exitCode == 0);
    CHECK_THAT(sharing.output, Tells(1, "of", 2, "points", "taken up"));
    {
      const ResultsStore kept(checkpoint, ResultsStore::Mode::read);
      CHECK(kept.count().runs == 1);
      CHECK(kept.count().untimed == 2);
    }
    CHECK(valuesIn(checkpoint) == std::vector<double>{1.0});
    const CommandResult resumed = place.run("report", {"slow"}, toPage);
    INFO(resumed.errors);
    CHECK(resumed.exitCode == 0);
    CHECK_THAT(resumed.output, Tells(1, "of", 4, "points", "taken up"));
    CHECK_THAT(resumed.errors, Tells("value=3", "taken up"));
    CHECK_FALSE(contains(resumed.errors, "stays, "));
    CHECK_FALSE(std::filesystem::exists(checkpoint));
    CHECK(place.sceneOf("page.json").at("points").size() == 4);
  }
}

TEST_CASE("an interrupted report goes on under another command with the same points, and leaves nothing") {
  const Place place;
  place.endedAt("4", place.words("report", {"slow"}, {"-o", place.file("page.html")}));
  const CommandResult again =
      place.run("report", {"slow"}, {"--brief", "--equal-time", "16ms", "-o", place.file("page.html")});
  INFO(again.errors);
  CHECK(again.exitCode == 0);
  CHECK_THAT(again.output, Tells(1, "of", 4, "points", "taken up"));
  CHECK_FALSE(place.has("page.unfinished.sqlite"));
}

TEST_CASE("of two reports at once on one page the first to end takes no point from the other") {
  const Place place;
  const std::string checkpoint = place.file("page.unfinished.sqlite");
  place.writeSlow("long", "1 2 3 4 5 6 7 8 9");
  const std::vector<std::string> toPage{"-o", place.file("page.html")};
  std::vector<std::string> stored = toPage;
  stored.insert(stored.end(), {"--store", place.file("results.sqlite")});
  // Held at its last point but one, until the other has ended.
  Started slow(place.words("report", {"long"}, toPage), place.file("long.txt"), "5");
  REQUIRE(place.comesTo("5", "long.txt"));
  // With a cache of its own, and so a lock: it could take no times beside one that is held at work.
  setenv("LUMIVOX_CACHE", place.file("other_cache").c_str(), 1);
  const CommandResult other = place.run("report", {"fast"}, stored);
  setenv("LUMIVOX_CACHE", place.file("cache").c_str(), 1);
  INFO(other.errors);
  CHECK(other.exitCode == 0);
  // It adds its own points to its store, and none of the other's.
  CHECK(runsIn(place.file("results.sqlite")) == 4);
  REQUIRE(std::filesystem::exists(checkpoint));
  CHECK_THAT(unwrapped(other.errors), Tells("page.unfinished.sqlite", "stays", "process", slow.process()));
  const std::size_t before = ResultsStore(checkpoint, ResultsStore::Mode::read).count().untimed;
  CHECK(before == 3);
  slow.signalAfter(std::chrono::milliseconds(0), SIGKILL);
  slow.wait();
  // The killed one is gone on with; meanwhile another on the same page begins and ends.
  Started resumed(place.words("report", {"long"}, toPage), place.file("resumed.txt"));
  REQUIRE(place.comesTo("", "resumed.txt"));
  CHECK(place.run("report", {"fast"}, toPage).exitCode == 0);
  const int status = resumed.wait();
  INFO(place.read("resumed.txt"));
  CHECK(status == 0);
  CHECK_FALSE(contains(place.read("resumed.txt"), "readonly"));
  CHECK(contains(place.read("resumed.txt"), "value=2: taken up from"));
  CHECK_FALSE(std::filesystem::exists(checkpoint));
  const Json points = place.sceneOf("page.json").at("points");
  CHECK(points.size() == 9);
  for (const Json& point : points) CHECK(point.at("failure") == "");
}

TEST_CASE("two reports of the same points at once share them, and both pages are whole") {
  const Place place;
  const std::vector<std::string> words = place.words("report", {"slow"}, {"-o", place.file("page.html")});
  Started first(words, place.file("first.txt")), second(words, place.file("second.txt"));
  const int firstStatus = first.wait(), secondStatus = second.wait();
  INFO(place.read("first.txt") << "\n" << place.read("second.txt"));
  CHECK(firstStatus == 0);
  CHECK(secondStatus == 0);
  CHECK_FALSE(place.has("page.unfinished.sqlite"));
  CHECK(place.sceneOf("page.json").at("points").size() == 4);
}

TEST_CASE("reports that begin while others on the page end lose no point, whoever removes the file") {
  const Place place;
  constexpr int kAtOnce = 3, kRounds = 4;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<std::unique_ptr<Started>> reports;
    for (int i = 0; i < kAtOnce; ++i) {
      const std::string seed = std::to_string(1 + round * kAtOnce + i);
      reports.push_back(std::make_unique<Started>(
          place.words("report", {"fast"}, {"--no-sweep", "--seed", seed, "-o", place.file("page.html")}),
          place.file("said" + std::to_string(i))));
    }
    for (int i = 0; i < kAtOnce; ++i) {
      const int status = reports[static_cast<std::size_t>(i)]->wait();
      INFO(place.read("said" + std::to_string(i)));
      CHECK(status == 0);
    }
    CHECK_FALSE(place.has("page.unfinished.sqlite"));
    CHECK(place.sceneOf("page.json").at("points").size() == 1);
  }
}

TEST_CASE("a report of a wrong text leaves no checkpoint") {
  const Place place;
  place.write("wrong.pipeline",
              "pipeline \"Wrong\" {\n  pass paint hostile.pain { }\n\n  output direct paint.radiance\n}\n");
  checkRefused(place.run("report", {"wrong"}, {"-o", place.file("page.html")}), "did you mean 'paint'");
  CHECK_FALSE(place.has("page.unfinished.sqlite"));
}

TEST_CASE("a point that fails while it is timed is a row that says why, and the report stands") {
  const Place place;
  const CommandResult result =
      place.run("report", {"tire", "slow"}, {"-o", place.file("page.html"), "--no-sweep"});
  INFO(result.errors);
  CHECK(result.exitCode == 1);
  const Json points = place.sceneOf("page.json").at("points");
  REQUIRE(points.size() == 2);
  CHECK(points[0].at("failure") == "pass paint: the pass is tired; expected fewer frames");
  CHECK(points[0].at("errors").empty());
  CHECK(points[0].at("passes").empty());
  CHECK(points[1].at("failure") == "");
  CHECK(points[1].at("errors").size() > 0);
  CHECK(contains(place.read("page.html"), "pass paint: the pass is tired; expected fewer frames"));
  CHECK(contains(place.read("page.csv"), "pass paint: the pass is tired; expected fewer frames"));
  CHECK(contains(result.output, "failed"));
}

TEST_CASE("a point that fails in a sweep is stored without numbers, and the others are measured") {
  const Place place;
  const std::string store = place.file("results.sqlite");
  CHECK(place.run("sweep", {"tire", "slow"}, {"--store", store, "--no-sweep"}).exitCode == 1);
  const std::vector<StoredRun> runs = ResultsStore(store, ResultsStore::Mode::read).runs();
  REQUIRE(runs.size() == 2);
  for (const StoredRun& run : runs) {
    const bool failed = !run.point.failure.empty();
    CHECK(failed == (run.pipelineName == "Tire"));
    CHECK(run.point.errors.empty() == failed);
    CHECK((run.point.frameMs.repeats == 0) == failed);
  }
}

TEST_CASE("two sweeps into one store measure each point once, and both end with all of them") {
  const Place place;
  const std::string store = place.file("results.sqlite");
  // More points than are timed together, so that each process finds some.
  place.write(
      "slow.pipeline",
      "pipeline \"Slow\" {\n  param value 1 in 0..10\n  pass paint hostile.paint { deed paint  value $value "
      "}\n\n  output direct paint.radiance\n}\n\nsweep values { value [0.5 1 2 3 4 5 6 7 8 9] }\n");
  const std::vector<std::string> words = place.words("sweep", {"slow"}, {"--store", store});
  Started first(words, place.file("first.txt")), second(words, place.file("second.txt"));
  const int firstStatus = first.wait(), secondStatus = second.wait();
  INFO(place.read("first.txt") << "\n" << place.read("second.txt"));
  CHECK(firstStatus == 0);
  CHECK(secondStatus == 0);
  CHECK(runsIn(store) == 10);
  // Each point is announced when it is measured: once by one of the two.
  const std::string said = place.read("first.txt") + place.read("second.txt");
  for (const char* value : {"0.5", "1", "2", "3", "4", "5", "6", "7", "8", "9"}) {
    std::size_t times = 0;
    const std::string line = std::string(": value=") + value + ", seed";
    const std::string bare = std::string(": value=") + value + "\n";
    for (const std::string& one : {line, bare})
      for (std::size_t at = said.find(one); at != std::string::npos; at = said.find(one, at + 1)) ++times;
    INFO(value);
    CHECK(times == 1);
  }
  CHECK(runsIn(store) == 10);
  // The first point was timed twice.
  const ResultsStore results(store, ResultsStore::Mode::read);
  CHECK(results.controls(results.runs().front().identity).size() >= 6);
}

TEST_CASE("points that a killed sweep had claimed are measured by the next") {
  const Place place;
  const std::string store = place.file("results.sqlite");
  const std::vector<std::string> words = place.words("sweep", {"slow"}, {"--store", store});
  // A frame of the default point, at 1, is looked at before the points are begun.
  place.endedAt("2", words);
  REQUIRE(runsIn(store) == 0);
  const CommandResult next = place.run("sweep", {"slow"}, {"--store", store, "--json"});
  INFO(next.errors);
  CHECK(next.exitCode == 0);
  CHECK(Json::parse(next.output).at("measured") == 4);
  CHECK(runsIn(store) == 4);
}

TEST_CASE(
    "a sweep that is killed in a batch loses the point at work and the times, and measures only those anew") {
  const Place place;
  const std::string store = place.file("results.sqlite");
  const std::vector<std::string> words = place.words("sweep", {"slow"}, {"--store", store});
  place.endedAt("3", words);
  const auto key = [&](int value) {
    for (const StoredRun& run : ResultsStore(store, ResultsStore::Mode::read).runs())
      if (run.point.parameters.at("value").number == value) return run.identity.key();
    return std::string();
  };
  REQUIRE(runsIn(store) == 0);
  CHECK(ResultsStore(store, ResultsStore::Mode::read).count().untimed == 2);
  // Nothing shows them as results.
  CHECK(contains(typed("results list --store", store).output, "0 runs"));
  const CommandResult next = place.run("sweep", {"slow"}, {"--store", store, "--json"});
  INFO(next.errors);
  CHECK(next.exitCode == 0);
  CHECK(Json::parse(next.output).at("measured") == 4);
  for (const char* value : {"1", "2", "3", "4"}) {
    INFO(value);
    const bool kept = contains(next.errors, std::string("value=") + value + ": taken up from");
    CHECK(kept == (*value <= '2'));
  }
  // They are what a sweep gives that nothing interrupts, times included.
  const std::string whole = place.file("whole.sqlite");
  REQUIRE(place.run("sweep", {"slow"}, {"--store", whole}).exitCode == 0);
  const ResultsStore resumed(store, ResultsStore::Mode::read), undisturbed(whole, ResultsStore::Mode::read);
  CHECK(resumed.count().untimed == 0);
  for (int value = 1; value <= 4; ++value) {
    const StoredRun a = resumed.find(key(value)).value(), b = undisturbed.find(key(value)).value();
    CHECK(a.point.frameMs.repeats == 3);
    CHECK(a.point.passDeviceMs.at("paint").repeats == 3);
    CHECK(a.point.peakBytes == b.point.peakBytes);
    CHECK(a.point.passWork == b.point.passWork);
    CHECK(a.point.parameters == b.point.parameters);
    REQUIRE(a.point.errors.size() == b.point.errors.size());
    for (std::size_t i = 0; i < a.point.errors.size(); ++i)
      CHECK(a.point.errors[i].error.rmse.value == b.point.errors[i].error.rmse.value);
  }
}

TEST_CASE("Ctrl-C says what is kept, and the command that goes on from there") {
  const Place place;
  const std::string store = place.file("results.sqlite");
  const std::vector<std::string> words = place.words("sweep", {"slow"}, {"--store", store});
  for (const int signal : {SIGINT, SIGTERM}) {
    INFO("signal " << signal);
    std::filesystem::remove(store);
    const int status = place.endedAt("3", words, signal);
    // As without the message: a shell sees that a signal ended it.
    CHECK(WIFSIGNALED(status));
    CHECK(WTERMSIG(status) == signal);
    const std::string said = place.read("said.txt");
    INFO(said);
    CHECK_THAT(said, Tells("interrupted", store, "keeps", 0, "points", 2, "times", "to go on"));
    std::string typed = "lumivox";
    for (const std::string& word : words) typed += " " + word;
    CHECK(contains(said, "to go on: " + typed + "\n"));
    CHECK(ResultsStore(store, ResultsStore::Mode::read).count().untimed == 2);
  }
}

TEST_CASE("a battery that is killed has stored the cells that were run") {
  const Place place;
  place.write("good.pipeline",
              "pipeline \"Good\" {\n  pass paint hostile.paint { }\n\n  output direct paint.radiance\n}\n");
  place.write(
      "spin.pipeline",
      "pipeline \"Spin\" {\n  pass paint hostile.paint { deed spin }\n\n  output direct paint.radiance\n}\n");
  const std::string store = place.file("cells.sqlite");
  const auto cells = [&] {
    try {
      return ResultsStore(store, ResultsStore::Mode::read).stressCells();
    } catch (const std::exception&) {
      return std::vector<StressCell>();
    }
  };
  Started battery({"--techniques", Place::techniques(), "stress", "--quick", "--workers", "1", "--case",
                   "camera_on_surface", "--pipeline", place.file("good.pipeline"), "--pipeline",
                   place.file("spin.pipeline"), "--time-limit", "600s", "--store", store});
  REQUIRE(becomes([&] { return cells().size() == 1; }));
  battery.signalAfter(std::chrono::milliseconds(0), SIGKILL);
  battery.wait();
  const std::vector<StressCell> kept = cells();
  REQUIRE(kept.size() == 1);
  CHECK(kept[0].outcome == StressOutcome::stable);
  CHECK(contains(kept[0].pipeline, "good.pipeline"));
  CHECK_FALSE(kept[0].device.empty());
}
