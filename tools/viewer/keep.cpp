// What is taken out of the viewer: images, texts, the record of the panels.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "common/outputs.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/experiment/report.h"
#include "lumivox/measure/exposure.h"
#include "viewer/panels.h"
#include "viewer/session.h"

namespace lumivox::viewer {
namespace {

namespace fs = std::filesystem;

void saveImage(const fs::path& file, const RenderedSide& side, const std::string& output,
               const std::optional<double>& given, double exposure, Curve curve) {
  if (file.extension() == ".png") {
    if (curve == Curve::falseColour)
      throw Error("save_image: false colour is of the window; expected another tone, or `shot`");
    const ImageBuffer image = outputOf(side.frame, output);
    const Tone tone = curve == Curve::linear   ? Tone::linear
                      : curve == Curve::filmic ? Tone::filmic
                                               : Tone::srgb;
    const Display chosen{exposure, tone};
    // As the picture is: what is no radiance is exposed only where somebody says by how much.
    writePng(file, image, given ? chosen : displayOf(image, chosen));
  } else {
    LayeredImage layered;
    for (const auto& [name, image] : side.frame.outputs)
      if (!image.empty()) layered.layers[name] = image;
    if (ImageBuffer whole = compositeImage(side.frame); !whole.empty()) layered.layers[""] = std::move(whole);
    writeExr(file, layered);
  }
}

/// What a statement writes is checked as the outputs of commands are, so that no record takes the place of a
/// scene.
void requireOutput(const std::string& word, const fs::path& file) {
  using command::Outputs;
  static const std::map<std::string, std::vector<std::string>> endings{{"save_image", {".png", ".exr"}},
                                                                       {"save_pipeline", {".pipeline"}},
                                                                       {"save_scene", {".scene"}},
                                                                       {"record", {".json"}},
                                                                       {"export_grid", {".vdb"}}};
  const bool isStrict = word == "save_image" || word == "export_grid";
  const Outputs outputs = Outputs().add(
      word, file, endings.at(word), isStrict ? Outputs::Endings::only : Outputs::Endings::otherKindsRefused);
  outputs.check({});
  // A text that is there is asked for before it is written.
  if (word != "save_pipeline" && word != "save_scene") outputs.requireUnread();
}

/// The folder of the original text, if a copy of it would not find what it names.
void requireSameFolder(const char* what, const fs::path& file, const fs::path& original) {
  const fs::path here = fs::absolute(file).parent_path().lexically_normal(),
                 there = fs::absolute(original).parent_path().lexically_normal();
  if (here != there)
    throw Error(fmt::format("{} {}: the text names other files beside it; expected a name in {}", what,
                            file.string(), there.string()));
}

}  // namespace

bool Session::doKeep(const Action& action) {
  const std::string& word = action.word();
  if (word == "answer") {
    if (!waitsForAnswer_) throw Error("answer: nothing was asked");
    const TextToWrite text = *std::exchange(waitsForAnswer_, std::nullopt);
    if (action.text() == "yes")
      write(text);
    else
      say(text.file.string() + " stays as it was", false);
    return true;
  }
  if (word == "export_grid") return requireOutput(word, action.text()), exportGrid(action.text()), true;
  if (word == "add_point") return addPoint(action.text()), true;
  if (word != "save_image" && word != "save_pipeline" && word != "save_scene" && word != "record")
    return false;
  const fs::path file = action.text();
  const Side& side = state_.sides.front();
  const bool isScene = word == "save_scene";
  if (isScene) requireSameFolder("save_scene", file, options_.scene);
  // A text may take its own place, whatever it is called: it is asked for.
  const fs::path own = isScene ? options_.scene : word == "save_pipeline" ? side.pipeline->file : fs::path();
  std::error_code none;
  if (!fs::equivalent(file, own, none)) requireOutput(word, file);
  if (word == "record") {
    writeFileAtomically(file, recordOf(*this).dump(2) + "\n");
  } else if (word == "save_image") {
    if (rendered_ == nullptr || !rendered_->sides.front().error.empty())
      throw Error("save_image: there is no picture; " + (rendered_ == nullptr
                                                             ? std::string("expected `wait frame` before")
                                                             : rendered_->sides.front().error));
    saveImage(file, rendered_->sides.front(), state_.output, state_.exposure, exposure_, state_.curve);
  } else {
    const TextToWrite text{file, isScene ? sceneText() : textWithDefaults(*side.pipeline, side.values)};
    if (!isScene) Pipeline::parse(text.text, file);  // what is written can be read
    if (!fs::exists(file)) {
      write(text);
    } else if (readFile(file) == text.text) {
      say(file.string() + " says so already", false);
    } else {
      waitsForAnswer_ = text;
      say({}, false);
    }
    return true;
  }
  say(file.string() + " written", false);
  return true;
}

std::string Session::question() const {
  return waitsForAnswer_ ? waitsForAnswer_->file.string() + " is there already. Overwrite it?"
                         : std::string();
}

std::string Session::sceneText() {
  std::optional<Camera> view;
  if (state_.free) {
    view = state_.free;
    view->width = state_.width;
    view->height = state_.height;
  }
  return textWithEdits(*scene_, state_.edits, view ? &*view : nullptr, options_.sceneLoad);
}

void Session::write(const TextToWrite& text) {
  createParentDirectories(text.file);
  writeFileAtomically(text.file, text.text);
  say(text.file.string() + " written", false);
  std::error_code none;
  if (!fs::equivalent(text.file, options_.scene, none)) return;
  // What was changed is now what the text says: there is nothing more to be undone in the scene.
  ViewState settled = state_;
  settled.edits = {};
  if (settled.free) settled.camera = settled.free->name;
  settled.free.reset();
  if (!takeTexts(std::move(settled))) return;
  for (std::vector<ViewState>* states : {&undo_, &redo_})
    for (ViewState& state : *states) state.edits = {};
  say(text.file.string() + " written", false);
}

}  // namespace lumivox::viewer
