// capture: what a depth camera would see of a scene, as files of a capture.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "command.h"
#include "common/named_texts.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/image.h"
#include "lumivox/base/interruption.h"
#include "lumivox/base/log.h"
#include "lumivox/reference/depth.h"
#include "lumivox/reference/emission.h"
#include "lumivox/reference/path_tracer.h"

namespace lumivox::command {
namespace {

namespace fs = std::filesystem;

constexpr double kDepthScale = 5000.0;  // units of a TUM depth image in a metre

struct CaptureCommand {
  fs::path scene, output;
  std::string frames = "0..0", noise = "none", resolution;
  double framesPerSecond = 30.0, exposure = 0.0;
  bool exr = false;
  ReferenceOptions options;
};

/// Camera to world of the capture's axes: x right, y down, z forward.
glm::dquat rotationOf(const CameraView& camera) {
  return glm::normalize(glm::quat_cast(
      glm::dmat3(glm::dvec3(camera.right), -glm::dvec3(camera.up), glm::dvec3(camera.forward))));
}

/// The brightest radiance that is no lamp's.
double brightEnough(const ImageBuffer& image, const std::vector<unsigned char>& emits) {
  float brightest = 0.0f;
  for (std::size_t i = 0; i < image.pixelCount(); ++i) {
    const float* pixel = image.values().data() + 3 * i;
    if (emits.empty() || emits[i] == 0) brightest = std::max({brightest, pixel[0], pixel[1], pixel[2]});
  }
  return brightest > 0.0f ? static_cast<double>(brightest) : 1.0;
}

ByteImage encoded(const ImageBuffer& image, double exposure) {
  ByteImage bytes{image.width(), image.height(), 3, {}};
  bytes.values.reserve(image.values().size());
  for (const float radiance : image.values())
    bytes.values.push_back(static_cast<unsigned char>(
        std::lround(255.0f * linearToSrgb(std::clamp(radiance / static_cast<float>(exposure), 0.0f, 1.0f)))));
  return bytes;
}

WordImage units(const SeenDepths& seen, const std::vector<float>& depths) {
  WordImage image{seen.width, seen.height, {}};
  constexpr double kMost = 65534.0;  // 65535 stands for no depth
  for (const float depth : depths) {
    const double value = std::round(kDepthScale * static_cast<double>(depth));
    image.values.push_back(static_cast<std::uint16_t>(value > kMost ? 0.0 : value));
  }
  return image;
}

class Writer {
 public:
  Writer(const CaptureCommand& command, const Scene& scene)
      : command_(command), scene_(scene), options_(command.options) {}

  void write(int frame) {
    options_.time = command_.options.time + frame / command_.framesPerSecond;
    const SceneSnapshot snapshot =
        snapshotOf(scene_, options_.time, options_.camera, options_.width, options_.height);
    const SeenDepths seen = seenDepths(scene_, snapshot, kKinectBaseline);
    focal_ = seen.focal;
    centre_ = {0.5 * (seen.width - 1), 0.5 * (seen.height - 1)};
    const std::vector<float> depths =
        command_.noise == "kinect" ? kinectDepths(seen, options_.seed + static_cast<std::uint64_t>(frame))
                                   : seen.depth;
    const ImageBuffer colour =
        (options_.useCache ? cachedReference(scene_, options_) : renderReference(scene_, options_))
            .layers.at("full");
    const double time = frame / command_.framesPerSecond;
    if (command_.exr) {
      LayeredImage image;
      image.layers[""] = colour;
      ImageBuffer z(seen.width, seen.height, 1);
      z.values() = depths;
      image.layers["Z"] = std::move(z);
      writeExr(command_.output / fmt::format("frame_{:04}.exr", frame), image);
    } else {
      if (!(exposure_ > 0.0))
        exposure_ = command_.exposure > 0.0 ? command_.exposure
                                            : brightEnough(colour, emittingPixels(scene_, snapshot));
      const std::string name = fmt::format("{:04}.png", frame);
      writeBytePng(command_.output / "rgb" / name, encoded(colour, exposure_));
      writeGreyPng16(command_.output / "depth" / name, units(seen, depths));
      pairs_ += fmt::format("{:.6f} rgb/{} {:.6f} depth/{}\n", time, name, time, name);
    }
    const glm::dvec3 eye = glm::dvec3(snapshot.camera.eye) + snapshot.origin;
    const glm::dquat turned = rotationOf(snapshot.camera);
    poses_ += fmt::format("{:.6f} {:.9g} {:.9g} {:.9g} {:.12g} {:.12g} {:.12g} {:.12g}\n", time, eye.x, eye.y,
                          eye.z, turned.x, turned.y, turned.z, turned.w);
  }

  void finish() const {
    writeFileAtomically(command_.output / "groundtruth.txt", "# time tx ty tz qx qy qz qw\n" + poses_);
    if (!command_.exr) writeFileAtomically(command_.output / "associations.txt", pairs_);
  }

  /// The block of a scene text that reads the files.
  std::string block() const {
    const std::string folder = command_.output.string();
    std::string text = fmt::format("capture {} {{\n", command_.output.filename().string());
    text += command_.exr ? fmt::format("  files \"{}/frame_####.exr\"\n", folder)
                         : fmt::format("  folder \"{}\"\n", folder);
    text +=
        fmt::format("  focal {:.9g} {:.9g}  centre {:.9g} {:.9g}\n", focal_, focal_, centre_.x, centre_.y);
    if (!command_.exr) text += fmt::format("  exposure {:.6g}\n", exposure_);
    text += fmt::format("  stands_for \"{}\"\n}}\n", command_.scene.generic_string());
    return text;
  }

 private:
  const CaptureCommand& command_;
  const Scene& scene_;
  ReferenceOptions options_;
  double exposure_ = 0.0, focal_ = 0.0;
  glm::dvec2 centre_{0};
  std::string pairs_, poses_;
};

int capture(CaptureCommand command, const GlobalOptions& global) {
  const auto [first, last] = parseFrames("--frames", command.frames);
  if (!command.resolution.empty())
    std::tie(command.options.width, command.options.height) = parseResolution(command.resolution);
  command.options.progress = !global.quiet;
  const Scene scene = global.loadScene(command.scene);
  scene.camera(command.options.camera);
  for (const char* file : {"groundtruth.txt", "rgb/0000.png", "depth/0000.png"})
    if (!command.exr || std::string(file) == "groundtruth.txt") requireWritable(command.output / file);
  InterruptionNote interruption;
  interruption.say("interrupted: the poses of a capture are written at its end; from the start: " +
                   global.commandLine);
  Writer writer(command, scene);
  for (int frame = first; frame <= last; ++frame) writer.write(frame);
  writer.finish();
  logInformation("{}: {} frames", command.output.string(), last - first + 1);
  print(writer.block());
  return kGood;
}

}  // namespace

void addCaptureCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand(
      "capture",
      "writes what a depth camera would see of a scene: colour, depth and poses, in the TUM layout");
  auto all = std::make_shared<CaptureCommand>();
  all->options.samplesPerPixel = 64;
  takesNames(command->add_option("SCENE", all->scene, "the real scene's text or name")->required(),
             NamedText::scene);
  command->add_option("-o,--out", all->output, "folder of the capture")->required();
  command->add_option("--frames", all->frames,
                      "frames of the scene's animation, such as 0..299 (default 0..0)");
  addFrameRate(*command, all->framesPerSecond);
  command->add_option("--spp", all->options.samplesPerPixel, "samples per pixel of the colours (default 64)")
      ->check(CLI::Range(2, 1 << 24));
  command
      ->add_option("--noise", all->noise,
                   "noise of depths; kinect: of that sensor, with its holes (default: none)")
      ->check(CLI::IsMember({"none", "kinect"}));
  command->add_flag("--exr", all->exr, "EXR images of linear radiance and Z in place of PNG");
  command
      ->add_option(
          "--exposure", all->exposure,
          "radiance that a PNG shows as white, W/(sr m^2) (default: the brightest of the first frame but for lamps)")
      ->check(numberBetween(1e-12, 1e12));
  addSeed(*command, all->options.seed, "of the noise");
  addTime(*command, all->options.time);
  command->add_option("--camera", all->options.camera,
                      "the scene's camera of this name (default: the first)");
  command->add_option("--resolution", all->resolution, "width and height in pixels (default: the camera's)");
  const GlobalOptions& global = commands.global;
  commands.onChosen(command, [=, &global] { return capture(*all, global); });
}

}  // namespace lumivox::command
