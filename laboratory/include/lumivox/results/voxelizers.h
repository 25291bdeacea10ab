// Measurements of a voxelizer: time, memory and the errors of its grid. Definitions: docs/metrics.md.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "lumivox/measure/metrics.h"
#include "lumivox/measure/voxels.h"
#include "lumivox/pipeline/pipeline.h"

namespace lumivox {

/// One output of one voxelizer on one scene at one resolution.
struct VoxelizerRecord {
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
  std::uint64_t reference = 0;       ///< voxels that the exact test is certain of
  std::uint64_t undecided = 0;       ///< touched or missed by no more than kContactTolerance
  VoxelError error;
  RayHoles holes;

  double bytesPerFragment() const;  ///< 0 without fragments
  double bytesPerVoxel() const;     ///< per occupied voxel; 0 when none is
  std::string label() const;        ///< the text's stem, the output when it has several, a sweep's point
};

}  // namespace lumivox
