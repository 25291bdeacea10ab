// The reference: unidirectional path tracing on Embree with next-event estimation and multiple importance
// sampling.
//
// Components at the first surface that a camera ray hits (box pixel filter of one pixel):
// - direct: emission seen by the camera, the environment seen by camera rays that miss, and the light of
//   point, spot, directional and area lights reflected once, by both lobes
// - indirect_diffuse: what arrives after one or more further bounces and is reflected at the first surface by
//   its diffuse lobe; a bounced ray that misses brings the environment (the sky's light belongs here)
// - indirect_glossy: the same for the Phong lobe
// One bounce: exactly one further surface, or a miss in its place. Full: up to `bounces` of them.
// With media these are dimmed and lit by them up to the first surface, not yet on the way to the camera; what
// the media scatter to the camera has layers of its own, and full = transmittance * (direct + indirect) +
// scattered. A scattering is a bounce.
// The choices that this leaves open are stated in docs/reference_path_tracer.md.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lumivox/base/error.h"
#include "lumivox/base/image.h"
#include "lumivox/scene/scene.h"

namespace lumivox {

/// A reference was given up because nobody wants it any more.
class StoppedError : public Error {
 public:
  using Error::Error;
};

struct ReferenceOptions {
  int samplesPerPixel = 256;
  int bounces = 32;  ///< indirect bounces of the full transport: what lies beyond is cut off
  /// Numbers N of bounces that get layers of their own, bounces_N and its two lobes; each in 1..bounces.
  std::vector<int> bounceLayers;
  bool roulette = true;  ///< Russian roulette: ends dim paths early, without bias
  std::uint64_t seed = 1;
  double time = 0.0;  ///< s
  std::string camera;
  int width = 0, height = 0;  ///< 0: the camera's
  double occlusionDistance =
      0.0;               ///< m, for ambient occlusion; 0: a tenth of the diagonal of the scene's bounds
  int threads = 0;       ///< 0: all
  bool progress = true;  ///< tells the user how far it is, and of light that the limit on bounces leaves out
  bool useCache = true;
  /// Asked before each tile, where it is not null: once it is true, renderReference() throws StoppedError.
  const std::atomic<bool>* stop = nullptr;
};

/// Layers (RGB but for the occlusion): direct, one_bounce_diffuse, one_bounce_glossy, one_bounce (= direct +
/// both), indirect_diffuse, indirect_glossy, full (= direct + both indirect), ambient_occlusion (one channel
/// Y: unoccluded fraction, cosine-weighted); with media also transmittance, scattered_single (light of the
/// lights, scattered once and nothing else), scattered_multiple (all other) and scattered; where there is an
/// environment also environment_diffuse, environment_glossy and their sum environment (its light that no
/// other surface reflected on its way: a part of one_bounce and indirect, which others count as direct); and
/// for each of them "<layer>.variance": the variance of the pixel's mean. One path gives all of them, so sums
/// have their own, right variance. For each N of `bounceLayers` also bounces_N_diffuse and bounces_N_glossy,
/// what arrives after up to N further bounces, and bounces_N, their sum with direct (and with media dimmed,
/// with the light that these scatter after up to N further bounces; there a scattering counts as a bounce,
/// which one_bounce leaves out). Attributes hold the provenance: scene, hash, samples, bounces, roulette,
/// seed, time, camera, resolution, occlusion_distance, tracer_version, bounce_layers (when there are any),
/// cut_off (the estimated share of all light that lies beyond the last bounce, which is warned of above 1 %,
/// and the factor from bounce to bounce). At least two samples per pixel, or Error.
LayeredImage renderReference(const Scene& scene, const ReferenceOptions& options);

/// The same through the cache (base/file.h cacheDirectory), keyed by everything the image depends on. A
/// damaged entry is made anew.
LayeredImage cachedReference(const Scene& scene, const ReferenceOptions& options);

/// The closed form that a layer is judged by and tools that need single rays use this: radiance along one ray
/// with n samples.
glm::vec3 referenceRadiance(const Scene& scene, double time, glm::dvec3 originWorld, glm::vec3 direction,
                            const ReferenceOptions& options);

/// Rays per second of the path tracer and of a bare Embree loop over the same rays on the same threads (best
/// of several runs, time of the threads' own work), for bench/.
struct TraversalSpeed {
  double tracerRaysPerSecond = 0, bareRaysPerSecond = 0;
  std::uint64_t rays = 0;
};
TraversalSpeed measureTraversalSpeed(const Scene& scene, const ReferenceOptions& options);

}  // namespace lumivox
