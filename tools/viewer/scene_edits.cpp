#include "viewer/scene_edits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace lumivox::viewer {
namespace {

/// Leaves an object's triangles and vertices out.
void removeObjects(Scene& scene, const std::set<std::string>& off) {
  Scene kept;
  std::vector<Object> objects;
  for (const Object& object : scene.objects) {
    if (off.count("object " + object.name) != 0) continue;
    Object moved = object;
    moved.firstVertex = static_cast<std::uint32_t>(kept.positions.size());
    const auto copy = [&](auto& to, const auto& from) {
      const auto first = from.begin() + static_cast<std::ptrdiff_t>(object.firstVertex);
      to.insert(to.end(), first, first + static_cast<std::ptrdiff_t>(object.vertexCount));
    };
    copy(kept.positions, scene.positions);
    copy(kept.normals, scene.normals);
    copy(kept.texcoords, scene.texcoords);
    for (Part& part : moved.parts) {
      const auto first = static_cast<std::uint32_t>(kept.indices.size());
      for (std::uint32_t i = 0; i < part.indexCount; ++i)
        kept.indices.push_back(scene.indices[part.firstIndex + i] - object.firstVertex + moved.firstVertex);
      part.firstIndex = first;
    }
    objects.push_back(std::move(moved));
  }
  scene.positions = std::move(kept.positions);
  scene.normals = std::move(kept.normals);
  scene.texcoords = std::move(kept.texcoords);
  scene.indices = std::move(kept.indices);
  scene.objects = std::move(objects);
}

std::string textOf(const SceneEdits& edits) {
  std::string text;
  const auto colour = [](const glm::vec3& value) {
    return fmt::format("{:a} {:a} {:a}", value.x, value.y, value.z);
  };
  for (const std::string& name : edits.off) text += "off " + name + "\n";
  for (const auto& [name, power] : edits.powers) text += "power " + name + " " + colour(power) + "\n";
  for (const auto& [name, edit] : edits.materials) {
    text += "material " + name;
    if (edit.diffuse) text += " diffuse " + colour(*edit.diffuse);
    if (edit.specular) text += " specular " + colour(*edit.specular);
    if (edit.emission) text += " emission " + colour(*edit.emission);
    if (edit.exponent) text += fmt::format(" exponent {:a}", *edit.exponent);
    text += "\n";
  }
  if (edits.environment) text += "environment " + colour(*edits.environment) + "\n";
  return text;
}

}  // namespace

std::vector<std::string> partsOf(const Scene& scene) {
  std::vector<std::string> parts;
  const SceneTraits traits = SceneTraits::of(scene);
  if (traits.environment) parts.emplace_back("environment");
  if (traits.glossy) parts.emplace_back("gloss");
  for (const Light& light : scene.lights) parts.push_back("light " + light.name);
  for (const Medium& medium : scene.media) parts.push_back("medium " + medium.name);
  for (const Object& object : scene.objects) parts.push_back("object " + object.name);
  return parts;
}

Scene edited(const Scene& scene, const SceneEdits& edits) {
  Scene result = scene;
  if (edits.empty()) return result;
  for (Material& material : result.materials) {
    const auto found = edits.materials.find(material.name);
    if (found != edits.materials.end()) {
      material.diffuse = found->second.diffuse.value_or(material.diffuse);
      material.specular = found->second.specular.value_or(material.specular);
      material.emission = found->second.emission.value_or(material.emission);
      material.exponent = found->second.exponent.value_or(material.exponent);
    }
    if (edits.off.count("gloss") != 0) material.specular = glm::vec3(0.0f);
  }
  for (Light& light : result.lights)
    if (const auto found = edits.powers.find(light.name); found != edits.powers.end())
      light.power = found->second;
  result.environment = edits.environment.value_or(result.environment);
  if (edits.off.count("environment") != 0) result.environment = glm::vec3(0.0f);
  std::erase_if(result.lights,
                [&](const Light& light) { return edits.off.count("light " + light.name) != 0; });
  std::erase_if(result.media,
                [&](const Medium& medium) { return edits.off.count("medium " + medium.name) != 0; });
  if (std::any_of(edits.off.begin(), edits.off.end(),
                  [](const std::string& name) { return name.starts_with("object "); }))
    removeObjects(result, edits.off);
  result.hash = hashOf(scene.hash.text() + "\n" + textOf(edits));
  return result;
}

}  // namespace lumivox::viewer
