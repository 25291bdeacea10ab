// render: images alone.
#include <fmt/format.h>

#include <cmath>

#include "command.h"
#include "lumivox/base/background_writer.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/image.h"
#include "lumivox/base/interruption.h"
#include "lumivox/base/log.h"
#include "lumivox/experiment/report.h"
#include "lumivox/measure/metrics.h"

namespace lumivox::command {
namespace {

namespace fs = std::filesystem;

struct RenderCommand {
  fs::path scene, pipeline, output;
  RunOptions run;
  std::string frames, onlyOutput;
  double framesPerSecond = 24.0;
  int accumulate = 0;  ///< frames an image; 0: each is made alone
  bool keepEverything = false, health = false, checkReads = false, json = false;
};

/// The frame that is shown at one time, after the frames that it accumulates. Findings are those of all of
/// them.
FrameResult renderShown(const RenderCommand& command, PipelineExecutor& executor, double time, int frame,
                        Progress& progress) {
  std::vector<std::string> health, reads, notes;
  const auto collect = [](std::vector<std::string>& all, std::vector<std::string>& more) {
    all.insert(all.end(), more.begin(), more.end());
  };
  const int count = std::max(command.accumulate, 1);
  for (int i = 1;; ++i) {
    FrameResult result = executor.render(
        time, frame, i == count ? PipelineExecutor::Images::yes : PipelineExecutor::Images::no);
    collect(health, result.healthFindings);
    collect(reads, result.readsFindings);
    collect(notes, result.notes);
    progress.advance();
    if (i < count) continue;
    result.healthFindings = std::move(health);
    result.readsFindings = std::move(reads);
    result.notes = std::move(notes);
    return result;
  }
}

ImageBuffer mainImage(const RenderCommand& command, const FrameResult& frame) {
  if (command.onlyOutput.empty()) return compositeImage(frame);
  const auto found = frame.outputs.find(command.onlyOutput);
  return found == frame.outputs.end() ? ImageBuffer{} : found->second;
}

void writeFrame(const RenderCommand& command, const fs::path& file, FrameResult frame,
                const std::map<std::string, std::string>& attributes) {
  ImageBuffer main = mainImage(command, frame);
  if (file.extension() == ".png") {
    if (main.empty()) throw Error("the pipeline has no output that is a radiance; name one with --output");
    writePng(file, main, main.channels() == 1 ? 1.0f : displayExposure(main));
    return;
  }
  LayeredImage layered;
  layered.attributes = attributes;
  if (command.onlyOutput.empty())
    for (auto& [name, image] : frame.outputs)
      if (!image.empty()) layered.layers[name] = std::move(image);
  if (!main.empty()) layered.layers[""] = std::move(main);
  writeExr(file, layered);
}

int render(const RenderCommand& command, const GlobalOptions& global) {
  const std::string extension = command.output.extension().string();
  if (extension != ".exr" && extension != ".png")
    throw Error(fmt::format("{}: unknown kind of image; expected a name that ends in .exr or .png",
                            command.output.string()));
  if (!(command.framesPerSecond > 0.0) || !std::isfinite(command.framesPerSecond))
    throw Error("--fps: expected a number above 0");
  const bool animation = !command.frames.empty();
  const auto [first, last] = animation ? parseFrames("--frames", command.frames) : std::pair(0, 0);
  for (const int frame : {first, last})
    requireWritable(animation ? numberedName(command.output, frame) : command.output);

  const Pipeline pipeline = Pipeline::load(command.pipeline);
  RenderOptions options = command.run.renderOptions(pipeline);
  options.keepEverything = command.keepEverything;
  options.health = command.health;
  options.accumulate = command.accumulate > 0;
  options.checkReads = command.checkReads;
  if (!command.onlyOutput.empty()) {
    std::vector<std::string> names;
    for (const Pipeline::Output& output : pipeline.outputs) names.push_back(output.name);
    if (std::find(names.begin(), names.end(), command.onlyOutput) == names.end()) {
      const std::string nearest = nearestWord(command.onlyOutput, names);
      throw Error(fmt::format("--output '{}': not an output of {}; expected one of {}{}", command.onlyOutput,
                              command.pipeline.string(), fmt::join(names, ", "),
                              nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
    }
    options.wanted = {command.onlyOutput};
  }
  TechniqueSet techniques = global.techniqueSet();
  checkPipeline(pipeline, techniques);
  const Scene scene = global.loadScene(command.scene);
  const auto device = global.openDevice();
  PipelineExecutor executor(*device, techniques, scene, pipeline, options);

  std::size_t findings = 0;
  Json images = Json::array(), found = Json::array();
  InterruptionNote interruption;
  interruption.say("interrupted before the first image was written");
  BackgroundWriter writer;
  Progress progress("rendering",
                    static_cast<std::uint64_t>(last - first + 1) *
                        static_cast<std::uint64_t>(std::max(command.accumulate, 1)),
                    "frames");
  for (int frame = first; frame <= last; ++frame) {
    const double time = command.run.time + (animation ? frame / command.framesPerSecond : 0.0);
    FrameResult result = renderShown(command, executor, time, frame, progress);
    for (const auto* list : {&result.healthFindings, &result.readsFindings}) {
      for (const std::string& finding : *list) {
        logMessage(LogLevel::quiet, (animation ? fmt::format("frame {}: ", frame) : std::string()) + finding);
        found.push_back({{"frame", frame}, {"finding", finding}});
      }
      findings += list->size();
    }
    for (const std::string& note : result.notes) logInformation("{}", note);
    const fs::path file = animation ? numberedName(command.output, frame) : command.output;
    auto attributes = provenance(global, scene, pipeline, options, *device, time);
    if (animation) attributes["lumivox.frame"] = fmt::format("{}", frame);
    if (command.accumulate > 0) attributes["lumivox.accumulate"] = fmt::format("{}", command.accumulate);
    logInformation("{}: {:.1f} ms", file.string(), result.frameMs);
    images.push_back(
        {{"file", file.string()}, {"frame", frame}, {"time", time}, {"frame_ms", result.frameMs}});
    writer.submit([&, frame, file, end = last, made = std::move(result),
                   attributes = std::move(attributes)]() mutable {
      writeFrame(command, file, std::move(made), attributes);
      if (frame < end)
        interruption.say(fmt::format("interrupted: images up to {} are kept; to go on: --frames {}..{} in {}",
                                     file.string(), frame + 1, end, global.commandLine));
    });
  }
  writer.finish();
  if (command.json) printJson({{"images", images}, {"findings", found}});
  return findings == 0 ? kGood : kNotGood;
}

}  // namespace

void addRenderCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand("render", "renders a scene with a pipeline into images");
  auto options = std::make_shared<RenderCommand>();
  command->add_option("SCENE", options->scene, "the scene's text")->required();
  command->add_option("PIPELINE", options->pipeline, "the pipeline's text")->required();
  command
      ->add_option("-o,--out", options->output,
                   "the image: .exr (every output as a layer, the whole image as the main layer) or .png "
                   "(the whole image)")
      ->required();
  options->run.addTo(*command);
  command->add_option("--frames", options->frames,
                      "FIRST..LAST: numbered images, out_0007.exr or a run of # in the name");
  command->add_option("--fps", options->framesPerSecond, "frames per second of --frames (default 24)");
  command->add_option("--output", options->onlyOutput, "only this output of the pipeline, as the main layer");
  command->add_flag("--keep-everything", options->keepEverything, "leave nothing out");
  command->add_flag("--health", options->health,
                    "scan every output of every pass for NaN, Inf and negative values");
  command
      ->add_option(
          "--accumulate", options->accumulate,
          "N: every image is the last of N frames at its time, and every frame finds what passes left "
          "in the one before; with --frames from image to image too (default: every frame alone)")
      ->check(CLI::Range(1, 1 << 20));
  command->add_flag(
      "--check-reads", options->checkReads,
      "for authors of techniques: make every frame a second time from scratch, and name passes whose "
      "Reads, Needs or uses() leave out what they depend on");
  command->add_flag("--json", options->json, "print the images' files, times and findings as JSON");
  const GlobalOptions& global = commands.global;
  commands.onChosen(command, [=, &global] { return render(*options, global); });
}

}  // namespace lumivox::command
