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

/// The command that merges what tasks have stored: those of one version, into a store that may hold earlier
/// ones. `program`, `into` and `folder` are quoted.
std::string mergeOfTasks(const std::string& program, const std::string& into, bool mixed,
                         const std::string& folder);

/// What a task is told besides its share: a store of its own in the quoted folder, that of the merge, its
/// plan.
std::string storeOfTask(const std::string& folder, const std::string& into);

/// Submits a command's array of `tasks`, whose plan `write` puts into the folder of the job; says where, and
/// with --wait follows it. Returns whether the tasks went well, as far as they were waited for.
bool submitShares(const Commands& commands, const ShareOptions& options, const SharedWork& work,
                  std::size_t tasks, const std::function<void(const std::filesystem::path& folder)>& write);

}  // namespace lumivox::command
