// The set-up script, with stand-ins for the programs that would look at or change the machine.
#include <cstdlib>
#include <filesystem>
#include <string>

#include "lumivox/base/file.h"
#include "support/support.h"

using namespace lumivox;
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
  CHECK(result.errors.find("could not be installed: beta") != std::string::npos);
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
  CHECK(log.find("install -y --no-install-recommends beta\n") != std::string::npos);

  // Now nothing is looked up: a broken dpkg-query goes unnoticed ...
  machine.program("dpkg-query", "exit 1");
  const auto again = machine.call("lumivox_ensure_packages");
  CHECK(again.exitCode == 0);
  CHECK(again.errors.empty());
  CHECK(readFile(calls) == log);
  // ... until the list is another.
  writeFileAtomically(machine.project() / "cmake/packages.txt", "gamma\n");
  CHECK(machine.call("lumivox_ensure_packages").exitCode == 0);
  CHECK(readFile(calls).find("gamma") != std::string::npos);
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
  for (const char* script : {"run", "test", "cmake/setup.sh"})
    fs::copy_file(test::sourceDirectory() / script, project / script);
  fs::copy_file(project / "cmake/packages.txt", project / "build/.packages-ok");
  writeFileAtomically(project / "build/build.ninja", "");
  machine.program("ninja", "echo \"ninja $*\"");
  machine.program("ctest", "echo \"ctest $*\"");
  for (const char* program : {"lumivox", "vdbexport"}) {
    const fs::path file = project / "build/bin" / program;
    fs::create_directories(file.parent_path());
    writeFileAtomically(file, "#!/bin/sh\necho \"" + std::string(program) + " $*\"\n");
    fs::permissions(file, fs::perms::owner_all);
  }
  const auto run = [&](const std::string& line) {
    return test::runCommand("PATH='" + (project.parent_path() / "bin").string() + "':$PATH '" +
                            project.string() + "'/" + line);
  };
  const auto alone = run("run");
  INFO(alone.errors);
  CHECK(alone.output == "lumivox report scenes/cornell.scene --budget 60s\n");
  CHECK(alone.errors.find("ninja laboratory\n") != std::string::npos);
  CHECK(run("run render 'a b' -o c").output == "lumivox render a b -o c\n");
  const auto exporter = run("run vdbexport --list a.vdb");
  CHECK(exporter.output == "vdbexport --list a.vdb\n");
  CHECK(exporter.errors.find("ninja laboratory vdbexport\n") != std::string::npos);
  const auto tests = run("test -R dsl");
  CHECK(tests.output.find("ctest --test-dir " + (project / "build").string()) == 0);
  CHECK(tests.output.find(" -R dsl\n") != std::string::npos);
  CHECK(tests.errors.find("ninja all\n") != std::string::npos);
}
