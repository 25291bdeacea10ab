// view: starts the window. It is a program of its own, so that this one needs neither a display nor its
// libraries.
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "command.h"
#include "lumivox/base/error.h"
#include "lumivox/base/installation.h"
#include "viewer/options.h"

namespace lumivox::command {
namespace {

constexpr const char* kProgram = "lumivox-view";

/// Replaces this process by the window's program, with these words.
int view(std::vector<std::string> words) {
  const auto here = programFile();
  const std::filesystem::path program =
      here ? here->parent_path() / kProgram : std::filesystem::path(kProgram);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(program, ignored))
    throw AbsentError(fmt::format(
        "{} is not there: this Lumivox was built without its window (`./run view` builds it; `lumivox render` makes "
        "images without one)",
        program.string()));
  words.insert(words.begin(), program.string());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  execv(program.c_str(), pointers.data());
  throw Error(fmt::format("{}: cannot be started, {}", program.string(), std::strerror(errno)));
}

}  // namespace

void addViewCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand("view", viewer::kViewMeaning);
  // Parsed here as well as in the window's program, so that a wrong word gives the same message as in other
  // commands.
  auto options = std::make_shared<viewer::ViewOptions>();
  options->addTo(*command);
  // Global options may stand before `view`; the window's program takes them too. Only the word `view` is
  // removed. Its position follows from the number of words behind it, since an option's value before it may
  // also be `view`.
  auto behind = std::make_shared<std::size_t>(0);
  command->preparse_callback([behind](std::size_t left) { *behind = left; });
  const std::vector<std::string>& words = commands.words;
  commands.onChosen(command, [options, behind, &words] {
    std::vector<std::string> given = words;
    given.erase(given.end() - static_cast<std::ptrdiff_t>(*behind) - 1);
    return view(std::move(given));
  });
}

}  // namespace lumivox::command
