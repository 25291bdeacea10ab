// Work for other programs. The exporter writes the shown grid, so that the window needs no OpenVDB; `lumivox`
// measures a point for a results store as a sweep does. Also the command that repeats the picture.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "common/command_line.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/plugin/loader.h"
#include "viewer/program.h"
#include "viewer/session.h"

namespace lumivox::viewer {
namespace {

namespace fs = std::filesystem;

/// A word of a command line, quoted for a shell if necessary.
std::string shellWord(const std::string& word) {
  static const std::string plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=:,+";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  return command::inSingleQuotes(word);
}

/// A file name in the folder of a text, so that relative paths in a copy stay valid.
fs::path nameBeside(const fs::path& text) {
  return text.parent_path() /
         fmt::format(".{}-view-{}{}", text.stem().string(), getpid(), text.extension().string());
}

void add(std::vector<std::string>& words, const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
}

/// The global options that differ from their defaults.
std::vector<std::string> globalWords(const SessionOptions& options) {
  std::vector<std::string> words;
  if (options.device.device != gpu::DeviceOptions{}.device) words = {"--device", options.device.device};
  const std::vector<fs::path> found = TechniqueSet::defaultDirectories({});
  for (const fs::path& folder : options.techniques)
    if (std::ranges::find(found, folder) == found.end()) add(words, {"--techniques", folder.string()});
  for (const fs::path& folder : options.sceneLoad.assetPath) add(words, {"--assets", folder.string()});
  if (options.device.shaderInput != gpu::ShaderInput::automatic)
    add(words, {"--shaders", options.device.shaderInput == gpu::ShaderInput::glsl ? "glsl" : "spirv"});
  if (options.device.arithmetic == gpu::Arithmetic::fast) add(words, {"--arithmetic", "fast"});
  if (options.device.memoryBytes != 0) add(words, {"--memory", std::to_string(options.device.memoryBytes)});
  return words;
}

}  // namespace

bool Session::isAsInTexts() const {
  const Side& side = state_.sides.front();
  if (!state_.edits.empty()) return false;
  try {
    return Pipeline::load(side.pipeline->file).hash == side.pipeline->hash;
  } catch (const std::exception&) {  // the text is absent or half written
    return false;
  }
}

std::string Session::command() const {
  if (!isAsInTexts())
    throw Error(
        "no command: the texts do not say what is shown; expected `save_scene` or `save_pipeline` before");
  const Side& side = state_.sides.front();
  std::vector<std::string> words{"lumivox", "render", options_.scene.string(), side.pipeline->file.string()};
  for (const auto& [name, value] : side.values) add(words, {"--set", name + "=" + value.text()});
  if (state_.free) {
    const auto point = [](const glm::dvec3& value) {
      return fmt::format("{},{},{}", value.x, value.y, value.z);
    };
    add(words, {"--eye", point(state_.free->eye), "--target", point(state_.free->target), "--fov",
                fmt::format("{}", state_.free->fov)});
  }
  if (!state_.camera.empty()) add(words, {"--camera", state_.camera});
  add(words, {"--resolution", fmt::format("{}x{}", state_.width, state_.height)});
  if (state_.time != 0.0) add(words, {"--time", fmt::format("{}", state_.time)});
  if (state_.seed != 1) add(words, {"--seed", fmt::format("{}", state_.seed)});
  if (state_.keepEverything) add(words, {"--keep-everything"});
  add(words, globalWords(options_));
  add(words, {"-o", "out/view.exr"});
  std::string text;
  for (const std::string& one : words) text += (text.empty() ? "" : " ") + shellWord(one);
  return text;
}

std::vector<std::string> Session::runWords(const std::string& camera) const {
  std::vector<std::string> words;
  for (const auto& [name, value] : state_.sides.front().values)
    add(words, {"--set", name + "=" + value.text()});
  add(words, {"--camera", camera, "--resolution", fmt::format("{}x{}", state_.width, state_.height), "--time",
              fmt::format("{}", state_.time), "--seed", fmt::format("{}", state_.seed)});
  return words;
}

void Session::exportGrid(const fs::path& file) {
  if (!state_.port) throw Error("export_grid: no port is shown; expected `port PASS.PORT` before");
  ToolWish wish{file.string() + " written", {programBeside("vdbexport").string(), "--quiet"}, {}};
  add(wish.words, globalWords(options_));
  fs::path scene = options_.scene, pipeline = state_.sides.front().pipeline->file;
  std::string camera = state_.camera;
  if (state_.free || !state_.edits.empty()) {
    scene = wish.temporary.emplace_back(nameBeside(scene));
    writeFileAtomically(scene, sceneText());
    if (state_.free) camera = state_.free->name;
  }
  if (Pipeline::load(pipeline).hash != state_.sides.front().pipeline->hash) {
    const std::string text = textWithDefaults(*state_.sides.front().pipeline, {});
    pipeline = wish.temporary.emplace_back(nameBeside(pipeline));
    writeFileAtomically(pipeline, text);
  }
  add(wish.words, {scene.string(), pipeline.string(), "--grid", state_.port->pass + "." + state_.port->port,
                   "--level", std::to_string(state_.port->level), "--out", file.string()});
  add(wish.words, runWords(camera));
  startTool(std::move(wish));
}

void Session::addPoint(const fs::path& store) {
  // A run in a store names its texts, which must contain everything that is measured.
  if (!isAsInTexts())
    throw Error(
        "add_point: the texts do not say what is shown; expected `save_scene` or `save_pipeline` before");
  if (state_.free)
    throw Error(
        "add_point: results are of a camera of the scene; expected `camera NAME`, or `save_scene` before");
  createParentDirectories(store);
  ToolWish wish{"a point was added to " + store.string(), {programBeside("lumivox").string(), "--quiet"}, {}};
  add(wish.words, globalWords(options_));
  add(wish.words,
      {"sweep", options_.scene.string(), "--pipeline", state_.sides.front().pipeline->file.string(),
       "--no-sweep", "--spp", std::to_string(state_.samples), "--store", store.string()});
  add(wish.words, runWords(state_.camera));
  startTool(std::move(wish));
}

void Session::startTool(ToolWish wish) {
  if (keeping_) throw Error("something else is being kept; expected `wait kept` before");
  keeping_ = true;
  say(fmt::format("{} runs ...", fs::path(wish.words.front()).filename().string()), false);
  tools_.want(std::move(wish));
}

}  // namespace lumivox::viewer
