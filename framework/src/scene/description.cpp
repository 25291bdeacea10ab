#include "scene/description.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <unordered_set>

#include "lumivox/dsl/schema.h"
#include "lumivox/scene/medium.h"
#include "lumivox/scene/text.h"
#include "scene/animation_text.h"
#include "scene/block_reader.h"

namespace lumivox {
namespace {

using dsl::Block;
using dsl::BlockSpecification;
using dsl::CheckedBlock;
using dsl::Property;

constexpr double kSmallestParticle = 1e-6;  // m; the volume of smaller ones underflows single precision

const BlockSpecification& specificationOf(const BlockSpecification& outer, const std::string& word) {
  return *std::find_if(outer.blocks.begin(), outer.blocks.end(),
                       [&](const BlockSpecification& one) { return one.word == word; });
}

std::string nameList(const std::vector<std::string>& names) {
  return names.empty() ? "one that is defined; there is none" : "one of " + listed(names);
}

/// Reads a text that the grammar accepts, and checks conditions beyond the tables.
class Reader : private BlockReader {
 public:
  Reader(const dsl::Document& document, std::vector<Diagnostic>& findings)
      : BlockReader(document, findings), grammar_(sceneSpecifications().front()) {}

  SceneDescription run(const Block& scene) {
    result_.name = CheckedBlock(scene, grammar_).name();
    collectNames(scene);
    for (const dsl::Item& item : scene.items) {
      if (!item.block || !known(grammar_, *item.block)) continue;
      checkReferences(*item.block);
      // Blocks that the grammar refused are not checked further.
      std::vector<Diagnostic> refusals;
      dsl::check(document_, *item.block, specificationOf(grammar_, item.block->word), refusals);
      if (!item.block->closed) continue;
      const std::size_t before = findings_.size();
      if (refusals.empty() && !holdsParameters(*item.block))
        read(*item.block);
      else
        readFiles(*item.block);
      if (item.block->word == "mesh" && !result_.meshes.empty() && findings_.size() > before)
        result_.meshes.back().isSound = false;
    }
    // What they name may stand behind them.
    for (const Block* animation : animations_) {
      const BlockSpecification& grammar = specificationOf(grammar_, "animate");
      describeAnimation(*this, checked(*animation), specificationOf(grammar, "key"),
                        targetOf(animation->header.front().text), result_);
    }
    return std::move(result_);
  }

 private:
  struct Names {
    std::vector<std::string> inOrder;
    std::unordered_set<std::string> known;
    void add(const std::string& name) {
      inOrder.push_back(name);
      known.insert(name);
    }
  };

  static bool known(const BlockSpecification& outer, const Block& block) {
    return std::any_of(outer.blocks.begin(), outer.blocks.end(),
                       [&](const BlockSpecification& one) { return one.word == block.word; });
  }

  /// Refuses parameters, which only pipelines have.
  bool holdsParameters(const Block& block) {
    bool found = false;
    const std::function<void(const std::vector<dsl::Value>&)> look =
        [&](const std::vector<dsl::Value>& values) {
          for (const dsl::Value& value : values) {
            if (value.kind == dsl::ValueKind::parameter) {
              found = true;
              report(value.place, value.length, fmt::format("parameter '${}' in a scene", value.text),
                     "a value; only pipelines have parameters");
            }
            look(value.items);
          }
        };
    for (const dsl::Item& item : block.items) {
      if (item.property) look(item.property->values);
      if (item.block && holdsParameters(*item.block)) found = true;
    }
    return found;
  }

  CheckedBlock checked(const Block& block) const { return {block, specificationOf(grammar_, block.word)}; }

  void collectNames(const Block& scene) {
    for (const dsl::Item& item : scene.items) {
      // A block written as a property has its own finding, but its name counts as known.
      if (item.property && !item.property->values.empty()) {
        const std::string& name = item.property->values.front().text;
        if (item.property->word == "material") materialNames_.add(name);
        if (item.property->word == "mesh") meshNames_.add(name);
        if (item.property->word == "capture") captureNames_.add(name);
        if (item.property->word == "camera") cameraNames_.add(name);
      }
      if (!item.block) continue;
      // A misspelt block has its own finding, but its name counts as known.
      std::string word = item.block->word;
      if (!known(grammar_, *item.block))
        word = suggestionFor(findings_, word, {"material", "mesh", "capture", "light", "camera"});
      Names* names = word == "material"  ? &materialNames_
                     : word == "mesh"    ? &meshNames_
                     : word == "capture" ? &captureNames_
                     : word == "camera"  ? &cameraNames_
                     : word == "light"   ? &lightNames_
                                         : nullptr;
      if (names == nullptr) continue;
      const CheckedBlock block(*item.block, specificationOf(grammar_, word));
      if (names == &lightNames_ && block.kind() == "area") names = &areaLightNames_;
      if (!block.name().empty()) names->add(block.name());
    }
  }

  /// `nothing` for an unknown name, and for one of two things.
  AnimationTarget targetOf(const std::string& name) const {
    const bool mesh = meshNames_.known.contains(meshOf(name)), light = lightNames_.known.contains(name),
               camera = cameraNames_.known.contains(name);
    if (mesh + light + camera != 1) return AnimationTarget::nothing;
    return mesh ? AnimationTarget::mesh : light ? AnimationTarget::light : AnimationTarget::camera;
  }

  void checkAnimationTarget(const PlacedText& target) {
    if (targetOf(target.text) != AnimationTarget::nothing) return;
    Names all;
    std::vector<std::string> kinds;
    const auto add = [&](const Names& names, const char* kind, const std::string& name) {
      for (const std::string& one : names.inOrder) all.add(one);
      if (names.known.contains(name)) kinds.emplace_back(kind);
    };
    add(meshNames_, "a mesh", meshOf(target.text));
    add(lightNames_, "a light", target.text);
    add(cameraNames_, "a camera", target.text);
    if (!kinds.empty())
      report(target.place, target.length,
             fmt::format("'{}' is the name of {}", target.text, fmt::join(kinds, " and of ")),
             "a name that only one of them has");
    else if (areaLightNames_.known.contains(target.text))
      report(
          target.place, target.length,
          fmt::format("'{}' is an area light: it moves with its mesh, and its radiance stays", target.text),
          "animate MESH; light that changes with time is that of point, spot and directional lights");
    else if (meshOf(target.text) != target.text)
      checkMeshName(target);  // MESH/OBJECT
    else
      requireKnown(all, "mesh, light or camera", target.text, target);
  }

  /// Checks the names of meshes, materials and captures that a block uses, even if it has other errors.
  void checkReferences(const Block& block) {
    const auto nameIn = [](const Property* property) -> std::optional<PlacedText> {
      if (property == nullptr || property->values.empty()) return std::nullopt;
      const dsl::Value& value = property->values.front();
      if (value.kind != dsl::ValueKind::word && value.kind != dsl::ValueKind::text) return std::nullopt;
      return PlacedText{value.text, value.place, value.length};
    };
    const CheckedBlock outer = checked(block);
    if (block.word == "mesh") {
      if (const auto name = nameIn(outer.find("material"))) checkMaterialName(*name);
      for (const Block* use : outer.blocks("use")) {
        const CheckedBlock inner(*use, specificationOf(specificationOf(grammar_, "mesh"), "use"));
        if (const auto name = nameIn(inner.find("material"))) checkMaterialName(*name);
      }
    } else if (block.word == "camera") {
      if (const auto name = nameIn(outer.find("capture")))
        requireKnown(captureNames_, "capture", name->text, *name);
      if (const auto path = nameIn(outer.find("from"))) checkMeshName(*path);
    } else if (block.word == "light") {
      if (const auto path = nameIn(outer.find("mesh"))) checkMeshName(*path);
    } else if (block.word == "animate" && !block.header.empty()) {
      const dsl::Value& target = block.header.front();
      checkAnimationTarget({target.text, target.place, target.length});
    }
  }

  void read(const Block& block) {
    const CheckedBlock checkedBlock = checked(block);
    if (block.word == "camera") readCamera(checkedBlock);
    if (block.word == "material") readMaterial(checkedBlock);
    if (block.word == "mesh") readMesh(checkedBlock);
    if (block.word == "light") readLight(checkedBlock);
    if (block.word == "environment") readEnvironment(checkedBlock);
    if (block.word == "medium") readMedium(checkedBlock);
    if (block.word == "animate") animations_.push_back(&block);
    if (block.word != "capture") return;
    if (auto capture = describeCapture(*this, checkedBlock)) result_.captures.push_back(std::move(*capture));
  }

  /// Takes the well-written file names of a refused block, so that these files can still be checked.
  void readFiles(const Block& block) {
    const CheckedBlock checkedBlock = checked(block);
    const auto fileIn = [&](const char* word, const std::vector<std::string>& formats) {
      const Property* property = checkedBlock.find(word);
      const bool isFile = property != nullptr && property->values.size() == 1 &&
                          property->values.front().kind == dsl::ValueKind::text &&
                          hasFormat(property->values.front().text, formats);
      return isFile ? std::optional(placed(*property)) : std::nullopt;
    };
    if (block.word == "mesh") {
      MeshText mesh;
      mesh.name = checkedBlock.name();
      mesh.isSound = false;
      if (const auto file = fileIn("file", kModelFormats)) mesh.file = *file;
      result_.meshes.push_back(std::move(mesh));
    } else if (block.word == "material") {
      MaterialText material;
      material.material.name = checkedBlock.name();
      material.texture = fileIn("texture", kImageFormats);
      material.mask = fileIn("mask", kImageFormats);
      result_.materials.push_back(std::move(material));
    } else if (block.word == "medium") {
      MediumText medium;
      medium.place = block.place;
      medium.file = fileIn("file", kVolumeFormats);
      result_.media.push_back(std::move(medium));
    }
  }

  void readCamera(const CheckedBlock& block) {
    Camera camera;
    camera.name = block.name();
    camera.eye = vector(block, "eye", camera.eye);
    camera.target = vector(block, "target", camera.target);
    camera.up = direction(block, "up", camera.up);
    constexpr double kDefaultFov = 0.6981317007977318;  // 40 deg
    camera.fov = block.number("fov", kDefaultFov);
    const std::vector<double> resolution = block.numbers("resolution", {256, 256});
    camera.width = static_cast<int>(resolution.at(0));
    camera.height = static_cast<int>(resolution.at(1));
    if (block.has("capture")) {
      readCapturedView(block, camera);
      return;
    }
    readLens(block, camera);
    if (block.has("from")) {
      readModelView(block, std::move(camera));
      return;
    }
    const BlockSpecification& keyGrammar = specificationOf(specificationOf(grammar_, "camera"), "key");
    const std::vector<const Block*> keys = block.blocks("key");
    bool isWhole = true;
    for (const char* word : {"eye", "target"}) {
      if (block.has(word) || std::any_of(keys.begin(), keys.end(), [&](const Block* key) {
            return CheckedBlock(*key, keyGrammar).has(word);
          }))
        continue;
      isWhole = false;
      report(block.block().place, static_cast<int>(block.block().word.size()),
             fmt::format("block '{}' lacks the property '{}'", block.block().title(), word),
             fmt::format("{} X Y Z, or key blocks", word));
    }
    if (isWhole && keys.empty()) checkView(*this, block.block(), camera.eye, camera.target, camera.up);
    if (isWhole) readCameraKeys(*this, block, keyGrammar, camera);
    if (!camera.keys.empty()) {
      const bool linear = camera.interpolation == Interpolation::linear;
      if (linear || !block.has("eye")) camera.eye = camera.keys.front().eye;
      if (linear || !block.has("target")) camera.target = camera.keys.front().target;
    }
    result_.cameras.push_back(std::move(camera));
  }

  /// A size of 0 means that of the capture's frames.
  void readCapturedView(const CheckedBlock& block, Camera& camera) {
    for (const char* word : {"eye", "target", "up", "fov", "aperture", "focus", "interpolation"}) {
      if (const Property* property = block.find(word))
        report(*property, fmt::format("'{}' of a camera that stands where a capture's stood", word),
               "capture NAME and resolution alone");
    }
    for (const Block* key : block.blocks("key"))
      report(key->place, 3, "'key' of a camera that stands where a capture's stood",
             "capture NAME and resolution alone");
    if (!block.has("resolution")) camera.width = camera.height = 0;
    const auto& names = captureNames_.inOrder;
    const auto found = std::find(names.begin(), names.end(), placed(block, "capture")->text);
    if (found != names.end()) camera.capture = static_cast<int>(found - names.begin());
    result_.cameras.push_back(std::move(camera));
  }

  /// The loader gives it the place and the angle of view of the file's camera.
  void readModelView(const CheckedBlock& block, Camera camera) {
    for (const char* word : {"eye", "target", "up", "fov"}) {
      if (const Property* property = block.find(word))
        report(*property, fmt::format("'{}' of a camera that a model file holds", word),
               "from MESH/CAMERA, resolution, aperture and focus");
    }
    for (const Block* key : block.blocks("key"))
      report(key->place, 3, "'key' of a camera that a model file holds",
             "from MESH/CAMERA, resolution, aperture and focus");
    result_.modelCameras.push_back({result_.cameras.size(), *placed(block, "from")});
    result_.cameras.push_back(std::move(camera));
  }

  void readLens(const CheckedBlock& block, Camera& camera) {
    camera.aperture = block.number("aperture", camera.aperture);
    camera.focus = block.number("focus", camera.focus);
    if (camera.aperture > 0.0 && !block.has("focus"))
      report(*block.find("aperture"), "'aperture' without a plane in focus",
             "focus DISTANCE, such as focus 3 m");
    if (block.has("focus") && !block.has("aperture"))
      report(*block.find("focus"), "'focus' without an aperture: a pinhole has everything in focus",
             "aperture DIAMETER, such as aperture 5 cm");
  }

  void readMaterial(const CheckedBlock& block) {
    MaterialText text;
    text.material.name = block.name();
    text.material.diffuse = vector(block, "diffuse", glm::dvec3(0));
    text.material.specular = vector(block, "specular", glm::dvec3(0));
    text.material.emission = vector(block, "emission", glm::dvec3(0));
    text.material.exponent = static_cast<float>(block.number("exponent", 1.0));
    text.texture = placed(block, "texture");
    text.mask = placed(block, "mask");
    for (const auto& image : {text.texture, text.mask})
      if (image) requireFormat(*image, "image", kImageFormats);
    const glm::vec3 albedo = text.material.diffuse + text.material.specular;
    if (std::max({albedo.x, albedo.y, albedo.z}) > 1.0f + 1e-6f) {
      report(block.block().place, static_cast<int>(block.block().word.size()),
             fmt::format("material '{}' reflects more light than it receives", block.name()),
             "diffuse + specular of at most 1");
    }
    result_.materials.push_back(std::move(text));
  }

  void checkMaterialName(const PlacedText& name) {
    requireKnown(materialNames_, "material", name.text, name);
  }

  void checkMeshName(const PlacedText& path) { requireKnown(meshNames_, "mesh", meshOf(path.text), path); }

  void requireKnown(const Names& names, const char* what, const std::string& name, const PlacedText& at) {
    if (names.known.contains(name)) return;
    report(at.place, at.length, fmt::format("unknown {} '{}'", what, name), nameList(names.inOrder),
           suggestionFor(findings_, name, names.inOrder));
  }

  Selection selection(const CheckedBlock& block) {
    if (!block.has("part") && !block.has("mtl")) {
      report(block.block().place, static_cast<int>(block.block().word.size()),
             fmt::format("block '{}' selects nothing", block.block().word), "part NAME, mtl NAME or both");
    }
    return {placed(block, "part"), placed(block, "mtl"), block.block().place};
  }

  void readMesh(const CheckedBlock& block) {
    MeshText mesh;
    mesh.name = block.name();
    if (mesh.name.find('/') != std::string::npos) {
      report(block.block().header.front().place, block.block().header.front().length,
             fmt::format("the mesh name '{}' contains a '/'", mesh.name),
             "a name without '/', which separates mesh and object");
    }
    if (auto file = placed(block, "file")) mesh.file = *file;
    requireFormat(mesh.file, "model", kModelFormats);
    if (const auto material = placed(block, "material")) mesh.material = material->text;
    const BlockSpecification& grammar = specificationOf(grammar_, "mesh");
    for (const Block* inner : block.blocks("use")) {
      const CheckedBlock use(*inner, specificationOf(grammar, "use"));
      mesh.uses.emplace_back(selection(use), placed(use, "material")->text);
    }
    for (const Block* inner : block.blocks("without")) {
      mesh.without.push_back(selection(CheckedBlock(*inner, specificationOf(grammar, "without"))));
    }
    if (block.has("crease")) mesh.crease = block.number("crease", 0);
    mesh.placement = placement(block);
    readSequence(block, mesh);
    result_.meshes.push_back(std::move(mesh));
  }

  glm::dmat4 placement(const CheckedBlock& block) {
    glm::dmat4 result = glm::translate(glm::dmat4(1.0), vector(block, "translate", glm::dvec3(0)));
    if (block.has("rotate")) {
      const std::vector<double> values = block.numbers("rotate", {});
      result = glm::rotate(result, values.at(3), direction(block, "rotate", {0, 1, 0}));
    }
    return glm::scale(result, vector(block, "scale", glm::dvec3(1)));
  }

  void readSequence(const CheckedBlock& block, MeshText& mesh) {
    const bool hasPattern = mesh.file.text.find('#') != std::string::npos;
    if (!block.has("sequence")) {
      if (hasPattern) {
        report(mesh.file.place, mesh.file.length, "the file name contains '#' but the mesh has no sequence",
               "sequence FIRST..LAST");
      }
      const bool mayMove = hasFormat(mesh.file.text, kGltfFormats);
      for (const char* word : {"rate", "loop", "animation"}) {
        const Property* property = block.find(word);
        if (property == nullptr || (mayMove && property->word != "rate")) continue;
        report(*property, fmt::format("'{}' without a sequence", word),
               property->word == "animation" ? "a glTF file (.gltf or .glb)" : "sequence FIRST..LAST");
      }
      if (const auto animation = placed(block, "animation")) mesh.animation = animation->text;
      mesh.loop = block.flag("loop", true);
      return;
    }
    if (!hasPattern) {
      report(mesh.file.place, mesh.file.length,
             "the file name of a sequence has no place for the frame number",
             "a name such as \"horse_##.obj\"");
    }
    const std::vector<double> range = block.numbers("sequence", {});
    if (hasFormat(mesh.file.text, kGltfFormats) || hasFormat(mesh.file.text, kPlyFormats)) {
      report(mesh.file.place, mesh.file.length, "a sequence of files that are no OBJ files",
             "OBJ files; a glTF file may hold an animation");
    }
    mesh.sequence = MeshText::Sequence{static_cast<int>(range.at(0)), static_cast<int>(range.at(1)),
                                       block.number("rate", 24.0), block.flag("loop", true)};
  }

  void readLight(const CheckedBlock& block) {
    if (block.kind() == "area") {
      const PlacedText mesh = *placed(block, "mesh");
      result_.areaLights.push_back({block.name(), mesh, vector(block, "radiance", glm::dvec3(0))});
      return;
    }
    Light light;
    light.name = block.name();
    if (block.kind() == "directional") {
      light.kind = LightKind::directional;
      light.power = vector(block, "irradiance", glm::dvec3(0));
    } else {
      light.kind = block.kind() == "point" ? LightKind::point : LightKind::spot;
      light.position = vector(block, "position", glm::dvec3(0));
      light.power = vector(block, "intensity", glm::dvec3(0));
    }
    if (light.kind != LightKind::point) light.direction = direction(block, "direction", light.direction);
    if (light.kind == LightKind::spot) {
      light.innerAngle = static_cast<float>(block.number("inner", 0));
      light.outerAngle = static_cast<float>(block.number("outer", 0));
      if (light.innerAngle >= light.outerAngle) {
        report(*block.find("inner"), "the inner angle of the spot is not below the outer one",
               "inner < outer");
      }
    }
    result_.lights.push_back(std::move(light));
  }

  void readEnvironment(const CheckedBlock& block) {
    result_.environment = vector(block, "radiance", glm::dvec3(0));
    EnvironmentText& map = result_.environmentMap;
    map.file = placed(block, "file");
    if (map.file) requireFormat(*map.file, "environment", kEnvironmentFormats);
    const auto length = static_cast<int>(block.block().word.size());
    if (block.has("radiance") == block.has("file"))
      report(
          block.block().place, length,
          map.file ? "an environment of both a constant radiance and a file" : "an environment without light",
          "radiance R G B, or file \"NAME.exr\"");
    for (const char* word : {"rotate", "scale"}) {
      const Property* property = block.find(word);
      if (property != nullptr && !map.file)
        report(*property, fmt::format("'{}' without a file", word), "file \"NAME.exr\"");
    }
    map.scale = block.number("scale", 1.0);
    if (block.has("rotate"))
      map.rotation = glm::dmat3(glm::rotate(glm::dmat4(1.0), block.numbers("rotate", {}).at(3),
                                            direction(block, "rotate", {0, 1, 0})));
  }

  void readMedium(const CheckedBlock& block) {
    MediumText text;
    text.place = block.block().place;
    Medium& medium = text.medium;
    medium.name = block.name();
    medium.extinction = vector(block, "extinction", glm::dvec3(0));
    medium.albedo = vector(block, "albedo", glm::dvec3(0));
    medium.anisotropy = static_cast<float>(block.number("anisotropy", 0));
    medium.particles = static_cast<int>(block.number("particles", 0));
    text.file = placed(block, "file");
    text.grid = placed(block, "grid");
    if (text.file) requireFormat(*text.file, "volume", kVolumeFormats);
    if (text.file && medium.particles > 0) {
      report(*block.find("file"), "a medium both of particles and of a file",
             "one of the two; the other can be a medium of its own");
    }
    readBox(block, medium, text.file.has_value());
    readParticles(block, medium);
    if (!text.file && text.grid) report(*block.find("grid"), "'grid' without a file", "file \"NAME.vdb\"");
    if (result_.media.size() == kMostMedia) {
      report(block.block().place, static_cast<int>(block.block().word.size()), "too many media",
             fmt::format("at most {}", kMostMedia));
    }
    const auto varies = [](const MediumText& one) {
      return one.file.has_value() || one.medium.particles > 0;
    };
    if (varies(text) &&
        std::count_if(result_.media.begin(), result_.media.end(), varies) == kMostVaryingMedia) {
      report(block.block().place, static_cast<int>(block.block().word.size()),
             "too many media of particles and files", fmt::format("at most {}", kMostVaryingMedia));
    }
    result_.media.push_back(std::move(text));
  }

  void readBox(const CheckedBlock& block, Medium& medium, bool isFile) {
    if (!block.has("low") && !block.has("high")) return;
    const Property& given = *block.find(block.has("low") ? "low" : "high");
    if (isFile || medium.particles > 0) {
      report(given, fmt::format("'{}' of a medium that is not even", given.word),
             "corners only without particles and file");
    }
    if (!block.has("low") || !block.has("high")) {
      report(given, fmt::format("'{}' alone", given.word), "both corners, low and high");
      return;
    }
    medium.box.emplace(vector(block, "low", glm::dvec3(0)), vector(block, "high", glm::dvec3(0)));
    if (!glm::all(glm::lessThan(medium.box->first, medium.box->second)))
      report(given, "the corner 'low' is not below 'high'", "low < high along each axis");
  }

  void readParticles(const CheckedBlock& block, Medium& medium) {
    if (medium.particles == 0) {
      for (const char* word : {"source", "spread", "radius", "rise", "drift", "life", "seed"}) {
        if (const Property* property = block.find(word))
          report(*property, fmt::format("'{}' without particles", word), "particles NUMBER");
      }
      return;
    }
    medium.source = vector(block, "source", glm::dvec3(0));
    medium.spread = block.number("spread", 0);
    medium.radius = block.number("radius", 0);
    medium.rise = block.number("rise", 0);
    medium.drift = block.number("drift", 0);
    constexpr double kDefaultLife = 4.0;
    medium.life = block.number("life", kDefaultLife);
    medium.seed = static_cast<std::uint32_t>(block.number("seed", 1));
    if (medium.radius < kSmallestParticle) {
      report(block.block().place, static_cast<int>(block.block().word.size()), "particles without a radius",
             fmt::format("radius of at least {:.6g} m", kSmallestParticle));
    }
  }

  const BlockSpecification& grammar_;
  SceneDescription result_;
  Names materialNames_, meshNames_, captureNames_, cameraNames_;
  Names lightNames_, areaLightNames_;  ///< without and with extent
  std::vector<const Block*> animations_;
};

}  // namespace

SceneDescription describeScene(const dsl::Document& document, std::vector<Diagnostic>& findings) {
  dsl::check(document, sceneSpecifications(), findings);
  for (const dsl::Item& item : document.items) {
    if (item.block && item.block->word == "scene") return Reader(document, findings).run(*item.block);
  }
  return {};
}

}  // namespace lumivox
