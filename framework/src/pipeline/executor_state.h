// The state of an executor: a bound pipeline, the last results of its passes, and what those were made from.
#pragma once

#include <chrono>
#include <map>
#include <optional>

#include "gpu/memory.h"
#include "pipeline/context.h"
#include "pipeline/graph.h"
#include "pipeline/prune.h"

namespace lumivox {

struct PipelineExecutor::State {
  using Clock = std::chrono::steady_clock;

  gpu::Device& device;
  TechniqueSource& techniques;
  const Scene* scene;
  Pipeline pipeline;
  RenderOptions options;
  const std::shared_ptr<gpu::MemoryAccount> account = std::make_shared<gpu::MemoryAccount>();
  BoundGraph graph;
  PruneRequest request;
  SceneTraits sceneTraits;  ///< the scene's own, also with --keep-everything
  std::vector<std::string> outputNames;
  FrameContext context;

  std::optional<PrunePlan> plan;         ///< made when the first frame or an explanation asks for it
  std::optional<PrunePlan> earlierPlan;  ///< of the previous parameters; results that both plans share stay
  std::vector<bool> mustRun;             ///< per pass: runs in the next frame, whatever changed
  Reads announced = Reads::nothing;      ///< changes of the scene itself since the last frame
  std::optional<SceneSnapshot> last;     ///< of the last frame
  bool freesUnused = true;               ///< frees resources that a frame did not use
  bool complete = false;                 ///< the last frame's results are there; otherwise every pass runs
  std::optional<int> lastFrameIndex;
  std::map<int, PassRecord> lastRun;                       ///< per pass, from the last time that it ran
  std::map<std::string, double> lastMs;                    ///< ms, the last measured device time of passes
  std::map<std::size_t, std::vector<float>> lastOfCamera;  ///< Pass::readsOfCamera(), the same
  /// Per pass, PassContext::accumulated() with RenderOptions::accumulate. Empty while histories are empty.
  std::vector<int> stillFrames;
  std::string startsAgain;                               ///< the pass whose accumulation a change has ended
  bool toldOfStart = false;                              ///< startsAgain was reported
  std::vector<std::vector<OutputIndex>> countedSources;  ///< per pass: sourcesThatCount() of this plan
  bool interrupted = false;                              ///< an error ended the last frame
  gpu::PassTimers timers;
  /// Records of frames whose times are not read back yet, and of frames whose times are, but which nobody
  /// took.
  std::vector<std::vector<PassRecord>> awaited, timed;
  /// With RenderOptions::checkReads, every frame is compared with one made from scratch and with one that
  /// leaves nothing out.
  std::unique_ptr<PipelineExecutor> scratch, whole;
  bool keepsOutputs = false;  ///< keeps all wanted outputs after a frame, for comparison

  State(gpu::Device& gpuDevice, TechniqueSource& source, const Scene& sceneToRender, const Pipeline& text,
        const RenderOptions& renderOptions);

  // ---- what runs
  const PrunePlan& planned();
  /// Plans a run and marks the outputs that it wants.
  PrunePlan planFor(const PruneRequest& run);
  /// Makes the next plan from nothing: every pass runs, and histories are empty.
  void forgetPlan();
  Reads changesSince(const SceneSnapshot& snapshot, int frameIndex) const;
  std::vector<bool> passesToRun(Reads changed, const SceneSnapshot& snapshot) const;
  bool readsWhatChanged(std::size_t pass, Reads changed, const SceneSnapshot& snapshot) const;

  // ---- what is carried from frame to frame
  /// Sources for PassContext::accumulated(). With --keep-everything, only sources count that a pruned run
  /// would read, so that both count alike.
  std::vector<std::vector<OutputIndex>> sourcesThatCount();
  std::map<std::string, int> indirectBounces() const;
  void countStillFrames(Reads changed, const SceneSnapshot& snapshot);
  /// Reports once that accumulation starts again because the scene differs at this time.
  void tellOfStart(double time);
  void holdHistories();
  void emptyHistories();

  // ---- what changes between frames
  /// Takes the passes that `begins` selects from a newly bound graph; the others stay.
  template <class Begins>
  void replacePasses(BoundGraph next, const Begins& begins);
  /// Calls `visit` with each executor that frames are compared with.
  template <class Visit>
  void forEachCheck(const Visit& visit) {
    for (const auto& executor : {scratch.get(), whole.get()})
      if (executor != nullptr) visit(*executor);
  }
  void setParameters(const ParameterValues& values);
  void setScene(const Scene& next);
  /// Replaces all passes by new ones without any memory.
  void renewPasses();

  // ---- times
  /// How passes are timed: not at all, by waiting for the device around each, or by the device's time stamps.
  enum class Instrument { none, fence, stamps };
  Instrument instrumentOf(Timing timing) const;
  void keepTimes(std::vector<PassRecord> passes);
  void readTimes(const std::vector<gpu::PassTimers::Frame>& frames);

  // ---- a frame
  void runPass(std::size_t index, Instrument instrument, FrameResult& result);
  /// Call it before the snapshot of a frame is made: the frame's time starts here.
  Clock::time_point startFrame(Instrument instrument);
  FrameResult frame(SceneSnapshot snapshot, int frameIndex, Images images, Timing timing,
                    Clock::time_point start);
  /// Returns nothing if a pass had too little room for its counts.
  std::optional<FrameResult> attempt(Reads changed, Instrument instrument, Clock::time_point start);
  void collectImages(FrameResult& result, Images images);
  void warnOfUnreadTraits(const SceneSnapshot& snapshot) const;
  void checkReads(FrameResult& result);
};

}  // namespace lumivox
