#include "command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "lumivox/dsl/document.h"

namespace lumivox::command {

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

std::unique_ptr<gpu::Device> GlobalOptions::openDevice() const {
  gpu::DeviceOptions options;
  options.device = device;
  options.shaderInput = shaders == "spirv"  ? gpu::ShaderInput::spirv
                        : shaders == "glsl" ? gpu::ShaderInput::glsl
                                            : gpu::ShaderInput::automatic;
  auto opened = std::make_unique<gpu::Device>(options);
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
                 "width and height in pixels, as 640x360 (default: the camera's)");
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

void Commands::onChosen(CLI::App* subcommand, Work work) {
  subcommand->fallthrough();
  subcommand->callback([this, work = std::move(work)] { chosen = work; });
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
    throw Error(fmt::format("--resolution '{}': expected WIDTHxHEIGHT in pixels, each in 1..{}, as 640x360",
                            text, kMost));
  return {width, height};
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
