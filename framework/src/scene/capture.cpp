#include "lumivox/scene/capture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <mutex>
#include <utility>

#include "lumivox/base/error.h"

namespace lumivox {
namespace {

/// A ray bent by OpenCV's model, and its derivatives along x and y.
struct Bent {
  glm::dvec2 ray;
  glm::dmat2 slope;
};

/// x' = x (1 + k1 r2 + k2 r4 + k3 r6) + 2 p1 x y + p2 (r2 + 2 x2), y' = y (...) + p1 (r2 + 2 y2) + 2 p2 x y.
Bent bend(const std::array<double, 5>& k, const glm::dvec2& ray) {
  const auto [k1, k2, p1, p2, k3] = k;
  const double x = ray.x, y = ray.y, r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double radialSlope = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3);  // by r2
  Bent bent;
  bent.ray = {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
              y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
  const double across = 2.0 * x * y * radialSlope + 2.0 * p1 * x + 2.0 * p2 * y;
  bent.slope[0] = {radial + 2.0 * x * x * radialSlope + 2.0 * p1 * y + 6.0 * p2 * x, across};
  bent.slope[1] = {across, radial + 2.0 * y * y * radialSlope + 6.0 * p1 * y + 2.0 * p2 * x};
  return bent;
}

}  // namespace

bool CaptureCamera::distorted() const {
  return std::any_of(distortion.begin(), distortion.end(), [](double k) { return k != 0.0; });
}

glm::dvec2 CaptureCamera::project(const glm::dvec2& ray) const {
  return focal * (distorted() ? bend(distortion, ray).ray : ray) + centre;
}

glm::dvec2 CaptureCamera::ray(const glm::dvec2& pixel) const {
  const glm::dvec2 wanted = (pixel - centre) / focal;
  if (!distorted()) return wanted;
  // Newton's method from the bent ray itself: the models of lenses bend rays by a few hundredths.
  constexpr int kMostSteps = 20;
  constexpr double kTolerance = 1e-9;
  glm::dvec2 ray = wanted;
  for (int step = 0; step < kMostSteps; ++step) {
    const Bent bent = bend(distortion, ray);
    const glm::dvec2 miss = wanted - bent.ray;
    const double determinant = glm::determinant(bent.slope);
    // Beyond the turning point of the polynomial no ray reaches the pixel.
    if (!(determinant > 0.0)) break;
    if (glm::length(miss) <= kTolerance) return ray;
    ray += glm::inverse(bent.slope) * miss;
  }
  return glm::dvec2(std::numeric_limits<double>::quiet_NaN());
}

struct Capture::Cache {
  static constexpr std::size_t kMost = 8;
  std::mutex mutex;
  std::deque<std::pair<std::size_t, std::shared_ptr<const CapturedImage>>> images;  // the latest first
};

Capture::Capture(std::string captureName, CaptureCamera pinhole, std::vector<CaptureFrame> posed,
                 std::unique_ptr<const CaptureSource> source)
    : name(std::move(captureName)),
      camera(pinhole),
      frames(std::move(posed)),
      source_(std::move(source)),
      cache_(std::make_unique<Cache>()) {}

Capture::~Capture() = default;

std::size_t Capture::frameAt(double time) const {
  // Times of captured and of rendered frames are quotients that round differently.
  constexpr double kRounding = 1e-6;  // s
  const auto later =
      std::upper_bound(frames.begin(), frames.end(), time + kRounding,
                       [](double wanted, const CaptureFrame& frame) { return wanted < frame.time; });
  return later == frames.begin() ? 0 : static_cast<std::size_t>(later - frames.begin()) - 1;
}

std::shared_ptr<const CapturedImage> Capture::image(std::size_t frame) const {
  const std::lock_guard lock(cache_->mutex);
  auto& images = cache_->images;
  const auto found =
      std::find_if(images.begin(), images.end(), [&](const auto& entry) { return entry.first == frame; });
  if (found != images.end()) return found->second;
  auto image = std::make_shared<const CapturedImage>(source_->read(frame));
  if (image->width != camera.width || image->height != camera.height)
    throw Error(fmt::format(
        "capture '{}', frame {}: the depth image is {} x {}; expected {} x {} as that of the first", name,
        frame, image->width, image->height, camera.width, camera.height));
  images.emplace_front(frame, image);
  if (images.size() > Cache::kMost) images.pop_back();
  return image;
}

CaptureState captureStateOf(const Capture& capture, std::size_t frame, const glm::dvec3& origin) {
  const CaptureFrame& posed = capture.frames.at(frame);
  return {frame, glm::vec3(posed.eye - origin), glm::mat3(glm::mat3_cast(posed.rotation))};
}

}  // namespace lumivox
