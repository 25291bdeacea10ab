#include "slurm.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>
#include <sstream>
#include <thread>

#include "common/command_line.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "lumivox/base/start_process.h"

namespace lumivox::command {
namespace {

/// Pauses between two looks at a job: short ones first, then few, since many users ask the same controller.
constexpr std::chrono::seconds kFirstPause{1}, kLongestPause{30};

std::filesystem::path slurmProgram(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::filesystem::path program = std::filesystem::path(folder.empty() ? "." : folder) / name;
    if (access(program.c_str(), X_OK) == 0) return program;
  }
  throw AbsentError(fmt::format(
      "{}, the command of Slurm that --slurm needs, is not on the PATH; type the command on a node of a cluster with "
      "Slurm (Debian: apt-get install slurm-client), or run the shares with --shard i/n (docs/cluster.md)",
      name));
}

struct Said {
  bool good = false;
  std::string output, errors;
};

std::string trimmed(std::string text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  return text;
}

std::string readAll(int file) {
  std::string text;
  std::array<char, 4096> some;
  for (ssize_t count = 0; (count = read(file, some.data(), some.size())) > 0;)
    text.append(some.data(), static_cast<std::size_t>(count));
  close(file);
  return text;
}

/// Runs a program to its end. Its words are few enough for a pipe.
Said said(const std::vector<std::string>& words) {
  std::array<int, 2> output{}, errors{};
  if (pipe2(output.data(), O_CLOEXEC) != 0 || pipe2(errors.data(), O_CLOEXEC) != 0)
    throw Error(fmt::format("{} cannot be started: no pipe is left", words.front()));
  ProcessStart start;
  start.words = words;
  start.output = output[1];
  start.errors = errors[1];
  const pid_t process = startProcess(start);
  close(output[1]);
  close(errors[1]);
  Said result;
  result.output = readAll(output[0]);
  result.errors = trimmed(readAll(errors[0]));
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  result.good = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  return result;
}

/// Submits a script; returns the job's number.
std::string submitted(const std::filesystem::path& script, const std::vector<std::string>& own,
                      const std::vector<std::string>& options) {
  std::vector<std::string> words{slurmProgram("sbatch").string(), "--parsable"};
  words.insert(words.end(), own.begin(), own.end());
  words.insert(words.end(), options.begin(), options.end());
  words.push_back(script.string());
  const Said answer = said(words);
  const std::string number = trimmed(answer.output.substr(0, answer.output.find(';')));
  if (!answer.good || number.empty() || number.find_first_not_of("0123456789") != std::string::npos)
    throw Error(fmt::format("sbatch did not take {}: {}", script.string(),
                            answer.errors.empty() ? trimmed(answer.output) : answer.errors));
  if (!answer.errors.empty()) logWarning("sbatch: {}", answer.errors);
  return number;
}

/// A script with its options for sbatch in front.
void writeScript(const std::filesystem::path& file, const std::vector<std::string>& options,
                 const std::string& command) {
  std::string text = "#!/bin/sh\n";
  for (const std::string& option : options) text += "#SBATCH " + option + "\n";
  writeFileAtomically(file, text + command);
}

}  // namespace

void requireSlurm(const std::vector<std::string>& options) {
  slurmProgram("sbatch");
  for (const std::string& option : options)
    for (const char* own : {"--array", "-a", "--dependency", "-d", "--parsable"}) {
      if (option != own && option.rfind(std::string(own) + "=", 0) != 0) continue;
      throw Error(
          fmt::format("--slurm: {} is set by lumivox itself; expected other options of sbatch", option));
    }
}

SubmittedArray submit(const SlurmArray& array) {
  const std::filesystem::path task = array.folder / "task.sh", merge = array.folder / "merge.sh";
  const std::string name = "lumivox-" + array.name;
  // Both keep going on the node that a requeued task gets: a task goes on with what its store holds.
  std::vector<std::string> ofTasks{"--job-name=" + name, fmt::format("--array=1-{}", array.tasks),
                                   "--requeue", "--open-mode=append",
                                   "--output=" + inSingleQuotes((array.folder / "%a.log").string())};
  if (array.exclusive) ofTasks.emplace_back("--exclusive");
  std::vector<std::string> ofMerge{"--job-name=" + name + "-merge",
                                   "--output=" + inSingleQuotes((array.folder / "merge.log").string())};
  if (array.mergeExclusive) ofMerge.emplace_back("--exclusive");
  writeScript(task, ofTasks, array.task);
  writeScript(merge, ofMerge, array.merge);
  SubmittedArray jobs;
  jobs.array = submitted(task, {}, array.options);
  try {
    jobs.merge = submitted(merge, {"--dependency=afterany:" + jobs.array}, array.options);
  } catch (const Error&) {
    said({slurmProgram("scancel").string(), jobs.array});
    throw;
  }
  return jobs;
}

ArrayState stateFrom(const std::string& lines) {
  ArrayState state;
  std::istringstream stream(lines);
  for (std::string line; std::getline(stream, line);) {
    std::istringstream fields(line);
    std::string job, what, seconds;
    if (!std::getline(fields, job, '|') || !std::getline(fields, what, '|')) continue;
    std::getline(fields, seconds, '|');
    // Tasks that wait stand together in one line, "12_[3-9]".
    if (job.find('[') != std::string::npos || job.find('_') == std::string::npos) continue;
    what = what.substr(0, what.find(' '));  // "CANCELLED by 1000"
    if (what == "RUNNING" || what == "COMPLETING") {
      ++state.running;
    } else if (what != "PENDING" && what != "REQUEUED" && what != "SUSPENDED" && what != "RESIZING") {
      ++state.ended;
      if (what != "COMPLETED") ++state.failed;
      state.secondsOfEnded += std::strtod(seconds.c_str(), nullptr);
    }
  }
  return state;
}

namespace {

/// What the queue still holds of a job: the number of its tasks that wait or run; 0 when it has ended.
struct Queued {
  std::size_t waiting = 0, running = 0;
};
Queued queued(const std::string& job) {
  Queued result;
  const Said answer =
      said({slurmProgram("squeue").string(), "--noheader", "--array", "--jobs=" + job, "--format=%T"});
  // A controller that does not answer for a while says nothing about the job; one that has forgotten it does.
  if (!answer.good && answer.errors.find("Invalid job id") == std::string::npos) {
    logWarning("squeue: {}", answer.errors);
    result.waiting = 1;
    return result;
  }
  std::istringstream lines(answer.output);
  for (std::string line; std::getline(lines, line);)
    ++(trimmed(line) == "RUNNING" || trimmed(line) == "COMPLETING" ? result.running : result.waiting);
  return result;
}

/// By accounting where there is any, else by the queue, which forgets how long tasks took.
ArrayState stateOf(const std::string& job, std::size_t tasks) {
  try {
    const Said answer = said({slurmProgram("sacct").string(), "--noheader", "--parsable2", "--allocations",
                              "--array", "--jobs=" + job, "--format=JobID,State,ElapsedRaw"});
    if (answer.good && !trimmed(answer.output).empty()) return stateFrom(answer.output);
  } catch (const AbsentError&) {
    // Clusters without accounting may lack the command.
  }
  const Queued queue = queued(job);
  ArrayState state;
  state.running = queue.running;
  state.ended = tasks - std::min(tasks, queue.running + queue.waiting);
  return state;
}

}  // namespace

ArrayState waitFor(const SubmittedArray& jobs, std::size_t tasks) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  Progress progress(fmt::format("job {}", jobs.array), tasks, "tasks");
  ArrayState state;
  std::chrono::seconds pause = kFirstPause;
  for (;;) {
    state = stateOf(jobs.array, tasks);
    const auto left = static_cast<double>(tasks - std::min(tasks, state.ended));
    double secondsLeft = std::numeric_limits<double>::quiet_NaN();
    if (state.ended > 0 && state.secondsOfEnded > 0.0) {
      // The tasks that run now are as many as run at once.
      const double each = state.secondsOfEnded / static_cast<double>(state.ended);
      secondsLeft = each * std::ceil(left / std::max(1.0, static_cast<double>(state.running)));
    } else if (state.ended > 0) {
      secondsLeft = std::chrono::duration<double>(Clock::now() - start).count() * left /
                    static_cast<double>(state.ended);
    }
    progress.show(state.ended, tasks, secondsLeft, fmt::format("{} running", state.running));
    const Queued merge = queued(jobs.merge);
    if (merge.running + merge.waiting == 0) return state;
    std::this_thread::sleep_for(pause);
    pause = std::min(pause * 2, kLongestPause);
  }
}

}  // namespace lumivox::command
