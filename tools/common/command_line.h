// Common parts of the programs' command lines: options, exit codes, numbered files and the provenance of a
// result.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/table.h"
#include "lumivox/gpu/device.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/plugin/loader.h"
#include "lumivox/scene/scene.h"

namespace lumivox::command {

using Json = nlohmann::ordered_json;

/// 0: done and good. 1: done, and what it checks is not good (a text that fmt --check would change, health
/// findings, a failed point, an error above --rmse-at-most, grids that differ). 2: bad input or something
/// absent; nothing was written.
enum ExitCode { kGood = 0, kNotGood = 1, kBadInput = 2 };

/// Options that every command knows.
struct GlobalOptions {
  std::vector<std::filesystem::path> assets, techniques;
  std::string device = "auto", shaders = "auto", arithmetic = "exact";
  std::uint64_t memory = 0;  ///< bytes; 0: what the device has
  bool debugContext = false, strict = false, quiet = false, verbose = false;
  std::string commandLine;  ///< as typed

  void addTo(CLI::App& app);
  SceneLoadOptions sceneLoad() const;
  Scene loadScene(const std::filesystem::path& file) const;  ///< refuses warnings under --strict
  gpu::DeviceOptions deviceOptions() const;
  std::unique_ptr<gpu::Device> openDevice() const;
  TechniqueSet techniqueSet() const;
};

/// Options of every command that runs a pipeline.
struct RunOptions {
  std::vector<std::string> settings;
  std::string camera, resolution;
  double time = 0.0;
  std::uint64_t seed = 1;

  void addTo(CLI::App& app);
  std::pair<int, int> size() const;  ///< {0, 0} when not given
  RenderOptions renderOptions(const Pipeline& pipeline) const;
};

/// A word for a shell, in single quotes. A quote within ends them, stands behind a backslash, and begins them
/// again.
std::string inSingleQuotes(const std::string& argument);
/// This command line as a shell would read it, with the program's plain name in front.
std::string asTyped(const std::string& program, int count, char** arguments);

/// Help of a command, or of the program itself: with the options of every command, as wide as the terminal.
std::string helpOf(const CLI::App& command);
/// The command that these words name, such as "results list"; Error with the nearest one otherwise.
const CLI::App& commandNamed(const CLI::App& app, const std::vector<std::string>& words);

/// Reads the options and sets the level of messages. A word that is no command or option is named with the
/// nearest. The exit code when nothing is left to do: help and the version are good, everything else is bad
/// input.
std::optional<int> parseOptions(CLI::App& app, const GlobalOptions& global, int count, char** arguments);

/// The exit code of `work`; what it throws becomes a message on standard error and kBadInput.
int guarded(const std::string& program, const std::function<int()>& work);

/// An option that takes one value each time it is given, so that it never swallows what follows.
CLI::Option* addRepeatable(CLI::App& app, const std::string& names, std::vector<std::string>& values,
                           const std::string& text);
CLI::Option* addRepeatable(CLI::App& app, const std::string& names,
                           std::vector<std::filesystem::path>& values, const std::string& text);

/// Seconds of a time as the texts write it: "300ms", "0.5 s", "2min", above 0; Error, with the option's name
/// and the units, otherwise and for a number without a unit.
double secondsOf(const std::string& option, const std::string& text);
/// Options of one value with a unit. `addDuration`: above 0, in seconds; the unit is required. `addTime`: a
/// moment in seconds, and `addLength`: at least 0 metres; as in the texts a number without a unit is one of
/// these.
CLI::Option* addDuration(CLI::App& app, const std::string& names, double& seconds, const std::string& text);
CLI::Option* addTime(CLI::App& app, double& seconds);
CLI::Option* addLength(CLI::App& app, const std::string& names, double& metres, const std::string& text);
/// --seed: a whole number from 0.
CLI::Option* addSeed(CLI::App& app, std::uint64_t& seed,
                     const std::string& text = "of the random numbers of techniques");

/// Of options that take a number, or several: a finite one within these ends, without a unit. The only check
/// of such options: CLI::Range lets "nan" through.
CLI::Validator numberBetween(double low, double high);
/// --fps: within what a text may give a deforming mesh, and more.
CLI::Option* addFrameRate(CLI::App& app, double& framesPerSecond);

/// "640x360"; Error that names the option otherwise.
std::pair<int, int> parseResolution(const std::string& text, const std::string& option = "--resolution");

/// Frames of an animation: "3..9" or "3"; both ends belong to it, and have at most seven digits. `option` is
/// named in the Error otherwise.
std::pair<int, int> parseFrames(const std::string& option, const std::string& text);

/// The numbered name of a frame: a run of # in the file's name is the number, else it goes before the
/// extension as _0007.
std::filesystem::path numberedName(const std::filesystem::path& output, int frame);

/// Where a result comes from: version, command, scene and pipeline with their hashes, parameters, seed, time,
/// device and driver.
std::map<std::string, std::string> provenance(const GlobalOptions& global, const Scene& scene,
                                              const Pipeline& pipeline, const RenderOptions& options,
                                              const gpu::Device& device, double time);

void printJson(const Json& json);
void print(const std::string& text);  ///< to stdout; Error when that fails (a full disk, a closed pipe)
std::string threeDigits(double value);

}  // namespace lumivox::command
