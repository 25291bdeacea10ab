// Turns a description into a scene: reads models, assigns materials and lights to parts and motion to
// objects.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <tuple>

#include "dsl/consequences.h"
#include "lumivox/base/error.h"
#include "lumivox/base/findings.h"
#include "lumivox/base/image.h"
#include "lumivox/base/log.h"
#include "lumivox/scene/model_animation.h"
#include "lumivox/scene/scene.h"
#include "lumivox/scene/text.h"
#include "scene/assets.h"
#include "scene/capture_load.h"
#include "scene/description.h"
#include "scene/environment_file.h"
#include "scene/missing_files.h"
#include "scene/model.h"
#include "scene/model_files.h"
#include "scene/texture.h"
#include "scene/volume_file.h"

namespace lumivox {
namespace {

namespace fs = std::filesystem;

void throwIfAny(std::vector<Diagnostic> findings) {
  if (!findings.empty()) throw DiagnosticsError(std::move(findings));
}

class Loader {
 public:
  /// `isWhole`: the text has no findings.
  Loader(const dsl::Document& document, const SceneDescription& description, bool isWhole,
         const AssetSearch& assets, const SceneLoadOptions& options, Purpose purpose)
      : document_(document),
        description_(description),
        isWhole_(isWhole),
        assets_(assets),
        options_(options),
        purpose_(purpose) {
    for (const MaterialText& material : description.materials)
      textMaterials_.emplace(material.material.name, &material);
  }

  Scene run() {
    hasher_.add(document_.source);
    for (const fs::path& file : document_.includedFiles)
      hasher_.add(document_.includedSources.at(file.string()));
    scene_.name = description_.name;
    scene_.file = document_.file;
    scene_.cameras = description_.cameras;
    scene_.lights = description_.lights;
    scene_.environment = description_.environment;
    if (const auto& file = description_.environmentMap.file) attempt(file, [&] { addEnvironment(*file); });
    for (const MediumText& medium : description_.media) attempt(medium.file, [&] { addMedium(medium); });
    for (const MeshText& mesh : description_.meshes) {
      if (!mesh.isSound && !namesOneFile(mesh)) continue;
      if (attempt(mesh.file, [&] { addMesh(mesh); }) && mesh.isSound) read_.insert(mesh.name);
    }
    for (const ModelCameraText& camera : description_.modelCameras) placeCamera(camera);
    for (const AreaLightText& light : description_.areaLights) shine(light);
    finishMaterials();
    for (const CaptureText& capture : description_.captures)
      attempt(capture.source(),
              [&] { scene_.captures.push_back(loadPlacedCapture(capture, assets_, options_, hasher_)); });
    if (isWhole_) sizeCapturedViews(scene_);
    if (isWhole_ && read_.size() == description_.meshes.size()) checkMediaBounds();
    for (const AnimationText& animation : description_.animations) animate(animation);
    throwIfAny(std::move(findings_));
    for (Object& object : scene_.objects) object.sweptBounds = sweptBoundsOf(scene_, object);
    scene_.hash = hasher_.finish();
    return std::move(scene_);
  }

  /// Warnings of a check; valid after run(), also where that threw.
  const std::vector<Diagnostic>& warnings() const { return warnings_; }

 private:
  /// A material in use: of the text or of a model's MTL file; emission may come from an area light.
  struct Use {
    const MaterialText* text = nullptr;
    const ModelMaterial* model = nullptr;
    std::string name;
    std::optional<glm::vec3> emission;
    using Key = std::tuple<const MaterialText*, const ModelMaterial*, bool, float, float, float>;
    Key key() const {
      return Key(text, model, emission.has_value(), emission.value_or(glm::vec3(0)).x,
                 emission.value_or(glm::vec3(0)).y, emission.value_or(glm::vec3(0)).z);
    }
  };

  void report(const PlacedText& place, std::string what, const std::vector<std::string>& known) {
    constexpr std::size_t kShown = 24;
    std::vector<std::string> shown(
        known.begin(), known.begin() + static_cast<std::ptrdiff_t>(std::min(known.size(), kShown)));
    findings_.push_back(document_.finding(place.place, place.length, std::move(what),
                                          known.empty() ? "one that the model has; it has none"
                                                        : fmt::format("one of {}{}", fmt::join(shown, ", "),
                                                                      known.size() > kShown ? ", ..." : ""),
                                          nearestWord(place.text, known)));
  }

  /// Reads a file that the text names at this place. In a check, errors and warnings become findings there.
  /// Returns false after an error.
  template <class Work>
  bool attempt(const std::optional<PlacedText>& file, const Work& work) {
    if (purpose_ == Purpose::rendering) {
      work();
      return true;
    }
    const auto here = [&](std::string what) {
      return document_.finding(file ? file->place : SourcePlace{document_.file.string(), 0, 0},
                               file ? file->length : 1, std::move(what));
    };
    const WarningCollector collector;
    bool good = true;
    try {
      work();
    } catch (const DiagnosticsError& error) {
      findings_.insert(findings_.end(), error.diagnostics().begin(), error.diagnostics().end());
      good = false;
    } catch (const AbsentError&) {  // findMissingFiles() has reported it
      good = false;
    } catch (const Error& error) {
      findings_.push_back(here(error.what()));
      good = false;
    }
    for (Diagnostic warning : collector.findings()) {
      if (warning.place.file.empty()) warning = here(std::move(warning.what));
      warning.severity = Diagnostic::Severity::warning;
      warnings_.push_back(std::move(warning));
    }
    return good;
  }
  bool attempt(const PlacedText& file, const auto& work) { return attempt(std::optional(file), work); }

  int useNumber(Use use) {
    const auto [entry, isNew] = useNumbers_.emplace(use.key(), static_cast<int>(uses_.size()));
    if (isNew) uses_.push_back(std::move(use));
    return entry->second;
  }

  /// A named material may be missing if the text has findings.
  const MaterialText* textMaterial(const std::string& name) const {
    static const MaterialText missing;
    const auto found = textMaterials_.find(name);
    return found == textMaterials_.end() && !isWhole_ ? &missing : textMaterials_.at(name);
  }

  void addEnvironment(const PlacedText& file) {
    auto map = std::make_shared<EnvironmentMap>(readEnvironmentFile(
        assets_.found(file.text, "the environment map"), description_.environmentMap, options_.strict));
    hasher_.add(map->hash.high).add(map->hash.low);
    scene_.environment = map->radiance.front();
    if (isConstant(*map)) return;
    scene_.environment = map->mean();
    scene_.environmentMap = std::move(map);
  }

  void addMedium(const MediumText& text) {
    Medium medium = text.medium;
    if (text.file) {
      medium.volume = std::make_shared<const DensityVolume>(readVolumeFile(
          assets_.found(text.file->text, "volume"), text.grid ? text.grid->text : "", hasher_));
    }
    scene_.media.push_back(std::move(medium));
  }

  /// Refuses a medium that fills the scene if the scene has no bounds.
  void checkMediaBounds() {
    const bool hasTriangles = std::any_of(scene_.objects.begin(), scene_.objects.end(),
                                          [](const Object& object) { return !object.parts.empty(); });
    for (std::size_t i = 0; i < scene_.media.size() && !hasTriangles; ++i) {
      if (!scene_.media[i].homogeneous() || scene_.media[i].box) continue;
      findings_.push_back(document_.finding(description_.media[i].place, 6,
                                            "the medium fills the bounds of a scene that has no triangles",
                                            "corners low and high, or a mesh"));
    }
  }

  void addMesh(const MeshText& mesh) {
    std::vector<fs::path> files;
    for (const std::string& name : fileNames(mesh))
      files.push_back(assets_.found(name, "the model of mesh '" + mesh.name + "'"));
    ModelOptions modelOptions;
    modelOptions.crease = mesh.crease;
    modelOptions.strict = options_.strict;
    modelOptions.animation = mesh.animation;
    modelOptions.loop = mesh.loop;
    modelOptions.needsMaterials = !mesh.material.has_value() && mesh.isSound;
    models_.push_back(std::make_unique<Model>(loadModel(files, modelOptions, hasher_)));
    if (!mesh.isSound) return;
    const Model& model = *models_.back();
    modelsOf_[static_cast<std::size_t>(&mesh - description_.meshes.data())] = models_.back().get();
    requireSelections(mesh, model);

    const std::size_t firstVertex = scene_.positions.size();
    constexpr std::size_t kMost = std::numeric_limits<std::uint32_t>::max();
    if (firstVertex + model.positions.size() > kMost ||
        scene_.indices.size() + model.indices.size() > kMost) {
      throw Error(fmt::format("{}: more than {} vertices or indices; expected fewer", document_.file.string(),
                              kMost));
    }
    scene_.positions.insert(scene_.positions.end(), model.positions.begin(), model.positions.end());
    scene_.normals.insert(scene_.normals.end(), model.normals.begin(), model.normals.end());
    scene_.texcoords.insert(scene_.texcoords.end(), model.texcoords.begin(), model.texcoords.end());
    for (const ModelObject& part : model.objects)
      addObject(mesh, model, part, static_cast<std::uint32_t>(firstVertex));
  }

  void addObject(const MeshText& mesh, const Model& model, const ModelObject& part,
                 std::uint32_t firstVertex) {
    Object object;
    object.name = objectName(mesh, model, part);
    object.firstVertex = firstVertex + part.firstVertex;
    object.vertexCount = part.vertexCount;
    object.placement = mesh.placement * part.placement;
    if (part.animation) {
      object.animation = part.animation->placedBy(mesh.placement);
      object.placement = object.animation->placementAt(0.0);
    }
    for (const Part& run : part.parts) {
      const ModelMaterial& material = model.materials[static_cast<std::size_t>(run.material)];
      if (leftOut(mesh, part.name, material.values.name)) continue;
      const int use = useOf(mesh, part.name, material);
      if (uses_[static_cast<std::size_t>(use)].text == nullptr && material.dissolve < 0.5f) {
        logInformation("{}: {} triangles of material '{}' are left out: its coverage d is {}", mesh.file.text,
                       run.indexCount / 3, material.values.name, material.dissolve);
        continue;
      }
      object.parts.push_back({use, static_cast<std::uint32_t>(scene_.indices.size()), run.indexCount});
      for (std::uint32_t i = 0; i < run.indexCount; ++i) {
        scene_.indices.push_back(model.indices[run.firstIndex + i] + firstVertex);
      }
      // A mirroring placement reverses the winding: reversed here once, it tells the front side in the world.
      if (isMirrored(object)) {
        for (std::size_t i = scene_.indices.size() - run.indexCount; i + 2 < scene_.indices.size(); i += 3)
          std::swap(scene_.indices[i + 1], scene_.indices[i + 2]);
      }
    }
    if (object.parts.empty()) return;
    object.placedBounds = placedBounds(object);
    if (mesh.sequence) object.sequence = sequenceOf(*mesh.sequence, model, part);
    scene_.objects.push_back(std::move(object));
  }

  static bool isMirrored(const Object& object) {
    return glm::determinant(glm::dmat3(object.placement)) < 0.0;
  }

  static std::string objectName(const MeshText& mesh, const Model& model, const ModelObject& part) {
    if (!part.name.empty()) return mesh.name + '/' + part.name;
    // "default" is the group of OBJ faces before the first name.
    return model.objects.size() == 1 ? mesh.name : mesh.name + "/default";
  }

  static VertexSequence sequenceOf(const MeshText::Sequence& text, const Model& model,
                                   const ModelObject& part) {
    VertexSequence sequence;
    sequence.framesPerSecond = text.framesPerSecond;
    sequence.loop = text.loop;
    const auto cut = [&](const std::vector<glm::vec3>& all) {
      const auto first = all.begin() + part.firstVertex;
      return std::vector<glm::vec3>(first, first + part.vertexCount);
    };
    if (model.framePositions.empty()) {  // a sequence of one frame
      sequence.positions.push_back(cut(model.positions));
      sequence.normals.push_back(cut(model.normals));
    }
    for (const auto& frame : model.framePositions) sequence.positions.push_back(cut(frame));
    for (const auto& frame : model.frameNormals) sequence.normals.push_back(cut(frame));
    return sequence;
  }

  static bool selects(const Selection& selection, const std::string& part, const std::string& mtl) {
    return (!selection.part || matches(selection.part->text, part)) &&
           (!selection.mtl || matches(selection.mtl->text, mtl));
  }

  static bool leftOut(const MeshText& mesh, const std::string& part, const std::string& mtl) {
    return std::any_of(mesh.without.begin(), mesh.without.end(),
                       [&](const Selection& one) { return selects(one, part, mtl); });
  }

  int useOf(const MeshText& mesh, const std::string& part, const ModelMaterial& material) {
    const std::string* name = mesh.material ? &*mesh.material : nullptr;
    for (const auto& [selection, wanted] : mesh.uses) {
      if (selects(selection, part, material.values.name)) name = &wanted;
    }
    if (name != nullptr) return useNumber({textMaterial(*name), nullptr, *name, std::nullopt});
    return useNumber({nullptr, &material, mesh.name + '/' + material.values.name, std::nullopt});
  }

  /// Reports selections that select nothing.
  void requireSelections(const MeshText& mesh, const Model& model) {
    if (mesh.uses.empty() && mesh.without.empty()) return;
    std::vector<std::string> parts, mtls;
    std::set<std::string> knownMtls;
    std::vector<std::pair<std::string, std::string>> pairs;
    for (const ModelObject& object : model.objects) {
      parts.push_back(object.name);
      for (const Part& part : object.parts) {
        const std::string& mtl = model.materials[static_cast<std::size_t>(part.material)].values.name;
        if (knownMtls.insert(mtl).second) mtls.push_back(mtl);
        pairs.emplace_back(object.name, mtl);
      }
    }
    const auto requireOne = [&](const Selection& selection) {
      const auto missing = [&](const std::optional<PlacedText>& pattern,
                               const std::vector<std::string>& names, const char* what) {
        if (!pattern) return false;
        if (std::any_of(names.begin(), names.end(),
                        [&](const std::string& name) { return matches(pattern->text, name); }))
          return false;
        report(*pattern, fmt::format("mesh '{}' has no {} '{}'", mesh.name, what, pattern->text), names);
        return true;
      };
      const bool noPart = missing(selection.part, parts, "part"),
                 noMtl = missing(selection.mtl, mtls, "MTL material");
      if (noPart || noMtl || !selection.part || !selection.mtl) return;
      if (std::any_of(pairs.begin(), pairs.end(),
                      [&](const auto& pair) { return selects(selection, pair.first, pair.second); }))
        return;
      report(*selection.mtl,
             fmt::format("part '{}' of mesh '{}' has no MTL material '{}'", selection.part->text, mesh.name,
                         selection.mtl->text),
             mtls);
    };
    for (const auto& use : mesh.uses) requireOne(use.first);
    for (const Selection& without : mesh.without) requireOne(without);
  }

  /// The objects that a path names: a whole mesh, or its objects by name or pattern.
  std::vector<Object*> targets(const PlacedText& path) {
    std::vector<Object*> result;
    std::vector<std::string> known;
    const std::string mesh = meshOf(path.text);
    if (!read_.contains(mesh)) return result;
    const bool whole = mesh == path.text;
    for (Object& object : scene_.objects) {
      if (meshOf(object.name) != mesh) continue;
      if (object.name != mesh) known.push_back(object.name);
      if (whole || matches(path.text, object.name)) result.push_back(&object);
    }
    if (result.empty()) report(path, fmt::format("mesh '{}' has no object '{}'", mesh, path.text), known);
    return result;
  }

  void shine(const AreaLightText& light) {
    for (Object* object : targets(light.mesh)) {
      for (Part& part : object->parts) {
        Use use = uses_[static_cast<std::size_t>(part.material)];
        use.emission = light.radiance;
        if (!light.name.empty()) use.name += '@' + light.name;
        part.material = useNumber(std::move(use));
      }
    }
  }

  /// Only used materials become materials of the scene, so that traits reflect its content.
  void finishMaterials() {
    std::map<int, int> numbers;
    for (Object& object : scene_.objects) {
      for (Part& part : object.parts) {
        const auto [entry, isNew] = numbers.emplace(part.material, static_cast<int>(scene_.materials.size()));
        if (isNew) addMaterial(uses_[static_cast<std::size_t>(part.material)]);
        part.material = entry->second;
      }
    }
  }

  void addMaterial(const Use& use) {
    std::optional<PlacedText> place;
    if (use.text != nullptr) place = use.text->texture ? use.text->texture : use.text->mask;
    if (!attempt(place, [&] { scene_.materials.push_back(materialOf(use)); }))
      scene_.materials.emplace_back();
  }

  Material materialOf(const Use& use) {
    Material material = use.text != nullptr ? use.text->material : use.model->values;
    material.name = use.name;
    if (use.emission) material.emission = *use.emission;
    if (use.text != nullptr) {
      if (use.text->texture) {
        const std::string& name = use.text->texture->text;
        material.diffuseTexture =
            texture(assets_.found(name, "the image of material '" + use.name + "'"), name, false);
      }
      if (use.text->mask) {
        const std::string& name = use.text->mask->text;
        material.maskTexture =
            texture(assets_.found(name, "the mask of material '" + use.name + "'"), name, true);
      }
    } else {
      const ModelMaterial& model = *use.model;
      if (model.diffuse.present())
        material.diffuseTexture = modelTexture(model, "map_Kd", model.diffuse, false);
      if (model.mask.present()) material.maskTexture = modelTexture(model, "map_d", model.mask, true);
    }
    return material;
  }

  int modelTexture(const ModelMaterial& model, const char* statement, const ModelImage& image, bool mask) {
    if (image.bytes == nullptr) requireImage(model, statement, image);
    return texture(image.file, image.name, mask, mask ? model.dissolve : 1.0f, image.bytes,
                   model.masksByAlphaOnly);
  }

  /// Each image is read once for each use of it. `bytes`: of an embedded image.
  int texture(const fs::path& file, const std::string& name, bool mask, float coverage = 1.0f,
              const std::shared_ptr<const std::string>& bytes = nullptr, bool byAlphaOnly = false) {
    const auto [entry, isNew] =
        textures_.emplace(std::tuple(file.lexically_normal(), mask, coverage, mask && byAlphaOnly),
                          static_cast<int>(scene_.textures.size()));
    if (!isNew) return entry->second;
    const ByteImage pixels =
        bytes == nullptr ? readHashedImage(file, hasher_) : decodeByteImage(*bytes, file);
    SurfaceTexture image = mask ? maskTextureOf(pixels, name, byAlphaOnly) : diffuseTextureOf(pixels, name);
    if (coverage != 1.0f) {
      for (float& value : image.values) value *= coverage;
    }
    scene_.textures.push_back(std::move(image));
    return entry->second;
  }

  /// Gives a camera of the text the place and the motion of a model's.
  void placeCamera(const ModelCameraText& text) {
    const std::string mesh = meshOf(text.from.text);
    if (!read_.contains(mesh)) return;
    std::vector<std::string> known;
    for (std::size_t i = 0; i < description_.meshes.size(); ++i) {
      if (description_.meshes[i].name != mesh) continue;
      for (const ModelCamera& camera : modelsOf_.at(i)->cameras) {
        known.push_back(mesh + '/' + camera.name);
        if (known.back() != text.from.text) continue;
        placeLike(camera, description_.meshes[i].placement, scene_.cameras[text.camera]);
        return;
      }
    }
    report(text.from, fmt::format("mesh '{}' has no camera '{}'", mesh, text.from.text), known);
  }

  void animate(const AnimationText& animation) {
    const std::vector<Object*> objects = targets(animation.target);
    RigidMotion motion = animation.motion;
    if (!animation.hasPivot) motion.pivot = centreOf(objects);
    for (Object* object : objects) {
      if (object->motion) {
        findings_.push_back(document_.finding(animation.target.place, animation.target.length,
                                              fmt::format("object '{}' is animated twice", object->name),
                                              "one motion for each object"));
        return;
      }
    }
    for (Object* object : objects) object->motion = motion;
  }

  std::pair<glm::dvec3, glm::dvec3> placedBounds(const Object& object) const {
    glm::dvec3 low(std::numeric_limits<double>::max()), high(std::numeric_limits<double>::lowest());
    for (const Part& part : object.parts) {
      for (std::uint32_t i = part.firstIndex; i < part.firstIndex + part.indexCount; ++i) {
        const glm::dvec3 p(object.placement *
                           glm::dvec4(glm::dvec3(scene_.positions[scene_.indices[i]]), 1.0));
        low = glm::min(low, p);
        high = glm::max(high, p);
      }
    }
    return {low, high};
  }

  static glm::dvec3 centreOf(const std::vector<Object*>& objects) {
    glm::dvec3 low(std::numeric_limits<double>::max()), high(std::numeric_limits<double>::lowest());
    for (const Object* object : objects) {
      low = glm::min(low, object->placedBounds->first);
      high = glm::max(high, object->placedBounds->second);
    }
    return objects.empty() ? glm::dvec3(0) : 0.5 * (low + high);
  }

  const dsl::Document& document_;
  const SceneDescription& description_;
  const bool isWhole_;
  const AssetSearch& assets_;
  const SceneLoadOptions& options_;
  Purpose purpose_;
  Scene scene_;
  Hasher hasher_;
  std::vector<std::unique_ptr<Model>> models_;    // uses_ points into them
  std::map<std::size_t, const Model*> modelsOf_;  // by the number of the mesh block
  std::vector<Use> uses_;
  std::map<Use::Key, int> useNumbers_;                        // into uses_
  std::map<std::string, const MaterialText*> textMaterials_;  // the first of each name
  std::map<std::tuple<fs::path, bool, float, bool>, int> textures_;
  std::set<std::string> read_;  // meshes whose files were good
  std::vector<Diagnostic> findings_, warnings_;
};

}  // namespace

namespace {

Scene loadDocument(const dsl::Document& document, const SceneLoadOptions& options) {
  const AssetSearch assets(document.file, options);
  std::vector<Diagnostic> findings = document.findings;
  const SceneDescription description = describeScene(document, findings);
  if (!options.mayHoldCaptures) {
    for (const CaptureText& capture : description.captures)
      findings.push_back(document.finding(capture.place, 7,
                                          "a capture within the scene that a capture stands for",
                                          "a scene of triangles and lights"));
  }
  findMissingFiles(document, description, assets, Purpose::rendering, findings);
  dsl::dropConsequences(document, findings);
  throwIfAny(std::move(findings));
  return Loader(document, description, true, assets, options, Purpose::rendering).run();
}

}  // namespace

void checkScene(const fs::path& file, const SceneLoadOptions& options) {
  const dsl::Document document = dsl::parseFile(file);
  const AssetSearch assets(file, options);
  std::vector<Diagnostic> findings = document.findings;
  const SceneDescription description = describeScene(document, findings);
  const bool isWhole = findings.empty();
  findMissingFiles(document, description, assets, Purpose::checking, findings);
  // With more findings than are shown, files are not checked.
  if (isWhole || findings.size() <= kMostFindingsShown) {
    Loader loader(document, description, isWhole, assets, options, Purpose::checking);
    try {
      loader.run();
    } catch (const DiagnosticsError& error) {
      findings.insert(findings.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
    for (const Diagnostic& warning : loader.warnings()) logFinding(warning);
  }
  dsl::dropConsequences(document, findings);
  throwIfAny(std::move(findings));
}

Scene loadScene(const fs::path& file, const SceneLoadOptions& options) {
  return loadDocument(dsl::parseFile(file), options);
}

Scene loadSceneText(std::string text, const fs::path& file, const SceneLoadOptions& options) {
  dsl::Document document = dsl::parse(std::move(text), file);
  dsl::resolveIncludes(document);
  return loadDocument(document, options);
}

}  // namespace lumivox
