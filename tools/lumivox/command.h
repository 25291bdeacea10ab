// What the commands of the command line share. One file per group of commands; each adds its subcommands to
// the application.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/gpu/device.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/plugin/loader.h"
#include "lumivox/scene/scene.h"

namespace lumivox::command {

using Json = nlohmann::ordered_json;

/// 0: done and good. 1: done, and what it checks is not good (a text that fmt --check would change, health
/// findings, a failed point, an error above --rmse-at-most). 2: bad input or something absent; nothing was
/// written.
enum ExitCode { kGood = 0, kNotGood = 1, kBadInput = 2 };

/// Options that every command knows.
struct GlobalOptions {
  std::vector<std::filesystem::path> assets, techniques;
  std::string device = "auto", shaders = "auto";
  bool strict = false, quiet = false, verbose = false;
  std::string commandLine;  ///< as typed

  SceneLoadOptions sceneLoad() const;
  Scene loadScene(const std::filesystem::path& file) const;  ///< refuses warnings under --strict
  std::unique_ptr<gpu::Device> openDevice() const;
  TechniqueSet techniqueSet() const;
};

/// What every command that runs a pipeline knows.
struct RunOptions {
  std::vector<std::string> settings;
  std::string camera, resolution;
  double time = 0.0;
  std::uint64_t seed = 1;

  void addTo(CLI::App& app);
  std::pair<int, int> size() const;  ///< {0, 0} when not given
  RenderOptions renderOptions(const Pipeline& pipeline) const;
};

/// A subcommand's work, called after all options were read.
using Work = std::function<int()>;
struct Commands {
  CLI::App& app;
  const GlobalOptions& global;
  /// Runs `work` when the subcommand was chosen.
  void onChosen(CLI::App* subcommand, Work work);
  Work chosen;
};

void addTextCommands(Commands& commands);      // check, fmt, describe
void addListCommand(Commands& commands);       // list
void addRenderCommand(Commands& commands);     // render
void addReferenceCommand(Commands& commands);  // reference
void addCompareCommand(Commands& commands);    // compare
void addReportCommand(Commands& commands);     // report
void addExplainCommand(Commands& commands);    // explain
void addShadersCommand(Commands& commands);    // shaders

/// An option that takes one value each time it is given, so that it never swallows what follows.
CLI::Option* addRepeatable(CLI::App& app, const std::string& names, std::vector<std::string>& values,
                           const std::string& text);
CLI::Option* addRepeatable(CLI::App& app, const std::string& names,
                           std::vector<std::filesystem::path>& values, const std::string& text);

/// "640x360"; Error otherwise.
std::pair<int, int> parseResolution(const std::string& text);

/// Lays rows out in columns; the first row is the head. Columns of numbers align to the right.
std::string textTable(const std::vector<std::vector<std::string>>& rows);
void printJson(const Json& json);
void print(const std::string& text);  ///< to stdout; Error when that fails (a full disk, a closed pipe)
std::string threeDigits(double value);

enum class TextKind { scene, pipeline };
/// By the extension, else by the first block; Error when it is neither.
TextKind kindOfText(const std::filesystem::path& file);

}  // namespace lumivox::command
