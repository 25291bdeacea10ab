// What is taken out of the viewer: images, texts, the record of the panels.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/experiment/report.h"
#include "viewer/panels.h"
#include "viewer/session.h"

namespace lumivox::viewer {
namespace {

namespace fs = std::filesystem;

void saveImage(const fs::path& file, const RenderedSide& side, const std::string& output, double exposure,
               Curve curve) {
  createParentDirectories(file);
  if (file.extension() == ".png") {
    if (curve == Curve::falseColour)
      throw Error("save_image: false colour is of the window; expected another tone, or `shot`");
    const ImageBuffer image = outputOf(side.frame, output);
    const Tone tone = curve == Curve::linear   ? Tone::linear
                      : curve == Curve::filmic ? Tone::filmic
                                               : Tone::srgb;
    writePng(file, image, image.channels() == 1 ? Display{} : Display{exposure, tone});
  } else if (file.extension() == ".exr") {
    LayeredImage layered;
    for (const auto& [name, image] : side.frame.outputs)
      if (!image.empty()) layered.layers[name] = image;
    if (ImageBuffer whole = compositeImage(side.frame); !whole.empty()) layered.layers[""] = std::move(whole);
    writeExr(file, layered);
  } else {
    throw Error(fmt::format("save_image {}: expected a name that ends in .png or .exr", file.string()));
  }
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
  if (word == "export_grid") return exportGrid(action.text()), true;
  if (word == "add_point") return addPoint(action.text()), true;
  if (word != "save_image" && word != "save_pipeline" && word != "save_scene" && word != "record")
    return false;
  const fs::path file = action.text();
  const Side& side = state_.sides.front();
  if (word == "record") {
    createParentDirectories(file);
    writeFileAtomically(file, recordOf(*this).dump(2) + "\n");
  } else if (word == "save_image") {
    if (rendered_ == nullptr || !rendered_->sides.front().error.empty())
      throw Error("save_image: there is no picture; " + (rendered_ == nullptr
                                                             ? std::string("expected `wait frame` before")
                                                             : rendered_->sides.front().error));
    saveImage(file, rendered_->sides.front(), state_.output, exposure_, state_.curve);
  } else {
    const bool isScene = word == "save_scene";
    if (isScene) requireSameFolder("save_scene", file, options_.scene);
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
  readChangedFiles();
  const auto settle = [](ViewState& state) { state.edits = {}; };
  settle(state_);
  std::for_each(undo_.begin(), undo_.end(), settle);
  std::for_each(redo_.begin(), redo_.end(), settle);
  if (state_.free) state_.camera = state_.free->name;
  state_.free.reset();
  applyEdits();
}

}  // namespace lumivox::viewer
