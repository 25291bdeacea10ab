// Measures points of one scene into a results store, for reports, sweeps and the search for the best: errors
// and work apart from times, the timed frames taking turns (experiment/turns.h).
#pragma once

#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "experiment/choice.h"
#include "experiment/costs.h"
#include "experiment/gathered_voxels.h"
#include "experiment/measure.h"
#include "lumivox/base/interruption.h"
#include "lumivox/results/store.h"

namespace lumivox::experiment {

/// One point that somebody wants to know.
struct WantedPoint {
  const LoadedPipeline* loaded = nullptr;
  PlannedPoint point;
  std::optional<std::uint64_t> seed = std::nullopt;  ///< that alone, in place of the seeds of the options
};

class Measurer {
 public:
  /// Points whose timed frames take turns, each keeping its results while it waits. What is known of a point
  /// before its times is in the store at once, so that an interruption loses the point at work and the times
  /// of the batch.
  static constexpr std::size_t kBatch = 6;

  enum class Images { no, kept };
  /// Images are kept in the store, beside the numbers, where they are wanted. Measurers of one job share what
  /// they know of `costs`.
  Measurer(gpu::Device& device, TechniqueSet& techniques, const ReportOptions& options, ResultsStore& store,
           Scene scene, std::string sceneShown, Images images = Images::no,
           std::shared_ptr<Costs> costs = std::make_shared<Costs>());

  /// Which of these points the store holds, in their order, before anything is measured. A failure counts as
  /// held unless `retryFailed`.
  std::vector<bool> held(const std::vector<WantedPoint>& points, bool retryFailed) const;
  std::string key(const WantedPoint& point) const;
  std::string text(const WantedPoint& point) const;

  /// A point before it is measured: what it depends on and how it is called.
  StoredRun open(const WantedPoint& point) const;

  /// Measures the points together, at most kBatch at once, and stores them; gives them back as they are in
  /// the store now. Points that another process measures are left to it, and waited for at the end. `done` is
  /// told how many points were measured here and how many by others: of a batch point after point, the last
  /// of them when all are timed.
  std::vector<StoredRun> measure(const std::vector<WantedPoint>& points,
                                 const std::function<void(std::size_t, std::size_t)>& done = {});
  /// Times the first of these points that the store holds once more, at most as many as are timed together,
  /// in the same way: what differs is the machine's mood.
  void control(const std::vector<WantedPoint>& points, std::size_t most = kBatch);
  /// How far times of the same thing differ on this device, from the controls in a store.
  TimeFloor floor(const ResultsStore& store) const;
  TimeFloor floor() const { return floor(store_); }
  /// Those that the store holds are taken from it, the others are measured.
  std::vector<StoredRun> fetch(const std::vector<WantedPoint>& points,
                               const std::function<void(std::size_t, std::size_t)>& done = {});

  const Scene& scene() const { return scene_; }
  int width() const { return width_; }
  int height() const { return height_; }
  const ReferenceOptions& referenceOptions() const { return referenceOptions_; }
  /// Makes it with all layers that these points are judged by; measure() does it for its own where it is not
  /// there.
  void makeReference(const std::vector<WantedPoint>& points);
  SceneReference& reference() { return reference_.value(); }
  /// Renders a frame of each of their pipelines that has none yet, so that times are expected by it.
  void lookAt(const std::vector<WantedPoint>& points);
  bool wasLookedAt(const WantedPoint& point) const { return frames_.contains(point.loaded); }
  /// s, of a frame of the point in which everything runs; 0 where that fails: what fails costs little, and
  /// its point says why.
  double frameSeconds(const WantedPoint& point);
  double knownFrameSeconds(const WantedPoint& point) const;  ///< once its pipeline was looked at
  /// What a point takes at most, as far as is known, s: as long as the longest of its pipeline's so far;
  /// before there is one, by its frame (bench/point_cost). What is promised goes by it.
  double mostSeconds(const WantedPoint& point);
  /// What it is expected to take, s: as its likes did.
  double expectedSeconds(const WantedPoint& point) const;
  /// What those of these points that are not done yet, the batch under way among them, are expected to take,
  /// s; of points that would end beyond `room` s nothing.
  double secondsLeft(const std::vector<WantedPoint>& points,
                     double room = std::numeric_limits<double>::infinity()) const;
  /// What control() of these is expected to take, s.
  double controlSeconds(const std::vector<WantedPoint>& points, std::size_t most = kBatch) const;
  /// What making the reference is expected to take, s: 0 once it is there.
  double referenceSeconds() const;
  /// How long a point took that was measured here, its share of the batch's times included, s; 0: it was not.
  double secondsOf(const WantedPoint& point) const;
  /// The same by what for; empty: it was not.
  std::map<std::string, double> partsOf(const WantedPoint& point) const;

 private:
  /// The options of one run: of its seeds.
  ReportOptions optionsOf(const RunIdentity& identity) const;
  struct Entry {
    WantedPoint wanted;
    StoredRun run;
    std::vector<StoredImage> images = {};
  };
  using Batch = std::vector<Entry>;
  /// Points that this process may measure now, at most a batch; takes them, and what others have stored
  /// meanwhile, out of `pending`.
  Batch claimed(std::vector<WantedPoint>& pending, std::size_t& byOthers);
  void measureBatch(Batch& batch, const std::function<void(std::size_t, std::size_t)>& done);
  /// Errors, images and work of a point that an interrupted run has left; false: there are none.
  bool takeUp(Entry& entry) const;
  /// Measures them, and keeps them until the times are there.
  void measureUntimed(Entry& entry);
  /// What an interruption would say now.
  void noteProgress();
  void timeTogether(Batch& batch);
  /// A frame of its pipeline, s, with no more care than a plan needs, and whether it asks for random numbers,
  /// so that seeds are to be measured. Error when it fails.
  struct Frame {
    double seconds = 0.0;
    bool readsSeed = false;
  };
  Frame frame(const WantedPoint& point);
  double referenceWeight() const;
  /// Before a point of its pipeline was measured: by its frame, s, which is also the weight of its costs.
  double plannedSeconds(const WantedPoint& point, const std::string& work) const;
  void noteCost(const WantedPoint& point, const std::string& work, double seconds);
  double expectedSeconds(const WantedPoint& point, const std::string& work) const;
  /// Of the costs of a point: its pipeline on this scene.
  std::string subjectOf(const WantedPoint& point) const;
  std::string waitingText(const std::vector<WantedPoint>& pending) const;

  gpu::Device& device_;
  TechniqueSet& techniques_;
  const ReportOptions& options_;
  ResultsStore& store_;
  Scene scene_;
  std::string sceneShown_;
  Images images_;
  int width_ = 0, height_ = 0;
  ReferenceOptions referenceOptions_;
  std::optional<SceneReference> reference_;
  std::optional<VoxelReferences> voxelReferences_;  ///< once a point needs them
  std::map<std::string, double> seconds_;           ///< by key
  std::map<std::string, std::map<std::string, double>> parts_;
  std::shared_ptr<Costs> costs_;
  std::map<const LoadedPipeline*, Frame> frames_;
  /// The batch under way: its points, and how many of them lack nothing but times.
  std::vector<WantedPoint> underWay_;
  std::size_t untimedDone_ = 0;
  std::set<std::string> done_;  ///< points that were measured, here or by others
  InterruptionNote note_;
};

/// Gives a point that was measured elsewhere the names, parameters and command that it has here.
void nameAs(ReportPoint& point, const ReportPoint& here);

}  // namespace lumivox::experiment
