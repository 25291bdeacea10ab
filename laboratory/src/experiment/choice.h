// The choice of a report and a sweep: which pipelines on a scene, at which size, against which reference.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "experiment/plan.h"
#include "lumivox/experiment/report.h"
#include "lumivox/results/store.h"

namespace lumivox::experiment {

struct LoadedPipeline {
  Pipeline pipeline;
  std::string shown;         ///< the file as a person would type it here
  ParameterValues settings;  ///< of the command line, those that it has
};

/// The pipeline with the settings that it knows.
LoadedPipeline withSettings(Pipeline pipeline, const std::vector<std::string>& settings);

/// Refuses a setting that no pipeline knows: a slip of the pen.
void requireKnownSettings(const std::vector<const LoadedPipeline*>& pipelines,
                          const std::vector<std::string>& settings);

/// All pipelines of a scene: those given, or every committed one that suits it. Every text is checked before
/// anything is measured.
class PipelineChoice {
 public:
  PipelineChoice(const ReportOptions& options, TechniqueSet& techniques);

  /// Those of the options, checked.
  const std::vector<LoadedPipeline>& given() const { return given_; }
  /// `unsuited`: pipeline and why, for those that are left out by themselves.
  std::vector<const LoadedPipeline*> forScene(const Scene& scene,
                                              std::vector<std::pair<std::string, std::string>>& unsuited);

 private:
  std::string missingTechnique(const Pipeline& pipeline);

  const ReportOptions& options_;
  TechniqueSet& techniques_;
  std::vector<LoadedPipeline> given_;
  std::map<std::filesystem::path, std::vector<LoadedPipeline>> committed_;
};

/// The points of a report, a sweep or a search: those of plannedPoints(), and of a progressive pipeline its
/// default point after more and more frames.
std::vector<PlannedPoint> pointsFor(const LoadedPipeline& loaded, TechniqueSource& techniques,
                                    const ReportOptions& options);

/// The size that is asked for, or the camera's, smaller on a software rasteriser.
std::pair<int, int> measuredSize(const gpu::Device& device, const Scene& scene, const ReportOptions& options);
ReferenceOptions referenceOptionsOf(const ReportOptions& options, int width, int height);

/// A point before it is measured: what it depends on and how it is called.
StoredRun storedRunOf(gpu::Device& device, TechniqueSource& techniques, const Scene& scene,
                      const LoadedPipeline& loaded, const PlannedPoint& point, const ReportOptions& options,
                      int width, int height, int referenceSamples, const std::string& sceneShown);

}  // namespace lumivox::experiment
