#include "scene/model_files.h"

#include <fmt/format.h>

#include "lumivox/base/error.h"
#include "scene/description.h"
#include "scene/obj_model.h"

namespace lumivox {

void placeLike(const ModelCamera& source, const glm::dmat4& placement, Camera& camera) {
  const auto keyOf = [&](const ModelCamera::View& view) {
    CameraKey key;
    key.time = view.time;
    key.eye = glm::dvec3(placement * glm::dvec4(view.eye, 1.0));
    key.target = key.eye + glm::normalize(glm::dmat3(placement) * view.forward);
    return key;
  };
  const CameraKey first = keyOf(source.views.front());
  camera.eye = first.eye;
  camera.target = first.target;
  camera.up = glm::normalize(glm::dmat3(placement) * source.views.front().up);
  camera.fov = source.fov;
  if (source.views.size() == 1) return;
  for (const ModelCamera::View& view : source.views) camera.keys.push_back(keyOf(view));
}

void requireImage(const ModelMaterial& material, const char* statement, const ModelImage& image) {
  std::error_code error;
  const bool readable = hasFormat(image.name, kImageFormats);
  if (material.mtlFile.empty() || (readable && std::filesystem::exists(image.file, error))) return;
  Diagnostic finding;
  finding.place = {material.mtlFile.string(), lineOfMap(material, statement), 0};
  finding.what = readable
                     ? fmt::format("the image '{}' of material '{}' ({}) does not exist", image.name,
                                   material.values.name, statement)
                     : fmt::format("the image '{}' of material '{}' ({}) has a format that cannot be read",
                                   image.name, material.values.name, statement);
  finding.expected = readable ? fmt::format("it at {}", image.file.lexically_normal().string())
                              : fmt::format("one of {}", fmt::join(kImageFormats, ", "));
  throw DiagnosticsError({finding});
}

}  // namespace lumivox
