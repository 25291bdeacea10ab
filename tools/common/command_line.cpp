#include "common/command_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>

#include "lumivox/base/error.h"
#include "lumivox/base/log.h"

namespace lumivox::command {

void GlobalOptions::addTo(CLI::App& app) {
  addRepeatable(
      app, "--assets", assets,
      "a folder to search for models; then $LUMIVOX_ASSETS, then ../shared/models beside the project; "
      "may be repeated")
      ->check(CLI::ExistingDirectory);
  addRepeatable(app, "--techniques", techniques,
                "a folder to search for technique libraries; may be repeated");
  app.add_option("--device", device, "auto, software, surfaceless, or the number of an EGL device");
  app.add_option("--shaders", shaders, "how programs reach the driver: spirv, glsl or auto")
      ->check(CLI::IsMember({"auto", "spirv", "glsl"}));
  app.add_option(
         "--arithmetic", arithmetic,
         "exact: the same bits on every driver; fast: sums and products fused and reordered at the driver's choice, "
         "as in a released renderer, for timing")
      ->check(CLI::IsMember({"exact", "fast"}));
  app.add_flag("--debug-context", debugContext,
               "the driver explains each error at the command that made it; slower (default: whether "
               "$LUMIVOX_DEBUG_CONTEXT is set)");
  app.add_option("--memory", memory,
                 "limit on the memory of all textures and buffers, such as 4GiB, as on a smaller device "
                 "(default: what the device has)")
      ->transform(CLI::AsSizeValue(false));
  app.add_flag("--strict", strict, "refuse what would otherwise be dropped with a warning");
  auto* quietFlag = app.add_flag("-q,--quiet", quiet, "no progress and no messages except errors");
  app.add_flag("-v,--verbose", verbose, "more messages")->excludes(quietFlag);
}

SceneLoadOptions GlobalOptions::sceneLoad() const {
  SceneLoadOptions options;
  options.assetPath = assets;
  options.strict = strict;
  return options;
}

Scene GlobalOptions::loadScene(const std::filesystem::path& file) const {
  const std::uint64_t before = warningCount();
  Scene scene = lumivox::loadScene(file, sceneLoad());
  if (strict && warningCount() != before)
    throw Error(file.string() + ": there were warnings, and --strict refuses them");
  return scene;
}

gpu::DeviceOptions GlobalOptions::deviceOptions() const {
  gpu::DeviceOptions options;
  options.device = device;
  options.shaderInput = shaders == "spirv"  ? gpu::ShaderInput::spirv
                        : shaders == "glsl" ? gpu::ShaderInput::glsl
                                            : gpu::ShaderInput::automatic;
  options.memoryBytes = memory;
  if (arithmetic == "fast") options.arithmetic = gpu::Arithmetic::fast;
  if (debugContext) options.debugContext = true;
  return options;
}

std::unique_ptr<gpu::Device> GlobalOptions::openDevice() const {
  auto opened = std::make_unique<gpu::Device>(deviceOptions());
  const gpu::DeviceInfo& info = opened->info();
  logInformation("device: {} ({}){}", info.renderer, info.platform,
                 info.software ? ", a software rasteriser" : "");
  return opened;
}

TechniqueSet GlobalOptions::techniqueSet() const {
  return TechniqueSet(TechniqueSet::defaultDirectories(techniques));
}

void RunOptions::addTo(CLI::App& app) {
  addRepeatable(app, "--set", settings, "a parameter of the pipeline, as name=value");
  app.add_option("--camera", camera, "the scene's camera of this name (default: the first)");
  app.add_option("--resolution", resolution,
                 "width and height in pixels, such as 640x360 (default: the camera's)");
  app.add_option("--time", time, "seconds");
  app.add_option("--seed", seed, "of the random numbers of techniques");
}

std::pair<int, int> RunOptions::size() const {
  return resolution.empty() ? std::pair(0, 0) : parseResolution(resolution);
}

RenderOptions RunOptions::renderOptions(const Pipeline& pipeline) const {
  RenderOptions options;
  options.parameters = pipeline.settings(settings);
  options.seed = seed;
  options.camera = camera;
  std::tie(options.width, options.height) = size();
  return options;
}

void DisplayOptions::addExposureTo(CLI::App& app) {
  app.add_option(
      "--exposure", exposure,
      "of images that are displayed, in EV (radiance is multiplied by 2^EV), or auto: the log-average "
      "luminance of what does not emit becomes 0.18 (default: auto)");
}

void DisplayOptions::addTo(CLI::App& app) {
  addExposureTo(app);
  addToneTo(app);
}

void DisplayOptions::addToneTo(CLI::App& app) {
  app.add_option("--tone", tone,
                 "tone curve of images that are displayed: linear, srgb or filmic (default: srgb)")
      ->check(CLI::IsMember({"linear", "srgb", "filmic"}));
}

std::optional<double> DisplayOptions::given() const {
  if (exposure == "auto") return std::nullopt;
  char* end = nullptr;
  const double number = std::strtod(exposure.c_str(), &end);
  std::string unit = end;
  unit.erase(0, unit.find_first_not_of(' '));
  if (end == exposure.c_str() || (!unit.empty() && unit != "EV") || !(std::abs(number) <= kLargestExposure))
    throw Error(fmt::format("--exposure '{}': expected auto or a number of EV from {} to {}, as -1.5",
                            exposure, -kLargestExposure, kLargestExposure));
  return number;
}

std::string asTyped(const std::string& program, int count, char** arguments) {
  std::string line;
  for (int i = 0; i < count; ++i) {
    const std::string argument = i == 0 ? program : std::string(arguments[i]);
    const bool plain =
        !argument.empty() && argument.find_first_of(" \t\n'\"\\$`*?#&|;<>(){}[]!~") == std::string::npos;
    line += (i == 0 ? "" : " ") + (plain ? argument : "'" + argument + "'");
  }
  return line;
}

std::optional<int> parseOptions(CLI::App& app, const GlobalOptions& global, int count, char** arguments) {
  try {
    app.parse(count, arguments);
  } catch (const CLI::ParseError& error) {
    // Help and version are no errors; everything else about the options is bad input.
    return app.exit(error, std::cout, std::cerr) == 0 ? kGood : kBadInput;
  }
  setLogLevel(global.quiet ? LogLevel::quiet : global.verbose ? LogLevel::details : LogLevel::information);
  return std::nullopt;
}

int guarded(const std::string& program, const std::function<int()>& work) {
  try {
    return work();
  } catch (const DiagnosticsError& error) {
    std::cerr << error.what() << std::endl;
  } catch (const std::bad_alloc&) {
    std::cerr << program << ": out of memory" << std::endl;
  } catch (const std::exception& error) {
    std::cerr << program << ": " << error.what() << std::endl;
  }
  return kBadInput;
}

namespace {

template <class Value>
CLI::Option* addRepeatableOf(CLI::App& app, const std::string& names, std::vector<Value>& values,
                             const std::string& text) {
  return app.add_option(names, values, text)->allow_extra_args(false);
}

bool looksLikeNumber(const std::string& text) {
  if (text.empty()) return true;
  const unsigned char first =
      static_cast<unsigned char>(text[0] == '-' && text.size() > 1 ? text[1] : text[0]);
  return std::isdigit(first) != 0 || text == "-";
}

/// Columns that a terminal shows for UTF-8 text: its code points.
std::size_t shownWidth(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

}  // namespace

CLI::Option* addRepeatable(CLI::App& app, const std::string& names, std::vector<std::string>& values,
                           const std::string& text) {
  return addRepeatableOf(app, names, values, text);
}
CLI::Option* addRepeatable(CLI::App& app, const std::string& names,
                           std::vector<std::filesystem::path>& values, const std::string& text) {
  return addRepeatableOf(app, names, values, text);
}

std::pair<int, int> parseResolution(const std::string& text) {
  int width = 0, height = 0, used = 0;
  constexpr int kMost = 65536;
  if (text.size() > 16 || std::sscanf(text.c_str(), "%dx%d%n", &width, &height, &used) != 2 ||
      static_cast<std::size_t>(used) != text.size() || width < 1 || height < 1 || width > kMost ||
      height > kMost)
    throw Error(fmt::format(
        "--resolution '{}': expected WIDTHxHEIGHT in pixels, each in 1..{}, such as 640x360", text, kMost));
  return {width, height};
}

void requirePng(const std::string& option, const std::filesystem::path& file) {
  if (file.extension() != ".png")
    throw Error(fmt::format("{} '{}': expected a name that ends in .png", option, file.string()));
}

std::pair<int, int> parseFrames(const std::string& option, const std::string& text) {
  int first = 0, last = 0, used = 0;
  const auto whole = [&] { return text.size() <= 24 && static_cast<std::size_t>(used) == text.size(); };
  if (std::sscanf(text.c_str(), "%d..%d%n", &first, &last, &used) == 2 && whole() && first >= 0 &&
      last >= first)
    return {first, last};
  used = 0;
  if (std::sscanf(text.c_str(), "%d%n", &first, &used) == 1 && whole() && first >= 0) return {first, first};
  throw Error(
      fmt::format("{} '{}': expected FIRST..LAST, whole numbers from 0, such as 0..47", option, text));
}

std::filesystem::path numberedName(const std::filesystem::path& output, int frame) {
  std::string stem = output.filename().string();
  const std::size_t first = stem.find('#');
  if (first != std::string::npos) {
    const std::size_t end = stem.find_first_not_of('#', first);
    const std::size_t digits = (end == std::string::npos ? stem.size() : end) - first;
    return output.parent_path() / stem.replace(first, digits, fmt::format("{:0{}}", frame, digits));
  }
  return output.parent_path() /
         fmt::format("{}_{:04}{}", output.stem().string(), frame, output.extension().string());
}

std::map<std::string, std::string> provenance(const GlobalOptions& global, const Scene& scene,
                                              const Pipeline& pipeline, const RenderOptions& options,
                                              const gpu::Device& device, double time) {
  std::string parameters;
  for (const PipelineParameter& parameter : pipeline.parameters) {
    const auto set = options.parameters.find(parameter.name);
    parameters += (parameters.empty() ? "" : " ") + parameter.name + "=" +
                  (set == options.parameters.end() ? parameter.value : set->second).text();
  }
  return {{"lumivox.version", LUMIVOX_VERSION},
          {"lumivox.command", global.commandLine},
          {"lumivox.scene", scene.name},
          {"lumivox.scene_hash", scene.hash.text()},
          {"lumivox.pipeline", pipeline.name},
          {"lumivox.pipeline_hash", pipeline.hash.text()},
          {"lumivox.parameters", parameters},
          {"lumivox.keep_everything", options.keepEverything ? "yes" : "no"},
          {"lumivox.seed", fmt::format("{}", options.seed)},
          {"lumivox.time", fmt::format("{}", time)},
          {"lumivox.camera", scene.camera(options.camera).name},
          {"lumivox.device", device.info().renderer},
          {"lumivox.driver", device.info().version},
          {"lumivox.shaders", device.programRoute()}};
}

std::string textTable(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  std::vector<bool> numbers;
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      if (c >= widths.size()) {
        widths.push_back(0);
        numbers.push_back(rows.size() > 1);
      }
      widths[c] = std::max(widths[c], shownWidth(rows[r][c]));
      if (r > 0 && !looksLikeNumber(rows[r][c])) numbers[c] = false;
    }
  std::string text;
  for (const std::vector<std::string>& row : rows) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string padding(widths[c] - shownWidth(row[c]), ' ');
      line += (c == 0 ? "" : "  ") + (numbers[c] ? padding + row[c] : row[c] + padding);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

void print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
    throw Error("cannot write to standard output");
}

void printJson(const Json& json) {
  print(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

std::string threeDigits(double value) {
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : std::string("-");
}

}  // namespace lumivox::command
