// view: starts the window, which is a program of its own, so that this one needs neither a display nor its
// libraries.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "command.h"
#include "lumivox/base/error.h"
#include "lumivox/base/installation.h"

namespace lumivox::command {
namespace {

constexpr const char* kProgram = "lumivox-view";

int view(const std::vector<std::string>& words) {
  const auto here = programFile();
  const std::filesystem::path program =
      here ? here->parent_path() / kProgram : std::filesystem::path(kProgram);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(program, ignored))
    throw AbsentError(fmt::format(
        "{} is not there: this Lumivox was built without its window (`lumivox render` makes images without one)",
        program.string()));
  std::vector<std::string> copies{program.string()};
  copies.insert(copies.end(), words.begin(), words.end());
  std::vector<char*> pointers;
  for (std::string& word : copies) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  execv(program.c_str(), pointers.data());
  throw Error(fmt::format("{}: cannot be started, {}", program.string(), std::strerror(errno)));
}

}  // namespace

void addViewCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand(
      "view", "shows a scene in a window: techniques are looked at, judged and changed while they run");
  command->prefix_command();
  command->footer("Its options: lumivox-view --help");
  // Options of every command may stand before its name; the window's program knows them too.
  std::vector<std::string>& words = commands.words;
  commands.onChosen(command, [&words] {
    std::vector<std::string> given = words;
    given.erase(std::find(given.begin(), given.end(), "view"));
    return view(given);
  });
}

}  // namespace lumivox::command
