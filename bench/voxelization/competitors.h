// Competitors of the voxelizers: loops over triangles on the CPU, and OpenVDB.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "lumivox/measure/voxels.h"

namespace lumivox::bench {

/// A scene as flat arrays, made before the clock starts.
struct Mesh {
  GridPlacement grid;
  std::vector<glm::vec3> positions;  ///< voxels
  std::vector<glm::vec3> normals;    ///< unit length, world space
  std::vector<glm::vec2> texcoords;
  struct Triangle {
    std::uint32_t corner[3];
    int material;
  };
  std::vector<Triangle> triangles;
  const Scene* scene = nullptr;  ///< materials and textures
};
Mesh meshOf(const Scene& scene, const SceneSnapshot& snapshot, const GridPlacement& grid);

/// A fragment in the layout that the voxelizers write (shaders/common/voxel.glsl).
struct Fragment {
  std::uint32_t voxel, offset, normal, albedoRg, albedoBCoverage, emission;
};

/// Finds the voxels that each triangle touches, in single precision: the test of Schwarz & Seidel 2010,
/// column by column along the dominant axis, as in the shaders. As in the voxelizers, memory is allocated
/// before the clock starts and reused.
class CpuLoops {
 public:
  explicit CpuLoops(const Mesh& mesh);
  ~CpuLoops();
  /// Clears the bits and sets those of touched voxels; the result is valid until the next call.
  void bits(int threads);
  const VoxelSet& occupied() const;  ///< of the last bits()
  /// The list of fragments; returns how many.
  std::uint64_t fragments(int threads);
  std::span<const Fragment> list() const;  ///< of the last fragments()

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// OpenVDB's narrow band of three voxels to each side, as unsigned and as signed distance. Returns its number
/// of active voxels.
class NarrowBand {
 public:
  explicit NarrowBand(const Mesh& mesh);
  ~NarrowBand();
  std::uint64_t convert(int threads);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lumivox::bench
