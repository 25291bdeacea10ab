// What a report holds between measuring and writing: the public records, and pictures already encoded for the
// page.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lumivox/report/comparison.h"
#include "lumivox/report/report.h"
#include "lumivox/report/store.h"
#include "lumivox/report/voxelisers.h"

namespace lumivox::report {

/// Pictures of one output at one point, as PNG bytes.
struct OutputPictures {
  std::string output, component;
  std::string picture;
  struct Against {
    std::string truth;
    std::string flipMap;
    double flip = 0.0;
  };
  std::vector<Against> against;  ///< one per truth layer
};

struct PointRecord {
  ReportPoint point;
  bool isDefault = false;  ///< every parameter as the text has it (with --set)
  std::string failure;     ///< why there are no numbers; empty when there are
  std::vector<OutputPictures> pictures;
};

struct TruthRecord {
  std::string layer;
  std::string picture;    ///< PNG
  double exposure = 1.0;  ///< common to every picture of this component
  double noise = 0.0;     ///< sqrt of the mean variance of a pixel value
  double mean = 0.0, largest = 0.0;
};

struct PipelineRecord {
  std::string file, name, hash;
};

struct SceneRecord {
  std::string file, name, hash, camera;
  int width = 0, height = 0;
  double time = 0.0;
  std::size_t triangles = 0;
  int truthSamples = 0;
  double truthSeconds = 0.0;  ///< to make or to read from the cache
  std::map<std::string, std::string> truthAttributes;
  std::vector<TruthRecord> truths;
  std::vector<PointRecord> points;
  std::vector<PruningRecord> pruning;
  std::vector<std::pair<std::string, std::string>> unsuited;  ///< pipeline, why
  std::vector<PipelineComparison> comparisons;
};

struct TechniqueRecord {
  std::string name, libraryHash, shaderHash, meaning, paper;
};

struct ReportData {
  ReportOptions options;
  gpu::DeviceInfo device;
  std::string shaderInput, host, date;
  std::vector<PipelineRecord> pipelines;
  std::vector<TechniqueRecord> techniques;
  std::vector<SkippedTechnique> skipped;
  std::vector<SceneRecord> scenes;
  std::vector<DeviceCeiling> ceilings;  ///< of this device; empty when nobody has measured them
  std::vector<VoxeliserRecord> voxels;  ///< only when they were asked for
  std::vector<StressCell> stress;       ///< that the results store holds, the newest of each
};

/// The metrics that the page compares pipelines by.
inline constexpr const char* kPageMetrics[] = {"rmse", "relative_mse", "percentile95", "flip"};

/// Everything but the pictures.
nlohmann::ordered_json toJson(const ReportData& data);
/// One row per point, output and truth layer (RFC 4180).
std::string toCsv(const ReportData& data);

/// The one self-contained page. `chartLibrary` is the text of Chart.js.
std::string toHtml(const ReportData& data, const std::string& chartLibrary);

/// Chart.js of the distribution (package libjs-chart.js). AbsentError names the package and where it was
/// sought.
std::string chartLibrary();

std::string base64(const std::string& bytes);

/// One field of a CSV row (RFC 4180), quoted where it needs it.
std::string csvField(const std::string& text);

/// The components that some point has an error for, in the order of a picture's making; the whole picture
/// last.
std::vector<std::string> componentsOf(const std::vector<const ReportPoint*>& points);
std::vector<const ReportPoint*> pointsOf(const SceneRecord& scene);

/// The error of a component at a point, if it was measured: against the bias truth or the full one (a
/// component with one truth has only the first, which then answers for both). For the component "final" it is
/// that of the whole picture.
const ComponentError* errorOf(const ReportPoint& point, const std::string& component, bool bias);

/// The comparison of a component by a metric; null when no point has it. One truth answers for both.
const PipelineComparison* comparisonOf(const SceneRecord& scene, const std::string& component, bool bias,
                                       const std::string& metric);

}  // namespace lumivox::report
