// Competitors of the voxelizers: loops over triangles on the CPU, and OpenVDB.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "lumivox/measure/voxels.h"

namespace lumivox::bench {

/// A scene as flat arrays in voxels, made before the clock starts.
struct Mesh {
  GridPlacement grid;
  std::vector<glm::vec3> positions;  ///< voxels
  std::vector<glm::vec3> normals;    ///< unit, world
  std::vector<glm::vec2> texcoords;
  struct Triangle {
    std::uint32_t corner[3];
    int material;
  };
  std::vector<Triangle> triangles;
  const Scene* scene = nullptr;  ///< materials and textures
};
Mesh meshOf(const Scene& scene, const SceneSnapshot& snapshot, const GridPlacement& grid);

/// The words of a fragment as the voxelizers write them (shaders/common/voxel.glsl).
struct Fragment {
  std::uint32_t voxel, offset, normal, albedoRg, albedoBCoverage, emission;
};

/// Which voxels every triangle touches, in single precision: the test of Schwarz & Seidel 2010, one column of
/// the dominant axis after the other, as the shaders do it. Memory is reserved before the clock starts and
/// used again, as the voxelizers' is.
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

/// A narrow band of three voxels to each side, unsigned and signed distance as OpenVDB makes it; returns its
/// active voxels.
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
