#include "scene/capture_load.h"

#include <fmt/format.h>

#include "scene/capture_files.h"

namespace lumivox {
namespace {

namespace fs = std::filesystem;

/// The file of poses beside EXR images.
std::string posesBeside(const std::string& pattern) {
  return (fs::path(pattern).parent_path() / "groundtruth.txt").string();
}

}  // namespace

void findMissingFrames(const dsl::Document& document, const CaptureText& capture, const AssetSearch& assets,
                       bool everywhere, std::vector<Diagnostic>& findings) {
  if (!capture.folder && !capture.files) return;
  const PlacedText& place = capture.source();
  const std::string name = capture.folder ? place.text : posesBeside(place.text);
  if (assets.findAny(name) || !(everywhere || assets.isLocal(name))) return;
  findings.push_back(document.finding(
      place.place, place.length,
      fmt::format("{} '{}' does not exist", capture.folder ? "capture folder" : "file of poses", name),
      "it at one of " + assets.soughtAt(name), assets.nearestLocal(name)));
}

std::shared_ptr<const Capture> loadPlacedCapture(const CaptureText& text, const AssetSearch& assets,
                                                 const SceneLoadOptions& options, Hasher& hasher) {
  const std::string& name = text.source().text;
  const std::string what = fmt::format("the source of capture '{}'", text.name);
  fs::path place = assets.foundAny(text.files ? posesBeside(name) : name, what);
  if (text.files) place = place.parent_path() / fs::path(name).filename();
  const auto capture = loadCapture(text, place, hasher);
  if (text.standsFor) {
    SceneLoadOptions real = options;
    real.mayHoldCaptures = false;
    capture->realScene = std::make_shared<const Scene>(loadScene(
        assets.found(text.standsFor->text, "the scene that capture '" + text.name + "' stands for"), real));
  }
  return capture;
}

void sizeCapturedViews(Scene& scene) {
  for (Camera& camera : scene.cameras) {
    if (camera.capture < 0 || static_cast<std::size_t>(camera.capture) >= scene.captures.size()) continue;
    const CaptureCamera& captured = scene.captures[static_cast<std::size_t>(camera.capture)]->camera;
    if (camera.width == 0) camera.width = captured.width, camera.height = captured.height;
  }
}

}  // namespace lumivox
