// Saves images, texts and the record of the panels.
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
    // As in the window: values that are not radiance are exposed only by a chosen exposure.
    writePng(file, image, given ? chosen : displayOf(image, chosen));
  } else {
    LayeredImage layered;
    for (const auto& [name, image] : side.frame.outputs)
      if (!image.empty()) layered.layers[name] = image;
    if (ImageBuffer whole = compositeImage(side.frame); !whole.empty()) layered.layers[""] = std::move(whole);
    writeExr(file, layered);
  }
}

/// Checks the file of a statement like an output of a command, so that for example a record never overwrites
/// a scene.
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
  // An existing text is overwritten only after a question.
  if (word != "save_pipeline" && word != "save_scene") outputs.requireUnread();
}

/// Throws unless the file is in the folder of the original text: elsewhere the files that the text names
/// would not be found.
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
  // A text may overwrite itself, whatever its ending, after a question.
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
    if (!isScene) Pipeline::parse(text.text, file);  // throws if the text could not be read again
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
  // The text now contains the edits, so the scene has nothing left to undo.
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
