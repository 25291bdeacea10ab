// Every command that the README and `lumivox help` name is started, with a scene and as a user types it, in a
// copy of the scenes.
#include <algorithm>
#include <regex>
#include <set>
#include <sstream>

#include "laboratory/results_sql.h"
#include "lumivox/base/file.h"
#include "tools/cli_support.h"
#include "tools/display.h"
#include "tools/guide.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

namespace fs = std::filesystem;

/// A command, and the line that starts it. They are started in this order: some read what others wrote.
struct Line {
  std::string command, typed;
};

const std::vector<Line>& lines() {
  static const std::vector<Line> all{
      {"help", "lumivox help render"},
      {"check", "lumivox check scenes/cornell.scene scenes/pipelines/direct_lighting.pipeline"},
      {"fmt", "lumivox fmt scenes/cornell.scene"},
      {"describe", "lumivox describe material"},
      {"list", "lumivox list scenes"},
      {"render",
       "lumivox render scenes/cornell.scene scenes/pipelines/direct_lighting.pipeline -o out/image.exr"},
      {"reference", "lumivox reference scenes/cornell.scene --spp 64 -o out/reference.exr"},
      {"compare", "lumivox compare out/image.exr out/reference.exr"},
      {"cache list", "lumivox cache list"},
      {"report",
       "lumivox report scenes/cornell.scene --pipeline scenes/pipelines/direct_lighting.pipeline -o out/report"},
      {"sweep",
       "lumivox sweep scenes/cornell.scene --pipeline scenes/pipelines/direct_lighting.pipeline --store "
       "out/results.sqlite"},
      {"results list", "lumivox results list --store out/results.sqlite"},
      {"results export", "lumivox results export --store out/results.sqlite -o out/results.csv"},
      {"results front", "lumivox results front --store out/results.sqlite"},
      {"results equal-time", "lumivox results equal-time --frame-time 16ms --store out/results.sqlite"},
      {"results equal-error", "lumivox results equal-error --error 0.1 --store out/results.sqlite"},
      {"results merge", "lumivox results merge out/results.sqlite --store out/all.sqlite"},
      {"results import", "lumivox results import out/earlier.sqlite --store out/all.sqlite"},
      {"compare-runs", "lumivox compare-runs out/results.sqlite out/all.sqlite"},
      {"results remove", "lumivox results remove --run 1 --store out/all.sqlite"},
      {"tune",
       "lumivox tune scenes/cornell.scene --frame-time 10s --pipeline scenes/pipelines/direct_lighting.pipeline"},
      {"reproduce", "lumivox reproduce 004-figure-18"},
      {"stress", "lumivox stress --quick"},
      {"voxels",
       "lumivox voxels scenes/cornell.scene --pipeline scenes/pipelines/voxelizers/atlas_binary.pipeline "
       "--resolution 64,128,256"},
      {"explain",
       "lumivox explain scenes/cornell.scene scenes/pipelines/direct_lighting.pipeline --no-times"},
      {"shaders", "lumivox shaders scenes/cornell.scene scenes/pipelines/direct_lighting.pipeline"},
      // All peak rates take most of a minute.
      {"device", "lumivox device --only float_operations --repeats 1 --store out/results.sqlite"},
      {"new technique", "lumivox new technique my_paper --in out/my_lab"},
      {"view", "lumivox view scenes/cornell.scene --script quit.view"},
      {"cache prune", "lumivox cache prune"},
      {"vdbexport",
       "vdbexport scenes/cornell.scene scenes/pipelines/voxelizers/atlas_binary.pipeline --all -o out/grids.vdb"},
  };
  return all;
}

/// The commands of a help text, each with those below it: "results list".
std::set<std::string> commandsOfHelp(const std::string& above = {}) {
  const std::string help = runCommand("lumivox help " + above).output;
  const std::size_t from = help.find("Subcommands:\n");
  if (from == std::string::npos) return {above};
  std::set<std::string> all;
  std::istringstream text(help.substr(from, help.find("\n\n", from) - from));
  static const std::regex entry("^  ([a-z][a-z-]*)( .*)?$");
  std::smatch match;
  for (std::string line; std::getline(text, line);)
    if (std::regex_match(line, match, entry))
      all.merge(commandsOfHelp(above.empty() ? match[1].str() : above + " " + match[1].str()));
  return all;
}

/// What the README's section on commands names in `code`, up to the first word that stands for something.
std::set<std::string> commandsOfReadme(const std::string& readme) {
  const std::size_t from = readme.find("## The commands\n"), to = readme.find("\n## ", from);
  REQUIRE(from != std::string::npos);
  std::set<std::string> all;
  static const std::regex item("(?:^|\n)(?:- ([^:]*):|(`\\./run [^`]*`))"), code("`(?:\\./run )?([^`]*)`"),
      words("^[a-z][a-z-]*(?: [a-z][a-z-]*(?= |$))?");
  const std::string section = readme.substr(from, to - from);
  for (std::sregex_iterator one(section.begin(), section.end(), item), end; one != end; ++one) {
    const std::string heads = one->str();
    for (std::sregex_iterator named(heads.begin(), heads.end(), code); named != end; ++named) {
      const std::string typed = (*named)[1];
      std::smatch match;
      INFO(typed);
      REQUIRE(std::regex_search(typed, match, words));
      all.insert(match.str());
    }
  }
  return all;
}

}  // namespace

TEST_CASE("the README's list of commands is read as it stands") {
  CHECK(commandsOfReadme(
            "## The commands\n\n- `render SCENE -o out.exr`: `no` command\n- `check`, `new thing NAME`,\n"
            "  `compare A.exr`: x\n\n`./run vdbexport A` writes `this`.\n\n## Next\n- `other`: y\n") ==
        std::set<std::string>{"check", "compare", "new thing", "render", "vdbexport"});
}

TEST_CASE("every command that the README and help name is started as a user types it, and ends well") {
  const std::set<std::string> ofHelp = commandsOfHelp(),
                              ofReadme = commandsOfReadme(readFile(sourceDirectory() / "README.md"));
  CHECK(ofHelp.size() >= 28);
  CHECK(ofReadme.size() >= 20);
  std::set<std::string> started;
  for (const Line& line : lines()) started.insert(line.command);
  for (const std::string& command : ofHelp) {
    INFO("lumivox help names it: " << command);
    CHECK(started.count(command) == 1);
  }
  for (const std::string& command : ofReadme) {
    INFO("the README names it: " << command);
    // Of commands with others below them, those.
    CHECK(std::any_of(started.begin(), started.end(), [&](const std::string& one) {
      return one == command || one.rfind(command + " ", 0) == 0;
    }));
  }
  for (const std::string& command : ofHelp) {
    INFO("the README does not name it: " << command);
    const auto word = [](const std::string& words) { return words.substr(0, words.find(' ')); };
    CHECK(std::any_of(ofReadme.begin(), ofReadme.end(),
                      [&](const std::string& one) { return word(one) == word(command); }));
  }
  for (const std::string& command : started) {
    INFO("neither names it: " << command);
    CHECK((ofHelp.count(command) == 1 || ofReadme.count(command) == 1));
  }

  const Workplace place;
  const fs::path folder = place.path() / "tree";
  fs::create_directories(folder / "docs");
  for (const char* part : {"scenes", "docs/examples"})
    fs::copy(sourceDirectory() / part, folder / part, fs::copy_options::recursive);
  place.write("tree/quit.view", "view \"quit\" {\n  wait frame\n  shot \"out/window.png\"\n  quit on\n}\n");
  writeEarlierStore(folder / "out/earlier.sqlite", 8);
  const bool window = display().there();
  for (const Line& line : lines()) {
    if (line.command == "view" && !window) continue;
    const std::string typed = reduced(line.typed);
    const CommandResult result = runCommand(
        "cd '" + folder.string() + "' && export PATH='" + (binaryDirectory() / "bin").string() +
        "':\"$PATH\" HOME='" + place.file("home") + "' && unset LUMIVOX_ASSETS LUMIVOX_RESULTS && " + typed);
    INFO(typed << "\n" << result.output << result.errors);
    CHECK(result.exitCode == 0);
  }
  for (const char* written : {"image.exr", "reference.exr", "report/index.html", "results.csv", "all.sqlite",
                              "my_lab", "grids.vdb"}) {
    INFO(written);
    CHECK(fs::exists(folder / "out" / written));
  }
  CHECK(readFile(folder / "scenes/cornell.scene") == readFile(sourceDirectory() / "scenes/cornell.scene"));
  if (!window) return skip("Xvfb is not installed: all but the window was started");
  CHECK(fs::exists(folder / "out/window.png"));
}
