// Tools for writing a case of the battery. A case knows neither techniques nor passes: it makes scenes, has
// the pipeline under test render them, and compares what comes out with closed forms, with the reference, or
// with the pipeline's own image of an equivalent scene. A cell that is biased or diverges by a property of
// the published method is explained in the technique's paper card: docs/stress.md.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "lumivox/base/image.h"
#include "lumivox/experiment/voxelizers.h"
#include "lumivox/measure/metrics.h"
#include "lumivox/measure/voxels.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/pipeline/port.h"
#include "lumivox/reference/path_tracer.h"
#include "lumivox/results/store.h"
#include "lumivox/scene/scene.h"
#include "lumivox/stress/stress.h"

namespace lumivox::stress {

/// A pass's output held what no image may hold.
class Unhealthy : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Changes a snapshot before it is rendered: teleported cameras and objects. `frame` counts from 0.
using Edit = std::function<void(std::size_t frame, SceneSnapshot&)>;

/// The battery's own values of a pipeline's parameters. Full: as the text has them. Quick: the first point of
/// its first sweep, which by convention is the cheapest.
ParameterValues batteryValues(const Pipeline& pipeline, bool quick);

/// How one image of the pipeline under test is made. Health is always scanned, every pass's output.
struct Shot {
  int width = 0, height = 0;  ///< 0: the battery's (48 x 48 quick, 96 x 96 full)
  double time = 0.0;          ///< s
  int firstFrame = 0;         ///< index of a sequence's first frame
  std::uint64_t seed = 1;
  std::string camera;
  /// Over the battery's own (the first point of the pipeline's first sweep when quick, else the text's). Only
  /// those that the pipeline has are used; Bench::parameter() tells.
  ParameterValues parameters;
  /// Of single passes, over everything: "gather.cones".
  ParameterValues passParameters;
  int subpixels = 1;  ///< the image is the mean over this many positions in the pixel (for comparisons with
                      ///< the reference)
  bool keepEverything = false;
  bool accumulate = false;  ///< frames of a sequence go on from those before them
};

struct Frame {
  FrameResult result;
  ImageBuffer whole;  ///< composite (report.h compositeImage); empty where no output is radiance
  /// By which frames are compared: `whole`, or where no output is radiance the channels of all outputs beside
  /// each other. Empty for a pipeline without outputs.
  ImageBuffer compared;
  std::vector<VoxelBox> grids;  ///< of the passes' outputs, only with Shot::keepEverything
  /// What the last pass of a pipeline without outputs occupies.
  std::optional<OccupiedVoxels> voxels;
};

/// A case's hands: the pipeline under test on a device. Throws Unhealthy (with the first finding of the first
/// bad pass) when a pass's output holds NaN, infinite or forbidden negative values, so that no case can
/// forget to look.
class Bench {
 public:
  virtual ~Bench() = default;
  virtual bool quick() const = 0;
  virtual const Pipeline& pipeline() const = 0;
  virtual const PipelineParameter* parameter(
      const std::string& name) const = 0;  ///< null: the pipeline has none
  virtual TechniqueSource& techniques() = 0;
  /// A text with scene-relative paths below `scenes/stress/`: the same language as a committed scene, with
  /// all of its checks.
  virtual Scene sceneFromText(const std::string& text) const = 0;
  virtual Scene committedScene(const std::string& name) const = 0;  ///< "cornell", "stress/one_triangle"
  /// One frame of a fresh executor.
  virtual Frame render(const Scene& scene, const Shot& shot = {}) = 0;
  /// Frames of one executor, at these times in this order; the last is what matters.
  virtual std::vector<Frame> renderSequence(const Scene& scene, const std::vector<double>& times,
                                            const Shot& shot = {}, const Edit& edit = {}) = 0;
  /// Bits of everything that the pipeline makes: outputs, or for a pipeline without outputs the textures and
  /// fragments of its last pass. For comparisons "the same bits".
  virtual std::uint64_t contentOf(const Scene& scene, const Shot& shot = {}) = 0;
  /// The same of the last of a sequence's frames.
  virtual std::uint64_t contentOfSequence(const Scene& scene, const std::vector<double>& times,
                                          const Shot& shot = {}, const Edit& edit = {}) = 0;
  /// The same as contentOf() on a device that is opened for it, and in a process of its own with these
  /// "NAME=value".
  virtual std::uint64_t contentOnSecondDevice(const Scene& scene, const Shot& shot = {}) = 0;
  virtual std::uint64_t contentElsewhere(const std::string& committedScene, const Shot& shot,
                                         const std::vector<std::string>& environment) = 0;
  /// How the voxels of the last pass differ from those that the scene's triangles touch; nullopt when it
  /// makes none.
  virtual std::optional<VoxelError> voxelError(const Scene& scene, const Shot& shot = {}) = 0;
  /// Path-traced reference at the shot's size, with the layers that the pipeline's outputs are judged by: of
  /// one bounce, and of as many as they model. From the cache, unless a number of threads is asked for.
  virtual LayeredImage reference(const Scene& scene, const Shot& shot, int samplesPerPixel,
                                 int threads = 0) = 0;
  /// The image that the cell links to; without it the last whole image that was rendered, or the voxels.
  virtual void show(const ImageBuffer& image) = 0;
};

/// The finding of a case. `outcome` follows from value and limit unless the case says otherwise.
struct Finding {
  StressOutcome outcome = StressOutcome::stable;
  std::string
      measure;       ///< "RMSE against the same scene of 1 m, of its mean"; empty: only health was looked at
  std::string unit;  ///< "" for shares
  Measured value;
  double limit = 0.0;  ///< above: biased; 0 with an empty unit and measure: none
  std::string detail;  ///< more numbers: "spectral radius 0.9986, 4600 bounces to 1 %"
};

struct Case {
  StressCaseInfo info;
  /// Nullopt: the case says nothing about this pipeline (a parameter that it lacks); `why` may be left in the
  /// finding.
  std::function<std::optional<Finding>(Bench&)> run;
};

/// value <= limit: stable, else biased.
Finding judged(std::string measure, Measured value, double limit, std::string detail = {});
/// RMS difference divided by the mean of `wanted` (by 1 where that is black).
double relativeDifference(const ImageBuffer& image, const ImageBuffer& wanted);

// The families, a file each: cases_<family>.cpp.
std::vector<Case> stiffTransportCases();
std::vector<Case> geometryCases();
std::vector<Case> scaleAndPlaceCases();
std::vector<Case> lightCases();
std::vector<Case> imageAndCameraCases();
std::vector<Case> timeCases();
/// Every number that the pipeline declares.
std::vector<Case> refinementCases(const Pipeline& pipeline);
std::vector<Case> repeatabilityCases();
/// Every declared parameter of a pipeline and of its passes at both ends of its range and at every word, the
/// others at the battery's own values. They depend on the pipeline.
std::vector<Case> parameterCases(const Pipeline& pipeline, TechniqueSource& techniques);

/// All of them for one pipeline.
std::vector<Case> casesFor(const Pipeline& pipeline, TechniqueSource& techniques);

}  // namespace lumivox::stress
