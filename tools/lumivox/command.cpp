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

void addHelpCommand(Commands& commands) {
  auto* command =
      commands.app.add_subcommand("help", "prints what a command takes, as --help does behind it");
  auto words = std::make_shared<std::vector<std::string>>();
  command->add_option("COMMAND", *words, "a command, such as render or results list (default: all commands)");
  const CLI::App& app = commands.app;
  commands.onChosen(command, [words, &app] {
    print(helpOf(commandNamed(app, *words)));
    return kGood;
  });
}

TextKind kindOfText(const std::filesystem::path& file) {
  if (file.extension() == ".scene") return TextKind::scene;
  if (file.extension() == ".pipeline") return TextKind::pipeline;
  if (file.extension() == ".sweep") return TextKind::sweep;
  if (file.extension() == ".reproduction") return TextKind::reproduction;
  if (file.extension() == ".view") return TextKind::view;
  const dsl::Document document = dsl::parse(readFile(file), file);
  // The order matters: a text of a pipeline may contain sweep blocks too.
  static const std::pair<const char*, TextKind> kBlocks[] = {{"scene", TextKind::scene},
                                                             {"pipeline", TextKind::pipeline},
                                                             {"sweep", TextKind::sweep},
                                                             {"reproduction", TextKind::reproduction},
                                                             {"view", TextKind::view}};
  for (const auto& [word, kind] : kBlocks)
    for (const dsl::Item& item : document.items)
      if (item.block && item.block->word == word) return kind;
  throw Error(fmt::format(
      "{}: not a text of Lumivox; expected a block 'scene', 'pipeline', 'sweep', 'reproduction' or 'view'",
      file.string()));
}

std::string stem(const std::string& file) {
  return std::filesystem::path(file).stem().string();
}

}  // namespace lumivox::command
