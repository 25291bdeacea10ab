#include "viewer/tool_worker.h"

#include <fmt/format.h>

#include "viewer/program.h"

namespace lumivox::viewer {

ToolWorker::Work makeToolWork() {
  return [](const ToolWish& wish, ToolWorker::Turn& turn) {
    ToolResult result{wish.done, false};
    try {
      const ProgramResult done = runProgram(wish.words, &turn.outdated());
      if (done.exitCode != 0)
        result = {done.errors.empty() ? fmt::format("{} ended with {}", wish.words.front(), done.exitCode)
                                      : done.errors,
                  true};
    } catch (const std::exception& error) {
      result = {error.what(), true};
    }
    std::error_code ignored;
    for (const std::filesystem::path& file : wish.temporary) std::filesystem::remove(file, ignored);
    turn.give(std::move(result));
  };
}

}  // namespace lumivox::viewer
