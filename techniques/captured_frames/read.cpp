// Decodes frames of a capture on the host and uploads them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "lumivox/base/error.h"
#include "passes.h"

namespace lumivox::captured_frames {
namespace {

namespace code = shaders::captured_frames;

/// Mirror of CapturedPose in camera.glsl.
struct PoseData {
  glm::vec4 eye, right, down, forward;
};

/// Rays through the middles of pixels, and the area of each pixel in the plane of depth 1: the quadrilateral
/// between the rays through its corners.
std::vector<float> raysOf(const CaptureCamera& camera) {
  const int columns = camera.width + 1;
  std::vector<glm::dvec2> corners;
  corners.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(camera.height + 1));
  for (int y = 0; y <= camera.height; ++y)
    for (int x = 0; x <= camera.width; ++x) corners.push_back(camera.ray({x - 0.5, y - 0.5}));
  std::vector<float> rays;
  rays.reserve(4 * static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  const auto cross = [](const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; };
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const auto at =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(x);
      const auto below = at + static_cast<std::size_t>(columns);
      const glm::dvec2 ray = camera.ray({x, y});
      const double area = 0.5 * cross(corners[below + 1] - corners[at], corners[below] - corners[at + 1]);
      const bool known = area > 0.0 && std::isfinite(area) && std::isfinite(ray.x) && std::isfinite(ray.y);
      for (const double value : {known ? ray.x : 0.0, known ? ray.y : 0.0, known ? area : 0.0, 0.0})
        rays.push_back(static_cast<float>(value));
    }
  }
  return rays;
}

/// Four components a pixel (CapturedFrames::colour).
void appendColours(const CapturedImage& image, std::vector<float>& texels) {
  for (std::size_t i = 0; i < image.depth.size(); ++i) {
    const float *colour = image.colour.data() + 3 * i, most = image.saturation;
    const bool known = std::isfinite(colour[0]) && std::isfinite(colour[1]) && std::isfinite(colour[2]) &&
                       std::min({colour[0], colour[1], colour[2]}) >= 0.0f;
    const bool saturated = std::max({colour[0], colour[1], colour[2]}) >= most;
    for (int c = 0; c < 3; ++c) texels.push_back(known ? colour[c] : 0.0f);
    texels.push_back(known ? (saturated ? 2.0f : 1.0f) : 0.0f);
  }
}

class ReadPass : public Pass {
  Param<int> number{this, "capture", 0, within(0, 255), "which capture of the scene, in its text's order"};
  Param<int> wanted{
      this,
      "frames",
      1,
      within(1, 64),
      "newest frames at this time, from the files: a frame alone has the same ones as in a sequence",
      published(1)};
  Out<CapturedFrames> frames{this, "frames", Contributes::nothing, Needs::capturedFrame, "the newest frames"};

  Reads readsFrom() const override { return Reads::capture; }
  bool worksOnHost() const override { return true; }

  void run(PassContext& frame) override {
    const auto& captures = frame.sceneDescription().captures;
    const auto index = static_cast<std::size_t>(static_cast<int>(number));
    if (index >= captures.size()) {
      // Where everything is kept, the pass also runs in scenes without a capture.
      if (!captures.empty())
        throw Error(fmt::format("capture {} of a scene that has {}; expected one from 0 to {}", index,
                                captures.size(), captures.size() - 1));
      frames = empty(frame);
      return;
    }
    const Capture& capture = *captures[index];
    const std::size_t newest = frame.snapshot().captures.at(index).frame;
    CapturedFrames result;
    result.camera = capture.camera;
    result.count = std::min(static_cast<int>(wanted), static_cast<int>(newest) + 1);
    result.rays = frame.kept("rays of pixels", capture.hash, [&] {
      gpu::TextureRef rays =
          texture(frame, capture.camera, gpu::TextureKind::d2, gpu::Format::rgba32f, 1, "rays of pixels");
      rays->uploadFloats(0, raysOf(capture.camera));
      return rays;
    });
    std::vector<PoseData> poses;
    std::vector<float> colours, depths;
    const std::size_t pixels =
        static_cast<std::size_t>(capture.camera.width) * static_cast<std::size_t>(capture.camera.height);
    colours.reserve(4 * pixels * static_cast<std::size_t>(result.count));
    depths.reserve(pixels * static_cast<std::size_t>(result.count));
    std::vector<DecodedFrame> decoded;
    for (int layer = 0; layer < result.count; ++layer) {
      const std::size_t at = newest - static_cast<std::size_t>(layer);
      const auto image = capture.image(at);
      decoded.push_back({capture.hash, at, image});
      appendColours(*image, colours);
      depths.insert(depths.end(), image->depth.begin(), image->depth.end());
      const CaptureState state = captureStateOf(capture, at, frame.snapshot().origin);
      poses.push_back({glm::vec4(state.eye, 1.0f), glm::vec4(state.toWorld[0], 0.0f),
                       glm::vec4(state.toWorld[1], 0.0f), glm::vec4(state.toWorld[2], 0.0f)});
      result.states.push_back(state);
    }
    result.colour = texture(frame, capture.camera, gpu::TextureKind::d2Array, gpu::Format::rgba32f,
                            result.count, "captured colours");
    result.colour->uploadFloats(0, colours);
    result.depth = texture(frame, capture.camera, gpu::TextureKind::d2Array, gpu::Format::r32f, result.count,
                           "captured depths");
    result.depth->uploadFloats(0, depths);
    result.poses = frame.uploaded(poses, "poses of captured frames");
    if (last_) decoded.push_back(*last_);
    compareExposures(frame, capture, decoded);
    last_ = decoded.front();
    frames = result;
  }

  struct DecodedFrame {
    ContentHash capture;
    std::size_t number = 0;
    std::shared_ptr<const CapturedImage> image;
  };

  /// Warns once if neighbouring frames differ in exposure. No frame is decoded for that: with 'frames 1' the
  /// neighbour is that of the run before.
  void compareExposures(PassContext& frame, const Capture& capture,
                        const std::vector<DecodedFrame>& decoded) {
    constexpr double kMostBetween = 1.25;
    for (std::size_t i = 1; i < decoded.size() && !isTold_; ++i) {
      const DecodedFrame *later = &decoded[i - 1], *earlier = &decoded[i];
      if (later->capture != earlier->capture) continue;
      if (later->number < earlier->number) std::swap(later, earlier);
      if (later->number != earlier->number + 1) continue;
      const auto ratio = brightnessOver(capture.camera, {*later->image, capture.frames[later->number]},
                                        {*earlier->image, capture.frames[earlier->number]});
      if (!ratio || (*ratio <= kMostBetween && *ratio >= 1.0 / kMostBetween)) continue;
      frame.warn(fmt::format(
          "frame {} of capture '{}' is {:.2f} times as bright as the frame before, at surfaces that "
          "both show; expected one exposure for all frames",
          later->number, capture.name, *ratio));
      isTold_ = true;
    }
  }

  std::optional<DecodedFrame> last_;  // the newest frame of the last run
  bool isTold_ = false;

  static gpu::TextureRef texture(PassContext& frame, const CaptureCamera& camera, gpu::TextureKind kind,
                                 gpu::Format format, int layers, const char* label) {
    return frame.texture({kind, format, camera.width, camera.height, layers, 1}, label);
  }

  static CapturedFrames empty(PassContext& frame) {
    CapturedFrames result;
    result.camera.width = result.camera.height = 1;
    result.camera.focal = glm::dvec2(1.0);
    result.rays = texture(frame, result.camera, gpu::TextureKind::d2, gpu::Format::rgba32f, 1, "no rays");
    result.colour =
        texture(frame, result.camera, gpu::TextureKind::d2Array, gpu::Format::rgba32f, 1, "no colours");
    result.depth =
        texture(frame, result.camera, gpu::TextureKind::d2Array, gpu::Format::r32f, 1, "no depths");
    for (const gpu::TextureRef& each : {result.rays, result.colour, result.depth})
      each->clear(glm::vec4(0.0f));
    result.poses = frame.uploaded(std::vector<PoseData>{}, "no poses");
    return result;
  }
};

}  // namespace

void addRead(TechniqueRegistry& registry) {
  registry.add<ReadPass>("read", "The newest frames of a capture: colour, depth, rays and poses");
}

}  // namespace lumivox::captured_frames
