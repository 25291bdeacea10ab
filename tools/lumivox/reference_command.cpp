// reference: the path-traced reference.
#include <fmt/format.h>

#include "command.h"
#include "common/display_options.h"
#include "common/named_texts.h"
#include "common/outputs.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/image.h"
#include "lumivox/base/interruption.h"
#include "lumivox/base/log.h"
#include "lumivox/experiment/report.h"
#include "lumivox/reference/moments.h"
#include "lumivox/reference/path_tracer.h"
#include "share_options.h"

namespace lumivox::command {
namespace {

struct ReferenceCommand {
  std::filesystem::path scene, output;
  std::string resolution;
  ReferenceOptions options;
  DisplayOptions display;
  ShareOptions share;
  std::vector<std::filesystem::path> parts;
  bool noCache = false, json = false;
};

constexpr const char* kPartEnding = ".part";

/// Submits the parts of a reference, and a job that merges them.
int shareReference(const ReferenceCommand& command, const Commands& commands) {
  SharedWork work;
  work.name = "reference";
  work.beside = command.output;
  work.dropped = {"-o", "--out"};
  work.task = [](const std::string& folder, std::size_t) {
    return fmt::format("-o {}/\"$SLURM_ARRAY_TASK_ID\"{}", folder, kPartEnding);
  };
  work.merge = [](const std::string& program, const std::string& typed, const std::string& folder) {
    return fmt::format(
        "set -- {1}/*{2}\nfor part; do shift; set -- \"$@\" --merge \"$part\"; done\n"
        "exec {0}{3} \"$@\"\n",
        program, folder, kPartEnding, typed);
  };
  const std::size_t tasks = command.share.tasks > 0 ? command.share.tasks : kTasksUnknown;
  return submitShares(commands, command.share, work, tasks, [](const std::filesystem::path&) {}) ? kGood
                                                                                                 : kNotGood;
}

int reference(ReferenceCommand command, const Commands& commands) {
  const GlobalOptions& global = commands.global;
  command.share.check(commands, "-o with a file of its own for each share", !command.output.empty());
  const bool isPart = command.share.isShare();
  if (isPart && !command.parts.empty())
    throw Error("reference: --shard makes a part and --merge puts parts together; expected one of both");
  const std::string extension = command.output.extension().string();
  Outputs outputs;
  if (isPart)
    outputs.add("-o", command.output, {kPartEnding}, Outputs::Endings::otherKindsRefused);
  else
    outputs.add("-o", command.output, {".exr", ".png"});
  std::vector<std::filesystem::path> inputs = command.parts;
  inputs.push_back(command.scene);
  outputs.check(inputs);
  const std::optional<double> given = command.display.given();
  if (!command.resolution.empty())
    std::tie(command.options.width, command.options.height) = parseResolution(command.resolution);
  command.options.useCache = !command.noCache;
  command.options.progress = !global.quiet;
  const Scene scene = global.loadScene(command.scene);
  scene.camera(command.options.camera);
  outputs.requireUnread();
  if (command.share.slurm) return shareReference(command, commands);
  InterruptionNote interruption;
  interruption.say("interrupted: nothing of a reference is kept before it is done; from the start: " +
                   global.commandLine);
  if (isPart) {
    const Shard shard = command.share.shard();
    renderReferencePart(scene, command.options, shard.index, shard.count, command.output);
    logInformation("{}: part {} of {}", command.output.string(), shard.index, shard.count);
    return kGood;
  }
  LayeredImage reference = !command.parts.empty()     ? mergedReference(scene, command.options, command.parts)
                           : command.options.useCache ? cachedReference(scene, command.options)
                                                      : renderReference(scene, command.options);
  const ImageBuffer full = reference.layers.at("full");
  const ReferenceOptions& options = command.options;
  const double exposure = given ? *given : viewExposure(scene, options);
  if (extension == ".png") {
    writePng(command.output, full, {exposure, command.display.toneCurve()},
             {{kExposureAttribute, exposureNumber(exposure)}});
  } else {
    reference.layers[""] = full;  // the layer that image viewers show first
    reference.attributes["lumivox.command"] = global.commandLine;
    reference.attributes["lumivox.version"] = LUMIVOX_VERSION;
    // Without the scene, a reader of the image cannot tell which surfaces emit, and so cannot compute the
    // exposure.
    reference.attributes[kExposureAttribute] = exposureNumber(exposure);
    writeExr(command.output, reference);
  }
  logInformation("{}: {} x {}, {} samples per pixel, {}", command.output.string(), full.width(),
                 full.height(), options.samplesPerPixel, exposureText(exposure));
  if (command.json) {
    Json layers = Json::array();
    for (const auto& [name, image] : reference.layers)
      if (!name.empty()) layers.push_back(name);
    printJson({{"file", command.output.string()},
               {"width", full.width()},
               {"height", full.height()},
               {"samples_per_pixel", command.options.samplesPerPixel},
               {"layers", layers}});
  }
  return kGood;
}

}  // namespace

void addReferenceCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand("reference", "path-traces the reference of a scene");
  auto all = std::make_shared<ReferenceCommand>();
  ReferenceOptions& options = all->options;
  takesNames(command->add_option("SCENE", all->scene, "the scene's text or name")->required(),
             NamedText::scene);
  command->add_option("-o,--out", all->output, ".exr (every layer and its variance) or .png (full transport)")
      ->required();
  command->add_option("--spp", options.samplesPerPixel, "samples per pixel (default 256)")
      ->check(CLI::Range(2, 1 << 24));
  command->add_option("--bounces", options.bounces, "indirect bounces of the full transport (default 32)")
      ->check(CLI::Range(0, 1 << 16));
  command
      ->add_option(
          "--bounce-layers", options.bounceLayers,
          "numbers of bounces, such as 1,2,4: for each N, layers bounces_N, bounces_N_diffuse and bounces_N_glossy with up to N bounces")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Range(1, 1 << 16));
  addSeed(*command, options.seed, "of the random numbers");
  addTime(*command, options.time);
  command->add_option("--camera", options.camera, "the scene's camera of this name (default: the first)");
  command->add_option("--resolution", all->resolution,
                      "width and height in pixels, such as 640x360 (default: the camera's)");
  addLength(
      *command, "--occlusion-distance", options.occlusionDistance,
      "distance for ambient occlusion, such as 0.5m; without a unit in metres (default: a tenth of the diagonal of the scene's bounds)");
  all->display.addTo(*command);
  command->add_option("--threads", options.threads, "default: all")->check(CLI::Range(0, 4096));
  command->add_flag("--no-cache", all->noCache, "neither read nor write the cache of references");
  addRepeatable(
      *command, "--merge", all->parts,
      "a part that --shard has written, of the same scene and options; may be repeated: the parts give "
      "the image of one run, bit by bit");
  all->share.addTo(*command, "the -o of its own, which ends in .part", /*hasStore=*/false);
  command->add_flag("--json", all->json, "print the file, its size and its layers as JSON");
  commands.onChosen(command, [=, &commands] { return reference(*all, commands); });
}

}  // namespace lumivox::command
