#include "command.h"

#include <fmt/format.h>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/dsl/document.h"

namespace lumivox::command {

void Commands::onChosen(CLI::App* subcommand, Work work) {
  subcommand->fallthrough();
  subcommand->callback([this, work = std::move(work)] { chosen = work; });
}

TextKind kindOfText(const std::filesystem::path& file) {
  if (file.extension() == ".scene") return TextKind::scene;
  if (file.extension() == ".pipeline") return TextKind::pipeline;
  constexpr std::uint64_t kLongestText = std::uint64_t{64} << 20;
  const dsl::Document document = dsl::parse(readFile(file, kLongestText), file);
  for (const dsl::Item& item : document.items) {
    if (item.block && item.block->word == "scene") return TextKind::scene;
    if (item.block && (item.block->word == "pipeline" || item.block->word == "sweep"))
      return TextKind::pipeline;
  }
  throw Error(fmt::format("{}: neither a scene nor a pipeline; expected a block 'scene' or 'pipeline'",
                          file.string()));
}

}  // namespace lumivox::command
