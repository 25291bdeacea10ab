// import: writes a scene text around a model file.
#include <fmt/format.h>

#include <numbers>
#include <set>

#include "command.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/dsl/document.h"
#include "lumivox/scene/model_contents.h"

namespace lumivox::command {
namespace {

namespace fs = std::filesystem;

constexpr double kDegrees = 180.0 / std::numbers::pi;

/// A name as texts write it: plain, or in quotes.
std::string written(const std::string& name) {
  const auto isLetter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  bool isPlain = !name.empty() && isLetter(name.front());
  for (const char c : name) isPlain = isPlain && (isLetter(c) || (c >= '0' && c <= '9'));
  return isPlain ? name : '"' + name + '"';
}

std::string written(const glm::dvec3& v) {
  return fmt::format("{:.7g} {:.7g} {:.7g}", v.x, v.y, v.z);
}

class SceneWriter {
 public:
  SceneWriter(const ModelContents& contents, const fs::path& model, const fs::path& output)
      : contents_(contents), model_(model), folder_(output.parent_path()) {
    // A name without the letter that separates mesh and object.
    mesh_ = model.filename().string();
    mesh_ = mesh_.substr(0, mesh_.find('.'));
    if (mesh_.empty()) mesh_ = "model";
  }

  std::string run() {
    text_ = fmt::format("# Written by `lumivox import` from {}.\nscene \"{}\" {{\n",
                        model_.filename().string(), mesh_);
    writeCameras();
    for (const ModelContents::UsedMaterial& material : contents_.materials) writeMaterial(material);
    writeMesh();
    for (const Light& light : contents_.lights) writeLight(light);
    const bool isLit = !contents_.lights.empty() || hasEmission_;
    if (!isLit) text_ += "# The file has no light.\nenvironment { radiance 1 }\n";
    text_ += "}\n";
    return dsl::format(dsl::parse(std::move(text_), model_));
  }

 private:
  void writeCameras() {
    for (const Camera& camera : contents_.cameras) {
      if (!camera.keys.empty())
        text_ += fmt::format("camera {} {{ from {}  resolution 960 540 }}\n", written(camera.name),
                             written(mesh_ + '/' + camera.name));
      else
        text_ += fmt::format("camera {} {{ eye {}  target {}  up {}  fov {:.6g} deg  resolution 960 540 }}\n",
                             written(camera.name), written(camera.eye), written(camera.target),
                             written(camera.up), camera.fov * kDegrees);
    }
    if (!contents_.cameras.empty()) return;
    const auto& [low, high] = contents_.bounds;
    const glm::dvec3 centre = 0.5 * (low + high);
    // A view of 40 degrees from this distance holds the sphere around the bounds.
    const double distance = std::max(0.5 * glm::length(high - low) / std::sin(20.0 / kDegrees), 1e-3);
    text_ += fmt::format(
        "# The file has no camera; this one sees all of it.\ncamera main {{ eye {}  target {}  "
        "resolution 960 540 }}\n",
        written(centre + distance * glm::normalize(glm::dvec3(0.5, 0.35, 1.0))), written(centre));
  }

  std::string relative(const fs::path& file) const {
    std::error_code failure;
    const fs::path result = fs::proximate(file, folder_.empty() ? fs::path(".") : folder_, failure);
    return (failure ? file : result).generic_string();
  }

  void writeMaterial(const ModelContents::UsedMaterial& material) {
    const Material& values = material.values;
    hasEmission_ = hasEmission_ || values.emissive();
    const bool isHole = material.coverage < 0.5f && material.mask.empty();
    if (material.hasEmbeddedImages || isHole || (material.coverage != 1.0f && !material.mask.empty())) {
      text_ += fmt::format("# Material {} stays in the file: {}.\n", written(values.name),
                           material.hasEmbeddedImages ? "its images are there"
                           : isHole                   ? "it is a hole"
                                                      : "its mask has a cut-off of its own");
      return;
    }
    text_ +=
        fmt::format("material {} {{ diffuse {}  ", written(values.name), written(glm::dvec3(values.diffuse)));
    if (values.glossy())
      text_ += fmt::format("specular {}  exponent {:.6g}  ", written(glm::dvec3(values.specular)),
                           values.exponent);
    if (values.emissive()) text_ += fmt::format("emission {}  ", written(glm::dvec3(values.emission)));
    if (!material.texture.empty()) text_ += fmt::format("texture \"{}\"  ", relative(material.texture));
    if (!material.mask.empty()) text_ += fmt::format("mask \"{}\"  ", relative(material.mask));
    text_ += "}\n";
    replaced_.push_back(values.name);
  }

  void writeMesh() {
    text_ += fmt::format("mesh {} {{\nfile \"{}\"\n", written(mesh_), relative(model_));
    for (const std::string& name : replaced_)
      text_ += fmt::format("use {{ mtl {}  material {} }}\n", written(name), written(name));
    text_ += "}\n";
  }

  void writeLight(const Light& light) {
    constexpr const char* kKinds[] = {"directional", "point", "spot"};
    text_ +=
        fmt::format("light {} {} {{ ", written(light.name), kKinds[static_cast<std::size_t>(light.kind)]);
    if (light.kind != LightKind::directional) text_ += fmt::format("position {}  ", written(light.position));
    if (light.kind != LightKind::point) text_ += fmt::format("direction {}  ", written(light.direction));
    text_ += fmt::format("{} {}  ", light.kind == LightKind::directional ? "irradiance" : "intensity",
                         written(glm::dvec3(light.power)));
    if (light.kind == LightKind::spot)
      text_ += fmt::format("inner {:.6g} deg  outer {:.6g} deg  ",
                           static_cast<double>(light.innerAngle) * kDegrees,
                           static_cast<double>(light.outerAngle) * kDegrees);
    text_ += "}\n";
  }

  const ModelContents& contents_;
  const fs::path& model_;
  fs::path folder_;
  std::string mesh_, text_;
  std::vector<std::string> replaced_;
  bool hasEmission_ = false;
};

}  // namespace

void addImportCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand(
      "import", "writes a scene text around a model: its cameras, lights and materials by name");
  auto model = std::make_shared<fs::path>();
  auto output = std::make_shared<fs::path>();
  command->add_option("FILE", *model, "model: .gltf, .glb, .obj or .ply")->required();
  command->add_option("-o,--output", *output, "the scene text")->required();
  const GlobalOptions& global = commands.global;
  commands.onChosen(command, [=, &global] {
    if (output->extension() != ".scene")
      throw Error(fmt::format("{}: is no name of a scene text; expected one that ends with .scene",
                              output->string()));
    const ModelContents contents = readModelContents(*model);
    createParentDirectories(*output);
    writeFileAtomically(*output, SceneWriter(contents, *model, *output).run());
    if (!global.quiet)
      print(fmt::format("{}: {} parts, {} materials, {} cameras, {} lights\n", output->string(),
                        contents.parts.size(), contents.materials.size(), contents.cameras.size(),
                        contents.lights.size()));
    return kGood;
  });
}

}  // namespace lumivox::command
