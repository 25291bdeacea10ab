// Every command that `lumivox help` names is in the README, and run by a guide as a user types it.
#include <algorithm>
#include <regex>
#include <set>
#include <sstream>

#include "lumivox/base/file.h"
#include "tools/cli_support.h"
#include "tools/guide.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

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

TEST_CASE("every command that help names is in the README, and a guide runs it as a user types it") {
  std::set<std::string> all = commandsOfHelp(), started;
  CHECK(all.size() >= 28);
  all.insert("vdbexport");
  const std::set<std::string> ofReadme = commandsOfReadme(readFile(sourceDirectory() / "README.md"));
  CHECK(ofReadme.size() >= 20);
  const auto begins = [](const std::string& text, const std::string& with) {
    return text == with || text.rfind(with + " ", 0) == 0;
  };
  for (const std::string& command : ofReadme) {
    INFO("the README names it: " << command);
    // Of commands with others below them, those.
    CHECK(std::any_of(all.begin(), all.end(), [&](const std::string& one) { return begins(one, command); }));
  }
  static const std::regex program("^(?:\\./run|lumivox) ");
  for (const std::filesystem::path& guide : guides())
    for (const Step& step : stepsOf(readFile(guide))) {
      const bool neverRun = std::any_of(omissions().begin(), omissions().end(), [&](const Omission& one) {
        return std::regex_search(step.command, std::regex(one.pattern));
      });
      const std::string typed = std::regex_replace(step.command, program, "");
      for (const std::string& command : all)
        if (!neverRun && (typed != step.command || command == "vdbexport") && begins(typed, command))
          started.insert(command);
    }
  // A window, and a store of an earlier version: viewer_start_test and cli_sweep_test.
  started.merge(std::set<std::string>{"view", "results import"});
  for (const std::string& command : all) {
    INFO(command);
    CHECK(started.count(command) == 1);
    const auto word = [](const std::string& words) { return words.substr(0, words.find(' ')); };
    CHECK(std::any_of(ofReadme.begin(), ofReadme.end(),
                      [&](const std::string& one) { return word(one) == word(command); }));
  }
}
