// The script that runs the steps of the Containerfile in a fresh tree, as far as that needs neither root nor
// a mirror of packages; and that the Containerfile has the two commands of the README.
#include <filesystem>
#include <string>

#include "lumivox/base/file.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;
namespace fs = std::filesystem;

namespace {

/// A project folder with the script and a Containerfile of its own, and a folder of stand-ins for programs.
class Room {
 public:
  explicit Room(const std::string& containerfile) {
    folder_.write("tests/clean_room/run", readFile(sourceDirectory() / "tests/clean_room/run"));
    if (!containerfile.empty()) folder_.write("Containerfile", containerfile);
    fs::create_directories(folder_.path() / "temporary");
    program("id", "echo 0");
    for (const char* name : {"mmdebstrap", "git", "unshare", "apt-get"}) program(name, "exit 1");
  }
  void program(const std::string& name, const std::string& body) const {
    const fs::path file = folder_.write("bin/" + name, "#!/bin/sh\n" + body + "\n");
    fs::permissions(file, fs::perms::owner_all);
  }
  void without(const std::string& name) const { fs::remove(folder_.path() / "bin" / name); }
  /// The script sees the stand-ins and the few programs that it reads a Containerfile with, and no others.
  CommandResult run(const std::string& arguments) const {
    for (const char* name :
         {"bash", "chmod", "dirname", "readlink", "sed", "df", "tail", "tr", "mktemp", "rm"}) {
      const fs::path link = folder_.path() / "bin" / name;
      if (!fs::exists(link))
        program(name, "PATH=/usr/local/bin:/usr/bin:/bin exec " + std::string(name) + " \"$@\"");
    }
    const std::string script = (folder_.path() / "tests/clean_room/run").string();
    return runCommand("PATH='" + (folder_.path() / "bin").string() + "' TMPDIR='" +
                      (folder_.path() / "temporary").string() + "' /bin/bash '" + script + "' " + arguments);
  }
  bool temporaryIsEmpty() const { return fs::is_empty(folder_.path() / "temporary"); }

 private:
  TemporaryDirectory folder_;
};

constexpr const char* kGood =
    "# a comment\nFROM docker.io/library/debian:bookworm\n\nWORKDIR /a\nCOPY . .\nRUN ./run\n";

}  // namespace

TEST_CASE(
    "the clean room runs the steps of the Containerfile as they stand: the two commands of the README") {
  const CommandResult result =
      runCommand("'" + (sourceDirectory() / "tests/clean_room/run").string() + "' --list");
  CHECK(result.exitCode == 0);
  CHECK(result.errors.empty());
  CHECK(result.output == "FROM Debian bookworm\nWORKDIR /lumivox\nCOPY . .\nRUN ./run\nRUN ./test -R dsl\n");
  CHECK(Room(kGood).run("--list").output == "FROM Debian bookworm\nWORKDIR /a\nCOPY . .\nRUN ./run\n");
  CHECK(Room(std::string(kGood) + "RUN ./test -R 'a b'  # c").run("--list").output ==
        "FROM Debian bookworm\nWORKDIR /a\nCOPY . .\nRUN ./run\nRUN ./test -R 'a b'  # c\n");
}

TEST_CASE("what a container builder copies is what git does not ignore") {
  std::string ignored = readFile(sourceDirectory() / ".dockerignore");
  for (const char* line : {"/build", "/build-*", "/out", "/.cache"}) {
    INFO(line);
    CHECK(contains("\n" + ignored, "\n" + std::string(line) + "\n"));
    CHECK(contains("\n" + readFile(sourceDirectory() / ".gitignore"), "\n" + std::string(line) + "/\n"));
  }
}

TEST_CASE("a step that the clean room cannot run is named with its line and what was expected") {
  const auto refused = [](const std::string& containerfile, const std::string& sentence) {
    const CommandResult result = Room(containerfile).run("--list");
    INFO(containerfile << result.output << result.errors);
    CHECK(result.exitCode == 2);
    CHECK(result.output.empty());
    CHECK(contains(result.errors, "Containerfile" + sentence));
  };
  refused("", ", which has the steps");
  refused(std::string(kGood) + "ADD a b\n", ":7: 'ADD a b': expected WORKDIR, COPY or RUN");
  refused(std::string(kGood) + "WORKDIR b\n", ":7: 'WORKDIR b': expected WORKDIR and an absolute path");
  refused(std::string(kGood) + "COPY a b\n", ":7: 'COPY a b': expected COPY . and the folder");
  refused(std::string(kGood) + "RUN [\"./run\"]\n",
          ":7: 'RUN [\"./run\"]': expected RUN and a shell command");
  refused(std::string(kGood) + "RUN a \\\n b\n",
          ":7: 'RUN a \\': expected RUN and a shell command on one line");
  refused("RUN ./run\n", ":1: 'RUN ./run': expected FROM docker.io/library/debian:SUITE first");
  refused("FROM alpine\n", ":1: 'FROM alpine': expected FROM docker.io/library/debian:SUITE first");
  refused("FROM docker.io/library/debian:bookworm\n", ": expected steps behind FROM");
  refused("# nothing\n", ": expected steps behind FROM");
}

TEST_CASE("the clean room says all that the machine lacks, makes nothing, and fails") {
  const Room room(kGood);
  room.without("mmdebstrap");
  room.program("id", "echo 1000");
  const CommandResult both = room.run("");
  CHECK(both.exitCode == 2);
  CHECK(contains(both.errors,
                 "it lacks root (it mounts and enters a tree), the program mmdebstrap; on Debian"));
  room.program("id", "echo 0");
  const CommandResult program = room.run("--keep");
  CHECK(program.exitCode == 2);
  CHECK(contains(program.errors, "it lacks the program mmdebstrap; on Debian"));
  room.program("mmdebstrap", "exit 1");
  const CommandResult rights = room.run("");
  CHECK(rights.exitCode == 2);
  CHECK(contains(rights.errors, "this machine gives root no namespace to mount in"));
  room.program("unshare", "exit 0");
  room.program("df", "echo Avail; echo 12M");
  const CommandResult disk = room.run("");
  CHECK(disk.exitCode == 2);
  CHECK(contains(disk.errors, " has 12 MB free, and a tree with the build needs "));
  CHECK(contains(disk.errors, "set TMPDIR to a folder on a larger disk"));
  // A step that fails leaves no folder.
  room.program("df", "echo Avail; echo 999999M");
  const CommandResult clone = room.run("");
  CHECK(clone.exitCode == 1);
  CHECK(contains(clone.errors, ": the last commit could not be cloned"));
  CHECK(room.temporaryIsEmpty());
  const CommandResult unknown = room.run("--kept");
  CHECK(unknown.exitCode == 2);
  CHECK(contains(unknown.errors, "unknown option --kept; expected --list or --keep"));
}
