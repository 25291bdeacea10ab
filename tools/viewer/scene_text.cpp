// Writes the edits of a scene into its text.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "lumivox/base/error.h"
#include "lumivox/dsl/document.h"
#include "lumivox/scene/text.h"
#include "viewer/scene_edits.h"
#include "viewer/text_items.h"

namespace lumivox::viewer {
namespace {

template <class Vector>
std::string numbers(const Vector& value) {
  return fmt::format("{} {} {}", value.x, value.y, value.z);
}

std::string inQuotes(const std::string& name) {
  dsl::Value value;
  value.kind = dsl::ValueKind::text;
  value.text = name;
  return value.written();
}

/// Splits MESH/OBJECT or MESH/MTL; the second part is empty if there is none.
std::pair<std::string, std::string> meshAndRest(const std::string& name) {
  const std::size_t slash = name.find('/');
  return slash == std::string::npos ? std::pair(name, std::string())
                                    : std::pair(name.substr(0, slash), name.substr(slash + 1));
}

/// The scene's text during the change.
class SceneText {
 public:
  SceneText(const Scene& scene, const SceneEdits& edits)
      : scene_(scene), edits_(edits), result_(edited(scene, edits)) {
    // Parsed without expanding includes, which stay as they are written.
    document_ = dsl::parse(dsl::parseFile(scene.file).source, scene.file);
    if (!document_.findings.empty()) throw DiagnosticsError(document_.findings);
    for (dsl::Item& top : document_.items)
      if (top.block && top.block->word == "scene") items_ = &top.block->items;
    if (items_ == nullptr) throw Error(fmt::format("{}: no block `scene`", scene.file.string()));
  }

  std::string with(const Camera* view) {
    for (const Material& material : editableMaterials(result_)) writeMaterial(material);
    for (const EditableLight& light : editableLights(scene_)) writeLight(light);
    for (const auto& [name, edit] : edits_.media)
      if (isInScene(scene_.media, name)) writeMedium(name, edit);
    for (const auto& [name, edit] : edits_.cameras)
      if (isInScene(scene_.cameras, name)) writeCamera(name, edit);
    writeEnvironment();
    for (const Medium& medium : scene_.media)
      if (edits_.off.count("medium " + medium.name) != 0) remove("medium", medium.name);
    removeObjects();
    if (view != nullptr) addView(*view);
    return dsl::format(document_);
  }

 private:
  template <class Named>
  static bool isInScene(const std::vector<Named>& all, const std::string& name) {
    return std::any_of(all.begin(), all.end(), [&](const Named& one) { return one.name == name; });
  }
  static bool isCalled(const dsl::Item& item, const std::string& word, const std::string& name) {
    return item.block && item.block->word == word &&
           (name.empty() || (!item.block->header.empty() && item.block->header.front().text == name));
  }

  std::vector<dsl::Item>::iterator find(const std::string& word, const std::string& name) {
    return std::find_if(items_->begin(), items_->end(),
                        [&](const dsl::Item& item) { return isCalled(item, word, name); });
  }
  dsl::Block& block(const std::string& word, const std::string& name) {
    const auto found = find(word, name);
    if (found == items_->end())
      throw Error(fmt::format("{}: it has no block `{} {}` itself, so that it cannot be written there",
                              scene_.file.string(), word, name));
    return *found->block;
  }
  void remove(const std::string& word, const std::string& name) {
    block(word, name);  // throws if there is none
    std::erase_if(*items_, [&](const dsl::Item& item) { return isCalled(item, word, name); });
  }

  void writeLight(const EditableLight& light) {
    const bool off = edits_.off.count("light " + light.name) != 0;
    const auto power = edits_.powers.find(light.name);
    if (off && !light.area) {
      remove("light", light.name);
      return removeAnimation(light.name);
    }
    if (!off && power == edits_.powers.end()) return;
    dsl::Block& text = block("light", light.name);
    const std::string kind = text.header.back().text;
    // An area light that is off stays with radiance 0: without it, its surfaces would show their material's
    // own emission.
    replaceProperty(text, fmt::format("{} {}",
                                      kind == "area"          ? "radiance"
                                      : kind == "directional" ? "irradiance"
                                                              : "intensity",
                                      off ? "0" : numbers(power->second)));
  }

  void removeAnimation(const std::string& name) {
    std::erase_if(*items_, [&](const dsl::Item& item) { return isCalled(item, "animate", name); });
  }

  void writeMedium(const std::string& name, const MediumEdit& edit) {
    dsl::Block& text = block("medium", name);
    if (edit.extinction) replaceProperty(text, fmt::format("extinction {} /m", numbers(*edit.extinction)));
    if (edit.albedo) replaceProperty(text, "albedo " + numbers(*edit.albedo));
    if (edit.anisotropy) replaceProperty(text, fmt::format("anisotropy {}", *edit.anisotropy));
  }

  void writeCamera(const std::string& name, const CameraEdit& edit) {
    dsl::Block& text = block("camera", name);
    if (edit.eye) replaceProperty(text, "eye " + numbers(*edit.eye));
    if (edit.target) replaceProperty(text, "target " + numbers(*edit.target));
    if (edit.fov) replaceProperty(text, fmt::format("fov {} rad", *edit.fov));
  }

  void writeEnvironment() {
    if (edits_.off.count("environment") != 0) {
      if (scene_.environment != glm::vec3(0.0f)) remove("environment", {});
    } else if (edits_.environment) {
      // As a whole: a constant radiance takes the place of a map's file.
      std::erase_if(*items_, [](const dsl::Item& item) { return isCalled(item, "environment", {}); });
      items_->push_back(itemOf("environment { radiance " + numbers(*edits_.environment) + " }"));
    }
  }

  /// Writes the properties that differ from the scene's own. A material of a model file becomes one of the
  /// text.
  void writeMaterial(const Material& material) {
    const std::vector<Material> before = editableMaterials(scene_);
    const auto was = std::find_if(before.begin(), before.end(),
                                  [&](const Material& one) { return one.name == material.name; });
    if (was == before.end() || *was == material) return;
    const auto found = find("material", material.name);
    if (found == items_->end()) return addMaterial(material);
    dsl::Block& text = *found->block;
    if (material.diffuse != was->diffuse) replaceProperty(text, "diffuse " + numbers(material.diffuse));
    if (material.specular != was->specular) replaceProperty(text, "specular " + numbers(material.specular));
    if (material.emission != was->emission) replaceProperty(text, "emission " + numbers(material.emission));
    if (material.exponent != was->exponent)
      replaceProperty(text, fmt::format("exponent {}", material.exponent));
  }

  void addMaterial(const Material& material) {
    const auto [mesh, mtl] = meshAndRest(material.name);
    if (mtl.empty()) block("material", material.name);  // throws: the text has no such material
    dsl::Block& text = block("mesh", mesh);
    std::string name = mtl;
    while (find("material", name) != items_->end()) name += "_edited";
    const auto image = [&](const char* word, int texture) -> std::string {
      if (texture < 0) return {};
      // An MTL file names images relative to its own folder.
      std::string file;
      for (const dsl::Item& item : text.items)
        if (item.property && item.property->word == "file") file = item.property->values.front().text;
      const std::filesystem::path folder = std::filesystem::path(file).parent_path();
      return fmt::format(
          "{} {}\n", word,
          inQuotes((folder / scene_.textures[static_cast<std::size_t>(texture)].name).generic_string()));
    };
    dsl::Item use = itemOf(fmt::format("use {{ mtl {} material {} }}", inQuotes(mtl), inQuotes(name)));
    // Inserted before the other `use` blocks, since later ones override it.
    const auto first = std::find_if(text.items.begin(), text.items.end(), [](const dsl::Item& item) {
      return item.block && item.block->word == "use";
    });
    text.items.insert(first, std::move(use));
    items_->insert(
        find("mesh", mesh),
        itemOf(fmt::format("material {} {{\ndiffuse {}\nspecular {}\nexponent {}\nemission {}\n{}{}}}",
                           inQuotes(name), numbers(material.diffuse), numbers(material.specular),
                           material.exponent, numbers(material.emission),
                           image("texture", material.diffuseTexture), image("mask", material.maskTexture))));
  }

  void removeObjects() {
    std::set<std::string> left;
    for (const Object& object : result_.objects) left.insert(meshAndRest(object.name).first);
    for (const Object& object : scene_.objects) {
      if (edits_.off.count("object " + object.name) == 0) continue;
      const auto [mesh, part] = meshAndRest(object.name);
      const bool whole = left.count(mesh) == 0;
      if (!whole) {
        block("mesh", mesh).items.push_back(itemOf("without { part " + inQuotes(part) + " }"));
      } else if (find("mesh", mesh) != items_->end()) {
        remove("mesh", mesh);
      }
      // Also removes the lights and animations of this object.
      std::erase_if(*items_, [&, &object = object, &mesh = mesh](const dsl::Item& item) {
        if (!item.block || item.block->header.empty()) return false;
        std::string target;
        if (item.block->word == "animate") target = item.block->header.front().text;
        if (item.block->word == "light")
          for (const dsl::Item& one : item.block->items)
            if (one.property && one.property->word == "mesh") target = one.property->values.front().text;
        return target == object.name || (whole && !target.empty() && meshAndRest(target).first == mesh);
      });
    }
  }

  void addView(const Camera& camera) {
    std::string text = fmt::format("camera view {{\neye {}\ntarget {}\nup {}\nfov {} rad\nresolution {} {}\n",
                                   numbers(camera.eye), numbers(camera.target), numbers(camera.up),
                                   camera.fov, camera.width, camera.height);
    if (camera.aperture > 0.0) text += fmt::format("aperture {}\nfocus {}\n", camera.aperture, camera.focus);
    std::erase_if(*items_, [](const dsl::Item& item) { return isCalled(item, "camera", "view"); });
    removeAnimation("view");  // the camera stands still
    items_->insert(items_->begin(), itemOf(text + "}"));
  }

  const Scene& scene_;
  const SceneEdits& edits_;
  Scene result_;
  dsl::Document document_;
  std::vector<dsl::Item>* items_ = nullptr;
};

/// Whether two materials look the same.
bool looksAlike(const Scene& a, const Material& one, const Scene& b, const Material& other) {
  const auto sameImage = [&](int first, int second) {
    if ((first < 0) != (second < 0)) return false;
    if (first < 0) return true;
    const SurfaceTexture &x = a.textures[static_cast<std::size_t>(first)],
                         &y = b.textures[static_cast<std::size_t>(second)];
    return x.width == y.width && x.height == y.height && x.mask == y.mask && x.values == y.values;
  };
  return one.diffuse == other.diffuse && one.specular == other.specular &&
         (one.exponent == other.exponent || !one.glossy()) && one.emission == other.emission &&
         sameImage(one.diffuseTexture, other.diffuseTexture) && sameImage(one.maskTexture, other.maskTexture);
}

/// The first visible difference of two scenes, in words; empty if there is none.
std::string differenceOf(const Scene& a, const Scene& b) {
  const auto sameMap = [](const std::shared_ptr<const EnvironmentMap>& x,
                          const std::shared_ptr<const EnvironmentMap>& y) {
    return x == y || (x != nullptr && y != nullptr && *x == *y);
  };
  if (a.environment != b.environment || !sameMap(a.environmentMap, b.environmentMap))
    return "the environment";
  if (a.lights.size() != b.lights.size()) return "the lights";
  for (std::size_t i = 0; i < a.lights.size(); ++i)
    if (a.lights[i].power != b.lights[i].power || a.lights[i].motion != b.lights[i].motion)
      return "light " + a.lights[i].name;
  if (a.media.size() != b.media.size()) return "the media";
  for (std::size_t i = 0; i < a.media.size(); ++i)
    if (a.media[i].extinction != b.media[i].extinction || a.media[i].albedo != b.media[i].albedo ||
        a.media[i].anisotropy != b.media[i].anisotropy)
      return "medium " + a.media[i].name;
  if (a.objects.size() != b.objects.size()) return "the objects";
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    const Object &one = a.objects[i], &other = b.objects[i];
    if (one.name != other.name || one.parts.size() != other.parts.size()) return "object " + one.name;
    for (std::size_t part = 0; part < one.parts.size(); ++part) {
      const Material& material = a.materials[static_cast<std::size_t>(one.parts[part].material)];
      if (!looksAlike(a, material, b, b.materials[static_cast<std::size_t>(other.parts[part].material)]))
        return fmt::format("material {} of object {}", material.name, one.name);
    }
  }
  return {};
}

}  // namespace

std::string textWithEdits(const Scene& scene, const SceneEdits& edits, const Camera* view,
                          const SceneLoadOptions& options) {
  const std::string text = SceneText(scene, edits).with(view);
  const std::string difference = differenceOf(edited(scene, edits), loadSceneText(text, scene.file, options));
  if (!difference.empty())
    throw Error(fmt::format("{}: the text cannot say how {} is edited", scene.file.string(), difference));
  return text;
}

}  // namespace lumivox::viewer
