// Common parts of the commands. One file per group of commands; each adds its subcommands to the application.
#pragma once

#include <filesystem>
#include <functional>

#include "common/command_line.h"

namespace lumivox::command {

/// A subcommand's work, called after all options were parsed.
using Work = std::function<int()>;
struct Commands {
  CLI::App& app;
  const GlobalOptions& global;
  /// Runs `work` when the subcommand was chosen.
  void onChosen(CLI::App* subcommand, Work work);
  Work chosen;
  std::vector<std::string> words{};          ///< the command line without the program's name, up to --slurm
  std::vector<std::string> sbatchOptions{};  ///< what stands behind --slurm
};

void addTextCommands(Commands& commands);      // check, fmt
void addDescribeCommand(Commands& commands);   // describe
void addListCommand(Commands& commands);       // list
void addImportCommand(Commands& commands);     // import
void addRenderCommand(Commands& commands);     // render
void addReferenceCommand(Commands& commands);  // reference
void addCaptureCommand(Commands& commands);    // capture
void addCacheCommand(Commands& commands);      // cache
void addCompareCommand(Commands& commands);    // compare
void addReportCommand(Commands& commands);     // report
void addSweepCommand(Commands& commands);      // sweep
void addReproduceCommand(Commands& commands);  // reproduce
void addTuneCommand(Commands& commands);       // tune
void addStressCommand(Commands& commands);     // stress
void addResultsCommands(Commands& commands);   // results, compare-runs
void addVoxelsCommand(Commands& commands);     // voxels
void addExplainCommand(Commands& commands);    // explain
void addDeviceCommand(Commands& commands);     // device
void addShadersCommand(Commands& commands);    // shaders
void addNewCommand(Commands& commands);        // new
void addViewCommand(Commands& commands);       // view

void addHelpCommand(Commands& commands);  // help

enum class TextKind { scene, pipeline, sweep, reproduction, view };
/// The kind by the file's extension, else by its blocks. Error if neither tells.
TextKind kindOfText(const std::filesystem::path& file);

/// "cornell" for scenes/cornell.scene: the name of a text in tables.
std::string stem(const std::string& file);

}  // namespace lumivox::command
