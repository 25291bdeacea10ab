// The results store: every measured point with everything that it depends on, in one SQLite file. Schema and
// the meaning of each column: docs/results.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/report/report.h"

namespace lumivox {

/// Everything that a result depends on. Two runs with the same identity measure the same thing, so that the
/// second is not run.
struct RunIdentity {
  std::string sceneHash, pipelineHash;            ///< of the texts with all that they include and name
  std::map<std::string, std::string> techniques;  ///< name to hash of library and shader pack
  std::string framework;                          ///< hash of the framework's own libraries
  std::map<std::string, std::string> parameters;  ///< all parameters of the pipeline, as settings
  std::string camera;
  double time = 0.0;  ///< s
  int width = 0, height = 0;
  std::uint64_t seed = 1;
  int seeds = 1, repeats = 1, subpixels = 1, truthSamples = 0;
  int flickerPairs = 0;                           ///< 0 where the scene does not move
  std::vector<std::string> kept;                  ///< sorted outputs "pass.port" that no picture needs
  std::string device, driver, shaderInput, host;  ///< host: processor and system

  std::string key() const;  ///< 32 hexadecimal digits
};

/// The times of a stored run measured once more, later: what differs is the machine's mood alone.
struct RepeatedControl {
  std::string created;            ///< "2015-10-21 16:29:00 UTC"
  Measured frameMs, nextFrameMs;  ///< of the run
  Measured frameMsAgain, nextFrameMsAgain;
};

/// How far apart two times of the same thing were found on one machine, as a share of the smaller.
struct TimeFloor {
  double frame = 0.0, nextFrame = 0.0;
  int controls = 0;  ///< that say so; 0: nobody has looked
};
/// The largest of the controls.
TimeFloor timeFloorOf(const std::vector<RepeatedControl>& controls);
/// The larger of both, for numbers of both.
TimeFloor larger(const TimeFloor& a, const TimeFloor& b);

/// A picture of a run: an output, or its FLIP map against a layer of the truth.
struct StoredPicture {
  std::string output, component;
  std::string truth;  ///< layer of the map; empty: the output itself
  double flip = 0.0;  ///< mean of the map
  std::string png;
};

/// Who is measuring a point at present.
struct RunClaim {
  std::string machine;  ///< and its start and name space of processes: where `process` means something
  int process = 0;
  std::uint64_t started = 0;  ///< of the process, so that another one with its number is told apart
  std::string command;        ///< its command line
  std::int64_t expires = 0;   ///< s since 1970
};

/// One record of the store.
struct StoredRun {
  std::int64_t id = 0;  ///< in its store; 0 before it is stored
  RunIdentity identity;
  std::string created;  ///< "2015-10-21 16:29:00 UTC"
  std::string version;  ///< of lumivox
  std::string sceneName, pipelineName;
  bool isDefault = false;  ///< every parameter as the text has it
  ReportPoint point;       ///< `command` repeats it; a point with `failure` has no numbers
};

/// Which runs. Empty members do not restrict. Names match when they are the stem, the whole path or the
/// title of the text.
struct RunFilter {
  std::string scene, pipeline, device, since;  ///< device: a part of its name; since: "2015-10-21"
  std::vector<std::string> parameters;         ///< "name=value"
  std::vector<std::int64_t> ids;
  std::optional<bool> failed;
  bool everything() const;
};

/// What became of one pipeline on one stress case.
enum class StressOutcome {
  stable,         ///< healthy, and within the case's limit
  biased,         ///< healthy, bounded, and beyond the limit: `value` says by how much
  diverges,       ///< finite, but it grows without bound or does not converge where it should
  refused,        ///< a clear message in place of a picture
  notApplicable,  ///< the case asks for something that the pipeline does not have
  broken          ///< NaN, infinite, negative radiance, a crash or a hang: never acceptable
};
const char* name(StressOutcome outcome);  ///< "not_applicable"
std::optional<StressOutcome> stressOutcomeNamed(const std::string& name);

/// One cell of the stress battery's matrix, with everything that it depends on.
struct StressCell {
  std::int64_t id = 0;
  std::string created, version;
  std::string family, name;  ///< of the case
  std::string pipeline;      ///< file as given
  std::string technique;     ///< the technique that the pipeline stands for
  std::string size;          ///< "quick" or "full"
  StressOutcome outcome = StressOutcome::stable;
  std::string measure, unit;  ///< of value and limit; empty when only health was looked at
  Measured value;
  double limit = 0.0;
  std::string detail;       ///< the first bad pass, port and voxel or pixel; the refusal; more numbers
  std::string explanation;  ///< of a property of the published method, from the technique's card
  std::string picture;      ///< file beside the page; empty: none
  std::string command;      ///< repeats it
  double seconds = 0.0;
  std::string pipelineHash, framework;            ///< content hashes
  std::map<std::string, std::string> techniques;  ///< name to hash of library and shader pack
  std::string device, driver, shaderInput, host;

  std::string key() const;  ///< 32 hexadecimal digits
};

/// Which cells. Empty members do not restrict; the pipeline matches as in RunFilter, without its title.
struct CellFilter {
  std::string family, name, pipeline, technique, device, since;
  std::optional<StressOutcome> outcome;
  std::vector<std::int64_t> ids;
  bool everything() const;
};

/// What one device can do at most, measured: `lumivox device`.
struct DeviceCeiling {
  std::string name;       ///< "texture_sampling_rgba16f_3d"
  std::string unit;       ///< "samples/s", "writes/s", "operations/s", "bytes/s"
  TimingStatistics rate;  ///< in that unit
  std::string created, version, device, driver, shaderInput, host;
};

/// How much a store took over from another.
struct MergeCount {
  std::size_t runs = 0, cells = 0, ceilings = 0;
};

class ResultsStore {
 public:
  enum class Mode { read, write };
  /// Opens a store; `write` makes it where there is none. Error for a file that is no store, has a schema of
  /// another version, or cannot be written.
  explicit ResultsStore(const std::filesystem::path& file, Mode mode = Mode::write);
  ~ResultsStore();
  ResultsStore(ResultsStore&&) noexcept;
  ResultsStore& operator=(ResultsStore&&) noexcept;

  const std::filesystem::path& file() const;
  bool contains(const std::string& key) const;
  /// The run with this key, if it is there.
  std::optional<StoredRun> find(const std::string& key) const;
  /// In one transaction: all of it or nothing, whatever happens. Returns false, and stores nothing, when
  /// another process has stored a run with this key meanwhile. A failed run is replaced by one that did not.
  bool add(const StoredRun& run, const std::vector<StoredPicture>& pictures = {});
  /// Those that were stored with a run.
  std::vector<StoredPicture> pictures(const std::string& key) const;

  /// Tells others that this process is about to measure these points. For each of them: false when a process
  /// that is alive and whose claim has not expired is at it. Claims of one's own are renewed. A claim ends
  /// when the run is stored, with release(), or after kClaimSeconds.
  std::vector<bool> claim(const std::vector<std::string>& keys);
  /// Gives up one's own claims.
  void release(const std::vector<std::string>& keys);
  /// Of another process that is at this point now.
  std::optional<RunClaim> claimedByOther(const std::string& key) const;

  /// Adds the times of the run with this key, measured once more.
  void addControl(const std::string& key, const TimingStatistics& frameMs,
                  const TimingStatistics& nextFrameMs);
  /// The last kControls of a device on a host, the newest first.
  std::vector<RepeatedControl> controls(const RunIdentity& where) const;
  static constexpr int kControls = 20;
  static constexpr int kClaimSeconds = 3600;

  /// By id, so in the order of storing.
  std::vector<StoredRun> runs(const RunFilter& filter = {}) const;
  /// How many were removed.
  std::size_t remove(const RunFilter& filter);
  /// Takes over the runs of another store that are not here, and the cells and ceilings that are not here or
  /// are older here. In one transaction.
  MergeCount merge(const ResultsStore& other);

  /// Cells of the stress battery. A cell with the same key takes the place of the older one.
  void add(const std::vector<StressCell>& cells);
  /// By id; empty for a store of schema 1 that is only read.
  std::vector<StressCell> stressCells(const CellFilter& filter = {}) const;
  std::size_t removeCells(const CellFilter& filter);  ///< how many were removed
  /// The newest ceilings of each device; those of the same name take the place of the older ones.
  void add(const std::vector<DeviceCeiling>& ceilings);
  std::vector<DeviceCeiling> ceilings(const std::string& device, const std::string& driver,
                                      const std::string& shaderInput, const std::string& host) const;
  std::vector<DeviceCeiling> ceilings() const;  ///< of all devices

  /// The store of a user who names none: $LUMIVOX_RESULTS, else results.sqlite in the cache directory.
  static std::filesystem::path defaultFile();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Hash of the framework's libraries as they are loaded: part of every identity.
std::string frameworkHash();

/// The metrics of one error by name, with the same of a black picture: what the store's table `metrics`
/// holds. Names: rmse, relative_mse, mean_ratio, bias, percentile95, ssim, flip, flip_ldr,
/// rms_bias, rms_noise, flicker, noise_floor, non_finite_picture, non_finite_truth.
struct NamedMetric {
  std::string name;
  Measured measured;
  double ofNothing = 0.0;
};
std::vector<NamedMetric> metricsOf(const ComponentError& error);
/// The inverse: fills the error's numbers from one metric; false for a name that it does not know.
bool setMetric(ComponentError& error, const NamedMetric& metric);

}  // namespace lumivox
