// Runs the battery: cells in worker processes, each driven by a thread.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <mutex>
#include <thread>

#include "base/child.h"
#include "base/memory_limits.h"
#include "experiment/choice.h"
#include "experiment/costs.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
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
using Clock = std::chrono::steady_clock;

// Time limit of one cell, s: ten times that of the slowest on an idle machine.
constexpr double kQuickLimit = 60.0, kFullLimit = 600.0;
/// A worker opens a device before it is ready, s.
constexpr double kStartLimit = 60.0;  // s

/// Starts of workers that may fail in a row before the battery gives up.
constexpr int kFailedStarts = 3;

class Battery {
 public:
  Battery(const StressOptions& options, TechniqueSource& techniques, ResultsStore* store)
      : options_(options),
        store_(store),
        jobs_(plannedStress(options, techniques)),
        cells_(jobs_.size()),
        isDone_(jobs_.size()),
        limit_(options.timeLimit > 0.0 ? options.timeLimit
               : options.quick         ? kQuickLimit
                                       : kFullLimit) {
    // Each cell reports its dependencies; a worker that dies cannot.
    for (const StressJob& job : jobs_) {
      requests_.push_back(requestFor(job));
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
    return std::move(cells_);
  }

 private:
  CellRequest requestFor(const StressJob& job) const {
    CellRequest request{job.pipeline, job.info.name, options_.quick, {}};
    if (!options_.output.empty())
      request.image =
          options_.output / "images" / (job.pipeline.stem().string() + "__" + job.info.name + ".png");
    return request;
  }

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
    return failure_ ? jobs_.size() : next_++;
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
  const std::vector<StressJob> jobs_;
  std::vector<CellRequest> requests_;
  std::vector<StressCell> cells_;
  std::vector<bool> isDone_;
  const double limit_;
  const std::uint64_t memoryAtStart_ = sharedMemoryLeft();  // each worker has an address space of its own
  std::size_t workers_ = 1;
  WorkerDevice device_{{}, {}, {}, true};
  std::atomic<int> failedStarts_ = 0;
  std::mutex mutex_;
  std::size_t next_ = 0, done_ = 0;
  experiment::Costs costs_;
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
  summary.cells = Battery(options, techniques, store ? &*store : nullptr).run();
  if (!options.output.empty())
    summary.page = writeStressPage(options.output, summary.cells, options.commandLine);
  return summary;
}

}  // namespace lumivox
