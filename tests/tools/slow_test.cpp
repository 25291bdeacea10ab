// The script that runs slow tests, with stand-ins for test programs; and that each of them keeps what it
// prints.
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "lumivox/base/file.h"
#include "lumivox/results/measured_table.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;
namespace fs = std::filesystem;

namespace {

/// A project folder with the script, and test programs that do as they are told.
class Project {
 public:
  Project() {
    folder_.write("tests/slow", readFile(sourceDirectory() / "tests/slow"));
    folder_.write("docs/benchmarks/measured_tables.json", R"({"version": 1, "tables": [
 {"table": "one.table",
  "test": "table: of light, and [more]",
  "device": "d",
  "date": "2026", "seconds": 125.0,
  "columns": [], "rows": []}]})");
    program("one_tests", "table: of light, and [more]",
            "echo 'row: light 0.5'; echo 'All tests passed (1 assertion in 1 test case)'");
  }
  /// A test program of one slow test.
  void program(const std::string& name, const std::string& test, const std::string& body) const {
    const fs::path file = folder_.write(
        "build/bin/" + name,
        "#!/bin/sh\nif [ \"$1\" = --list-test-names-only ]; then echo '" + test +
            "'; exit 1; fi\necho \"$1\" >> asked\necho \"$LUMIVOX_KEEP_TABLES\" >> keeps\n" + body + "\n");
    fs::permissions(file, fs::perms::owner_all);
  }
  CommandResult run(const std::string& arguments) const {
    return runCommand("bash '" + (folder_.path() / "tests/slow").string() + "' " + arguments);
  }
  std::string read(const std::string& name) const { return readFile(folder_.path() / name); }
  bool has(const std::string& name) const { return fs::exists(folder_.path() / name); }

 private:
  TemporaryDirectory folder_;
};

/// Names and bodies of the hidden tests.
std::map<std::string, std::string> hiddenTests() {
  std::map<std::string, std::string> found;
  static const std::regex head("TEST_CASE\\(\\s*\"([^\"]*)\",\\s*\"\\[\\.(?:slow)?\\]\"\\)");
  for (const auto& entry : fs::recursive_directory_iterator(sourceDirectory() / "tests")) {
    if (entry.path().extension() != ".cpp" || entry.path().filename() == "slow_test.cpp") continue;
    const std::string text = readFile(entry.path());
    for (std::sregex_iterator match(text.begin(), text.end(), head), end; match != end; ++match) {
      const auto from = static_cast<std::size_t>(match->position());
      found[(*match)[1]] = text.substr(from, text.find("\n}\n", from) - from);
    }
  }
  return found;
}

}  // namespace

TEST_CASE(
    "slow tests run one by one, with what they print, their time, and those that were skipped or failed") {
  const Project project;
  project.program("two_tests", "needs a model",
                  "echo 'SKIPPED: no dragon'; echo 'All tests passed (1 in 1)'");
  const CommandResult good = project.run("");
  INFO(good.output << good.errors);
  CHECK(good.exitCode == 0);
  CHECK(contains(good.output, "2 slow tests; when their tables were kept they took 2 min 05 s, 1 of them"));
  CHECK(contains(good.output, "row: light 0.5\npassed   0 min 0"));
  CHECK(contains(good.output, "s  one: table: of light, and [more]\n"));
  CHECK(contains(good.output, "1 passed, 0 failed, 1 skipped in "));
  CHECK(contains(good.output, "\nskipped: two: needs a model: no dragon\n"));
  // As Catch2 reads a name.
  CHECK(contains(project.read("asked"), "table: of light\\, and \\[more]\n"));
  project.program("three_tests", "is wrong", "echo 'light: 0.7, kept 0.5'; echo 'test cases: 1'; exit 1");
  const CommandResult bad = project.run("");
  CHECK(bad.exitCode == 1);
  CHECK(contains(bad.output, "light: 0.7, kept 0.5\n"));
  CHECK(contains(bad.output, "1 passed, 1 failed, 1 skipped in "));
  CHECK(contains(bad.output, "\nfailed: three: is wrong\n"));
  // A program that dies, or finds no test of that name, has not passed.
  project.program("three_tests", "is wrong", "echo 'No tests ran'");
  CHECK(project.run("").exitCode == 1);
  project.program("three_tests", "is wrong'; kill -ABRT $$; echo '", "true");
  CHECK(contains(project.run("").output, "\nfailed: three_tests: it cannot list its tests\n"));
}

TEST_CASE("slow tests are listed with their times, chosen by a pattern, and told to keep their tables") {
  const Project project;
  project.program("two_tests", "another", "echo 'All tests passed (1)'");
  const CommandResult list = project.run("--list");
  CHECK(contains(list.output, "\none: table: of light, and [more] (2 min 05 s)\ntwo: another\n"));
  CHECK_FALSE(project.has("asked"));
  CHECK(project.run("'^two'").exitCode == 0);
  CHECK(project.read("asked") == "another\n");
  CHECK(project.read("keeps") == "\n");
  const CommandResult none = project.run("nothing");
  CHECK(none.exitCode == 2);
  CHECK(contains(none.errors, "no slow test is called like 'nothing'"));
  CHECK(project.run("--fast").exitCode == 2);
  // Cards are written from what was kept.
  project.program("lumivox", "none", "echo \"$@\" > cards");
  CHECK(project.run("--keep '^two'").exitCode == 0);
  CHECK(project.read("keeps") == "\n1\n1\n");
  CHECK(project.read("cards") == "reproduce --cards\n");
}

TEST_CASE("every hidden test keeps a table, but for those that hold a closed form for longer") {
  const std::map<std::string, std::string> tests = hiddenTests();
  CHECK(tests.size() >= 25);
  const std::set<std::string> ofLaws{
      "the same elements stand on two large triangles and on a million tiny ones; a million vertices are refused",
      "form factors hold in closed form for every size of elements and bins",
      "a million rays find the same first voxel by every method",
      "light in a closed room of albedo 0.999 does not grow over a thousand bounces",
      "links grow as N log N with the number of elements, all pairs as its square",
      "what arrives in a voxel is what quadrature over a hundred thousand directions finds",
      "with 4096 paths a pixel all light of the boxes is met within 0.3 %",
      "in closed boxes of albedo 0.9 and 0.99 each bounce keeps what it keeps at 0.5, and without leaks all is there",
      // What work in shares costs, and survives.
      "a plan of 100000 points is shared in ten seconds and a gigabyte, and a share knows its points as fast",
      "a thousand stores of a thousand points merge in a minute",
      "shares that are killed at 200 random moments are complete after they go on, with no point twice"};
  const std::vector<MeasuredTable> kept =
      readMeasuredTables(sourceDirectory() / "docs/benchmarks/measured_tables.json");
  const std::regex declared("KeptTable \\w+\\(\\s*\"([^\"]+)\"");
  for (const auto& [name, body] : tests) {
    INFO(name);
    CHECK((contains(body, "KeptTable ") != ofLaws.contains(name)));
    for (std::sregex_iterator found(body.begin(), body.end(), declared), none; found != none; ++found) {
      const std::string table = (*found)[1];
      INFO(table);
      const auto known =
          std::find_if(kept.begin(), kept.end(), [&](const MeasuredTable& one) { return one.name == table; });
      REQUIRE(known != kept.end());
      CHECK(known->seconds > 0.0);
    }
  }
  for (const std::string& name : ofLaws) {
    INFO(name);
    CHECK(tests.contains(name));
  }
}

TEST_CASE("every table that is kept is measured by a hidden test of that name") {
  const std::map<std::string, std::string> tests = hiddenTests();
  const fs::path file = sourceDirectory() / "docs/benchmarks/measured_tables.json";
  for (const MeasuredTable& table : readMeasuredTables(file)) {
    INFO(table.name);
    REQUIRE(tests.contains(table.test));
    CHECK(contains(tests.at(table.test), "\"" + table.name + "\""));
    CHECK_FALSE(table.rows.empty());
    CHECK_FALSE(table.device.empty());
  }
}
