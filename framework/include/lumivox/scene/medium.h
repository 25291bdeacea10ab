// Where media are and how dense: the one definition that techniques and the path tracer share.
//
// Particles: each is a pure function of its number, the medium's seed and the time, so that any frame can be
// made alone. A particle starts near the source, rises and drifts in a straight line, and is reborn with new
// random numbers when its life is over; their births are spread evenly over a life. The same arithmetic, down
// to the bits, is in shaders/common/particles.glsl.
//
// Each particle carries a round cloud of density (1 - q^2)^3, q = distance / radius < 1: the polynomial
// kernel of Mueller, Charypar & Gross 2003, "Particle-based fluid simulation for interactive applications",
// Eq. 20, scaled to 1 in the middle. Clouds that overlap add up. So the extinction of a medium is that in the
// middle of one lone cloud.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <numbers>

#include "lumivox/scene/scene.h"

namespace lumivox {

/// Most media in a scene, and most of them whose density varies: what the shaders have room for.
inline constexpr int kMostMedia = 8, kMostVaryingMedia = 4;
/// Most voxels along a side of a density volume.
inline constexpr int kLargestVolume = 1024;

/// The time in lives: whole ones, and the share of the present one in [0,1).
struct ParticleClock {
  std::uint32_t lives = 0;
  float share = 0.0f;
};
ParticleClock particleClock(const Medium& medium, double time);

/// xyz: position relative to the source, m; w: age, s.
glm::vec4 particleAt(const Medium& medium, const ParticleClock& clock, std::uint32_t index);

/// Volume integral of the density of one particle's cloud, m^3: int 4 pi r^2 (1 - r^2/R^2)^3 dr = 64 pi R^3 /
/// 315.
inline double particleMass(const Medium& medium) {
  return 64.0 * std::numbers::pi / 315.0 * medium.radius * medium.radius * medium.radius;
}

/// The box that holds all clouds at all times: (low, high) in world space, m.
std::pair<glm::dvec3, glm::dvec3> particleBounds(const Medium& medium);

/// The bounds of a medium relative to the snapshot's origin: of a homogeneous medium its box, or without one
/// SceneSnapshot::gridBounds; of the others the box outside of which there is no density. Empty where a
/// homogeneous medium has neither box nor scene.
Bounds mediumBounds(const Medium& medium, const SceneSnapshot& snapshot);

/// The density of all clouds at a time, at the centres of voxels no larger than `voxelSize` nor more than
/// kLargestVolume along a side.
DensityVolume particleDensity(const Medium& medium, double time, double voxelSize);

}  // namespace lumivox
