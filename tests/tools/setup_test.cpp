// The set-up script, with stand-ins for the programs that would look at or change the machine.
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <thread>

#include "lumivox/base/file.h"
#include "tools/cli_support.h"

using namespace lumivox;
using test::contains;
namespace fs = std::filesystem;

namespace {

/// A project folder with a list of packages, and a folder of stand-ins that comes first on the PATH.
class Machine {
 public:
  Machine() {
    folder_.write("project/cmake/packages.txt", "# two packages\nalpha\n\nbeta\n");
    fs::create_directories(project() / "build");
    program("dpkg-query", "echo 'alpha installed'; echo 'beta not-installed'");
    program("id", "echo 1000");
    program("sudo", "exit 1");
    program("apt-get", "exit 1");
  }
  fs::path project() const { return folder_.path() / "project"; }
  void program(const std::string& name, const std::string& body) const {
    const fs::path file = folder_.write("bin/" + name, "#!/bin/sh\n" + body + "\n");
    fs::permissions(file, fs::perms::owner_all);
  }
  /// Runs a function of the script with the project folder as its argument.
  test::CommandResult call(const std::string& function) const {
    return test::runCommand("PATH='" + (folder_.path() / "bin").string() + "':$PATH bash -c '. \"" +
                            (test::sourceDirectory() / "cmake/setup.sh").string() + "\"; " + function +
                            " \"" + project().string() + "\"'");
  }

 private:
  test::TemporaryDirectory folder_;
};

}  // namespace

TEST_CASE("the set-up names the packages that are missing and nothing else") {
  const Machine machine;
  const auto result = machine.call("lumivox_missing_packages");
  CHECK(result.exitCode == 0);
  CHECK(result.output == "beta\n");
}

TEST_CASE(
    "the set-up fails with the names of packages that are missing and cannot be installed, and leaves no "
    "stamp") {
  const Machine machine;
  const auto result = machine.call("lumivox_set_up");
  CHECK(result.exitCode == 1);
  CHECK(result.output.empty());
  CHECK(contains(result.errors, "could not be installed: beta"));
  CHECK(result.errors.find("alpha") == std::string::npos);
  CHECK_FALSE(fs::exists(machine.project() / "build/.packages-ok"));
}

TEST_CASE(
    "the set-up installs what is missing without asking questions and remembers it until the list changes") {
  const Machine machine;
  const fs::path calls = machine.project() / "calls";
  machine.program("id", "echo 0");
  machine.program("apt-get", "echo \"$DEBIAN_FRONTEND $*\" >>'" + calls.string() + "'");
  REQUIRE(machine.call("lumivox_ensure_packages").exitCode == 0);
  const std::string log = readFile(calls);
  CHECK(log.find("noninteractive") == 0);
  CHECK(contains(log, "install -y --no-install-recommends beta\n"));

  // Now nothing is looked up: a broken dpkg-query goes unnoticed ...
  machine.program("dpkg-query", "exit 1");
  const auto again = machine.call("lumivox_ensure_packages");
  CHECK(again.exitCode == 0);
  CHECK(again.errors.empty());
  CHECK(readFile(calls) == log);
  // ... until the list is another.
  writeFileAtomically(machine.project() / "cmake/packages.txt", "gamma\n");
  CHECK(machine.call("lumivox_ensure_packages").exitCode == 0);
  CHECK(contains(readFile(calls), "gamma"));
}

TEST_CASE("what is configured already is not configured again, and a copied build folder is") {
  const Machine machine;
  const fs::path build = machine.project() / "build";
  machine.program("cmake", "echo \"$*\" >>'" + (machine.project() / "calls").string() + "'");
  REQUIRE(machine.call("lumivox_configure").exitCode == 0);
  CHECK(readFile(machine.project() / "calls") == "--preset release -Wno-dev\n");

  writeFileAtomically(build / "build.ninja", "");
  writeFileAtomically(build / "CMakeCache.txt",
                      "CMAKE_HOME_DIRECTORY:INTERNAL=" + machine.project().string() + "\n");
  REQUIRE(machine.call("lumivox_configure").exitCode == 0);
  CHECK(readFile(machine.project() / "calls") == "--preset release -Wno-dev\n");

  writeFileAtomically(build / "CMakeCache.txt", "CMAKE_HOME_DIRECTORY:INTERNAL=/elsewhere\n");
  REQUIRE(machine.call("lumivox_configure").exitCode == 0);
  CHECK(readFile(machine.project() / "calls").find("--fresh") != std::string::npos);
}

TEST_CASE("./run and ./test set up what they need and pass their arguments on; alone ./run measures") {
  const Machine machine;
  const fs::path project = machine.project();
  fs::create_directories(project / "tests");
  for (const char* script : {"run", "test", "tests/run", "cmake/setup.sh"})
    fs::copy_file(test::sourceDirectory() / script, project / script);
  fs::copy_file(project / "cmake/packages.txt", project / "build/.packages-ok");
  writeFileAtomically(project / "build/build.ninja", "");
  machine.program("ninja", "echo \"ninja $*\"");
  machine.program("ctest", "echo \"ctest $*\"");
  for (const char* program : {"lumivox", "vdbexport", "dsl_tests"}) {
    const fs::path file = project / "build/bin" / program;
    fs::create_directories(file.parent_path());
    const std::string says =
        program == std::string("dsl_tests") ? "dsl_lexer: words end at spaces" : program + std::string(" $*");
    writeFileAtomically(file, "#!/bin/sh\necho \"" + says + "\"\n");
    fs::permissions(file, fs::perms::owner_all);
  }
  const auto run = [&](const std::string& line) {
    return test::runCommand("PATH='" + (project.parent_path() / "bin").string() + "':$PATH '" +
                            project.string() + "'/" + line);
  };
  const auto alone = run("run");
  INFO(alone.errors);
  CHECK(alone.output == "lumivox report scenes/cornell.scene --budget 60s\n");
  CHECK(contains(alone.errors, "ninja laboratory\n"));
  const auto render = run("run render 'a b' -o c");
  CHECK(render.output == "lumivox render a b -o c\n");
  CHECK(contains(render.errors, "ninja laboratory lumivox_volume\n"));
  const auto exporter = run("run vdbexport --list a.vdb");
  CHECK(exporter.output == "vdbexport --list a.vdb\n");
  CHECK(contains(exporter.errors, "ninja laboratory vdbexport\n"));
  const auto tests = run("test -R dsl");
  CHECK(tests.output.find("ctest --test-dir " + (project / "build").string()) == 0);
  CHECK(contains(tests.output, " -R ^(dsl_lexer)( [0-9]+ of [0-9]+)?$\n"));
  CHECK(contains(run("test -R 'at spaces$'").output, " -R ^(dsl_lexer)( [0-9]+ of [0-9]+)?$\n"));
  const auto none = run("test -R absent");
  CHECK(none.exitCode == 1);
  CHECK(contains(none.errors, "no case matches 'absent'"));
  CHECK(contains(run("run view a.scene").errors, "ninja laboratory lumivox_volume lumivox_view\n"));
  CHECK(contains(tests.errors, "ninja all\n"));
}

namespace {

/// What chooses cases of this process chooses none of those that it starts.
constexpr const char* kAnew = "env -u LUMIVOX_TEST_CASES -u LUMIVOX_TEST_SHARE -u LUMIVOX_TEST_WITHOUT ";

}  // namespace

TEST_CASE("./test tells of cases: it names one that crashes, and runs what stands behind it") {
  const Machine machine;
  const fs::path project = machine.project();
  fs::create_directories(project / "tests");
  fs::create_directories(project / "build/bin");
  fs::copy_file(test::sourceDirectory() / "tests/run", project / "tests/run");
  machine.program(
      "ctest",
      "printf 'begin\\tdsl_lexer: a\\nend\\tpassed\\t0.50\\tdsl_lexer: a\\nbegin\\tdsl_lexer: b\\n' "
      "> \"$LUMIVOX_TEST_EVENTS/dsl_tests.1\"\nexit 8");
  const fs::path program = project / "build/bin/dsl_tests";
  writeFileAtomically(
      program,
      "#!/bin/sh\ncat \"$LUMIVOX_TEST_WITHOUT\" > '" + (project / "without").string() +
          "'\nprintf 'begin\\tdsl_lexer: c\\nskip\\tno model\\nend\\tpassed\\t0.25\\tdsl_lexer: c\\n' "
          "> \"$LUMIVOX_TEST_EVENTS/dsl_tests.2\"\n");
  fs::permissions(program, fs::perms::owner_all);
  const auto result = test::runCommand(kAnew + ("PATH='" + (project.parent_path() / "bin").string()) +
                                       "':$PATH '" + (project / "tests/run").string() + "'");
  INFO(result.output << result.errors);
  CHECK(result.exitCode == 1);
  CHECK(readFile(project / "without") == "dsl_lexer: a\ndsl_lexer: b\n");
  CHECK(contains(result.output, "crashed: dsl_lexer: b\n"));
  CHECK(contains(result.output, "skipped: dsl_lexer: c (no model)\n"));
  CHECK(contains(result.output, "3 cases: 1 passed, 1 failed, 1 skipped;"));
}

TEST_CASE("a case of the next one: it does not end where that asks for it") {
  while (std::getenv("LUMIVOX_TEST_WAITS") != nullptr) std::this_thread::sleep_for(std::chrono::seconds(1));
  SUCCEED("nobody asked");
}

TEST_CASE("a case that does not end is ended, and told by its name; what it set is put back") {
  const test::TemporaryDirectory events;
  const std::string program = (test::binaryDirectory() / "bin/project_tests").string();
  const auto result = test::runCommand(
      std::string(kAnew) + "LUMIVOX_TEST_WAITS=1 LUMIVOX_TEST_LIMIT=1 LUMIVOX_TEST_EVENTS='" +
      events.path().string() + "' '" + program + "' 'a case of the next one*'");
  CHECK(result.exitCode == 124);
  std::string told;
  for (const auto& entry : fs::directory_iterator(events.path())) told += readFile(entry.path());
  CHECK(told.find("begin\tsetup: a case of the next one") == 0);
  CHECK(contains(told, "end\ttime-out\t1\tsetup: a case of the next one"));
  // All shares together are all cases, each once.
  std::multiset<std::string> shared, all;
  const auto listed = [&](const std::string& variables, std::multiset<std::string>& names) {
    std::istringstream lines(test::runCommand(kAnew + variables + " '" + program + "' --cases").output);
    for (std::string line; std::getline(lines, line);) names.insert(line);
  };
  listed("", all);
  for (const char* share : {"1/3", "2/3", "3/3"}) listed(std::string("LUMIVOX_TEST_SHARE=") + share, shared);
  CHECK(all.size() > 50);
  CHECK(shared == all);
}
