// Measures points of one scene into a results store, for reports, sweeps and tuning. Errors and work are
// measured apart from times, whose frames take turns (experiment/turns.h).
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

/// A point to be measured.
struct WantedPoint {
  const LoadedPipeline* loaded = nullptr;
  PlannedPoint point;
  std::optional<std::uint64_t> seed = std::nullopt;  ///< only this one, in place of the seeds of the options
};

/// Unique among the points of one scene.
std::string idOf(const WantedPoint& point);

class Measurer {
 public:
  /// Number of points whose timed frames take turns. Everything but a point's times is stored at once, so
  /// that an interruption loses only the point at work and the times of the batch.
  static constexpr std::size_t kBatch = 6;

  enum class Images { no, kept };
  /// The store keeps images beside the numbers where they are wanted. Measurers of one job share `costs`.
  Measurer(gpu::Device& device, TechniqueSet& techniques, const ReportOptions& options, ResultsStore& store,
           Scene scene, std::string sceneShown, Images images = Images::no,
           std::shared_ptr<Costs> costs = std::make_shared<Costs>());

  /// For each of these points, in order, whether the store holds it. A failure counts as held unless
  /// `retryFailed`.
  std::vector<bool> held(const std::vector<WantedPoint>& points, bool retryFailed) const;
  std::string key(const WantedPoint& point) const;
  std::string text(const WantedPoint& point) const;

  /// The store is a share. Nobody watches it, so that no frame is rendered to learn what the rest takes.
  /// Unless null, `into` is the store that it will be merged into: what is there is not measured again, and
  /// what is claimed there for other stores is left to them.
  void measureShare(ResultsStore* into);
  /// Of the points of measure(), those left to other shares.
  std::size_t leftToOthers() const { return leftToOthers_; }

  /// A point before it is measured: its identity and its names.
  StoredRun open(const WantedPoint& point) const;

  /// Measures the points together, at most kBatch at once, and stores them; gives them back as they are in
  /// the store now. Points that another process measures are left to it, and waited for at the end. `done` is
  /// told how many points were measured here and how many by others: of a batch point after point, the last
  /// of them when all are timed.
  std::vector<StoredRun> measure(const std::vector<WantedPoint>& points,
                                 const std::function<void(std::size_t, std::size_t)>& done = {});
  /// Times the first of these points that the store holds once more, in the same way and at most as many as
  /// are timed together. The difference is the machine's drift.
  void control(const std::vector<WantedPoint>& points, std::size_t most = kBatch);
  /// How far repeated times of the same point differ on this device, from the controls in a store.
  TimeFloor floor(const ResultsStore& store) const;
  TimeFloor floor() const { return floor(store_); }
  /// Takes the points that the store holds from it and measures the others.
  std::vector<StoredRun> fetch(const std::vector<WantedPoint>& points,
                               const std::function<void(std::size_t, std::size_t)>& done = {});

  const Scene& scene() const { return scene_; }
  int width() const { return width_; }
  int height() const { return height_; }
  const ReferenceOptions& referenceOptions() const { return referenceOptions_; }
  /// Makes the reference with all layers that these points are judged by. measure() does so for its own
  /// points where needed.
  void makeReference(const std::vector<WantedPoint>& points);
  SceneReference& reference() { return reference_.value(); }
  /// Renders a frame of each of their pipelines that has none yet; expected times follow from it.
  void lookAt(const std::vector<WantedPoint>& points);
  bool wasLookedAt(const WantedPoint& point) const { return frames_.contains(point.loaded); }
  /// Time of a frame of the point in which everything runs, s. 0 where it fails: a failure costs little, and
  /// its point says why.
  double frameSeconds(const WantedPoint& point);
  double knownFrameSeconds(const WantedPoint& point) const;  ///< after lookAt() of its pipeline
  /// Longest time of a point, s: that of the longest point of its pipeline so far, or, before there is one,
  /// by its frame (bench/point_cost). Promises rest on this one.
  double mostSeconds(const WantedPoint& point);
  /// Expected time of a point, s, from similar ones.
  double expectedSeconds(const WantedPoint& point) const;
  /// Expected time, s, of those of these points that are not done yet, including the batch under way. Points
  /// that would end beyond `room` s do not count.
  double secondsLeft(const std::vector<WantedPoint>& points,
                     double room = std::numeric_limits<double>::infinity()) const;
  /// Expected time of control() of these points, s.
  double controlSeconds(const std::vector<WantedPoint>& points, std::size_t most = kBatch) const;
  /// Expected time of making the reference, s; 0 once it is there.
  double referenceSeconds() const;
  /// Time that a point took, s, with its share of the batch's times; 0 where it was not measured here.
  double secondsOf(const WantedPoint& point) const;
  /// The same by purpose; empty where it was not measured here.
  std::map<std::string, double> partsOf(const WantedPoint& point) const;

 private:
  /// The options of one run, with its seeds.
  ReportOptions optionsOf(const RunIdentity& identity) const;
  struct Entry {
    WantedPoint wanted;
    StoredRun run;
    std::vector<StoredImage> images = {};
  };
  using Batch = std::vector<Entry>;
  /// At most a batch of points that this process may measure now. Removes them from `pending`, as well as
  /// what others have stored in the meantime.
  Batch claimed(std::vector<WantedPoint>& pending, std::size_t& byOthers);
  void measureBatch(Batch& batch, const std::function<void(std::size_t, std::size_t)>& done);
  /// Takes the errors, images and work of a point from an interrupted run; false where there are none.
  bool takeUp(Entry& entry) const;
  /// Measures all but the times, and keeps it until the times are there.
  void measureUntimed(Entry& entry);
  /// Updates what an interruption would report.
  void noteProgress();
  void timeTogether(Batch& batch);
  /// A frame of the point's pipeline: its time, s, as accurately as a plan needs, and whether it reads random
  /// numbers, so that seeds are measured. Error when it fails.
  struct Frame {
    double seconds = 0.0;
    bool readsSeed = false;
  };
  Frame frame(const WantedPoint& point);
  double referenceWeight() const;
  /// Time of a point before one of its pipeline was measured, s, by its frame; also the weight of its costs.
  double plannedSeconds(const WantedPoint& point, const std::string& work) const;
  void noteCost(const WantedPoint& point, const std::string& work, double seconds);
  double expectedSeconds(const WantedPoint& point, const std::string& work) const;
  /// Subject of a point's costs: its pipeline on this scene.
  std::string subjectOf(const WantedPoint& point) const;
  std::string waitingText(const std::vector<WantedPoint>& pending) const;

  gpu::Device& device_;
  TechniqueSet& techniques_;
  const ReportOptions& options_;
  ResultsStore& store_;
  ResultsStore* into_ = nullptr;
  bool estimates_ = true;
  std::size_t leftToOthers_ = 0;
  Scene scene_;
  std::string sceneShown_;
  Images images_;
  int width_ = 0, height_ = 0;
  ReferenceOptions referenceOptions_;
  std::optional<SceneReference> reference_;
  std::optional<VoxelReferences> voxelReferences_;  ///< made once a point needs them
  std::map<std::string, double> seconds_;           ///< by key
  std::map<std::string, std::map<std::string, double>> parts_;
  std::shared_ptr<Costs> costs_;
  std::map<const LoadedPipeline*, Frame> frames_;
  /// The batch under way: its points, and how many of them lack only their times.
  std::vector<WantedPoint> underWay_;
  std::size_t untimedDone_ = 0;
  std::set<std::string> done_;  ///< points measured here or by others
  InterruptionNote note_;
};

/// Replaces names, parameters and command of a point from elsewhere by those that it has here.
void nameAs(ReportPoint& point, const ReportPoint& here);

}  // namespace lumivox::experiment
