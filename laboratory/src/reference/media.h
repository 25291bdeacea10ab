// Participating media for rays: transmittance, and collisions at which light scatters.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "lumivox/base/random.h"
#include "lumivox/scene/medium.h"

namespace lumivox::reference {

/// The phase function of Henyey & Greenstein 1941, "Diffuse radiation in the galaxy", Eq. 2: density per sr
/// of scattering by an angle with this cosine. g is the mean cosine. It integrates to 1 over the sphere.
float phase(float anisotropy, float cosine);

/// Samples a cosine of the scattering angle with that density by inverting its integral.
float samplePhaseCosine(float anisotropy, float u);

/// A point where light scatters.
struct Collision {
  glm::vec3 position;
  float anisotropy;
};

/// All media of a scene at one time.
class Media {
 public:
  Media(const Scene& scene, const SceneSnapshot& snapshot);
  bool empty() const { return media_.empty(); }

  /// Estimates the transmittance over `reach` metres of a unit direction: exact for homogeneous media,
  /// otherwise by ratio tracking (Novak, Selle & Jarosz 2014, "Residual ratio tracking for estimating
  /// attenuation in participating media", Sec. 3).
  glm::vec3 transmittance(const glm::vec3& origin, const glm::vec3& direction, float reach,
                          RandomStream& random) const;

  /// Delta tracking (Woodcock et al. 1965): returns whether light along the ray scatters before `reach`.
  /// `throughput` is multiplied by the weight of the choice: 1 or the albedo in grey media. If channels
  /// differ, collisions are chosen by the history of the weights (Kutz, Habel, Li & Novak 2017, "Spectral and
  /// decomposition tracking for rendering heterogeneous volumes", Sec. 5.1).
  bool collide(const glm::vec3& origin, const glm::vec3& direction, float reach, RandomStream& random,
               glm::vec3& throughput, Collision& collision) const;

 private:
  /// Densities at voxel centres with the largest density of each block of them.
  struct Field {
    static constexpr int kBlock = 8;  ///< voxels along a side of a block
    Field(const DensityVolume& volume, const glm::dvec3& snapshotOrigin);
    float densityAt(const glm::vec3& position) const;
    float majorant(const glm::ivec3& block) const {
      return majorants[static_cast<std::size_t>((block.z * blocks.y + block.y) * blocks.x + block.x)];
    }

    glm::vec3 low;  ///< centre of voxel (0,0,0)
    float voxelSize;
    glm::ivec3 resolution;
    std::vector<float> values;
    glm::vec3 blocksLow;  ///< corner of block (0,0,0): half a voxel outside of the grid
    glm::ivec3 blocks;
    std::vector<float> majorants;
  };
  struct Entry {
    Bounds bounds;
    glm::vec3 extinction, scattering;  ///< at density 1, 1/m
    float largest;                     ///< of the channels of extinction
    float anisotropy;
    int field;  ///< into fields_; -1 for a homogeneous medium
  };

  /// Generates tentative collisions along a ray in one medium, with the density of its majorant.
  class Flight {
   public:
    void begin(const Media& media, const Entry& entry, const glm::vec3& origin, const glm::vec3& direction,
               float reach);
    /// Moves to the next collision; false if the medium or the reach ends before.
    bool next(RandomStream& random);
    const Entry* entry = nullptr;
    float distance = 0.0f;  ///< m
    float majorant = 0.0f;  ///< extinction of the majorant there, 1/m

   private:
    void enterBlock();
    const Field* field_ = nullptr;
    glm::vec3 origin_, direction_;
    float end_ = 0.0f, blockEnd_ = 0.0f;
    glm::ivec3 block_{0}, step_{0};
    glm::vec3 nextCrossing_, crossing_;
  };

  /// The distances between which the ray is inside the bounds; false if it misses them.
  static bool clip(const Bounds& bounds, const glm::vec3& origin, const glm::vec3& direction, float reach,
                   float& begin, float& end);
  /// Density at a point: its extinction over that at density 1.
  float densityAt(const Entry& entry, const glm::vec3& position) const {
    return entry.field < 0 ? 1.0f : fields_[static_cast<std::size_t>(entry.field)].densityAt(position);
  }

  std::vector<Entry> media_;
  std::vector<Field> fields_;
};

}  // namespace lumivox::reference
