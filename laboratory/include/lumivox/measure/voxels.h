// Exact reference for voxel grids: which voxels a scene's triangles touch, by the separating axis theorem in
// double precision on the CPU; and how a voxelizer's grid differs from it, as precision, recall and holes
// that rays find. Definitions and reasons: docs/metrics.md. Everything here gives the same bits on any number
// of threads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "lumivox/scene/grid.h"
#include "lumivox/scene/scene.h"

namespace lumivox {

/// One bit per voxel of a grid.
class VoxelSet {
 public:
  VoxelSet() = default;
  /// An empty set. Error when a side is negative or above 4096 voxels, or when it does not fit into memory.
  explicit VoxelSet(const glm::ivec3& resolution);

  const glm::ivec3& resolution() const { return resolution_; }
  bool inside(const glm::ivec3& voxel) const {
    return glm::all(glm::greaterThanEqual(voxel, glm::ivec3(0))) &&
           glm::all(glm::lessThan(voxel, resolution_));
  }
  /// False outside the grid.
  bool contains(const glm::ivec3& voxel) const {
    if (!inside(voxel)) return false;
    return containsBit(bitOf(voxel));
  }
  /// The voxel must lie inside.
  void insert(const glm::ivec3& voxel) {
    const std::uint64_t bit = bitOf(voxel);
    words_[bit >> 6] |= std::uint64_t{1} << (bit & 63);
  }
  /// The same from several threads at once.
  void insertShared(const glm::ivec3& voxel);
  std::uint64_t count() const;
  /// Bits of voxels, x fastest, then y, then z, 64 to a word from the lowest bit; the last word is filled
  /// with zeros.
  const std::vector<std::uint64_t>& words() const { return words_; }
  /// The voxel of a bit of words(), counted from the first word's lowest.
  glm::ivec3 voxelOf(std::uint64_t bit) const {
    const auto width = static_cast<std::uint64_t>(resolution_.x),
               height = static_cast<std::uint64_t>(resolution_.y);
    return {bit % width, bit / width % height, bit / width / height};
  }
  bool operator==(const VoxelSet&) const = default;

  /// The bit of words() of a voxel inside.
  std::uint64_t bitOf(const glm::ivec3& voxel) const {
    return static_cast<std::uint64_t>(voxel.x) +
           static_cast<std::uint64_t>(resolution_.x) *
               (static_cast<std::uint64_t>(voxel.y) +
                static_cast<std::uint64_t>(resolution_.y) * static_cast<std::uint64_t>(voxel.z));
  }
  bool containsBit(std::uint64_t bit) const { return (words_[bit >> 6] >> (bit & 63) & 1) != 0; }

 private:
  glm::ivec3 resolution_{0};
  std::vector<std::uint64_t> words_;
};

using ExactTriangle = std::array<glm::dvec3, 3>;

/// Whether a triangle touches an axis-aligned closed box, by the thirteen separating axes of the two
/// (Akenine-Moller 2001, "Fast 3D triangle-box overlap testing"). Points, lines and needles are triangles
/// too. One triangle is tested against many boxes.
class TriangleBoxTest {
 public:
  explicit TriangleBoxTest(const ExactTriangle& triangle);
  bool overlaps(const glm::dvec3& boxCentre, const glm::dvec3& boxHalfExtent) const;
  const glm::dvec3& low() const { return low_; }
  const glm::dvec3& high() const { return high_; }

 private:
  struct Axis {
    glm::dvec3 direction, magnitude;  ///< magnitude: of the direction's components
    double low, high;                 ///< of the triangle along it
  };
  glm::dvec3 low_, high_;
  std::array<Axis, 10> axes_;  ///< the plane's normal; edges times the box's axes
};

/// Contacts closer than this, in voxels, are left undecided: single precision places a surface in a grid of
/// 1024 voxels no better than four of its steps (4 * 2^-24 * 1024 = 2.4e-4), and a voxelizer adds its own.
inline constexpr double kContactTolerance = 1e-3;

/// The right answer. A voxel that is possible but not certain is touched by no more than the tolerance, or is
/// missed by no more than it: either answer is right there.
struct VoxelReference {
  VoxelSet certain;   ///< the box shrunk by the tolerance on every side is touched
  VoxelSet possible;  ///< the box grown by it is
};

/// The voxels that the triangles touch; their corners are in voxels, from the corner of voxel (0,0,0).
/// Triangles with corners that are not finite touch nothing.
VoxelReference trueVoxels(std::span<const ExactTriangle> triangles, const glm::ivec3& resolution,
                          double tolerance = kContactTolerance);

/// The same for a scene at one time. Of a surface with a cut-out mask only what is left of it counts: a voxel
/// is certain when the mask is at least 0.5 at some point of the surface within it, and not possible when the
/// mask is below 0.5 at every texel that the surface within it reaches.
VoxelReference trueVoxels(const Scene& scene, const SceneSnapshot& snapshot, const GridPlacement& grid,
                          double tolerance = kContactTolerance);

struct VoxelError {
  std::uint64_t truePositive = 0, falsePositive = 0, falseNegative = 0;
  double precision() const;  ///< share of the occupied voxels that are rightly so; 1 when none is occupied
  double recall()
      const;  ///< share of the reference's voxels that are occupied; 1 when the reference has none
};
/// An undecided voxel counts for neither, but for one case: where it and its 26 neighbours, all within the
/// grid, are empty, the surface was missed on whichever side it lies, and that is a false negative. Error
/// when the resolutions differ.
VoxelError compareVoxels(const VoxelSet& occupied, const VoxelReference& reference);

/// Surfaces that straight rays slip through. A ray crosses a surface wherever it meets a run of consecutive
/// voxels of the reference, possible ones of which at least one is certain; the crossing is a hole when the
/// ray meets no occupied voxel from 1.5 voxel lengths before the run to 1.5 behind it.
struct RayHoles {
  std::uint64_t axisCrossings = 0, axisHoles = 0;        ///< of rays along the grid's axes
  std::uint64_t obliqueCrossings = 0, obliqueHoles = 0;  ///< of rays in all other directions
  double axisShare() const;                              ///< holes per crossing; 0 without crossings
  double obliqueShare() const;
};
inline constexpr double kHoleReach = 1.5;  ///< voxel lengths along the ray

/// The crossings of one reference, found once for any number of grids: of each the voxels of its ray that may
/// close it. Rays along the axes go through the centres of the columns: of all, or of `raysPerKind` per axis
/// at equal steps where there are more. As many oblique rays are spread evenly over all directions and
/// places, the same every time.
class RayCrossings {
 public:
  explicit RayCrossings(const VoxelReference& reference, int raysPerKind = 1 << 16);
  /// Error when the resolutions differ.
  RayHoles holes(const VoxelSet& occupied) const;

  /// Crossings of rays of one kind, one behind the other.
  struct Closers {
    std::vector<std::uint64_t> voxels;  ///< bits of VoxelSet::words()
    std::vector<std::uint64_t> ends;    ///< of each crossing: the end of its part of `voxels`
    std::uint64_t holes(const VoxelSet& occupied) const;
  };

 private:
  glm::ivec3 resolution_;
  Closers axis_, oblique_;
};

/// The same for one grid.
RayHoles rayHoles(const VoxelSet& occupied, const VoxelReference& reference, int raysPerKind = 1 << 16);

}  // namespace lumivox
