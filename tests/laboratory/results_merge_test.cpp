// Stores that are merged: in any order, once or again, of one version, whole or not at all.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>

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

/// Everything that a store holds, numbers of rows included.
std::string contentOf(const std::filesystem::path& file) {
  const ResultsStore store(file, ResultsStore::Mode::read);
  std::string text = runsJson(store.runs()).dump(1) + stressCellsJson(store.stressCells());
  for (const StoredRun& run : store.runs())
    for (const StoredImage& image : store.images(run.identity.key())) text += image.output + image.png;
  return text + selected(file, "SELECT group_concat(run || created || what || median_ms) FROM controls") +
         selected(file, "SELECT group_concat(run || name || coalesce(value, 'none')) FROM metrics");
}

std::vector<MergeCount> merged(const std::filesystem::path& into,
                               const std::vector<std::filesystem::path>& files) {
  return ResultsStore(into).merge(files, /*mixed=*/false);
}

StoredRun at(int number, const std::string& created) {
  StoredRun run = runNumber(number);
  run.created = created;
  return run;
}

/// Three stores: runs that only one has, runs of two that differ, failures, cells of one second that differ.
class Stores : public TemporaryDirectory {
 public:
  const std::filesystem::path a = path() / "a.sqlite", b = path() / "b.sqlite", c = path() / "c.sqlite";
  Stores() {
    ResultsStore first(a), second(b), third(c);
    for (int number : {9, 1, 2}) first.add(runNumber(number));
    for (int number : {5, 3}) second.add(at(number, "2026-02-01 12:00:00 UTC"));
    second.add(at(2, "2026-01-01 12:00:00 UTC"), {{"final", "full", "", 0.0, "of b"}});
    StoredRun failed = at(1, "2025-01-01 12:00:00 UTC");
    failed.point.failure = "it did not fit";
    second.add(failed);
    StoredRun other = runNumber(9);  // of the same second as that of a
    other.point.frameMs.median = 11.0;
    third.add(other);
    third.add(runNumber(7));
    first.addControl(runNumber(2).identity.key(), {12.0, 11.5, 12.5, 11.0, 13.0, 5}, {});
    second.addControl(runNumber(2).identity.key(), {13.0, 11.5, 13.5, 11.0, 14.0, 5}, {});
    const auto cellOf = [](int number) {
      StressCell cell = cellNumber(number);
      cell.framework = runNumber(1).identity.framework;
      cell.techniques = runNumber(1).identity.techniques;
      return cell;
    };
    StressCell cell = cellOf(1);
    first.add(std::vector<StressCell>{cell});
    cell.detail = "another detail";
    second.add(std::vector<StressCell>{cell, cellOf(2)});
  }
};

}  // namespace

TEST_CASE("stores merge to the same, bit by bit, in whichever order they are given") {
  const Stores stores;
  merged(stores.path() / "1.sqlite", {stores.a, stores.b, stores.c});
  merged(stores.path() / "2.sqlite", {stores.c, stores.b, stores.a});
  merged(stores.path() / "3.sqlite", {stores.b, stores.a, stores.c});
  const std::string content = contentOf(stores.path() / "1.sqlite");
  CHECK(content == contentOf(stores.path() / "2.sqlite"));
  CHECK(content == contentOf(stores.path() / "3.sqlite"));
  const ResultsStore store(stores.path() / "1.sqlite", ResultsStore::Mode::read);
  CHECK(store.runs().size() == 6);
  CHECK(store.succeeded(runNumber(1).identity.key()) == true);  // the failure is older, and yet no result
  CHECK(store.find(runNumber(2).identity.key())->created == "2026-01-01 12:00:00 UTC");
  CHECK(store.images(runNumber(2).identity.key()).at(0).png == "of b");
  CHECK(selected(stores.path() / "1.sqlite", "SELECT median_ms FROM controls") == "12.0");
}

TEST_CASE("stores that are merged one after another hold the same, but for the numbers of the rows") {
  const Stores stores;
  const auto held = [](const std::filesystem::path& file) {
    std::set<std::string> texts;
    for (StoredRun run : ResultsStore(file, ResultsStore::Mode::read).runs()) {
      run.id = 0;
      texts.insert(toJson(run).dump());
    }
    return texts;
  };
  for (const auto& file : {stores.a, stores.b, stores.c}) merged(stores.path() / "1.sqlite", {file});
  for (const auto& file : {stores.c, stores.b, stores.a}) merged(stores.path() / "2.sqlite", {file});
  CHECK(held(stores.path() / "1.sqlite") == held(stores.path() / "2.sqlite"));
  for (const char* sql :
       {"SELECT group_concat(t) FROM (SELECT r.key || c.created || c.what || c.median_ms AS t FROM "
        "controls c JOIN runs r ON r.id = c.run ORDER BY t)",
        "SELECT group_concat(detail) FROM (SELECT detail FROM stress_cells ORDER BY key)"})
    CHECK(selected(stores.path() / "1.sqlite", sql) == selected(stores.path() / "2.sqlite", sql));
}

TEST_CASE("a store that is merged once more changes nothing") {
  const Stores stores;
  const auto into = stores.path() / "all.sqlite";
  const std::vector<MergeCount> first = merged(into, {stores.a, stores.b, stores.c});
  CHECK(first[0].runs + first[1].runs + first[2].runs >= 6);
  const std::string content = contentOf(into);
  for (const MergeCount& count : merged(into, {stores.b, stores.c, stores.a, into})) {
    CHECK(count.runs == 0);
    CHECK(count.cells == 0);
  }
  CHECK(contentOf(into) == content);
}

TEST_CASE("results of two versions are refused with both names, and merged when that is asked for") {
  const Stores stores;
  const auto other = stores.path() / "other.sqlite", into = stores.path() / "all.sqlite";
  const auto refused = [&](const std::string& what) {
    try {
      merged(into, {stores.a, other});
    } catch (const Error& error) {
      INFO(error.what());
      CHECK_THAT(error.what(), Catch::Contains(what));
      CHECK_THAT(error.what(), Catch::Contains(other.string()));
      CHECK_THAT(error.what(), Catch::Contains(stores.a.string()));
      CHECK_THAT(error.what(), Catch::Contains("--mixed"));
      return;
    }
    FAIL("it was merged");
  };
  StoredRun run = runNumber(20);
  run.version = "0.2.0";
  ResultsStore(other).add(run);
  refused("results of lumivox 0.2.0");
  std::filesystem::remove(other);
  run = runNumber(20);
  run.identity.framework = "f1";
  ResultsStore(other).add(run);
  refused("libraries f1");
  std::filesystem::remove(other);
  run = runNumber(20);
  run.identity.techniques["voxelization"] = "3c";
  ResultsStore(other).add(run);
  refused("technique voxelization 3c");
  CHECK(ResultsStore(into).runs().empty());
  ResultsStore(into).merge({stores.a, other}, /*mixed=*/true);
  CHECK(ResultsStore(into).runs().size() == 4);
  // What is here already counts, too.
  CHECK_THROWS_WITH(merged(into, {stores.b}), Catch::Contains(into.string()));
}

TEST_CASE("a store that is cut off or no store is refused by name and leaves the store as it was") {
  const Stores stores;
  const auto into = stores.path() / "all.sqlite", cut = stores.path() / "cut.sqlite";
  {
    ResultsStore large(cut);
    for (int number = 100; number < 200; ++number) large.add(runNumber(number));
  }
  merged(into, {stores.a});
  const std::string content = contentOf(into), whole = readFile(cut);
  for (const double share : {0.0, 0.01, 0.5, 0.95}) {
    INFO(share);
    stores.write("cut.sqlite",
                 whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size()))));
    CHECK_THROWS_WITH(merged(into, {stores.b, cut, stores.c}), Catch::Contains(cut.string()));
    CHECK(contentOf(into) == content);
  }
  CHECK_THROWS_WITH(merged(into, {stores.b, stores.path() / "none.sqlite"}), Catch::Contains("none.sqlite"));
  CHECK(contentOf(into) == content);
}

TEST_CASE(
    "a merge that is killed leaves the store before or after it, and a store that was killed is merged") {
  const TemporaryDirectory directory;
  const auto into = directory.path() / "all.sqlite";
  std::vector<std::filesystem::path> files;
  for (int i = 0; i < 4; ++i) {
    files.push_back(directory.path() / (std::to_string(i) + ".sqlite"));
    ResultsStore store(files.back());
    for (int number = 0; number < 150; ++number) store.add(runNumber(1000 * i + number));
  }
  const auto start = std::chrono::steady_clock::now();
  merged(directory.path() / "once.sqlite", files);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  ResultsStore(into).add(runNumber(-1));
  constexpr int kKills = 8;
  for (int attempt = 0; attempt < kKills; ++attempt) {
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      merged(into, files);
      _exit(0);
    }
    usleep(static_cast<unsigned>(1e6 * seconds * (attempt + 0.5) / kKills));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    const std::size_t runs = ResultsStore(into, ResultsStore::Mode::read).runs().size();
    INFO(runs);
    CHECK((runs == 1 || runs == 601));
  }
  // One of the others is killed while it writes: its journal is rolled back when it is read.
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0)
    for (int number = 500;; ++number) ResultsStore(files[0]).add(runNumber(number));
  usleep(300'000);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  merged(into, files);
  CHECK(ResultsStore(into).runs().size() >= 601);
  CHECK(selected(into, "SELECT count(*) FROM runs GROUP BY key HAVING count(*) > 1").empty());
}

TEST_CASE("a claim for a share stands until its store is merged, removed or given up") {
  const TemporaryDirectory directory;
  const auto part = directory.path() / "1.sqlite", other = directory.path() / "2.sqlite";
  ResultsStore into(directory.path() / "all.sqlite");
  ResultsStore(part).add(runNumber(1));
  ResultsStore{other};
  const std::string one = runNumber(1).identity.key(), two = runNumber(2).identity.key();
  CHECK(into.claimFor(part, {one, two}) == std::vector<bool>{true, true});
  CHECK(into.claimFor(part, {one}) == std::vector<bool>{true});  // it goes on
  CHECK(into.claimFor(other, {one, two}) == std::vector<bool>{false, false});
  into.releaseFor(part, {two});
  CHECK(into.claimFor(other, {one, two}) == std::vector<bool>{false, true});
  // Delivered, it stands though its process is gone and its time is over.
  into.deliver(part, {one});
  CHECK(into.claimFor(other, {one}) == std::vector<bool>{false});
  std::filesystem::rename(part, directory.path() / "away.sqlite");
  CHECK(into.claimFor(other, {one}) == std::vector<bool>{true});
  std::filesystem::rename(directory.path() / "away.sqlite", part);
  into.deliver(part, {one});
  into.merge({part}, false);
  CHECK(selected(into.file(), "SELECT count(*) FROM claims") == "1");  // of 2.sqlite
  into.merge({other}, false);
  CHECK(selected(into.file(), "SELECT count(*) FROM claims") == "0");
}
