// The inside of an executor: a bound pipeline, what its passes made last, and what that was made from.
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
  SceneTraits sceneTraits;  ///< of the scene as it is, with --keep-everything too
  std::vector<std::string> outputNames;
  FrameContext context;

  std::optional<PrunePlan> plan;  ///< made when the first frame or an explanation asks for it
  std::optional<PrunePlan>
      earlierPlan;                    ///< with the parameters before: what it shares with the next one stays
  std::vector<bool> mustRun;          ///< per pass: in the next frame, whatever changed
  Reads announced = Reads::nothing;   ///< changes of the scene itself since the last frame
  std::optional<SceneSnapshot> last;  ///< of the last frame
  bool freesUnused = true;            ///< resources that a frame did not use
  bool complete = false;              ///< the last frame's results are there; otherwise every pass runs
  std::optional<int> lastFrameIndex;
  std::map<int, PassRecord> lastRun;     ///< per pass, from the last time that it ran
  std::map<std::string, double> lastMs;  ///< device time of passes, from the last time that it was measured
  std::map<std::size_t, std::vector<float>> lastOfCamera;  ///< Pass::readsOfCamera(), the same
  /// Per pass, with RenderOptions::accumulate: PassContext::accumulated(). Empty when histories are.
  std::vector<int> stillFrames;
  std::string startsAgain;   ///< a pass whose accumulated frames a change has ended
  bool toldOfStart = false;  ///< the user knows
  std::vector<std::vector<OutputIndex>> countedSources;  ///< per pass: sourcesThatCount() of this plan
  bool interrupted = false;                              ///< an error ended the last frame
  gpu::PassTimers timers;
  /// Passes of the frames whose times are not read yet, and of those whose are and that nobody took.
  std::vector<std::vector<PassRecord>> awaited, timed;
  /// With RenderOptions::checkReads, what every frame is compared with: one that makes it anew, and one that
  /// leaves nothing out.
  std::unique_ptr<PipelineExecutor> scratch, whole;
  bool keepsOutputs = false;  ///< all that are wanted stay after a frame, to be compared

  State(gpu::Device& gpuDevice, TechniqueSource& source, const Scene& sceneToRender, const Pipeline& text,
        const RenderOptions& renderOptions);

  // ---- what runs
  const PrunePlan& planned();
  /// What a run needs; outputs know from now on whether they are wanted by it.
  PrunePlan planFor(const PruneRequest& run);
  /// The next plan is made from nothing: every pass runs, and histories are empty.
  void forgetPlan();
  Reads changesSince(const SceneSnapshot& snapshot, int frameIndex) const;
  std::vector<bool> passesToRun(Reads changed, const SceneSnapshot& snapshot) const;
  bool readsWhatChanged(std::size_t pass, Reads changed, const SceneSnapshot& snapshot) const;

  // ---- what is carried from frame to frame
  /// Sources for PassContext::accumulated(): with --keep-everything too, passes count like those of a run
  /// that leaves out what it can.
  std::vector<std::vector<OutputIndex>> sourcesThatCount();
  std::map<std::string, int> indirectBounces() const;
  void countStillFrames(Reads changed, const SceneSnapshot& snapshot);
  /// Tells, once, that frames accumulate anew since the scene at this time is another.
  void tellOfStart(double time);
  void holdHistories();
  void emptyHistories();

  // ---- what changes between frames
  /// Takes the passes that `begins` names, by index, from a graph that was bound anew; the others stay.
  template <class Begins>
  void replacePasses(BoundGraph next, const Begins& begins);
  /// Calls with the executors that frames are compared with, if there are any.
  template <class Visit>
  void forEachCheck(const Visit& visit) {
    for (const auto& executor : {scratch.get(), whole.get()})
      if (executor != nullptr) visit(*executor);
  }
  void setParameters(const ParameterValues& values);
  void setScene(const Scene& next);
  /// Passes made anew, which remember nothing.
  void renewPasses();

  // ---- times
  /// How the passes of a frame are timed: not at all, by waiting around each, or by the device's time stamps.
  enum class Instrument { none, fence, stamps };
  Instrument instrumentOf(Timing timing) const;
  void keepTimes(std::vector<PassRecord> passes);
  void readTimes(const std::vector<gpu::PassTimers::Frame>& frames);

  // ---- a frame
  void runPass(std::size_t index, Instrument instrument, FrameResult& result);
  /// Before a frame, the snapshot of its time included: what its time starts from.
  Clock::time_point startFrame(Instrument instrument);
  FrameResult frame(SceneSnapshot snapshot, int frameIndex, Images images, Timing timing,
                    Clock::time_point start);
  /// Nothing when a pass had too little room for what it counts.
  std::optional<FrameResult> attempt(Reads changed, Instrument instrument, Clock::time_point start);
  void collectImages(FrameResult& result, Images images);
  void warnOfUnreadTraits(const SceneSnapshot& snapshot) const;
  void checkReads(FrameResult& result);
};

}  // namespace lumivox
