// Reloads texts that change while they are shown: all of them, or none.
#include <fmt/format.h>

#include <algorithm>

#include "lumivox/base/error.h"
#include "viewer/session.h"

namespace lumivox::viewer {
namespace {

/// Moves a side to its changed text with the values that still fit. Returns whether nothing that was set is
/// lost.
bool refresh(Side& side, const std::shared_ptr<const Pipeline>& before,
             const std::shared_ptr<const Pipeline>& again) {
  ParameterValues values;
  for (const auto& [name, value] : side.values)
    for (const PipelineParameter& parameter : again->parameters)
      if (parameter.name == name && parameter.misfit(value).empty()) values[name] = value;
  // A side with changed pass parameters has a text of its own, whose changes are lost.
  const bool whole = values.size() == side.values.size() && side.pipeline->hash == before->hash;
  side = {again, std::move(values)};
  return whole;
}

/// Edited parts that the text no longer has. Their edits are kept, and apply again when the part returns.
std::vector<std::string> lostParts(const Scene& scene, const SceneEdits& edits) {
  std::vector<std::string> known = partsOf(scene), lost;
  for (const Material& material : editableMaterials(scene)) known.push_back("material " + material.name);
  for (const Camera& camera : scene.cameras) known.push_back("camera " + camera.name);
  known.insert(known.end(), {"environment", "gloss"});
  const auto note = [&](const std::string& part) {
    if (std::ranges::find(known, part) == known.end()) lost.push_back(part);
  };
  for (const std::string& part : edits.off) note(part);
  for (const auto& [name, edit] : edits.powers) note("light " + name);
  for (const auto& [name, edit] : edits.materials) note("material " + name);
  for (const auto& [name, edit] : edits.media) note("medium " + name);
  for (const auto& [name, edit] : edits.cameras) note("camera " + name);
  std::ranges::sort(lost);
  lost.erase(std::unique(lost.begin(), lost.end()), lost.end());
  return lost;
}

}  // namespace

bool Session::readChangedFiles() {
  return takeTexts(state_);
}

/// Reads all texts, and shows `next` with them. Returns false if a text is wrong; then nothing changes, and
/// problem() gives the reason.
bool Session::takeTexts(ViewState next) {
  stateChanged_ = pictureChanged_ = true;
  refusedWith_ = next.edits;
  std::vector<std::string> said;
  std::shared_ptr<const Scene> scene, edited;
  std::vector<std::shared_ptr<const Pipeline>> pipelines = pipelines_;
  std::vector<ViewState> undo = undo_, redo = redo_;
  try {
    scene = std::make_shared<const Scene>(loadScene(options_.scene, options_.sceneLoad));
    if (scene->hash == scene_->hash) scene = scene_;
    edited = editedScene(scene, next.edits);
    // The default camera of `view` and `render`.
    const std::vector<Camera>& cameras = scene->cameras;
    if (std::ranges::find(cameras, next.camera, &Camera::name) == cameras.end()) {
      said.push_back(fmt::format("the text no longer has the camera '{}': its first, '{}', takes its place",
                                 next.camera, scene->camera("").name));
      next.camera = scene->camera("").name;
    }
    if (const std::vector<std::string> lost = lostParts(*scene, next.edits); !lost.empty() && scene != scene_)
      said.push_back(fmt::format("edited, and no longer in the text: {}", fmt::join(lost, ", ")));
    for (auto& pipeline : pipelines) {
      const std::shared_ptr<const Pipeline> before = pipeline;
      auto again = std::make_shared<const Pipeline>(Pipeline::load(before->file));
      if (again->hash == before->hash) continue;
      bool whole = true;
      const auto refreshAll = [&](ViewState& state) {
        for (Side& side : state.sides)
          if (side.pipeline->file == before->file) whole = refresh(side, before, again) && whole;
      };
      std::ranges::for_each(undo, refreshAll);
      std::ranges::for_each(redo, refreshAll);
      whole = true;
      refreshAll(next);
      if (!whole)
        said.push_back(
            fmt::format("{}: not all that was set fits the changed text; what does not is as it says",
                        before->file.filename().string()));
      pipeline = std::move(again);
    }
    const auto& outputs = next.sides.front().pipeline->outputs;
    if (next.output != kWholeImage &&
        std::ranges::find(outputs, next.output, &Pipeline::Output::name) == outputs.end()) {
      said.push_back(
          fmt::format("the text no longer has the output '{}': the whole image is shown", next.output));
      next.output = kWholeImage;
    }
  } catch (const std::exception& error) {
    textProblem_ = error.what();
    return false;
  }
  scene_ = std::move(scene);
  edited_ = std::move(edited);
  applied_ = next.edits;
  editedFrom_ = scene_;
  pipelines_ = std::move(pipelines);
  undo_ = std::move(undo);
  redo_ = std::move(redo);
  state_ = std::move(next);
  textProblem_.clear();
  if (!said.empty()) say(fmt::format("{}", fmt::join(said, "; ")), false);
  return true;
}

}  // namespace lumivox::viewer
