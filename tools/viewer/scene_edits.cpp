#include "viewer/scene_edits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "lumivox/base/error.h"
#include "lumivox/scene/free_camera.h"

namespace lumivox::viewer {
namespace {

// By as much the scene's own text may exceed 1.
constexpr float kAlbedoSlack = 1e-6f;

/// Removes objects with their triangles and vertices.
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

bool hasKeysOfPower(const Light& light) {
  return light.motion && std::any_of(light.motion->keys.begin(), light.motion->keys.end(),
                                     [](const LightKey& key) { return key.power.has_value(); });
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
  for (const auto& [name, edit] : edits.media) {
    text += "medium " + name;
    if (edit.extinction) text += " extinction " + colour(*edit.extinction);
    if (edit.albedo) text += " albedo " + colour(*edit.albedo);
    if (edit.anisotropy) text += fmt::format(" anisotropy {:a}", *edit.anisotropy);
    text += "\n";
  }
  for (const auto& [name, edit] : edits.cameras) {
    text += "camera " + name;
    const auto point = [&](const char* word, const std::optional<glm::dvec3>& value) {
      if (value) text += fmt::format(" {} {:a} {:a} {:a}", word, value->x, value->y, value->z);
    };
    point("eye", edit.eye);
    point("target", edit.target);
    if (edit.fov) text += fmt::format(" fov {:a}", *edit.fov);
    text += "\n";
  }
  if (edits.environment) text += "environment " + colour(*edits.environment) + "\n";
  return text;
}

}  // namespace

bool moves(const Camera& camera) {
  return !camera.keys.empty() || camera.motion.has_value();
}
bool hasKeysOfFov(const Camera& camera) {
  return std::any_of(camera.keys.begin(), camera.keys.end(),
                     [](const CameraKey& key) { return key.fov.has_value(); });
}
std::string materialName(const Material& material) {
  return material.name.substr(0, material.name.find('@'));
}
std::string areaLightOf(const Material& material) {
  const std::size_t at = material.name.rfind('@');
  return at == std::string::npos ? std::string() : material.name.substr(at + 1);
}

std::vector<EditableLight> editableLights(const Scene& scene) {
  std::vector<EditableLight> lights;
  for (const Light& light : scene.lights)
    lights.push_back({light.name, false, light.power, hasKeysOfPower(light)});
  for (const Material& material : scene.materials) {
    const std::string name = areaLightOf(material);
    if (name.empty() ||
        std::any_of(lights.begin(), lights.end(), [&](const EditableLight& one) { return one.name == name; }))
      continue;
    lights.push_back({name, true, material.emission});
  }
  return lights;
}

std::vector<Material> editableMaterials(const Scene& scene) {
  std::vector<Material> materials;
  for (const Material& material : scene.materials) {
    const bool own = areaLightOf(material).empty();
    const auto known = std::find_if(materials.begin(), materials.end(),
                                    [&](const Material& one) { return one.name == materialName(material); });
    if (known == materials.end()) {
      materials.push_back(material);
      materials.back().name = materialName(material);
      if (!own) materials.back().emission = glm::vec3(0.0f);
    } else if (own) {
      *known = material;
    }
  }
  return materials;
}

std::vector<std::string> partsOf(const Scene& scene) {
  std::vector<std::string> parts;
  const SceneTraits traits = SceneTraits::of(scene);
  if (traits.environment) parts.emplace_back("environment");
  if (traits.glossy) parts.emplace_back("gloss");
  for (const EditableLight& light : editableLights(scene)) parts.push_back("light " + light.name);
  for (const Medium& medium : scene.media) parts.push_back("medium " + medium.name);
  for (const Object& object : scene.objects) parts.push_back("object " + object.name);
  return parts;
}

namespace {

void editMaterials(Scene& scene, const SceneEdits& edits) {
  for (Material& material : scene.materials) {
    const std::string light = areaLightOf(material);
    if (const auto found = edits.materials.find(materialName(material)); found != edits.materials.end()) {
      const MaterialEdit& edit = found->second;
      material.diffuse = edit.diffuse.value_or(material.diffuse);
      material.specular = edit.specular.value_or(material.specular);
      material.exponent = edit.exponent.value_or(material.exponent);
      if (light.empty()) material.emission = edit.emission.value_or(material.emission);
      const glm::vec3 albedo = material.diffuse + material.specular;
      if (std::max({albedo.x, albedo.y, albedo.z}) > 1.0f + kAlbedoSlack)
        throw Error(
            fmt::format("material '{}' reflects more light than it receives; expected diffuse + "
                        "specular of at most 1",
                        materialName(material)));
    }
    if (!light.empty()) {
      if (const auto power = edits.powers.find(light); power != edits.powers.end())
        material.emission = power->second;
      if (edits.off.count("light " + light) != 0) material.emission = glm::vec3(0.0f);
    }
    if (edits.off.count("gloss") != 0) material.specular = glm::vec3(0.0f);
  }
}

void editCameras(Scene& scene, const SceneEdits& edits) {
  for (Camera& camera : scene.cameras) {
    const auto found = edits.cameras.find(camera.name);
    if (found == edits.cameras.end()) continue;
    const CameraEdit& edit = found->second;
    if ((edit.eye || edit.target) && moves(camera))
      throw Error(
          fmt::format("camera '{}' moves: its eye and target are those of its keys and rates; "
                      "expected fov alone",
                      camera.name));
    if (edit.fov && hasKeysOfFov(camera))
      throw Error(
          fmt::format("camera '{}' has keys of its fov; expected an edit of another camera", camera.name));
    camera.eye = edit.eye.value_or(camera.eye);
    camera.target = edit.target.value_or(camera.target);
    camera.fov = edit.fov.value_or(camera.fov);
    snapshotFrom(scene, 0.0, camera);  // throws for a view without a direction
  }
}

}  // namespace

Scene edited(const Scene& scene, const SceneEdits& edits) {
  Scene result = scene;
  if (edits.empty()) return result;
  editMaterials(result, edits);
  editCameras(result, edits);
  for (Light& light : result.lights) {
    const auto found = edits.powers.find(light.name);
    if (found == edits.powers.end()) continue;
    if (hasKeysOfPower(light))
      throw Error(fmt::format("light '{}' has keys of its power; expected an edit of another light, or off",
                              light.name));
    light.power = found->second;
  }
  for (Medium& medium : result.media)
    if (const auto found = edits.media.find(medium.name); found != edits.media.end()) {
      medium.extinction = found->second.extinction.value_or(medium.extinction);
      medium.albedo = found->second.albedo.value_or(medium.albedo);
      medium.anisotropy = found->second.anisotropy.value_or(medium.anisotropy);
    }
  if (edits.environment) {
    result.environment = *edits.environment;
    result.environmentMap = nullptr;
  }
  if (edits.off.count("environment") != 0) {
    result.environment = glm::vec3(0.0f);
    result.environmentMap = nullptr;
  }
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
