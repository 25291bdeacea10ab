#include "reference/real_scene.h"

#include <algorithm>
#include <set>
#include <string>

namespace lumivox::reference {
namespace {

template <class Named>
std::set<std::string> namesOf(const std::vector<Named>& all) {
  std::set<std::string> names;
  for (const Named& one : all) names.insert(one.name);
  return names;
}

template <class Element>
void append(std::vector<Element>& all, const std::vector<Element>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

void add(Scene& scene, const Scene& real) {
  const auto firstVertex = static_cast<std::uint32_t>(scene.positions.size()),
             firstIndex = static_cast<std::uint32_t>(scene.indices.size());
  const auto firstMaterial = static_cast<int>(scene.materials.size()),
             firstTexture = static_cast<int>(scene.textures.size());
  append(scene.positions, real.positions);
  append(scene.normals, real.normals);
  append(scene.texcoords, real.texcoords);
  append(scene.textures, real.textures);
  for (const std::uint32_t index : real.indices) scene.indices.push_back(firstVertex + index);
  for (Material material : real.materials) {
    if (material.diffuseTexture >= 0) material.diffuseTexture += firstTexture;
    if (material.maskTexture >= 0) material.maskTexture += firstTexture;
    scene.materials.push_back(std::move(material));
  }
  const std::set<std::string> objects = namesOf(scene.objects), lights = namesOf(scene.lights),
                              media = namesOf(scene.media);
  for (Object object : real.objects) {
    if (objects.contains(object.name)) continue;
    object.real = true;
    object.firstVertex += firstVertex;
    for (Part& part : object.parts) {
      part.firstIndex += firstIndex;
      part.material += firstMaterial;
    }
    scene.objects.push_back(std::move(object));
  }
  for (const Light& light : real.lights)
    if (!lights.contains(light.name)) scene.lights.push_back(light);
  for (const Medium& medium : real.media)
    if (!media.contains(medium.name)) scene.media.push_back(medium);
  if (scene.environment == glm::vec3(0.0f)) {
    scene.environment = real.environment;
    scene.environmentMap = real.environmentMap;
  }
}

}  // namespace

bool hasEnvironment(const Scene& scene) {
  return SceneTraits::of(scene).environment ||
         std::any_of(
             scene.captures.begin(), scene.captures.end(), [](const std::shared_ptr<const Capture>& capture) {
               return capture->realScene != nullptr && SceneTraits::of(*capture->realScene).environment;
             });
}

std::optional<Scene> withRealScenes(const Scene& scene) {
  const auto standsForScene = [](const std::shared_ptr<const Capture>& capture) {
    return capture->realScene != nullptr;
  };
  if (std::none_of(scene.captures.begin(), scene.captures.end(), standsForScene)) return std::nullopt;
  Scene merged = scene;
  std::set<ContentHash> hashes;
  for (const auto& capture : scene.captures)
    if (standsForScene(capture) && hashes.insert(capture->realScene->hash).second)
      add(merged, *capture->realScene);
  return merged;
}

}  // namespace lumivox::reference
