// shaders: lists the variants of every program, and prints any of them as GLSL.
#include <fmt/format.h>

#include <algorithm>

#include "command.h"
#include "common/named_texts.h"
#include "lumivox/base/error.h"
#include "lumivox/base/installation.h"
#include "lumivox/experiment/report.h"
#include "lumivox/shader/library.h"

namespace lumivox::command {
namespace {

struct ShadersCommand {
  std::filesystem::path scene, pipeline;
  RunOptions run;
  std::string program, variant;
  bool json = false, keepEverything = false;
};

const char* stageName(gpu::Stage stage) {
  switch (stage) {
    case gpu::Stage::vertex:
      return "vertex";
    case gpu::Stage::geometry:
      return "geometry";
    case gpu::Stage::fragment:
      return "fragment";
    case gpu::Stage::compute:
      return "compute";
  }
  return "";
}

/// "GLOSSY=1 LIGHT=spot"
std::string variantText(const shader::PackedProgram& program, const std::vector<int>& values) {
  const std::string text = program.text(values);
  return text.empty() ? "the only one" : text;
}

/// The values of "--variant a,b": one per axis, in the words of its declaration.
std::vector<int> parseVariant(const shader::PackedProgram& program, const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t start = 0; !text.empty() && start <= text.size();) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    words.push_back(text.substr(start, comma - start));
    start = comma + 1;
  }
  std::vector<std::string> axes;
  for (const shader::Axis& axis : program.axes)
    axes.push_back(fmt::format("{} ({})", axis.name, fmt::join(axis.values, "|")));
  if (words.size() != program.axes.size())
    throw Error(fmt::format("--variant '{}': {} value(s) given; expected one for each axis of '{}': {}", text,
                            words.size(), program.name,
                            axes.empty() ? "it has none" : fmt::format("{}", fmt::join(axes, ", "))));
  std::vector<int> values;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const shader::Axis& axis = program.axes[i];
    const auto found = std::find(axis.values.begin(), axis.values.end(), words[i]);
    if (found == axis.values.end())
      throw Error(fmt::format("--variant: '{}' is not a value of the axis {}; expected one of {}", words[i],
                              axis.name, fmt::join(axis.values, ", ")));
    values.push_back(axis.value(static_cast<std::size_t>(found - axis.values.begin())));
  }
  return values;
}

/// The shader pack of a technique, or the framework's own.
shader::ShaderPack packNamed(const std::string& name, TechniqueSet& techniques) {
  if (const Technique* technique = techniques.technique(name)) return technique->shaders;
  if (std::filesystem::exists(frameworkPack(name))) return shader::readShaderPack(frameworkPack(name));
  for (const SkippedTechnique& skipped : techniques.skipped())
    std::cerr << fmt::format("{}: skipped: {}\n", skipped.library.string(), skipped.reason);
  throw Error(
      fmt::format("no technique '{}'; expected one of {}", name, fmt::join(techniques.available(), ", ")));
}

int printProgram(const ShadersCommand& command, const GlobalOptions& global) {
  const std::size_t slash = command.program.find('/');
  if (slash == std::string::npos)
    throw Error(fmt::format("--print '{}': expected TECHNIQUE/PROGRAM, such as voxel_cone_tracing/gather",
                            command.program));
  TechniqueSet techniques = global.techniqueSet();
  const shader::ShaderPack pack = packNamed(command.program.substr(0, slash), techniques);
  const shader::PackedProgram& program = pack.program(command.program.substr(slash + 1));
  const shader::PackedVariant* chosen = program.variants.empty() ? nullptr : &program.variants.front();
  if (!command.variant.empty() || program.axes.empty()) {
    const std::vector<int> values = parseVariant(program, command.variant);
    chosen = program.find({values});
    if (chosen == nullptr)
      throw Error(fmt::format("{}: the variant {} was not compiled: its shader's constraints exclude it",
                              command.program, variantText(program, values)));
  }
  if (chosen == nullptr) throw Error(command.program + ": has no compiled variant");
  std::string text;
  for (const shader::PackedStage& stage : chosen->stages)
    text += fmt::format("// {}, {}: {}\n{}\n", command.program, stageName(stage.stage),
                        variantText(program, chosen->values), pack.codes.at(stage.code).glsl());
  print(text);
  return kGood;
}

int listPrograms(const ShadersCommand& command, const GlobalOptions& global) {
  const Pipeline pipeline = Pipeline::load(command.pipeline);
  TechniqueSet techniques = global.techniqueSet();
  checkPipeline(pipeline, techniques);
  RenderOptions options = command.run.renderOptions(pipeline);
  options.keepEverything = command.keepEverything;
  const Scene scene = global.loadScene(command.scene);
  const auto device = global.openDevice();
  if (options.width == 0) {
    constexpr int kSmall = 64;  // the needed variants do not depend on the image's size
    const Camera& camera = scene.camera(options.camera);
    std::tie(options.width, options.height) = reducedResolution(camera.width, camera.height, kSmall);
  }
  PipelineExecutor executor(*device, techniques, scene, pipeline, options);
  executor.render(command.run.time, 0, PipelineExecutor::Images::no);

  Json list = Json::array();
  std::vector<std::vector<std::string>> rows{
      {"Program", "Possible", "Compiled", "Needed", "Variants needed"}};
  std::size_t possible = 0, compiled = 0, needed = 0;
  for (const auto& [name, usage] : executor.shaders().usage()) {
    const std::size_t slash = name.find('/');
    const shader::PackedProgram& program =
        executor.shaders().packs().at(name.substr(0, slash)).program(name.substr(slash + 1));
    Json variants = Json::array();
    std::string texts;
    for (const std::vector<int>& values : usage.needed) {
      variants.push_back(variantText(program, values));
      texts += (texts.empty() ? "" : "; ") + variantText(program, values);
    }
    list.push_back({{"program", name},
                    {"possible", usage.possible},
                    {"compiled", usage.compiled},
                    {"needed", variants}});
    rows.push_back({name, fmt::format("{}", usage.possible), fmt::format("{}", usage.compiled),
                    fmt::format("{}", usage.needed.size()), texts});
    possible += usage.possible;
    compiled += usage.compiled;
    needed += usage.needed.size();
  }
  rows.push_back(
      {"all", fmt::format("{}", possible), fmt::format("{}", compiled), fmt::format("{}", needed), ""});
  if (command.json)
    printJson({{"programs", list}, {"possible", possible}, {"compiled", compiled}, {"needed", needed}});
  else
    print(textTable(rows));
  return kGood;
}

}  // namespace

void addShadersCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand(
      "shaders", "lists the shader variants that are possible, compiled and needed, and prints them");
  auto options = std::make_shared<ShadersCommand>();
  takesNames(command->add_option("SCENE", options->scene, "the scene's text or name"), NamedText::scene);
  takesNames(command->add_option("PIPELINE", options->pipeline, "the pipeline's text or name"),
             NamedText::pipeline);
  options->run.addTo(*command);
  command->add_option("--print", options->program,
                      "TECHNIQUE/PROGRAM: print a variant of it as GLSL; needs no scene");
  command->add_option("--variant", options->variant,
                      "the variant for --print: one value per axis, such as 1,0 (default: the first)");
  command->add_flag("--keep-everything", options->keepEverything,
                    "the variants that are needed when nothing is left out");
  command->add_flag("--json", options->json, "print JSON");
  const GlobalOptions& global = commands.global;
  commands.onChosen(command, [=, &global] {
    if (!options->program.empty()) return printProgram(*options, global);
    if (options->pipeline.empty())
      throw Error("shaders: expected SCENE and PIPELINE, or --print TECHNIQUE/PROGRAM");
    return listPrograms(*options, global);
  });
}

}  // namespace lumivox::command
