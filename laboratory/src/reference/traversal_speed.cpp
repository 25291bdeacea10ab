// Measures the share of traversal in the path tracer's time: its rays per second beside those of a bare loop
// over the same rays.
#include <algorithm>
#include <ctime>
#include <limits>
#include <numeric>

#include "lumivox/base/error.h"
#include "lumivox/reference/path_tracer.h"
#include "reference/render.h"

namespace lumivox {
namespace reference {
namespace {

struct RecordedRay {
  glm::vec3 origin, direction;
  float reach;  ///< negative: a ray for the closest hit
};

/// Records and traces every ray.
struct RecordingRays {
  const RayScene& scene;
  std::vector<RecordedRay>& rays;

  bool closestHit(const glm::vec3& origin, const glm::vec3& direction, Hit& hit) {
    rays.push_back({origin, direction, -1.0f});
    return scene.closestHit(origin, direction, hit);
  }
  bool occluded(const glm::vec3& origin, const glm::vec3& direction, float reach) {
    rays.push_back({origin, direction, reach});
    return scene.occluded(origin, direction, reach);
  }
};

/// Processor time of this thread, s; other programs do not count.
double secondsOfThread() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Lowers `best` to the time of the work, if it is shorter.
template <class Work>
void keepBest(double& best, Work&& work) {
  const double start = secondsOfThread();
  work();
  best = std::min(best, secondsOfThread() - start);
}

/// The bare loop. Returns the number of hits, so that no compiler removes the work.
std::uint64_t replay(RTCScene scene, const std::vector<RecordedRay>& rays) {
  std::uint64_t met = 0;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (const RecordedRay& recorded : rays) {
    if (recorded.reach < 0.0f) {
      RTCRayHit ray;
      RayScene::setRay(ray.ray, recorded.origin, recorded.direction, std::numeric_limits<float>::infinity());
      ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(scene, &context, &ray);
      met += ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    } else {
      RTCRay ray;
      RayScene::setRay(ray, recorded.origin, recorded.direction, recorded.reach);
      rtcOccluded1(scene, &context, &ray);
      met += ray.tfar < 0.0f;
    }
  }
  return met;
}

}  // namespace
}  // namespace reference

TraversalSpeed measureTraversalSpeed(const Scene& scene, const ReferenceOptions& given) {
  using namespace reference;
  const ResolvedOptions resolved = resolve(scene, given);
  const Tracer tracer(scene, resolved);
  const Tiles tiles(resolved.options.width, resolved.options.height);
  Film film(resolved.options.width, resolved.options.height, !tracer.media.empty(),
            SceneTraits::of(scene).environment, {});

  std::vector<std::vector<RecordedRay>> recorded(static_cast<std::size_t>(tiles.count()));
  forEachTile(tiles, given.threads, [&](int tile) {
    RecordingRays rays{tracer.rays, recorded[static_cast<std::size_t>(tile)]};
    renderTile(tracer, resolved, tiles, tile, rays, film);
  });
  TraversalSpeed speed;
  for (const auto& tile : recorded) speed.rays += tile.size();
  if (speed.rays == 0) throw Error("reference: the image needs no rays, so there is no speed to measure");

  // Measures both in turn on every tile, within milliseconds, and takes the best of each, so that the
  // processor's clock and other programs affect both alike.
  constexpr int kRepeats = 5;
  std::vector<double> tracerSeconds(recorded.size(), std::numeric_limits<double>::max()),
      bareSeconds = tracerSeconds;
  std::vector<std::uint64_t> met(recorded.size());
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    forEachTile(tiles, given.threads, [&](int tile) {
      const auto index = static_cast<std::size_t>(tile);
      keepBest(tracerSeconds[index], [&] {
        CountingRays rays{tracer.rays};
        renderTile(tracer, resolved, tiles, tile, rays, film);
      });
      keepBest(bareSeconds[index], [&] { met[index] = replay(tracer.rays.embree(), recorded[index]); });
    });
  }
  if (std::accumulate(met.begin(), met.end(), std::uint64_t{0}) > speed.rays)
    throw Error("reference: more hits than rays");
  const auto raysPerSecond = [&](const std::vector<double>& seconds) {
    return static_cast<double>(speed.rays) * threadsOf(given.threads) /
           std::accumulate(seconds.begin(), seconds.end(), 0.0);
  };
  speed.tracerRaysPerSecond = raysPerSecond(tracerSeconds);
  speed.bareRaysPerSecond = raysPerSecond(bareSeconds);
  return speed;
}

}  // namespace lumivox
