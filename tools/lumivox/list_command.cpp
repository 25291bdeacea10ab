// list scenes|pipelines|techniques|passes, list parts MODEL
#include <fmt/format.h>

#include <algorithm>

#include "command.h"
#include "common/named_texts.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/dsl/document.h"
#include "lumivox/pipeline/pass.h"
#include "lumivox/scene/model_contents.h"

namespace lumivox::command {
namespace {

namespace fs = std::filesystem;

/// The title of a text: the string in the header of its first block.
std::string titleOf(const fs::path& file) {
  const dsl::Document document = dsl::parse(readFile(file), file);
  for (const dsl::Item& item : document.items)
    if (item.block && !item.block->header.empty()) return item.block->header.front().text;
  return {};
}

/// The texts of the project around the working folder and those installed with the program.
Json texts(NamedText kind) {
  std::error_code failure;
  Json list = Json::array();
  for (const fs::path& file : listedTexts(kind)) {
    const fs::path shown = fs::proximate(file, failure);
    list.push_back({{"name", file.stem().string()},
                    {"title", titleOf(file)},
                    {"file", (failure ? file : shown).string()}});
  }
  return list;
}

Json techniquesList(TechniqueSet& techniques) {
  Json list = Json::array();
  for (const std::string& name : techniques.available()) {
    const Technique* technique = techniques.technique(name);
    if (technique == nullptr) continue;
    list.push_back({{"name", name},
                    {"passes", technique->passes.size()},
                    {"meaning", technique->meaning},
                    {"paper", technique->paper},
                    {"library", technique->library.string()}});
  }
  for (const SkippedTechnique& skipped : techniques.skipped())
    std::cerr << fmt::format("{}: skipped: {}\n", skipped.library.string(), skipped.reason);
  return list;
}

Json passesList(TechniqueSet& techniques) {
  Json list = Json::array();
  for (const std::string& name : techniques.available())
    if (const Technique* technique = techniques.technique(name))
      for (const PassEntry& entry : technique->passes) {
        const std::unique_ptr<Pass> pass = entry.make();
        std::vector<std::string> inputs, outputs;
        for (const InBase* input : pass->inputs()) inputs.push_back(input->name());
        for (const OutBase* output : pass->outputs()) outputs.push_back(output->name());
        list.push_back({{"name", name + "." + entry.name},
                        {"inputs", inputs},
                        {"outputs", outputs},
                        {"meaning", entry.meaning}});
      }
  return list;
}

/// What is in a model file, one row each.
Json contentsList(const fs::path& file) {
  const ModelContents contents = readModelContents(file);
  Json list = Json::array();
  const auto add = [&](const char* kind, const std::string& name, const std::string& what) {
    list.push_back({{"kind", kind}, {"name", name}, {"what", what}});
  };
  for (const ModelContents::ModelPart& part : contents.parts)
    add("part", part.name,
        fmt::format("{} triangles, {} vertices, of {}{}", part.triangles, part.vertices,
                    fmt::join(part.materials, " "),
                    part.isDeforming ? "; deforms"
                    : part.isMoving  ? "; moves"
                                     : ""));
  for (const ModelContents::UsedMaterial& material : contents.materials) {
    const Material& values = material.values;
    const bool hasImage = !material.texture.empty() || !material.mask.empty() || material.hasEmbeddedImages;
    add("material", values.name,
        fmt::format("diffuse {:.3g} {:.3g} {:.3g}, specular {:.3g} {:.3g} {:.3g}, exponent {:.3g}{}{}",
                    values.diffuse.r, values.diffuse.g, values.diffuse.b, values.specular.r,
                    values.specular.g, values.specular.b, values.exponent, values.emissive() ? ", emits" : "",
                    hasImage ? ", images" : ""));
  }
  for (const Camera& camera : contents.cameras)
    add("camera", camera.name,
        fmt::format("at {:.4g} {:.4g} {:.4g} m{}", camera.eye.x, camera.eye.y, camera.eye.z,
                    camera.keys.empty() ? "" : "; moves"));
  for (const Light& light : contents.lights)
    add("light", light.name,
        light.kind == LightKind::directional ? "directional"
        : light.kind == LightKind::point     ? "point"
                                             : "spot");
  for (const ModelContents::Animation& animation : contents.animations)
    add("animation", animation.name, fmt::format("{:.4g} s", animation.duration));
  return list;
}

/// A table for the terminal, with some of the members that the JSON has.
std::string asTable(const Json& list, const std::vector<std::string>& columns) {
  std::vector<std::vector<std::string>> rows{columns};
  for (const Json& entry : list) {
    std::vector<std::string> row;
    for (const std::string& column : columns) {
      const Json& value = entry.at(column);
      if (value.is_string()) {
        row.push_back(value.get<std::string>());
      } else if (value.is_array()) {
        row.push_back(fmt::format("{}", fmt::join(value.get<std::vector<std::string>>(), " ")));
      } else {
        row.push_back(value.dump());
      }
    }
    rows.push_back(std::move(row));
  }
  return textTable(rows);
}

}  // namespace

void addListCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand(
      "list", "lists scenes, pipelines, techniques or passes, or the parts of a model");
  auto what = std::make_shared<std::string>();
  auto model = std::make_shared<fs::path>();
  auto json = std::make_shared<bool>(false);
  command->add_option("WHAT", *what, "scenes, pipelines, techniques, passes, or parts")
      ->required()
      ->check(CLI::IsMember({"scenes", "pipelines", "techniques", "passes", "parts"}));
  command->add_option("MODEL", *model, "with parts: a model file");
  command->add_flag("--json", *json, "print JSON");
  const GlobalOptions& global = commands.global;
  commands.onChosen(command, [=, &global] {
    Json list;
    std::vector<std::string> columns{"name", "title", "file"};
    if ((*what == "parts") == model->empty())
      throw Error(model->empty() ? std::string("list parts: no model; expected its file")
                                 : fmt::format("'{}' behind {}; expected a file behind parts alone",
                                               model->string(), *what));
    if (*what == "parts") {
      list = contentsList(*model);
      columns = {"kind", "name", "what"};
    } else if (*what == "scenes") {
      list = texts(NamedText::scene);
    } else if (*what == "pipelines") {
      list = texts(NamedText::pipeline);
    } else {
      TechniqueSet techniques = global.techniqueSet();
      list = *what == "techniques" ? techniquesList(techniques) : passesList(techniques);
      columns = *what == "techniques" ? std::vector<std::string>{"name", "passes", "meaning"}
                                      : std::vector<std::string>{"name", "inputs", "outputs", "meaning"};
    }
    if (*json)
      printJson(list);
    else
      print(asTable(list, columns));
    return kGood;
  });
}

}  // namespace lumivox::command
