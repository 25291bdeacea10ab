// `lumivox new technique`: what it writes and what it refuses; how the program describes itself to shells and
// as a manual page. That what it writes is built and renders is tested by sdk_test.
#include <algorithm>
#include <regex>
#include <set>

#include "lumivox/base/file.h"
#include "lumivox/base/installation.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;
namespace fs = std::filesystem;

namespace {

/// All files below a folder, by their paths relative to it.
std::set<std::string> filesBelow(const fs::path& folder) {
  std::set<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.insert(entry.path().lexically_relative(folder).generic_string());
  return files;
}

}  // namespace

TEST_CASE("a new technique has one of each part, under its name, in a project of its own") {
  const TemporaryDirectory work;
  const CommandResult made = ran("new technique glow --in", work.path() / "lab");
  const std::set<std::string> files = filesBelow(work.path() / "lab");
  for (const char* file :
       {"CMakeLists.txt", "techniques/glow/CMakeLists.txt", "techniques/glow/glow.cpp",
        "techniques/glow/README.md", "techniques/glow/glow.png", "shaders/glow/gather.comp",
        "scenes/pipelines/glow.pipeline", "tests/techniques/glow_test.cpp"}) {
    INFO(file);
    CHECK(files.count(file) == 1);
  }
  for (const std::string& file : files) {
    INFO(file);
    CHECK(contains(made.output, file));
    CHECK_FALSE(contains(readFile(work.path() / "lab" / file), "technique_name"));
  }
  CHECK(typed("fmt --check", work.path() / "lab/scenes/pipelines/glow.pipeline").exitCode == 0);
  // A program in a build folder is installed first: find_package would reject the folder itself.
  const std::string build = binaryDirectory().string(), prefix = build + "/installed";
  CHECK(contains(made.output,
                 "ninja -C " + build + " sdk && cmake --install " + build + " --prefix " + prefix));
  CHECK(contains(made.output, "-DCMAKE_PREFIX_PATH=" + prefix + " "));
  // A second one goes beside it and leaves the project as it is.
  const std::string project = readFile(work.path() / "lab/CMakeLists.txt");
  ran(in(work.path() / "lab/techniques"), "new technique shine");
  CHECK(fs::exists(work.path() / "lab/techniques/shine/shine.cpp"));
  CHECK(readFile(work.path() / "lab/CMakeLists.txt") == project);
}

TEST_CASE("without a project around the working folder a new technique makes one of its own name") {
  const TemporaryDirectory work;
  ran(in(work.path()), "new technique glow");
  CHECK(fs::exists(work.path() / "glow/techniques/glow/glow.cpp"));
}

TEST_CASE("names that are no C++ namespace, no folder or taken are refused, and nothing is written") {
  const TemporaryDirectory work;
  const auto made = [&](const std::string& name) {
    return typed("new technique", name, "--in", work.path() / "lab");
  };
  for (const char* name : {"", "Glow", "2d", "_glow", "glow_", "a__b", "a-b", "../up", "a/b", "ns::a",
                           "class", "new", "common", "device", "shaders", "toolkit", "viewer"}) {
    INFO(name);
    checkRefused(made(name), "my_paper");
  }
  checkRefused(made(std::string(65, 'a')), 64);
  checkRefused(made("direct_lighting"), "direct_lighting", "already");
  CHECK(filesBelow(work.path()).empty());
}

TEST_CASE("a folder that is no project, and a technique that exists, are refused and left as they were") {
  const TemporaryDirectory work;
  work.write("notes/today.txt", "mine");
  checkRefused(typed("new technique glow --in", work.path() / "notes"), "notes");
  CHECK(filesBelow(work.path()) == std::set<std::string>{"notes/today.txt"});

  ran("new technique glow --in", work.path() / "lab");
  const std::set<std::string> before = filesBelow(work.path());
  writeFileAtomically(work.path() / "lab/techniques/glow/glow.cpp", "mine");
  checkRefused(typed("new technique glow --in", work.path() / "lab"), "techniques/glow");
  CHECK(readFile(work.path() / "lab/techniques/glow/glow.cpp") == "mine");
  CHECK(filesBelow(work.path()) == before);

  // One of its files alone is enough to refuse it.
  work.write("lab/scenes/pipelines/shine.pipeline", "mine");
  checkRefused(typed("new technique shine --in", work.path() / "lab"), "shine.pipeline");
  CHECK_FALSE(fs::exists(work.path() / "lab/techniques/shine"));
}

TEST_CASE("a technique without a source or without a paper card is refused when it is configured") {
  const TemporaryDirectory work;
  work.write("CMakeLists.txt",
             "cmake_minimum_required(VERSION 3.25)\nproject(lab LANGUAGES NONE)\ninclude(\"" +
                 (sourceDirectory() / "cmake/LumivoxTechniques.cmake").string() +
                 "\")\nlumivox_add_technique(glow)\n");
  const auto configured = [&] {
    const CommandResult result =
        runCommand("cmake -S '" + work.path().string() + "' -B '" + work.path().string() + "/build'");
    CHECK(result.exitCode != 0);
    return std::regex_replace(result.errors, std::regex("\\s+"), " ");  // CMake breaks lines where it likes
  };
  const std::string folder = (work.path() / "techniques/glow").string();
  CHECK(contains(configured(), "lumivox_add_technique(glow): there is no source " + folder + "/*.cpp"));
  work.write("techniques/glow/glow.cpp", "");
  const std::string cardless = configured();
  INFO(cardless);
  CHECK(contains(cardless,
                 "lumivox_add_technique(glow): the paper card " + folder +
                     "/README.md is missing; expected the paper, what is implemented, deviations, claims and "
                     "limits; 'lumivox new technique' writes one to start from"));
  // It is told of the list file that calls it, and nothing is built without a card.
  CHECK(contains(cardless, "CMakeLists.txt:4 (lumivox_add_technique)"));
  CHECK_FALSE(fs::exists(work.path() / "build/build.ninja"));
}

TEST_CASE("data of an installed program is in share/lumivox of its prefix, that of a built one above it") {
  const TemporaryDirectory work;
  work.write("tree/templates/a", "");
  work.write("tree/build/bin/lumivox", "");
  CHECK(programData("templates", work.path() / "tree/build/bin/lumivox") == work.path() / "tree/templates");
  CHECK_FALSE(programData("absent_data", work.path() / "tree/build/bin/lumivox"));
  // The prefix comes first, whatever lies above it.
  work.write("tree/prefix/bin/lumivox", "");
  work.write("tree/prefix/share/lumivox/templates/a", "");
  CHECK(programData("templates", work.path() / "tree/prefix/bin/lumivox") ==
        work.path() / "tree/prefix/share/lumivox/templates");
}

TEST_CASE("the manual page has every command with its options, and troff takes it") {
  const CommandResult page = ran("--print-man");
  for (const char* part :
       {".TH LUMIVOX 1", ".SH NAME\nlumivox \\- ", ".SS lumivox render\n", ".SS lumivox results list\n",
        "\\fB\\-\\-keep\\-everything\\fR", ".SH EXIT STATUS"}) {
    INFO(part);
    CHECK(contains(page.output, part));
  }
  if (runCommand("command -v groff").exitCode != 0) return skip("groff is not installed");
  const TemporaryDirectory work;
  const std::string file = work.write("lumivox.1", page.output).string();
  const CommandResult read = runCommand("groff -man -Tutf8 -ww '" + file + "'");
  CHECK(read.exitCode == 0);
  CHECK(read.errors.empty());
}

TEST_CASE("bash completes commands, options and the words that an option takes") {
  const CommandResult script = ran("--print-completion bash");
  const TemporaryDirectory work;
  const std::string file = work.write("completion", script.output).string();
  const auto completed = [&](const std::string& words, int at) {
    const CommandResult result =
        runCommand("bash -c '. \"" + file + "\"; COMP_WORDS=(" + words +
                   "); COMP_CWORD=" + std::to_string(at) + "; _lumivox; echo \"${COMPREPLY[@]}\"'");
    INFO(words << "\n" << result.errors);
    CHECK(result.exitCode == 0);
    CHECK(result.errors.empty());
    return result.output;
  };
  for (const auto& [words, at, offered] :
       {std::tuple("lumivox ren", 1, "render"),
        {"lumivox new t", 2, "technique"},
        {"lumivox render --keep", 2, "--keep-everything"},
        {"lumivox render --arith", 2, "--arithmetic"},  // of all
        {"lumivox render --arithmetic e", 3, "exact"},
        {"lumivox --print-completion z", 2, "zsh"},
        {"lumivox render scenes/co", 2, ""}})  // left to the shell, which completes files
    CHECK(completed(words, at) == std::string(offered) + "\n");
}

TEST_CASE("zsh takes its completion, and completes commands and options by it") {
  const CommandResult script = ran("--print-completion zsh");
  CHECK(script.output.rfind("#compdef lumivox\n", 0) == 0);
  CHECK(contains(script.output, "'--keep-everything:"));
  checkRefused(typed("--print-completion tcsh"), "tcsh");
  if (runCommand("command -v zsh").exitCode != 0) return skip("zsh is not installed");
  const TemporaryDirectory work;
  const std::string file = work.write("_lumivox", script.output).string();
  CHECK(runCommand("zsh -n '" + file + "'").exitCode == 0);
  // Its own functions are answered by ones that print what they are asked to offer.
  const auto offered = [&](const std::string& words, int current, const std::string& prefix) {
    const std::string test = work.write("offer.zsh",
                                        "_describe() { local name=${@[-1]}; print -l -- \"${(@P)name}\" }\n"
                                        "compadd() { print -l -- \"$@\" }\n_files() { print files }\n"
                                        "words=(" +
                                            words + "); CURRENT=" + std::to_string(current) +
                                            "; PREFIX=" + prefix + "\nsource '" + file + "'\n")
                                 .string();
    const CommandResult result = runCommand("zsh -f '" + test + "'");
    INFO(result.errors);
    CHECK(result.errors.empty());
    return result.output;
  };
  CHECK(contains(offered("lumivox ren", 2, "ren"), "render:renders"));
  CHECK(contains(offered("lumivox new t", 3, "t"), "technique:"));
  CHECK(contains(offered("lumivox render --keep", 3, "--keep"), "--keep-everything:"));
  CHECK(contains(offered("lumivox render --ar", 3, "--ar"), "--arithmetic:"));  // of every command
  CHECK(offered("lumivox render --arithmetic e", 4, "e") == "exact\nfast\n");
  CHECK(offered("lumivox render scenes/co", 3, "scenes/co") == "files\n");
}

TEST_CASE("fish takes its completion, and completes commands, options and words by it") {
  const CommandResult script = ran("--print-completion fish");
  CHECK(contains(script.output, "complete -c lumivox -n '__lumivox_at render' -l keep-everything"));
  CHECK(contains(script.output, "complete -c lumivox -l arithmetic -x -a 'exact fast'"));
  if (runCommand("command -v fish").exitCode != 0) return skip("fish is not installed");
  const TemporaryDirectory work;
  const std::string file = work.write("lumivox.fish", script.output).string();
  const auto offered = [&](const std::string& line) {
    const CommandResult result =
        runCommand("HOME='" + work.path().string() + "' fish --no-config -c 'source " + file +
                   "; complete -C \"" + line + "\"'");
    INFO(result.errors);
    CHECK(result.errors.empty());
    return result.output;
  };
  CHECK(contains(offered("lumivox ren"), "render\t"));
  CHECK(contains(offered("lumivox new t"), "technique\t"));
  CHECK(contains(offered("lumivox render --keep"), "--keep-everything"));
  CHECK(contains(offered("lumivox render --arith"), "--arithmetic"));
  CHECK(contains(offered("lumivox render --arithmetic e"), "exact"));
  CHECK_FALSE(contains(offered("lumivox render --quick"), "--quick"));  // of another command
}
