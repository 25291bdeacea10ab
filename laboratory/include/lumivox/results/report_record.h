// The contents of a report between measuring and writing: the records, and images already encoded.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "lumivox/gpu/device.h"
#include "lumivox/plugin/loader.h"
#include "lumivox/results/records.h"
#include "lumivox/results/runs.h"
#include "lumivox/results/stress_cells.h"
#include "lumivox/results/voxelizers.h"

namespace lumivox {

/// Images of one output at one point, as PNG bytes.
struct OutputImages {
  std::string output, component;
  std::string image;
  struct Against {
    std::string reference;
    std::string flipMap;
    double flip = 0.0;
  };
  std::vector<Against> against;  ///< one per reference layer
};

struct PointRecord {
  ReportPoint point;
  RunIdentity identity;
  std::string created;     ///< empty: it was not measured
  bool isDefault = false;  ///< every parameter as the text has it (with --set)
  std::vector<OutputImages> images;
  std::string node;  ///< as in StoredRun
  double seconds = 0.0;
  MachineState before, after;
};

struct ReferenceRecord {
  std::string layer;
  std::string image;      ///< PNG
  double exposure = 0.0;  ///< EV; that of the scene, but for occlusion, which is shown as it is
  double noise = 0.0;     ///< sqrt of the mean variance of a pixel value
  double mean = 0.0, largest = 0.0;
};

struct PipelineRecord {
  std::string file, name, hash;
};

/// A point of a sweep for which there was no time.
struct LeftOutPoint {
  std::string pipeline, sweep;
  ParameterValues parameters;
};

struct SceneRecord {
  std::string file, name, hash, camera;
  int width = 0, height = 0;
  double time = 0.0;
  std::size_t triangles = 0;
  int referenceSamples = 0;
  double referenceSeconds = 0.0;  ///< to make or to read from the cache
  Display display;                ///< of all its images but those of occlusion
  bool exposureGiven = false;     ///< by --exposure; false: from the full reference
  std::map<std::string, std::string> referenceAttributes;
  std::vector<ReferenceRecord> references;
  std::vector<PointRecord> points;
  std::vector<LeftOutPoint> leftOutPoints;
  std::vector<PruningRecord> pruning;
  std::vector<std::string> leftOutPrunings;                   ///< pipelines for which there was no time
  std::vector<std::pair<std::string, std::string>> unsuited;  ///< pipeline, why
  TimeFloor floor;                                            ///< of the times of its points
};

struct TechniqueRecord {
  std::string name, libraryHash, shaderHash, meaning, paper;
};

struct ReportRecord {
  std::string commandLine, date;                  ///< as typed; when it was made
  std::vector<double> equalTimesMs, equalErrors;  ///< of the tables; empty: round numbers from the data
  double budgetSeconds = 0.0;                     ///< for measuring after the references; 0: no limit
  double measuringSeconds = 0.0;                  ///< that it took
  bool isLook = false;                            ///< one frame, one seed, few positions: nothing is decided
  bool complete = true;                           ///< false: it is still being measured
  gpu::DeviceInfo device;
  std::string shaderInput, host;
  std::vector<PipelineRecord> pipelines;
  std::vector<TechniqueRecord> techniques;
  std::vector<SkippedTechnique> skipped;
  std::vector<SceneRecord> scenes;
  std::vector<PeakRate> peakRates;      ///< of this device; empty when they were not measured
  std::vector<VoxelizerRecord> voxels;  ///< only when they were asked for
  std::vector<StressCell> stress;       ///< that the results store holds, the newest of each
};

std::vector<const ReportPoint*> pointsOf(const SceneRecord& scene);
/// The points of a scene as runs that are in no store.
std::vector<StoredRun> runsOf(const ReportRecord& report, const SceneRecord& scene);

}  // namespace lumivox
