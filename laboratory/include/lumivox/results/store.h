// The results store: every measured point with everything that it depends on, in one SQLite file. The
// meaning of each column: docs/results.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "lumivox/results/runs.h"
#include "lumivox/results/stress_cells.h"

namespace lumivox {

namespace results {
class UnfinishedStore;
}

/// Who is measuring a point at present.
struct RunClaim {
  std::string machine;  ///< and its start and name space of processes: where `process` means something
  int process = 0;
  std::uint64_t started = 0;  ///< of the process, distinguishes another one with its number
  std::string command;        ///< its command line
  std::int64_t expires = 0;   ///< s since 1970
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

/// Which cells. Empty members do not restrict; the pipeline matches as in RunFilter, without its title.
struct CellFilter {
  std::string family, name, pipeline, technique, device, since;
  std::optional<StressOutcome> outcome;
  std::vector<std::int64_t> ids;
  bool everything() const;
};

/// The numbers of records that a store took over from another.
struct MergeCount {
  std::size_t runs = 0, cells = 0, peakRates = 0;
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
  bool add(const StoredRun& run, const std::vector<StoredImage>& images = {});
  /// Keeps a run whose errors, images and work are there, but no times, for whoever goes on with it: only
  /// findUntimed() and images() know of it. It goes when the run is added.
  void addUntimed(const StoredRun& run, const std::vector<StoredImage>& images = {});
  std::optional<StoredRun> findUntimed(const std::string& key) const;
  /// Those that were stored with a run.
  std::vector<StoredImage> images(const std::string& key) const;

  /// Tells others that this process is about to measure these points. For each of them: false when a process
  /// that is alive and whose claim has not expired is at it. Claims of one's own are renewed. A claim ends
  /// when the run is stored, with release(), or after kClaimSeconds.
  std::vector<bool> claim(const std::vector<std::string>& keys);
  /// Gives up one's own claims.
  void release(const std::vector<std::string>& keys);
  /// The same for points that are stored in another file and merged into this store later. A claim that was
  /// delivered stands as long as that file exists; merging the file ends all claims for it.
  std::vector<bool> claimFor(const std::filesystem::path& part, const std::vector<std::string>& keys);
  void releaseFor(const std::filesystem::path& part, const std::vector<std::string>& keys);
  void deliver(const std::filesystem::path& part, const std::vector<std::string>& keys);
  /// Ends the claims of other machines. Only for a store that one process uses at a time.
  void releaseElsewhere();
  /// Of another process that is at this point now.
  std::optional<RunClaim> claimedByOther(const std::string& key) const;

  /// Adds the times of the run with this key, measured once more.
  void addControl(const std::string& key, const TimingStatistics& frameMs,
                  const TimingStatistics& nextFrameMs);
  /// The last kControls of a device on a host, the newest first.
  std::vector<RepeatedControl> controls(const RunIdentity& where) const;
  static constexpr int kControls = 20;
  static constexpr int kClaimSeconds = 3600;

  struct Count {
    std::size_t runs = 0, untimed = 0;
  };
  Count count() const;
  /// By id, so in the order of storing.
  std::vector<StoredRun> runs(const RunFilter& filter = {}) const;
  /// How many were removed, those without times not counted.
  std::size_t remove(const RunFilter& filter);
  /// Whether the run with this key did not fail; empty: it is not here.
  std::optional<bool> succeeded(const std::string& key) const;
  /// Calls visit(identity, scene, pipeline, seconds) for each run that did not fail.
  void forEachMeasured(const std::function<void(const RunIdentity&, const std::string&, const std::string&,
                                                double)>& visit) const;
  /// Takes over the runs of another store that are not here, its controls, and the cells and peak rates that
  /// are not here or are older here. In one transaction. Of two runs with one key the one that did not fail
  /// stays, of two such the earlier.
  MergeCount merge(const ResultsStore& other);
  /// The same for the runs with these keys alone.
  MergeCount merge(const ResultsStore& other, const std::vector<std::string>& keys);
  /// The same for many stores, in one transaction for all of them: the result is the same in whichever order
  /// they are given, and merging them once more changes nothing. Error that names two stores if their
  /// results, or those here, come from different versions of Lumivox or of a technique, unless `mixed`. The
  /// counts are in the order of the files.
  std::vector<MergeCount> merge(const std::vector<std::filesystem::path>& files, bool mixed);
  /// What made the results: "lumivox" and the techniques, each with its versions.
  std::map<std::string, std::set<std::string>> versions() const;

  /// The same from a store that an earlier version wrote, with schema 1 to 9.
  MergeCount import(const std::filesystem::path& file);

  /// Cells of the stress battery. A cell with the same key takes the place of the older one.
  void add(const std::vector<StressCell>& cells);
  std::vector<StressCell> stressCells(const CellFilter& filter = {}) const;
  bool hasCell(const std::string& key) const;
  std::size_t removeCells(const CellFilter& filter);  ///< how many were removed
  /// The newest peak rates of each device; those of the same name take the place of the older ones.
  void add(const std::vector<PeakRate>& peakRates);
  std::vector<PeakRate> peakRates(const std::string& device, const std::string& driver,
                                  const std::string& shaderInput, const std::string& host) const;
  std::vector<PeakRate> peakRates() const;  ///< of all devices

  /// Tables, views and their columns, as docs/results.md lists them.
  static std::string describe();
  /// The store of a user who names none: $LUMIVOX_RESULTS, else results.sqlite in the cache directory.
  static std::filesystem::path defaultFile();

 private:
  friend class results::UnfinishedStore;
  struct State;
  explicit ResultsStore(std::unique_ptr<State> state);
  MergeCount mergeRows(const ResultsStore& other, const std::function<bool(const std::string&)>& isWanted);
  std::unique_ptr<State> state_;
};

}  // namespace lumivox
