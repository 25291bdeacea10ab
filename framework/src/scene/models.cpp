#include "lumivox/scene/models.h"

namespace lumivox {

std::vector<std::uint32_t> modelsOf(const Scene& scene) {
  std::vector<std::uint32_t> models(scene.objects.size(), 0);
  std::uint32_t last = 0;
  for (std::size_t i = 0; i < models.size(); ++i) {
    const Object& object = scene.objects[i];
    if (!object.animated()) continue;
    for (std::size_t j = 0; j < i && models[i] == 0; ++j) {
      const Object& other = scene.objects[j];
      const bool bringMotion = object.sequence || other.sequence || object.animation || other.animation;
      if (other.animated() && !bringMotion && object.motion == other.motion) models[i] = models[j];
    }
    if (models[i] == 0) models[i] = ++last;
  }
  return models;
}

}  // namespace lumivox
