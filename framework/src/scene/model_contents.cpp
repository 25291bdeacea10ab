#include "lumivox/scene/model_contents.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>

#include "lumivox/base/error.h"
#include "lumivox/base/image.h"
#include "lumivox/scene/model_animation.h"
#include "scene/description.h"
#include "scene/model_files.h"

namespace lumivox {
namespace {

ModelContents::UsedMaterial usedMaterial(const ModelMaterial& source) {
  ModelContents::UsedMaterial result;
  result.values = source.values;
  result.coverage = source.dissolve;
  for (const auto& [image, file] :
       {std::pair(&source.diffuse, &result.texture), {&source.mask, &result.mask}}) {
    if (!image->present()) continue;
    if (image->bytes != nullptr)
      result.hasEmbeddedImages = true;
    else
      *file = image->file;
  }
  // As a mask a scene text takes the first channel of an image without alpha; there it covers everything.
  if (source.masksByAlphaOnly && !result.mask.empty() && std::filesystem::exists(result.mask) &&
      readByteImage(result.mask).channels % 2 == 1)
    result.mask.clear();
  return result;
}

}  // namespace

ModelContents readModelContents(const std::filesystem::path& file) {
  if (!hasFormat(file.filename().string(), kModelFormats))
    throw Error(fmt::format("{}: is no model; expected a file whose name ends with {}", file.string(),
                            fmt::join(kModelFormats, ", ")));
  Hasher hasher;
  const Model model = loadModel({file}, {}, hasher);
  ModelContents contents;
  glm::dvec3 low(std::numeric_limits<double>::max()), high(std::numeric_limits<double>::lowest());
  std::set<std::string> known;
  for (const ModelObject& object : model.objects) {
    ModelContents::ModelPart part;
    part.name = object.name;
    part.vertices = object.vertexCount;
    part.isMoving = object.animation != nullptr;
    part.isDeforming = part.isMoving && object.animation->deforms();
    for (const Part& run : object.parts) {
      const ModelMaterial& material = model.materials[static_cast<std::size_t>(run.material)];
      part.triangles += run.indexCount / 3;
      if (std::find(part.materials.begin(), part.materials.end(), material.values.name) ==
          part.materials.end())
        part.materials.push_back(material.values.name);
      if (known.insert(material.values.name).second) contents.materials.push_back(usedMaterial(material));
    }
    for (std::uint32_t v = object.firstVertex; v < object.firstVertex + object.vertexCount; ++v) {
      const glm::dvec3 place(object.placement * glm::dvec4(glm::dvec3(model.positions[v]), 1.0));
      low = glm::min(low, place);
      high = glm::max(high, place);
    }
    contents.parts.push_back(std::move(part));
  }
  contents.bounds = {low, high};
  for (const ModelCamera& source : model.cameras) {
    Camera& camera = contents.cameras.emplace_back();
    camera.name = source.name;
    placeLike(source, glm::dmat4(1.0), camera);
  }
  contents.lights = model.lights;
  for (const ModelMotionName& motion : model.motions)
    contents.animations.push_back({motion.name, motion.duration});
  return contents;
}

}  // namespace lumivox
