// Tools for writing cases of the battery. A case knows neither techniques nor passes. It makes scenes, lets
// the pipeline under test render them, and compares the results with closed forms, with the reference, or
// with the pipeline's own image of an equivalent scene. The technique's paper card explains a cell that is
// biased or diverges by a property of the published method: docs/stress.md.
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

/// A pass's output held a value that no image may hold.
class Unhealthy : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Changes a snapshot before it is rendered, to teleport cameras and objects. `frame` counts from 0.
using Edit = std::function<void(std::size_t frame, SceneSnapshot&)>;

/// The battery's values of a pipeline's parameters. Full: those of the text. Quick: the first point of its
/// first sweep, by convention the cheapest.
ParameterValues batteryValues(const Pipeline& pipeline, bool quick);

/// How the pipeline under test renders an image. The health of every pass's output is always scanned.
struct Shot {
  int width = 0, height = 0;  ///< 0: the battery's (48 x 48 quick, 96 x 96 full)
  double time = 0.0;          ///< s
  int firstFrame = 0;         ///< index of a sequence's first frame
  std::uint64_t seed = 1;
  std::string camera;
  /// Values over batteryValues(). Parameters that the pipeline lacks are ignored; Bench::parameter() tells.
  ParameterValues parameters;
  /// Parameters of single passes, over everything else: "gather.cones".
  ParameterValues passParameters;
  int subpixels = 1;  ///< the image is the mean over this many positions in the pixel (for comparisons with
                      ///< the reference)
  bool keepEverything = false;
  bool accumulate = false;  ///< frames of a sequence continue from earlier ones
};

struct Frame {
  FrameResult result;
  ImageBuffer whole;  ///< composite (report.h compositeImage); empty where no output is radiance
  /// The image by which frames are compared: `whole`, or, where no output is radiance, the channels of all
  /// outputs. Empty for a pipeline without outputs.
  ImageBuffer compared;
  std::vector<VoxelBox> grids;  ///< those of the passes' outputs, only with Shot::keepEverything
  /// Voxels that the last pass of a pipeline without outputs occupies.
  std::optional<OccupiedVoxels> voxels;
};

/// The pipeline under test on a device. Throws Unhealthy, with the first finding of the first bad pass, when
/// a pass's output holds NaN, infinite or forbidden negative values, so that no case can forget to check.
class Bench {
 public:
  virtual ~Bench() = default;
  virtual bool quick() const = 0;
  virtual const Pipeline& pipeline() const = 0;
  virtual const PipelineParameter* parameter(
      const std::string& name) const = 0;  ///< null: the pipeline has none
  virtual TechniqueSource& techniques() = 0;
  /// Reads a scene text whose paths are relative to `scenes/stress/`, with all checks of a committed scene.
  virtual Scene sceneFromText(const std::string& text) const = 0;
  virtual Scene committedScene(const std::string& name) const = 0;  ///< "cornell", "stress/one_triangle"
  /// Renders one frame with a fresh executor.
  virtual Frame render(const Scene& scene, const Shot& shot = {}) = 0;
  /// Renders frames of one executor at these times in this order; the last one counts.
  virtual std::vector<Frame> renderSequence(const Scene& scene, const std::vector<double>& times,
                                            const Shot& shot = {}, const Edit& edit = {}) = 0;
  /// Hash of everything that the pipeline makes: its outputs, or without outputs the textures and fragments
  /// of its last pass. For bitwise comparisons.
  virtual std::uint64_t contentOf(const Scene& scene, const Shot& shot = {}) = 0;
  /// The same for the last frame of a sequence.
  virtual std::uint64_t contentOfSequence(const Scene& scene, const std::vector<double>& times,
                                          const Shot& shot = {}, const Edit& edit = {}) = 0;
  /// contentOf() on a newly opened device, and in a process of its own with this environment ("NAME=value").
  virtual std::uint64_t contentOnSecondDevice(const Scene& scene, const Shot& shot = {}) = 0;
  virtual std::uint64_t contentElsewhere(const std::string& committedScene, const Shot& shot,
                                         const std::vector<std::string>& environment) = 0;
  /// Error of the last pass's voxels against those that the scene's triangles touch; nullopt where it makes
  /// none.
  virtual std::optional<VoxelError> voxelError(const Scene& scene, const Shot& shot = {}) = 0;
  /// Path-traced reference at the shot's size, with the layers that judge the pipeline's outputs: one bounce,
  /// and as many as they model. Taken from the cache unless a number of threads is given.
  virtual LayeredImage reference(const Scene& scene, const Shot& shot, int samplesPerPixel,
                                 int threads = 0) = 0;
  /// Sets the image that the cell links to; by default the last whole image rendered, or the voxels.
  virtual void show(const ImageBuffer& image) = 0;
};

/// The finding of a case. `outcome` follows from value and limit unless the case says otherwise.
struct Finding {
  StressOutcome outcome = StressOutcome::stable;
  std::string
      measure;       ///< "RMSE against the same scene of 1 m, of its mean"; empty: only health was looked at
  std::string unit;  ///< "" for shares
  Measured value;
  double limit = 0.0;  ///< biased above this; 0 with empty unit and measure: none
  std::string detail;  ///< more numbers: "spectral radius 0.9986, 4600 bounces to 1 %"
};

struct Case {
  StressCaseInfo info;
  /// Nullopt: the case does not apply to this pipeline, which may lack a parameter; a finding can give the
  /// reason.
  std::function<std::optional<Finding>(Bench&)> run;
};

/// value <= limit: stable, else biased.
Finding judged(std::string measure, Measured value, double limit, std::string detail = {});
/// RMS difference divided by the mean of `wanted` (by 1 where that is black).
double relativeDifference(const ImageBuffer& image, const ImageBuffer& wanted);

// The families of cases, one file each: cases_<family>.cpp.
std::vector<Case> stiffTransportCases();
std::vector<Case> geometryCases();
std::vector<Case> scaleAndPlaceCases();
std::vector<Case> lightCases();
std::vector<Case> imageAndCameraCases();
std::vector<Case> timeCases();
/// Refines every number that the pipeline declares.
std::vector<Case> refinementCases(const Pipeline& pipeline);
std::vector<Case> repeatabilityCases();
/// Sets every declared parameter of a pipeline and of its passes to both ends of its range and to every word,
/// with the others at the battery's values. The cases depend on the pipeline.
std::vector<Case> parameterCases(const Pipeline& pipeline, TechniqueSource& techniques);

/// All cases for one pipeline.
std::vector<Case> casesFor(const Pipeline& pipeline, TechniqueSource& techniques);

}  // namespace lumivox::stress
