#include "common/command_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <limits>

#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/dsl/document.h"
#include "lumivox/scene/text.h"

namespace lumivox::command {
namespace {

constexpr double kSlowestRate = 1e-3, kFastestRate = 1e6;  // frames per second

const CLI::App& programOf(const CLI::App& command) {
  const CLI::App* app = &command;
  while (app->get_parent() != nullptr) app = app->get_parent();
  return *app;
}

/// Help that is wrapped to the width of the terminal; that of a command ends with the options of every
/// command.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_footer(const CLI::App* app) const override {
    if (app->get_parent() == nullptr) return CLI::Formatter::make_footer(app);
    return make_group("Options of every command", false,
                      programOf(*app).get_options([](const CLI::Option* option) {
                        return option->get_group() == "Options" && option->get_name() != "--help";
                      }));
  }
  std::string make_option(const CLI::Option* option, bool isPositional) const override {
    const std::string head = "  " + make_option_name(option, isPositional) + make_option_opts(option);
    return entry(head, make_option_desc(option));
  }
  std::string make_subcommand(const CLI::App* command) const override {
    return entry("  " + command->get_name(), command->get_description());
  }

 private:
  static std::string entry(const std::string& head, const std::string& text) {
    constexpr std::size_t kMeaning = 28;  // the column in which meanings begin
    const auto columns = static_cast<std::size_t>(outputColumns());
    const std::string broken =
        std::string(kMeaning, ' ') + wrapped(text, columns - std::min(columns - 1, kMeaning));
    std::string lines;
    for (const char c : broken) lines += c == '\n' ? "\n" + std::string(kMeaning, ' ') : std::string(1, c);
    if (text.empty()) return head + "\n";
    if (head.size() + 2 > kMeaning) return head + "\n" + lines + "\n";
    return head + lines.substr(head.size()) + "\n";
  }
};

std::vector<const CLI::App*> commandsOf(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

std::string suggestion(const std::string& word, const std::vector<std::string>& known) {
  const std::string nearest = nearestWord(word, known);
  return nearest.empty() ? "" : "; did you mean '" + nearest + "'?";
}

/// "lumivox results" for a command below.
std::string wordsOf(const CLI::App& command) {
  return command.get_parent() == nullptr ? command.get_name()
                                         : wordsOf(*command.get_parent()) + " " + command.get_name();
}

std::string unknownCommand(const CLI::App& app, const std::string& word) {
  std::vector<std::string> known;
  for (const CLI::App* command : commandsOf(app)) known.push_back(command->get_name());
  return fmt::format("'{}' is no command of {}; expected one of {}{}", word, wordsOf(app),
                     fmt::join(known, ", "), suggestion(word, known));
}

/// The fault of the words that no command took; empty if all were taken.
std::string wrongWords(const CLI::App& app) {
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().back();
  for (const std::string& word : app.remaining(true)) {
    if (word == "--") continue;
    if (word.size() < 2 || word[0] != '-')
      return commandsOf(*command).empty() ? fmt::format("'{}' is more than {} takes", word, wordsOf(*command))
                                          : unknownCommand(*command, word);
    std::vector<std::string> known;
    for (const CLI::App* one : {command, &app})
      for (const CLI::Option* option : one->get_options())
        for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    const std::string option = word.substr(0, word.find('='));
    return fmt::format("{} has no option '{}'{}", wordsOf(*command), option, suggestion(option, known));
  }
  return {};
}

/// The value, in base units, of a number with a unit of the dimension; nothing for any other text.
std::optional<double> quantityOf(const std::string& text, const dsl::Dimension& dimension, bool needsUnit) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || !std::isfinite(number)) return std::nullopt;
  std::string unit = end;
  unit.erase(0, unit.find_first_not_of(' '));
  if (unit.empty()) return needsUnit ? std::nullopt : std::optional(number);
  for (const dsl::Unit& known : dsl::knownUnits())
    if (known.name == unit && known.dimension == dimension) return number * known.toBase;
  return std::nullopt;
}

}  // namespace

void GlobalOptions::addTo(CLI::App& app) {
  app.formatter(std::make_shared<HelpFormatter>());
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
  return TechniqueSet(TechniqueSet::defaultDirectories(techniques), strict);
}

void RunOptions::addTo(CLI::App& app) {
  addRepeatable(app, "--set", settings, "a parameter of the pipeline, as name=value");
  app.add_option("--camera", camera, "the scene's camera of this name (default: the first)");
  app.add_option("--resolution", resolution,
                 "width and height in pixels, such as 640x360 (default: the camera's)");
  addTime(app, time);
  addSeed(app, seed);
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

std::string inSingleQuotes(const std::string& argument) {
  std::string text = "'";
  for (const char c : argument) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string asTyped(const std::string& program, int count, char** arguments) {
  std::string line;
  for (int i = 0; i < count; ++i) {
    const std::string argument = i == 0 ? program : std::string(arguments[i]);
    const bool plain =
        !argument.empty() && argument.find_first_of(" \t\n'\"\\$`*?#&|;<>(){}[]!~") == std::string::npos;
    line += (i == 0 ? "" : " ") + (plain ? argument : inSingleQuotes(argument));
  }
  return line;
}

std::string helpOf(const CLI::App& command) {
  return command.get_formatter()->make_help(&command, wordsOf(command), CLI::AppFormatMode::Normal);
}

const CLI::App& commandNamed(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::App* command = &app;
  for (const std::string& word : words) {
    const std::vector<const CLI::App*> below = commandsOf(*command);
    const auto found = std::find_if(below.begin(), below.end(),
                                    [&](const CLI::App* one) { return one->get_name() == word; });
    if (found == below.end())
      throw Error(below.empty() ? fmt::format("'{}' has no commands of its own", wordsOf(*command))
                                : unknownCommand(*command, word));
    command = *found;
  }
  return *command;
}

std::optional<int> parseOptions(CLI::App& app, const GlobalOptions& global, int count, char** arguments) {
  try {
    app.parse(count, arguments);
  } catch (const CLI::ParseError& error) {
    // Help and version are no errors; everything else about the options is bad input.
    if (error.get_exit_code() != 0)
      if (const std::string wrong = wrongWords(app); !wrong.empty()) {
        std::cerr << app.get_name() << ": " << wrong << "\nRun with --help for more information.\n";
        return kBadInput;
      }
    return app.exit(error, std::cout, std::cerr) == 0 ? kGood : kBadInput;
  }
  setLogLevel(global.quiet ? LogLevel::quiet : global.verbose ? LogLevel::details : LogLevel::information);
  return std::nullopt;
}

int guarded(const std::string& program, const std::function<int()>& work) {
  // Runs on every way out of this function.
  struct Repeated {
    ~Repeated() { logRepeatedWarnings(); }
  } repeated;
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

}  // namespace

CLI::Option* addRepeatable(CLI::App& app, const std::string& names, std::vector<std::string>& values,
                           const std::string& text) {
  return addRepeatableOf(app, names, values, text);
}
CLI::Option* addRepeatable(CLI::App& app, const std::string& names,
                           std::vector<std::filesystem::path>& values, const std::string& text) {
  return addRepeatableOf(app, names, values, text);
}

double secondsOf(const std::string& option, const std::string& text) {
  const std::optional<double> seconds = quantityOf(text, dsl::kTime, true);
  if (seconds && *seconds > 0.0 && *seconds <= kLongestTime) return *seconds;
  throw Error(fmt::format(
      "{} '{}': expected a time above 0 with its unit ({}), such as 16ms or 0.5s, of at most {:g} s", option,
      text, dsl::unitNames(dsl::kTime), kLongestTime));
}

namespace {

/// An option whose value is text that `read` understands; Error otherwise.
CLI::Option* addText(CLI::App& app, const std::string& names, const std::string& type,
                     const std::string& text, std::function<void(const std::string&)> read) {
  return app
      .add_option_function<std::string>(
          names,
          [read = std::move(read)](const std::string& value) {
            try {
              read(value);
            } catch (const Error& error) {
              throw CLI::ValidationError(error.what());
            }
          },
          text)
      ->type_name(type);
}

}  // namespace

CLI::Option* addDuration(CLI::App& app, const std::string& names, double& seconds, const std::string& text) {
  return addText(app, names, "TIME", text,
                 [names, &seconds](const std::string& value) { seconds = secondsOf(names, value); });
}

CLI::Option* addTime(CLI::App& app, double& seconds) {
  return addText(app, "--time", "TIME",
                 "when in the scene's animation, such as 300ms; without a unit in seconds",
                 [&seconds](const std::string& value) {
                   const std::optional<double> read = quantityOf(value, dsl::kTime, false);
                   if (!read || std::abs(*read) > kLongestTime)
                     throw Error(fmt::format(
                         "--time '{}': expected a time in {} from {:g} to {:g} s, such as 300ms or 0.5s",
                         value, dsl::unitNames(dsl::kTime), -kLongestTime, kLongestTime));
                   seconds = *read;
                 });
}

CLI::Option* addLength(CLI::App& app, const std::string& names, double& metres, const std::string& text) {
  return addText(app, names, "LENGTH", text, [names, &metres](const std::string& value) {
    const std::optional<double> read = quantityOf(value, dsl::kLength, false);
    if (!read || *read < 0.0 || *read > kFarthestPlace)
      throw Error(fmt::format("{} '{}': expected a length in {} from 0 to {:g} m, such as 0.5m", names, value,
                              dsl::unitNames(dsl::kLength), kFarthestPlace));
    metres = *read;
  });
}

CLI::Validator numberBetween(double low, double high) {
  return {[=](std::string& text) {
            const std::optional<double> number = quantityOf(text, dsl::kNoDimension, false);
            if (number && *number >= low && *number <= high) return std::string();
            return fmt::format("'{}': expected a number from {:g} to {:g}", text, low, high);
          },
          fmt::format("FLOAT in [{:g} - {:g}]", low, high)};
}

CLI::Option* addFrameRate(CLI::App& app, double& framesPerSecond) {
  return app.add_option("--fps", framesPerSecond, "frames per second of --frames (default 24)")
      ->check(numberBetween(kSlowestRate, kFastestRate));
}

CLI::Option* addSeed(CLI::App& app, std::uint64_t& seed, const std::string& text) {
  return addText(app, "--seed", "UINT", text, [&seed](const std::string& value) {
    const auto read = std::from_chars(value.data(), value.data() + value.size(), seed);
    if (read.ec != std::errc() || read.ptr != value.data() + value.size())
      throw Error(fmt::format("--seed '{}': expected a whole number from 0 to {}", value,
                              std::numeric_limits<std::uint64_t>::max()));
  });
}

namespace {

/// Two whole numbers with `between` between them; nothing for anything else.
std::optional<std::pair<int, int>> twoNumbers(const std::string& text, const std::string& between) {
  const std::size_t at = text.find(between);
  if (at == std::string::npos) return std::nullopt;
  std::pair<int, int> numbers;
  const auto read = [](const char* first, const char* last, int& number) {
    const auto result = std::from_chars(first, last, number);
    return result.ec == std::errc() && result.ptr == last;
  };
  const char* text0 = text.data();
  if (!read(text0, text0 + at, numbers.first) ||
      !read(text0 + at + between.size(), text0 + text.size(), numbers.second))
    return std::nullopt;
  return numbers;
}

}  // namespace

std::pair<int, int> parseResolution(const std::string& text, const std::string& option) {
  constexpr int kMost = 65536;
  const auto size = twoNumbers(text, "x");
  if (!size || size->first < 1 || size->second < 1 || size->first > kMost || size->second > kMost)
    throw Error(fmt::format("{} '{}': expected WIDTHxHEIGHT in pixels, each in 1..{}, such as 640x360",
                            option, text, kMost));
  return *size;
}

std::pair<int, int> parseFrames(const std::string& option, const std::string& text) {
  constexpr int kLastFrame = 9999999;
  const auto frames =
      text.find("..") == std::string::npos ? twoNumbers(text + ".." + text, "..") : twoNumbers(text, "..");
  if (!frames || frames->first < 0 || frames->second < frames->first || frames->second > kLastFrame)
    throw Error(fmt::format("{} '{}': expected FIRST..LAST, whole numbers from 0 to {}, such as 0..47",
                            option, text, kLastFrame));
  return *frames;
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

void print(const std::string& text) {
  if (isatty(STDOUT_FILENO) != 0) clearProgressLine();
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
