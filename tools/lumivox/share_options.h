// The options of every command whose work can be shared: sweep, stress, report, reference.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "command.h"
#include "lumivox/experiment/shard.h"
#include "slurm.h"

namespace lumivox::command {

struct ShareOptions {
  std::string shardText;
  std::filesystem::path into, points;
  std::size_t tasks = 0;
  double taskSeconds = 30.0 * 60.0;
  bool slurm = false, wait = false;

  /// `out`: where a share goes, for the help. Commands without a plan in a store have neither --into nor
  /// --points.
  void addTo(CLI::App& app, const std::string& out, bool hasStore);
  bool isShare() const { return !shardText.empty(); }
  Shard shard() const { return isShare() ? shardOf(shardText) : Shard{}; }
  /// Whether a plan is to be shared here, by Slurm or into a file, in place of measured.
  bool plans() const { return slurm || (!points.empty() && !isShare()); }
  /// Error for options that do not go together. `out`: the option that says where a share goes, and whether
  /// it was given.
  void check(const Commands& commands, const std::string& out, bool isGiven) const;

 private:
  CLI::Option *tasks_ = nullptr, *taskSeconds_ = nullptr;
};

/// What of a command is submitted.
struct SharedWork {
  std::string name;              ///< of the command
  std::filesystem::path beside;  ///< the folder of the job is made beside this file
  bool exclusive = false, mergeExclusive = false;
  /// The words of one task after those that the user typed, for a shell; of its folder, in quotes.
  std::function<std::string(const std::string& folder, std::size_t tasks)> task;
  /// The commands of the job after them, for a shell. `program`: this one, in quotes.
  std::function<std::string(const std::string& program, const std::string& typed, const std::string& folder)>
      merge;
  std::vector<std::string> dropped;  ///< options with a value that tasks do not get, besides those of sharing
};

/// Submits a command's array of `tasks`, whose plan `write` puts into the folder of the job; says where, and
/// with --wait follows it. Returns whether the tasks went well, as far as they were waited for.
bool submitShares(const Commands& commands, const ShareOptions& options, const SharedWork& work,
                  std::size_t tasks, const std::function<void(const std::filesystem::path& folder)>& write);

/// What of a command is shared whose results lie in a store.
struct SharedStore {
  std::string name;             ///< of the command
  std::string units;            ///< what is missing, in the plural: "points"
  std::filesystem::path into;   ///< the store that the shares are merged into
  std::function<bool()> mixed;  ///< whether it holds results of earlier versions; asked before a submission
  bool exclusive = false, mergeExclusive = false;
  std::vector<std::string> dropped;  ///< as in SharedWork
  /// What follows the merge, for a shell; empty: nothing.
  std::function<std::string(const std::string& program, const std::string& typed, const std::string& into)>
      afterMerge = nullptr;
};

/// Says how much of a plan a store lacks.
void tellMissing(const SharedPlan& plan, const std::string& units, const std::filesystem::path& into);

/// Says so, and writes its shares to --points or submits them as an array, each with a store
/// of its own, and a job that merges them. Returns the exit code.
int sharePlan(const Commands& commands, const ShareOptions& options, const SharedPlan& plan,
              const SharedStore& store);

}  // namespace lumivox::command
