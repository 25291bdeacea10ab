// Voxelisers measured: every pipeline that makes voxels, for time, memory and what its grid gets wrong.
// Definitions: docs/metrics.md. How to read the results: docs/measuring_voxels.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/gpu/device.h"
#include "lumivox/measure/metrics.h"
#include "lumivox/measure/voxels.h"
#include "lumivox/pipeline/pipeline.h"

namespace lumivox {

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

/// One output of one voxeliser on one scene at one resolution.
struct VoxeliserRecord {
  std::string scene, pipeline;  ///< files as shown
  std::string output;           ///< "pass.port"
  std::string kind;             ///< of the port
  ParameterValues parameters;   ///< all of the pipeline's
  bool isDefault = true;  ///< as the text has them but for the resolution and --set; else a sweep's point
  std::string whyNot;     ///< why there are no numbers; empty when there are
  int resolution = 0;     ///< asked for, along the longest side
  GridPlacement grid;
  std::size_t triangles = 0;
  int subdivisions = 0;      ///< how often every triangle was split into four before: more triangles of the
                             ///< same surface
  TimingStatistics frameMs;  ///< a frame in which every pass that the output needs runs, from nothing
  std::uint64_t fragments = 0, occupied = 0;
  std::uint64_t bytes = 0;           ///< of the output: fragments in use, or the grid
  std::uint64_t allocatedBytes = 0;  ///< of all resources of the pipeline's passes
  std::uint64_t truth = 0;           ///< voxels that the exact test is certain of
  std::uint64_t undecided = 0;       ///< touched or missed by no more than kContactTolerance
  VoxelError error;
  RayHoles holes;

  double bytesPerFragment() const;  ///< 0 without fragments
  double bytesPerVoxel() const;     ///< per occupied voxel; 0 when none is
  std::string label() const;        ///< the text's stem, the output when it has several, a sweep's point
};

struct VoxeliserOptions {
  std::vector<std::filesystem::path> pipelines;  ///< files, or folders of them; none: the committed ones
  std::vector<int> resolutions{64};
  std::vector<std::string> settings;  ///< "name=value", for those pipelines that have the parameter
  std::string camera;
  int width = 0, height = 0;  ///< of the picture, for voxelisers that start from one; 0: the camera's
  double time = 0.0;          ///< s
  std::uint64_t seed = 1;
  int repeats = 5;
  /// Timed frames of a voxeliser whose frames take longer than kLongFrameMs: their spread is a small share
  /// of them, and they are most of the work.
  int repeatsOfLongFrames = 3;
  static constexpr double kLongFrameMs = 200.0;
  bool openSweeps = true;  ///< measure the points of the pipelines' sweeps too; axes that are set collapse
  /// Measured again with every triangle split into four, as often as this, at the first resolution: how time
  /// grows with triangles.
  int subdivisions = 0;
};

/// The committed voxelisers' folder, `pipelines/voxelisers` beside the scenes; nullopt when there is none.
std::optional<std::filesystem::path> committedVoxelisers(const std::filesystem::path& start = {});

/// Measures all voxelisers on one scene. The timed frames of those that are held together alternate, so that
/// a machine that grows slower meanwhile does so for all of them (docs/measuring_voxels.md). A voxeliser that
/// cannot be measured has a reason in place of numbers. Error for a folder without pipelines, a wrong text, a
/// resolution outside 1..1024, or a setting that no pipeline knows.
std::vector<VoxeliserRecord> measureVoxelisers(gpu::Device& device, TechniqueSource& techniques,
                                               const Scene& scene, const VoxeliserOptions& options);

/// How a voxeliser's time grows: the exponent p of a power law time ~ x^p through the medians (least squares
/// in logarithms).
struct VoxeliserScaling {
  std::string scene, label;
  std::optional<double> withResolution;  ///< x: voxels along a side; at least two resolutions
  std::optional<double> withTriangles;   ///< x: triangles; at least two numbers of them
};
std::vector<VoxeliserScaling> scalingOf(const std::vector<VoxeliserRecord>& records);

/// The same surface with every triangle split into four at the middles of its edges. Error for an object that
/// deforms.
Scene subdivided(const Scene& scene);

/// Writes `folder`/index.html, voxels.csv and voxels.json. Error (before any work: requireWritable) when one
/// cannot be written.
struct VoxeliserFiles {
  std::filesystem::path page, csv, json;
};
VoxeliserFiles voxeliserFiles(const std::filesystem::path& folder);
void writeVoxelisers(const VoxeliserFiles& files, const std::vector<VoxeliserRecord>& records,
                     const gpu::DeviceInfo& device, const std::string& commandLine);
/// The JSON alone.
std::string voxelisersJson(const std::vector<VoxeliserRecord>& records, const gpu::DeviceInfo& device,
                           const std::string& commandLine);

}  // namespace lumivox
