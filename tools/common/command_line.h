// Common parts of the programs' command lines: options, exit codes, tables, numbered files and the provenance
// of a result.
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

#include "lumivox/base/display.h"
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

/// How images are displayed, in every command that makes one or takes a measure that depends on it.
struct DisplayOptions {
  std::string exposure = "auto", tone = "srgb";

  void addTo(CLI::App& app);
  void addExposureTo(CLI::App& app);  ///< alone: of commands that only measure
  void addToneTo(CLI::App& app);
  std::optional<double> given() const;  ///< EV; nothing for auto. Error otherwise
  Tone toneCurve() const { return toneNamed(tone); }
};

/// Of an EXR file: EV at which its scene is displayed.
inline constexpr const char* kExposureAttribute = "lumivox.exposure_ev";

/// This command line as a shell would read it, with the program's plain name in front.
std::string asTyped(const std::string& program, int count, char** arguments);

/// Reads the options and sets the level of messages. The exit code when nothing is left to do: help and the
/// version are good, everything else is bad input.
std::optional<int> parseOptions(CLI::App& app, const GlobalOptions& global, int count, char** arguments);

/// The exit code of `work`; what it throws becomes a message on standard error and kBadInput.
int guarded(const std::string& program, const std::function<int()>& work);

/// An option that takes one value each time it is given, so that it never swallows what follows.
CLI::Option* addRepeatable(CLI::App& app, const std::string& names, std::vector<std::string>& values,
                           const std::string& text);
CLI::Option* addRepeatable(CLI::App& app, const std::string& names,
                           std::vector<std::filesystem::path>& values, const std::string& text);

/// "640x360"; Error otherwise.
std::pair<int, int> parseResolution(const std::string& text);

/// Refuses (Error that names the option) a name that does not end in .png.
void requirePng(const std::string& option, const std::filesystem::path& file);

/// Frames of an animation: "3..9" or "3"; both ends belong to it. `option` is named in the Error otherwise.
std::pair<int, int> parseFrames(const std::string& option, const std::string& text);

/// The numbered name of a frame: a run of # in the file's name is the number, else it goes before the
/// extension as _0007.
std::filesystem::path numberedName(const std::filesystem::path& output, int frame);

/// Where a result comes from: version, command, scene and pipeline with their hashes, parameters, seed, time,
/// device and driver.
std::map<std::string, std::string> provenance(const GlobalOptions& global, const Scene& scene,
                                              const Pipeline& pipeline, const RenderOptions& options,
                                              const gpu::Device& device, double time);

/// Lays rows out in columns; the first row is the head. Columns of numbers align to the right.
std::string textTable(const std::vector<std::vector<std::string>>& rows);
void printJson(const Json& json);
void print(const std::string& text);  ///< to stdout; Error when that fails (a full disk, a closed pipe)
std::string threeDigits(double value);

}  // namespace lumivox::command
