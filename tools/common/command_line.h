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

/// 0: done, and every check passed. 1: done, and a check failed: a text that fmt --check would change, health
/// findings, a failed point, an error above --rmse-at-most, grids that differ. 2: bad input or something
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

/// A word in single quotes for a shell; a single quote within becomes '\''.
std::string inSingleQuotes(const std::string& argument);
/// This command line as a shell would read it, with the program's plain name in front.
std::string asTyped(const std::string& program, int count, char** arguments);

/// Help of a command or of the program itself, with the options of every command, wrapped to the width of the
/// terminal.
std::string helpOf(const CLI::App& command);
/// The command that these words name, such as "results list". Error, with the nearest one, if there is none.
const CLI::App& commandNamed(const CLI::App& app, const std::vector<std::string>& words);

/// Reads the options and sets the level of messages. Returns the exit code if nothing is left to do: kGood
/// after help or the version, kBadInput for wrong options. The message for an unknown command or option names
/// the nearest.
std::optional<int> parseOptions(CLI::App& app, const GlobalOptions& global, int count, char** arguments);

/// The exit code of `work`. An exception becomes a message on standard error and kBadInput.
int guarded(const std::string& program, const std::function<int()>& work);

/// An option that takes one value each time it is given, so that it never takes a positional behind it.
CLI::Option* addRepeatable(CLI::App& app, const std::string& names, std::vector<std::string>& values,
                           const std::string& text);
CLI::Option* addRepeatable(CLI::App& app, const std::string& names,
                           std::vector<std::filesystem::path>& values, const std::string& text);

/// Seconds of a time above 0 as the texts write it: "300ms", "0.5 s", "2min". Error, with the option's name
/// and the units, for anything else, and for a number without a unit.
double secondsOf(const std::string& option, const std::string& text);
/// Options of one value with a unit. `addDuration`: above 0, in seconds; the unit is required. `addTime`: a
/// point in time, in seconds. `addLength`: at least 0, in metres. As in the texts, a number without a unit
/// counts as seconds or metres in the latter two.
CLI::Option* addDuration(CLI::App& app, const std::string& names, double& seconds, const std::string& text);
CLI::Option* addTime(CLI::App& app, double& seconds);
CLI::Option* addLength(CLI::App& app, const std::string& names, double& metres, const std::string& text);
/// --seed: a whole number from 0.
CLI::Option* addSeed(CLI::App& app, std::uint64_t& seed,
                     const std::string& text = "of the random numbers of techniques");

/// Accepts finite numbers from `low` to `high` without a unit. Use it instead of CLI::Range, which accepts
/// "nan".
CLI::Validator numberBetween(double low, double high);
/// --fps, in frames per second. The range is wider than that of a deforming mesh in a text.
CLI::Option* addFrameRate(CLI::App& app, double& framesPerSecond);

/// "640x360"; Error that names the option otherwise.
std::pair<int, int> parseResolution(const std::string& text, const std::string& option = "--resolution");

/// First and last frame of an animation, inclusive, from "3..9" or "3" with at most seven digits each. Error,
/// naming `option`, for anything else.
std::pair<int, int> parseFrames(const std::string& option, const std::string& text);

/// The file of a frame: its number replaces a run of # in the name; without one it goes before the extension
/// as _0007.
std::filesystem::path numberedName(const std::filesystem::path& output, int frame);

/// Provenance of a result: version, command, scene and pipeline with their hashes, parameters, seed, time,
/// device and driver.
std::map<std::string, std::string> provenance(const GlobalOptions& global, const Scene& scene,
                                              const Pipeline& pipeline, const RenderOptions& options,
                                              const gpu::Device& device, double time);

void printJson(const Json& json);
void print(const std::string& text);  ///< to stdout; Error if that fails (a full disk, a closed pipe)
std::string threeDigits(double value);

}  // namespace lumivox::command
