// Voxelizers measured: every pipeline that makes voxels, for time, memory and what its grid gets wrong.
// Definitions: docs/metrics.md. How to read the results: docs/measuring_voxels.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/gpu/device.h"
#include "lumivox/measure/voxels.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/results/voxelizers.h"

namespace lumivox {

struct PortKind;

/// The occupied voxels of an output that holds some, as its kind says (PortKind::occupancy).
struct OccupiedVoxels {
  GridPlacement grid;
  VoxelSet voxels;
  std::uint64_t fragments = 0;  ///< 0 for grids
  std::uint64_t bytes = 0;      ///< of the fragments that are in use, or of the grid's textures
};
/// Nothing for an output of another kind. Downloads from the device.
std::optional<OccupiedVoxels> occupiedVoxels(const OutBase& output);
bool holdsVoxels(const PortKind& kind);

/// Of all textures and buffers that an output refers to.
std::uint64_t heldBytes(const OutBase& output);
/// The voxels of an output's finest level whose field `opacity` is above 0 in some component; nothing without
/// such a field. Downloads from the device.
std::optional<std::uint64_t> opaqueVoxels(const OutBase& output);

struct VoxelizerOptions {
  std::vector<std::filesystem::path> pipelines;  ///< files, or folders of them; none: the committed ones
  std::vector<int> resolutions{64};
  std::vector<std::string> settings;  ///< "name=value", for those pipelines that have the parameter
  std::string camera;
  int width = 0, height = 0;  ///< of the image, for voxelizers that start from one; 0: the camera's
  double time = 0.0;          ///< s
  std::uint64_t seed = 1;
  int repeats = 5;
  /// Timed frames of a voxelizer whose frames take longer than kLongFrameMs: their spread is a small share
  /// of them, and they are most of the work.
  int repeatsOfLongFrames = 3;
  static constexpr double kLongFrameMs = 200.0;
  bool openSweeps = true;  ///< measure the points of the pipelines' sweeps too; axes that are set collapse
  /// Measured again with every triangle split into four, as often as this, at the first resolution: how time
  /// grows with triangles.
  int subdivisions = 0;
  /// Told after every step: the warm-up of a voxelizer, and each of its timed frames. The time left is NaN:
  /// as the steps before.
  std::function<void(std::size_t done, std::size_t total, double secondsLeft)> progress;
};

/// The committed voxelizers' folder, `pipelines/voxelizers` beside the scenes; nullopt when there is none.
std::optional<std::filesystem::path> committedVoxelizers(const std::filesystem::path& start = {});

/// Measures all voxelizers on one scene. The timed frames of those that are held together alternate, so that
/// a machine that grows slower meanwhile does so for all of them (docs/measuring_voxels.md). A voxelizer that
/// cannot be measured has a reason in place of numbers. Error for a folder without pipelines, a wrong text, a
/// resolution outside 1..1024, or a setting that no pipeline knows.
std::vector<VoxelizerRecord> measureVoxelizers(gpu::Device& device, TechniqueSource& techniques,
                                               const Scene& scene, const VoxelizerOptions& options);

/// The same surface with every triangle split into four at the middles of its edges. Error for an object that
/// deforms.
Scene subdivided(const Scene& scene);

}  // namespace lumivox
