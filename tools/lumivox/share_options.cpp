#include "share_options.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/experiment/sweep.h"

namespace lumivox::command {

void ShareOptions::addTo(CLI::App& app, const std::string& out, bool hasStore) {
  app.add_option("--shard", shardText, "only share i of n of the work, from 1/n to n/n, into " + out);
  if (hasStore) {
    app.add_option(
        "--into", into,
        "the results store that the shares are merged into: what it holds or another share has claimed "
        "in it is not measured (default: none)");
    app.add_option(
        "--points", points,
        "with --shard, the file that says which points each share has; without, write that file: the "
        "points that --into lacks, in --tasks shares of about the same time");
    taskSeconds_ = addDuration(
        app, "--task-time", taskSeconds,
        "aim of --slurm and --points: the time of one task by what --into knows, such as 10min (default 30min)");
  }
  tasks_ = app.add_option(
                  "--tasks", tasks,
                  fmt::format("so many shares with --slurm{} (default: {})", hasStore ? " or --points" : "",
                              hasStore ? "by --task-time, or 16 where no time is known" : "16"))
               ->check(CLI::Range(std::size_t{1}, kMostTasks));
  app.add_flag("--wait", wait, "with --slurm, show the progress of the array until it is merged");
  app.add_flag(
      "--slurm", slurm,
      "submit the work as a job array of Slurm, and a job that merges it; everything behind --slurm goes to "
      "sbatch, such as --slurm --partition=gpu --time=2:00:00");
}

void ShareOptions::check(const Commands& commands, const std::string& out, bool isGiven) const {
  if (slurm && isShare())
    throw Error("--slurm shares the work itself; expected --slurm or --shard, not both");
  if (wait && !slurm) throw Error("--wait follows the jobs of --slurm; expected --slurm behind it");
  if (!plans() && (tasks_->count() > 0 || (taskSeconds_ != nullptr && taskSeconds_->count() > 0)))
    throw Error(
        "--tasks and --task-time say how --slurm and --points share; expected one of these, or --shard i/n alone");
  if (isShare()) {
    shard();
    if (!isGiven)
      throw Error(fmt::format("--shard {}: each share is written by itself; expected {}", shardText, out));
  }
  if (!slurm && !points.empty() && !isShare() && into.empty())
    throw Error("--points without --shard shares what a store lacks; expected --into with that store");
  if (slurm) requireSlurm(commands.sbatchOptions);
}

namespace {

/// The words without these options, given as "--name value" or "--name=value", and without these flags.
std::vector<std::string> without(const std::vector<std::string>& words,
                                 const std::vector<std::string>& options,
                                 const std::vector<std::string>& flags) {
  std::vector<std::string> kept;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string name = words[i].substr(0, words[i].find('='));
    if (std::find(flags.begin(), flags.end(), words[i]) != flags.end()) continue;
    if (std::find(options.begin(), options.end(), name) == options.end())
      kept.push_back(words[i]);
    else if (name == words[i])
      ++i;
  }
  return kept;
}

std::string shellWords(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += " " + inSingleQuotes(word);
  return text;
}

}  // namespace

bool submitShares(const Commands& commands, const ShareOptions& options, const SharedWork& work,
                  std::size_t tasks, const std::function<void(const std::filesystem::path&)>& write) {
  SlurmArray array;
  array.name = work.name;
  array.tasks = tasks;
  array.exclusive = work.exclusive;
  array.mergeExclusive = work.mergeExclusive;
  array.options = commands.sbatchOptions;
  // One folder for each submission, whose name no other has.
  std::error_code ignored;
  array.folder = std::filesystem::absolute(work.beside, ignored).string() +
                 fmt::format(".parts/{}-{}", std::time(nullptr), getpid());
  createParentDirectories(array.folder / "task.sh");
  write(array.folder);
  const std::string program = inSingleQuotes(std::filesystem::read_symlink("/proc/self/exe").string());
  std::vector<std::string> dropped{"--into", "--points", "--tasks", "--task-time", "--shard"};
  const std::string typed = shellWords(without(commands.words, dropped, {"--slurm", "--wait"}));
  dropped.insert(dropped.end(), work.dropped.begin(), work.dropped.end());
  const std::string ofTask = shellWords(without(commands.words, dropped, {"--slurm", "--wait"}));
  const std::string folder = inSingleQuotes(array.folder.string());
  array.task = fmt::format("exec {}{} {} --shard \"$SLURM_ARRAY_TASK_ID/{}\"\n", program, ofTask,
                           work.task(folder, tasks), tasks);
  array.merge = work.merge(program, typed, folder);
  const SubmittedArray jobs = submit(array);
  print(fmt::format("job {}: {} task{}; job {}: merges them when they have ended\n{}\n", jobs.array, tasks,
                    tasks == 1 ? "" : "s", jobs.merge, array.folder.string()));
  if (!options.wait) return true;
  const ArrayState state = waitFor(jobs, tasks);
  const std::filesystem::path merged = array.folder / "merge.log";
  std::string text =
      fmt::format("{} of {} tasks ended, {} of them not well\n", state.ended, tasks, state.failed);
  if (std::filesystem::exists(merged, ignored)) text += readFile(merged);
  print(text);
  return state.failed == 0;
}

void tellMissing(const SharedPlan& plan, const std::string& units, const std::filesystem::path& into) {
  std::size_t missing = 0;
  for (const std::vector<std::size_t>& one : plan.shares) missing += one.size();
  print(fmt::format("{} of {} {} are missing in {}\n", missing, plan.points, units, into.string()));
}

int sharePlan(const Commands& commands, const ShareOptions& options, const SharedPlan& plan,
              const SharedStore& store) {
  tellMissing(plan, store.units, store.into);
  if (plan.shares.empty()) return kGood;
  if (!options.slurm) {
    plan.write(options.points);
    print(fmt::format("{} shares; {}\n", plan.shares.size(), options.points.string()));
    return kGood;
  }
  std::error_code ignored;
  const std::string into = inSingleQuotes(std::filesystem::absolute(store.into, ignored).string());
  const bool mixed = store.mixed();
  SharedWork work;
  work.name = store.name;
  work.beside = store.into;
  work.exclusive = store.exclusive;
  work.mergeExclusive = store.mergeExclusive;
  work.dropped = store.dropped;
  work.task = [&](const std::string& folder, std::size_t) {
    return fmt::format("--store {0}/\"$SLURM_ARRAY_TASK_ID\".sqlite --into {1} --points {0}/plan.txt", folder,
                       into);
  };
  work.merge = [&](const std::string& program, const std::string& typed, const std::string& folder) {
    return fmt::format("{} results merge --store {}{} {}/*.sqlite || exit\n{}", program, into,
                       mixed ? " --mixed" : "", folder,
                       store.afterMerge ? store.afterMerge(program, typed, into) : "");
  };
  return submitShares(commands, options, work, plan.shares.size(),
                      [&](const std::filesystem::path& folder) { plan.write(folder / "plan.txt"); })
             ? kGood
             : kNotGood;
}

}  // namespace lumivox::command
