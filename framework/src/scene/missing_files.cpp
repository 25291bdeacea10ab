#include "scene/missing_files.h"

#include <fmt/format.h>

#include <algorithm>

#include "scene/capture_load.h"

namespace lumivox {
namespace {

/// `name_##.obj` for frame 7 is `name_07.obj`.
std::string frameName(const std::string& pattern, int frame) {
  const std::size_t first = pattern.find('#');
  if (first == std::string::npos) return pattern;
  const std::size_t last = pattern.find_first_not_of('#', first);
  const std::size_t digits = (last == std::string::npos ? pattern.size() : last) - first;
  return pattern.substr(0, first) + fmt::format("{:0{}}", frame, digits) +
         (last == std::string::npos ? "" : pattern.substr(last));
}

}  // namespace

std::vector<std::string> fileNames(const MeshText& mesh) {
  if (!mesh.sequence) return {mesh.file.text};
  std::vector<std::string> names;
  for (int frame = mesh.sequence->first; frame <= mesh.sequence->last; ++frame)
    names.push_back(frameName(mesh.file.text, frame));
  return names;
}

bool namesOneFile(const MeshText& mesh) {
  return !mesh.sequence && mesh.file.text.find('#') == std::string::npos &&
         hasFormat(mesh.file.text, kModelFormats);
}

void findMissingFiles(const dsl::Document& document, const SceneDescription& description,
                      const AssetSearch& assets, Purpose purpose, std::vector<Diagnostic>& findings) {
  const auto isMissing = [&](const std::string& name) {
    return (purpose == Purpose::checking || assets.isLocal(name)) && !assets.find(name);
  };
  const auto require = [&](const PlacedText& place, const std::string& name, const char* what,
                           const std::vector<std::string>& formats) {
    if (!isMissing(name) || !hasFormat(name, formats)) return;
    findings.push_back(document.finding(place.place, place.length,
                                        fmt::format("{} file '{}' does not exist", what, name),
                                        "it at one of " + assets.soughtAt(name), assets.nearestLocal(name)));
  };
  for (const MeshText& mesh : description.meshes) {
    if (!mesh.isSound && !namesOneFile(mesh)) continue;
    const std::vector<std::string> names = fileNames(mesh);
    const auto last = purpose == Purpose::checking ? names.end() : names.begin() + 1;
    const auto missing = std::find_if(names.begin(), last, isMissing);
    if (missing != last) require(mesh.file, *missing, "model", kModelFormats);
  }
  for (const MaterialText& material : description.materials) {
    if (material.texture) require(*material.texture, material.texture->text, "image", kImageFormats);
    if (material.mask) require(*material.mask, material.mask->text, "image", kImageFormats);
  }
  for (const CaptureText& capture : description.captures) {
    if (capture.standsFor) require(*capture.standsFor, capture.standsFor->text, "scene", kSceneFormats);
    if (capture.file) require(*capture.file, capture.file->text, "capture", kSensorFormats);
    findMissingFrames(document, capture, assets, purpose == Purpose::checking, findings);
  }
  if (const auto& file = description.environmentMap.file)
    require(*file, file->text, "environment", kEnvironmentFormats);
  for (const MediumText& medium : description.media) {
    if (medium.file) require(*medium.file, medium.file->text, "volume", kVolumeFormats);
  }
}

}  // namespace lumivox
