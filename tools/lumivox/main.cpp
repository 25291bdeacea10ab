// lumivox: the command line of the laboratory.
#include <algorithm>

#include "command.h"
#include "common/manual.h"
#include "lumivox/plugin/technique.h"

namespace {

using namespace lumivox;
using namespace lumivox::command;

/// Printed when the program is started without a command.
constexpr const char* kFirstSteps =
    "lumivox: expected a command. To begin with:\n"
    "  lumivox list scenes\n"
    "  lumivox render cornell voxel_cone_tracing -o out.png\n"
    "  lumivox report cornell --budget 60s\n"
    "`lumivox help` lists all commands, `lumivox help COMMAND` what one takes.\n";

int run(int count, char** arguments) {
  requireLibraryOf(techniqueVersionHere());
  CLI::App app{
      "A laboratory for real-time global illumination: a scene and a pipeline in; images, their error and "
      "their time out."};
  app.name("lumivox");
  app.set_version_flag("--version", std::string("lumivox ") + LUMIVOX_VERSION);
  app.require_subcommand(1);
  app.option_defaults()->always_capture_default(false);

  if (count == 1) {
    std::cerr << kFirstSteps;
    return kBadInput;
  }
  GlobalOptions global;
  global.commandLine = asTyped("lumivox", count, arguments);
  global.addTo(app);
  Commands commands{app, global, {}};
  // What stands behind --slurm is for sbatch.
  const int typed =
      static_cast<int>(std::find(arguments + 1, arguments + count, std::string("--slurm")) - arguments);
  const int own = std::min(count, typed + 1);
  commands.words.assign(arguments + 1, arguments + own);
  commands.sbatchOptions.assign(arguments + own, arguments + count);
  addTextCommands(commands);
  addDescribeCommand(commands);
  addListCommand(commands);
  addImportCommand(commands);
  addRenderCommand(commands);
  addReferenceCommand(commands);
  addCaptureCommand(commands);
  addCacheCommand(commands);
  addCompareCommand(commands);
  addReportCommand(commands);
  addSweepCommand(commands);
  addReproduceCommand(commands);
  addTuneCommand(commands);
  addStressCommand(commands);
  addResultsCommands(commands);
  addVoxelsCommand(commands);
  addExplainCommand(commands);
  addDeviceCommand(commands);
  addShadersCommand(commands);
  addNewCommand(commands);
  addViewCommand(commands);
  addHelpCommand(commands);
  addDescriptionOptions(app, LUMIVOX_VERSION);

  if (const auto done = parseOptions(app, global, own, arguments)) return *done;
  return commands.chosen();
}

}  // namespace

int main(int count, char** arguments) {
  return lumivox::command::guarded("lumivox", [=] { return run(count, arguments); });
}
