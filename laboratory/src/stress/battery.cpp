// Runs the battery: cells in worker processes, each driven by a thread.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <mutex>
#include <set>
#include <thread>

#include "base/child.h"
#include "base/memory_limits.h"
#include "experiment/choice.h"
#include "experiment/costs.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/hash.h"
#include "lumivox/base/log.h"
#include "lumivox/experiment/report.h"
#include "lumivox/page/stress_page.h"
#include "lumivox/results/store.h"
#include "lumivox/results/stress_cells.h"
#include "stress/protocol.h"
#include "stress/run_cell.h"

namespace lumivox {
namespace {

using namespace stress;
using experiment::Costs;
using Clock = std::chrono::steady_clock;

// Time limit of one cell, s: ten times that of the slowest on an idle machine.
constexpr double kQuickLimit = 60.0, kFullLimit = 600.0;
/// A worker opens a device before it is ready, s.
constexpr double kStartLimit = 60.0;  // s

/// Starts of workers that may fail in a row before the battery gives up.
constexpr int kFailedStarts = 3;

CellRequest requestFor(const StressJob& job, const StressOptions& options) {
  CellRequest request{job.pipeline, job.info.name, options.quick, {}};
  if (!options.output.empty())
    request.image =
        options.output / "images" / (job.pipeline.stem().string() + "__" + job.info.name + ".png");
  return request;
}

/// Of what positions in a plan mean.
std::string hashOf(const std::vector<StressJob>& jobs) {
  Hasher hasher;
  for (const StressJob& job : jobs) hasher.add(job.pipeline.string()).add(job.info.name);
  return hasher.finish().text();
}

/// The jobs of the wanted share.
std::vector<StressJob> sharedJobs(const StressOptions& options, std::vector<StressJob> jobs) {
  std::vector<StressJob> share;
  for (const std::size_t position : positionsOf(options.shard, options.points, hashOf(jobs), jobs.size()))
    share.push_back(std::move(jobs[position]));
  return share;
}

class Battery {
 public:
  Battery(const StressOptions& options, TechniqueSource& techniques, ResultsStore* store, ResultsStore* into)
      : options_(options),
        store_(store),
        into_(into),
        jobs_(sharedJobs(options, plannedStress(options, techniques))),
        cells_(jobs_.size()),
        isDone_(jobs_.size()),
        isLeftOut_(jobs_.size()),
        limit_(options.timeLimit > 0.0 ? options.timeLimit
               : options.quick         ? kQuickLimit
                                       : kFullLimit) {
    // Each cell reports its dependencies; a worker that dies cannot.
    for (const StressJob& job : jobs_) {
      requests_.push_back(requestFor(job, options));
      cells_[requests_.size() - 1] =
          cellBefore(requests_.back(), job.info.family, techniques, options.repeatArguments);
    }
  }

  std::vector<StressCell> run() {
    if (options_.program.empty()) throw Error("a stress battery needs a program that serves as its workers");
    if (jobs_.empty()) return {};
    // The first worker describes the device, from which the number of workers follows.
    workers_ = processorsWanted();
    std::unique_ptr<Child> first = firstWorker();
    if (!device_.software && options_.workers == 0 && workers_ > 1) {
      logInformation("{} is one device: one worker", device_.device);
      workers_ = 1;
      first.reset();
      first = firstWorker();  // gets all of the memory
    }
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < workers_; ++i)
      threads.emplace_back(
          [this, child = i == 0 ? first.release() : nullptr] { work(std::unique_ptr<Child>(child)); });
    for (std::thread& thread : threads) thread.join();
    if (failure_) std::rethrow_exception(failure_);
    std::vector<StressCell> cells;
    for (std::size_t i = 0; i < cells_.size(); ++i)
      if (!isLeftOut_[i]) cells.push_back(std::move(cells_[i]));
    return cells;
  }
  std::size_t leftOut() const {
    return static_cast<std::size_t>(std::count(isLeftOut_.begin(), isLeftOut_.end(), true));
  }

 private:
  std::size_t processorsWanted() const {
    const std::size_t wanted = options_.workers > 0 ? static_cast<std::size_t>(options_.workers)
                                                    : std::max(1u, std::thread::hardware_concurrency());
    return std::clamp<std::size_t>(wanted, 1, std::max<std::size_t>(1, jobs_.size()));
  }

  /// Several workers share the processors: software rasterisers with a thread per processor would only hinder
  /// each other.
  std::vector<std::string> environment() const {
    if (workers_ == 1 || std::getenv("LP_NUM_THREADS") != nullptr) return {};
    return {"LP_NUM_THREADS=1"};
  }

  /// They also share the memory.
  std::vector<std::string> program() const {
    std::vector<std::string> words = options_.program;
    const std::uint64_t all = options_.memoryBytes > 0 ? options_.memoryBytes
                              : device_.software       ? memoryAtStart_
                                                       : 0;
    if (workers_ > 1 && all > 0)
      words.insert(words.end(), {"--worker-memory", std::to_string(all / workers_)});
    return words;
  }

  /// The next job, pipeline by pipeline; past the end where none is left.
  std::size_t take() {
    const std::lock_guard lock(mutex_);
    if (failure_) return jobs_.size();
    while (next_ < jobs_.size() && !isOurs(next_)) {
      isLeftOut_[next_] = isDone_[next_] = true;
      ++done_;
      ++next_;
    }
    return next_ < jobs_.size() ? next_++ : next_;
  }

  /// Whether a cell is to be run here; if so, it is claimed.
  bool isOurs(std::size_t job) {
    if (!isShare()) return true;
    const std::string key = cells_[job].key();
    if (store_->hasCell(key) || (into_ != nullptr && into_->hasCell(key))) return false;
    return into_ == nullptr || into_->claimFor(store_->file(), {key}).front();
  }

  bool isShare() const {
    return store_ != nullptr && (!options_.shard.isWhole() || !options_.points.empty());
  }

  void work(std::unique_ptr<Child> child) {
    try {
      for (std::size_t job = take(); job < jobs_.size(); job = take()) {
        if (child == nullptr) child = nextWorker(job);
        if (child == nullptr) continue;
        if (!ask(*child, job)) child.reset();
        finished(job, true);
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
    }
  }

  /// Starts a worker and returns it with its description of the device. Error where it does not start.
  std::pair<std::unique_ptr<Child>, WorkerDevice> startWorker() const {
    auto child = std::make_unique<Child>(program(), environment());
    const Child::Answer answer = child->receive(kStartLimit);
    if (answer.state == Child::State::answered)
      if (std::optional<WorkerDevice> ready = readyFrom(answer.line)) return {std::move(child), *ready};
    if (answer.state == Child::State::silent)
      throw Error(fmt::format("a worker of the stress battery was not ready within {:g} s", kStartLimit));
    if (answer.state == Child::State::answered)
      throw Error(
          fmt::format("a worker of the stress battery said '{}' instead of being ready", answer.line));
    throw Error(fmt::format("a worker of the stress battery {}: {}", child->ending(), child->lastWords()));
  }

  /// Without a first worker there is no battery.
  std::unique_ptr<Child> firstWorker() {
    auto [child, device] = startWorker();
    device_ = device;
    for (StressCell& cell : cells_) describeDevice(cell, device_);
    return std::move(child);
  }

  /// Replaces a lost worker; null where it could not be started, which breaks one cell. After kFailedStarts
  /// in a row the battery gives up, and the remaining cells are not run.
  std::unique_ptr<Child> nextWorker(std::size_t job) {
    StressCell& cell = cells_[job];
    cell.outcome = StressOutcome::broken;
    if (failedStarts_ >= kFailedStarts) {
      cell.detail = fmt::format("not run: the last {} workers did not start", kFailedStarts);
      finished(job, false);
      return nullptr;
    }
    try {
      std::unique_ptr<Child> child = startWorker().first;
      failedStarts_ = 0;
      return child;
    } catch (const Error& error) {
      ++failedStarts_;
      cell.detail = error.what();
      logWarning("{}", error.what());
      finished(job, true);
      return nullptr;
    }
  }

  /// False where the worker is of no further use.
  bool ask(Child& child, std::size_t job) {
    StressCell& cell = cells_[job];
    child.forgetWords();
    child.send(lineOf(requests_[job]));
    const auto start = Clock::now();
    const Child::Answer answer = child.receive(limit_);
    std::string what;
    if (answer.state == Child::State::answered) {
      try {
        cell = stressCellFrom(answer.line);
        return true;
      } catch (const Error& error) {
        what = fmt::format("its process did not answer with a cell: {}", error.what());
      }
    } else if (answer.state == Child::State::silent) {
      what = fmt::format("no answer within {:g} s; its process was ended", limit_);
    } else {
      const std::string words = child.lastWords();
      what = "its process " + child.ending() + (words.empty() ? "" : ": " + words);
    }
    cell.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    cell.outcome = StressOutcome::broken;
    cell.detail = what;
    return false;
  }

  /// Stores a cell at once, so that an interruption costs only the cells under way.
  void finished(std::size_t job, bool wasRun) {
    const std::lock_guard lock(mutex_);
    if (store_ != nullptr && wasRun) store_->add(std::vector<StressCell>{cells_[job]});
    if (into_ != nullptr && wasRun) into_->deliver(store_->file(), {cells_[job].key()});
    ++done_;
    isDone_[job] = true;
    if (cells_[job].seconds > 0.0)
      costs_.add(jobs_[job].pipeline.string(), jobs_[job].info.name, 1.0, cells_[job].seconds);
    seconds_ += cells_[job].seconds;
    if (options_.progress) options_.progress(cells_[job], done_, jobs_.size(), secondsLeft());
  }

  /// Expected remaining time, s, from the same cases of other pipelines. A case not run yet counts like the
  /// mean of those that were.
  double secondsLeft() const {
    double left = 0.0;
    for (std::size_t i = 0; i < jobs_.size(); ++i)
      if (!isDone_[i])
        left += costs_.expected(jobs_[i].pipeline.string(), jobs_[i].info.name, 1.0)
                    .value_or(seconds_ / static_cast<double>(done_));
    return left / static_cast<double>(workers_);
  }

  const StressOptions& options_;
  ResultsStore* store_;
  ResultsStore* into_;
  const std::vector<StressJob> jobs_;
  std::vector<CellRequest> requests_;
  std::vector<StressCell> cells_;
  std::vector<bool> isDone_, isLeftOut_;
  const double limit_;
  const std::uint64_t memoryAtStart_ = sharedMemoryLeft();  // each worker has an address space of its own
  std::size_t workers_ = 1;
  WorkerDevice device_{{}, {}, {}, true};
  std::atomic<int> failedStarts_ = 0;
  std::mutex mutex_;
  std::size_t next_ = 0, done_ = 0;
  Costs costs_;
  double seconds_ = 0.0;  ///< of all cells that were run
  std::exception_ptr failure_;
};

}  // namespace

bool StressSummary::sound() const {
  return std::none_of(cells.begin(), cells.end(),
                      [](const StressCell& cell) { return cell.outcome == StressOutcome::broken; });
}

StressSummary runStress(const StressOptions& options, TechniqueSource& techniques) {
  if (!options.output.empty()) requireWritable(options.output / "index.html");
  std::optional<ResultsStore> store;
  if (!options.store.empty()) store.emplace(options.store);
  StressSummary summary;
  std::optional<ResultsStore> into;
  if (!options.into.empty()) into.emplace(options.into);
  Battery battery(options, techniques, store ? &*store : nullptr, into ? &*into : nullptr);
  summary.cells = battery.run();
  summary.leftOut = battery.leftOut();
  if (!options.output.empty())
    summary.page = writeStressPage(options.output, summary.cells, options.commandLine);
  return summary;
}

SharedPlan planStress(const StressOptions& options, TechniqueSource& techniques, std::size_t tasks,
                      double taskSeconds) {
  const std::vector<StressJob> jobs = plannedStress(options, techniques);
  std::set<std::string> held;
  Costs costs;
  for (const StressCell& cell : ResultsStore(options.into).stressCells()) {
    held.insert(cell.anywhere());
    if (cell.seconds > 0.0) costs.add(cell.pipeline, cell.name, 1.0, cell.seconds);
  }
  std::vector<std::size_t> missing;
  std::vector<double> seconds;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const StressCell cell =
        cellBefore(requestFor(jobs[i], options), jobs[i].info.family, techniques, options.repeatArguments);
    if (held.count(cell.anywhere()) > 0) continue;
    missing.push_back(i);
    seconds.push_back(costs.expected(jobs[i].pipeline.string(), jobs[i].info.name, 1.0).value_or(0.0));
  }
  return sharedPlan(hashOf(jobs), jobs.size(), missing, seconds, tasks, taskSeconds);
}

}  // namespace lumivox
