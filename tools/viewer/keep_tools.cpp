// What is kept by other programs: the grid that is shown, by the exporter, so that the window needs no
// OpenVDB; and a point of the results, measured as sweeps measure.
#include <fmt/format.h>
#include <unistd.h>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "viewer/program.h"
#include "viewer/session.h"

namespace lumivox::viewer {
namespace {

namespace fs = std::filesystem;

/// A name beside a text, which finds what the text finds.
fs::path nameBeside(const fs::path& text) {
  return text.parent_path() /
         fmt::format(".{}-view-{}{}", text.stem().string(), getpid(), text.extension().string());
}

void add(std::vector<std::string>& words, const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
}

/// Of the command lines of all programs.
std::vector<std::string> globalWords(const SessionOptions& options) {
  std::vector<std::string> words{"--quiet", "--device", options.device.device};
  for (const fs::path& folder : options.techniques) add(words, {"--techniques", folder.string()});
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
  return state_.edits.empty() && Pipeline::load(side.pipeline->file).hash == side.pipeline->hash;
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
  if (file.extension() != ".vdb")
    throw Error(fmt::format("export_grid {}: expected a name that ends in .vdb", file.string()));
  createParentDirectories(file);
  ToolWish wish{file.string() + " written", {programBeside("vdbexport").string()}, {}};
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
  // A row of a store names its texts: they must say what was measured.
  if (!isAsInTexts())
    throw Error(
        "add_point: the texts do not say what is shown; expected `save_scene` or `save_pipeline` before");
  if (state_.free)
    throw Error(
        "add_point: results are of a camera of the scene; expected `camera NAME`, or `save_scene` before");
  createParentDirectories(store);
  ToolWish wish{"a point was added to " + store.string(), {programBeside("lumivox").string()}, {}};
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
