// render: images alone.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "command.h"
#include "common/display_options.h"
#include "common/named_texts.h"
#include "common/outputs.h"
#include "lumivox/base/background_writer.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/image.h"
#include "lumivox/base/interruption.h"
#include "lumivox/base/log.h"
#include "lumivox/base/video.h"
#include "lumivox/experiment/report.h"
#include "lumivox/measure/exposure.h"
#include "lumivox/page/contact_sheet.h"
#include "lumivox/scene/free_camera.h"
#include "lumivox/scene/text.h"

namespace lumivox::command {
namespace {

namespace fs = std::filesystem;

struct RenderCommand {
  fs::path scene, pipeline, output, sheet, video;
  RunOptions run;
  std::vector<double> eye, target;  ///< replace the camera's; empty: the camera's
  double fov = 0.0;                 ///< rad; 0: the camera's
  DisplayOptions display;
  std::string frames, onlyOutput;
  double framesPerSecond = 24.0;
  int accumulate = 0;  ///< frames per image; 0: no accumulation
  int subpixels = 0;   ///< sample positions per pixel; 0: positions() chooses
  bool keepEverything = false, health = false, checkReads = false, json = false;

  bool isAnimation() const { return !frames.empty(); }
  double timeOf(int frame) const { return run.time + (isAnimation() ? frame / framesPerSecond : 0.0); }
  fs::path fileOf(int frame) const { return isAnimation() ? numberedName(output, frame) : output; }
  bool movesCamera() const { return !eye.empty() || !target.empty() || fov > 0.0; }
  /// Whether the command writes an image for display.
  bool displays() const { return output.extension() == ".png" || !sheet.empty() || !video.empty(); }
  /// Sample positions per pixel that an image averages. An EXR file holds the values of one frame unless
  /// --subpixels says otherwise, and accumulated frames must share one camera position.
  int positions() const {
    constexpr int kSmooth = 4;
    if (subpixels > 0) return subpixels;
    return output.extension() == ".exr" || accumulate > 0 ? 1 : kSmooth;
  }
};

/// The frame that is shown at one time, after the frames that it accumulates, with the findings of them all.
FrameResult renderShown(const RenderCommand& command, PipelineExecutor& executor, const Scene& scene,
                        int frame, Progress& progress) {
  const double time = command.timeOf(frame);
  if (const int positions = command.positions(); positions > 1) {
    const auto [width, height] = command.run.size();
    FrameResult result = experiment::renderFiltered(
        executor, snapshotOf(scene, time, command.run.camera, width, height), positions, frame);
    progress.advance();
    return result;
  }
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

ImageBuffer requireImage(const RenderCommand& command, const FrameResult& frame) {
  ImageBuffer main = mainImage(command, frame);
  if (main.empty()) throw Error("the pipeline has no output that is a radiance; name one with --output");
  return main;
}

/// At most `most` frames, spread evenly over the sequence, including both ends.
std::set<int> spread(int first, int last, int most) {
  std::set<int> frames;
  for (int i = 0; i < most; ++i)
    frames.insert(first + static_cast<int>(std::lround(static_cast<double>(last - first) * i / (most - 1))));
  return frames;
}

/// The camera of the scene that the options name, with their changes.
Camera cameraOf(const RenderCommand& command, const Scene& scene) {
  Camera camera = scene.camera(command.run.camera);
  const auto place = [](const std::vector<double>& n) { return glm::dvec3(n[0], n[1], n[2]); };
  if (command.movesCamera()) {
    camera.keys.clear();
    camera.motion.reset();
  }
  if (!command.eye.empty()) camera.eye = place(command.eye);
  if (!command.target.empty()) camera.target = place(command.target);
  if (command.fov > 0.0) camera.fov = command.fov;
  return camera;
}

/// The exposure, in EV, of all images of the run: that of the view, for an animation metered at some of its
/// frames.
double exposureOf(const RenderCommand& command, Scene& scene, int first, int last) {
  ReferenceOptions view;
  view.camera = command.run.camera;
  std::tie(view.width, view.height) = command.run.size();
  constexpr int kMeteredFrames = 5;
  std::vector<double> times;
  for (const int frame : first == last ? std::set{first} : spread(first, last, kMeteredFrames))
    times.push_back(command.timeOf(frame));
  // The text's hash does not cover a camera that the options moved. Without it the scene's contents identify
  // the view.
  const ContentHash text = scene.hash;
  if (command.movesCamera()) scene.hash = {};
  const double exposure = viewExposure(scene, view, times);
  scene.hash = text;
  return exposure;
}

/// The files of a run: the image or the images, the sheet and the video.
class Files {
 public:
  Files(const RenderCommand& command, int first, int last, double exposure)
      : command_(command), display_{exposure, command.display.toneCurve()} {
    if (!command.video.empty()) video_.emplace(command.video, command.framesPerSecond);
    constexpr int kMostPanels = 400;
    if (command.isAnimation() && !command.sheet.empty())
      onSheet_ = spread(first, last, std::max(2, std::min(kMostPanels, last - first + 1)));
    sheet_.title =
        fmt::format("{}, {}", command.scene.filename().string(), command.pipeline.filename().string());
  }

  const Display& display() const { return display_; }

  void add(int frame, FrameResult result, const std::map<std::string, std::string>& attributes) {
    if (!command_.sheet.empty()) addToSheet(frame, result);
    if (video_) {
      const ImageBuffer image = requireImage(command_, result);
      video_->add(image, displayOf(image));
    }
    if (!command_.output.empty()) write(command_.fileOf(frame), std::move(result), attributes);
  }

  void finish() {
    if (!command_.sheet.empty()) {
      sheet_.title += fmt::format(" ({}, {})", exposureText(display_.exposure), name(display_.tone));
      writePng(command_.sheet, contactSheet(sheet_), {}, toldExposure());
      logInformation("{}: {} panels", command_.sheet.string(), sheet_.panels.size());
    }
    if (video_) {
      video_->finish();
      logInformation("{}: written by ffmpeg", command_.video.string());
    }
  }

 private:
  /// Fractions, such as occlusion, are displayed without exposure unless the options give one.
  Display displayOf(const ImageBuffer& image) const {
    return command_.display.isGiven() ? display_ : lumivox::displayOf(image, display_);
  }
  std::map<std::string, std::string> toldExposure() const {
    return {{kExposureAttribute, exposureNumber(display_.exposure)}};
  }

  void addToSheet(int frame, const FrameResult& result) {
    const auto add = [&](const std::string& name, const ImageBuffer& image, int width) {
      sheet_.panels.push_back({name, thumbnail(image, displayOf(image), width), {}});
    };
    if (command_.isAnimation()) {
      if (onSheet_.count(frame) != 0)
        add(fmt::format("frame {}, {:.3f} s", frame, command_.timeOf(frame)), requireImage(command_, result),
            sheetPanelWidth(static_cast<int>(onSheet_.size())));
      return;
    }
    const int width = sheetPanelWidth(static_cast<int>(result.outputs.size()) + 1);
    const ImageBuffer whole = compositeImage(result);
    const bool isOutput = std::any_of(result.outputs.begin(), result.outputs.end(), [&](const auto& output) {
      return output.second.values() == whole.values();
    });
    if (command_.onlyOutput.empty() && !whole.empty() && !isOutput) add("whole image", whole, width);
    for (const auto& [name, image] : result.outputs) {
      const bool shown = image.channels() == 1 || image.channels() == 3;
      if (shown && !image.empty()) add(name, image, width);
    }
    if (sheet_.panels.empty()) throw Error("--sheet: the pipeline makes no image");
  }

  void write(const fs::path& file, FrameResult frame, const std::map<std::string, std::string>& attributes) {
    if (file.extension() == ".png") {
      const ImageBuffer image = requireImage(command_, frame);
      writePng(file, image, displayOf(image), toldExposure());
      return;
    }
    ImageBuffer main = mainImage(command_, frame);
    LayeredImage layered;
    layered.attributes = attributes;
    if (command_.onlyOutput.empty())
      for (auto& [name, image] : frame.outputs)
        if (!image.empty()) layered.layers[name] = std::move(image);
    if (!main.empty()) layered.layers[""] = std::move(main);
    writeExr(file, layered);
  }

  const RenderCommand& command_;
  Display display_;
  Sheet sheet_;
  std::set<int> onSheet_;  ///< frames of an animation
  std::optional<VideoWriter> video_;
};

/// The message of an interruption after this frame was written: how to render the remaining frames at the
/// same exposure.
std::string keptText(const RenderCommand& command, int frame, int last, const Display& display,
                     const GlobalOptions& global) {
  if (command.output.empty())
    return "interrupted: nothing of a sheet or video is kept; from the start: " + global.commandLine;
  return fmt::format("interrupted: images up to {} are kept; to go on: --frames {}..{}{} in {}",
                     command.fileOf(frame).string(), frame + 1, last,
                     command.displays() && !command.display.isGiven()
                         ? " --exposure=" + exposureNumber(display.exposure)
                         : "",
                     global.commandLine);
}

/// The files that the command writes. Error for wrong options, before any work.
Outputs checkFiles(const RenderCommand& command, int first, int last) {
  if (command.output.empty() && command.sheet.empty() && command.video.empty())
    throw Error("nothing to write; expected --out, --sheet or --video");
  Outputs outputs;
  outputs.add("-o", command.output.empty() ? fs::path() : command.fileOf(first), {".exr", ".png"});
  if (first != last && !command.output.empty()) outputs.add("-o", command.fileOf(last), {".exr", ".png"});
  outputs.add("--sheet", command.sheet, {".png"}).add("--video", command.video, {".mp4"});
  outputs.check({command.scene, command.pipeline});
  if (!command.video.empty()) {
    if (!command.isAnimation())
      throw Error("--video: expected --frames FIRST..LAST too, the frames of the video");
    try {
      ffmpegProgram();
    } catch (const AbsentError& absent) {
      throw AbsentError(fmt::format("--video: {}", absent.what()));
    }
  }
  return outputs;
}

int render(const RenderCommand& command, const GlobalOptions& global) {
  const auto [first, last] =
      command.isAnimation() ? parseFrames("--frames", command.frames) : std::pair(0, 0);
  const std::optional<double> given = command.display.given();
  const Outputs outputs = checkFiles(command, first, last);

  if (command.scene.extension() == ".pipeline" && command.pipeline.extension() == ".scene")
    throw Error(fmt::format(
        "{} is a pipeline and {} a scene; expected them the other way round: render SCENE PIPELINE",
        command.scene.string(), command.pipeline.string()));
  const Pipeline pipeline = Pipeline::load(command.pipeline);
  RenderOptions options = command.run.renderOptions(pipeline);
  options.keepEverything = command.keepEverything;
  options.health = command.health;
  options.accumulate = command.accumulate > 0;
  // The sample positions share everything that does not depend on the camera.
  options.interactive = command.positions() > 1;
  if (command.subpixels > 1 && command.accumulate > 0)
    throw Error(
        "--subpixels and --accumulate: a frame that follows others has one position; expected one of both");
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
  Scene scene = global.loadScene(command.scene);
  if (command.movesCamera())
    for (Camera& camera : scene.cameras)
      if (camera.name == scene.camera(command.run.camera).name) {
        camera = cameraOf(command, scene);
        break;
      }
  outputs.requireUnread();
  if (!command.output.empty())
    for (int frame = first + 1; frame < last; ++frame) Outputs::requireUnread("-o", command.fileOf(frame));
  for (const int frame : {first, last})
    if (std::abs(command.timeOf(frame)) > kLongestTime)
      throw Error(fmt::format("--frames '{}': frame {} is at {:g} s; expected one within {:g} s",
                              command.frames, frame, command.timeOf(frame), kLongestTime));
  const auto device = global.openDevice();
  PipelineExecutor executor(*device, techniques, scene, pipeline, options);

  std::size_t findings = 0;
  Json images = Json::array(), found = Json::array();
  InterruptionNote interruption;
  interruption.say("interrupted before the first image was written");
  const double exposure = given ? *given : command.displays() ? exposureOf(command, scene, first, last) : 0.0;
  Files files(command, first, last, exposure);
  BackgroundWriter writer;
  Progress progress("rendering",
                    static_cast<std::uint64_t>(last - first + 1) *
                        static_cast<std::uint64_t>(std::max(command.accumulate, 1)),
                    "frames");
  for (int frame = first; frame <= last; ++frame) {
    FrameResult result = renderShown(command, executor, scene, frame, progress);
    for (const auto* list : {&result.healthFindings, &result.readsFindings}) {
      for (const std::string& finding : *list) {
        logMessage(LogLevel::quiet,
                   (command.isAnimation() ? fmt::format("frame {}: ", frame) : std::string()) + finding);
        found.push_back({{"frame", frame}, {"finding", finding}});
      }
      findings += list->size();
    }
    for (const std::string& note : result.notes) logInformation("{}", note);
    auto attributes = provenance(global, scene, pipeline, options, *device, command.timeOf(frame));
    if (command.isAnimation()) attributes["lumivox.frame"] = fmt::format("{}", frame);
    if (command.accumulate > 0) attributes["lumivox.accumulate"] = fmt::format("{}", command.accumulate);
    logInformation("{}: {:.1f} ms{}",
                   command.output.empty() ? fmt::format("frame {}", frame) : command.fileOf(frame).string(),
                   result.frameMs,
                   command.displays() ? ", " + exposureText(files.display().exposure) : std::string());
    images.push_back({{"file", command.output.empty() ? Json(nullptr) : Json(command.fileOf(frame).string())},
                      {"frame", frame},
                      {"time", command.timeOf(frame)},
                      {"frame_ms", result.frameMs}});
    writer.submit(
        [&, frame, end = last, made = std::move(result), attributes = std::move(attributes)]() mutable {
          files.add(frame, std::move(made), attributes);
          if (frame < end) interruption.say(keptText(command, frame, end, files.display(), global));
        });
  }
  writer.submit([&files] { files.finish(); });
  writer.finish();
  if (command.json) printJson({{"images", images}, {"findings", found}});
  return findings == 0 ? kGood : kNotGood;
}

}  // namespace

void addRenderCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand("render", "renders a scene with a pipeline into images");
  auto options = std::make_shared<RenderCommand>();
  takesNames(command->add_option("SCENE", options->scene, "the scene's text or name")->required(),
             NamedText::scene);
  takesNames(command->add_option("PIPELINE", options->pipeline, "the pipeline's text or name")->required(),
             NamedText::pipeline);
  command->add_option("-o,--out", options->output,
                      "the image: .exr (every output as a layer, the whole image as the main layer) or .png "
                      "(the whole image)");
  command->add_option(
      "--sheet", options->sheet,
      "a .png with the whole image and every output side by side, or with --frames the frames");
  command->add_option("--video", options->video, "a .mp4 of the frames; needs ffmpeg");
  options->run.addTo(*command);
  const auto addPlace = [&](const char* name, std::vector<double>& place, const char* text) {
    command->add_option(name, place, text)
        ->delimiter(',')
        ->expected(3)
        ->type_name("X,Y,Z")
        ->check(numberBetween(-kFarthestPlace, kFarthestPlace).description(""));
  };
  addPlace("--eye", options->eye, "where the camera stands, in metres, in place of the scene's");
  addPlace("--target", options->target, "what it looks at, in metres");
  command->add_option("--fov", options->fov, "its full vertical angle, in radians")
      ->check(numberBetween(1e-3, 3.1));
  options->display.addTo(*command);
  command->add_option("--frames", options->frames,
                      "FIRST..LAST: numbered images, out_0007.exr or a run of # in the name");
  addFrameRate(*command, options->framesPerSecond);
  command->add_option("--output", options->onlyOutput, "only this output of the pipeline, as the main layer");
  command
      ->add_option(
          "--subpixels", options->subpixels,
          "images are means over this many positions in the pixel, so that edges are smooth, as a report "
          "measures them (default: 4 for images to look at; 1, a frame as it is, for .exr and --accumulate)")
      ->check(CLI::Range(1, 1 << 10));
  command->add_flag("--keep-everything", options->keepEverything, "leave nothing out");
  command->add_flag("--health", options->health,
                    "scan every output of every pass for NaN, Inf and negative values");
  command
      ->add_option(
          "--accumulate", options->accumulate,
          "N: every image is the last of N frames at its time, in which passes find their results of the previous frame; with --frames from image to image too (default: every frame alone)")
      ->check(CLI::Range(1, 1 << 20));
  command->add_flag(
      "--check-reads", options->checkReads,
      "for authors of techniques: render every frame a second time from scratch, and name passes whose Reads, Needs or uses() lack a dependency");
  command->add_flag("--json", options->json, "print the images' files, times and findings as JSON");
  const GlobalOptions& global = commands.global;
  commands.onChosen(command, [=, &global] { return render(*options, global); });
}

}  // namespace lumivox::command
