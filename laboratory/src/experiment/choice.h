// What a report or a sweep measures: the pipelines for a scene, the image size and the reference.
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
  ParameterValues settings;  ///< those of the command line that the pipeline has
};

/// The pipeline with those settings that it knows.
LoadedPipeline withSettings(Pipeline pipeline, const std::vector<std::string>& settings);

/// Refuses a setting that no pipeline knows, which is a typing error.
void requireKnownSettings(const std::vector<const LoadedPipeline*>& pipelines,
                          const std::vector<std::string>& settings);

/// The pipelines for a scene: those given, or every committed one that suits it. All texts are checked before
/// the first measurement.
class PipelineChoice {
 public:
  PipelineChoice(const ReportOptions& options, TechniqueSet& techniques);

  /// The checked pipelines of the options.
  const std::vector<LoadedPipeline>& given() const { return given_; }
  /// `unsuited` receives each pipeline that does not suit the scene, with the reason.
  std::vector<const LoadedPipeline*> forScene(const Scene& scene,
                                              std::vector<std::pair<std::string, std::string>>& unsuited);

 private:
  std::string missingTechnique(const Pipeline& pipeline);

  const ReportOptions& options_;
  TechniqueSet& techniques_;
  std::vector<LoadedPipeline> given_;
  std::map<std::filesystem::path, std::vector<LoadedPipeline>> committed_;
};

/// The points of a report, a sweep or a search: those of plannedPoints(). A progressive pipeline also has its
/// default point after more and more frames.
std::vector<PlannedPoint> pointsFor(const LoadedPipeline& loaded, TechniqueSource& techniques,
                                    const ReportOptions& options);

/// The requested size, else the camera's, reduced on a software rasteriser.
std::pair<int, int> measuredSize(const gpu::Device& device, const Scene& scene, const ReportOptions& options);
ReferenceOptions referenceOptionsOf(const ReportOptions& options, int width, int height);

/// A point before it is measured: its identity and its names.
StoredRun storedRunOf(gpu::Device& device, TechniqueSource& techniques, const Scene& scene,
                      const LoadedPipeline& loaded, const PlannedPoint& point, const ReportOptions& options,
                      int width, int height, int referenceSamples, const std::string& sceneShown);

}  // namespace lumivox::experiment
