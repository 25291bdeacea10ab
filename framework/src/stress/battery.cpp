// The battery: cells in worker processes, a thread of the battery behind each.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <mutex>
#include <thread>

#include "lumivox/base/error.h"
#include "lumivox/report/report.h"
#include "lumivox/report/stress_cells.h"
#include "report/choice.h"
#include "stress/child.h"
#include "stress/protocol.h"
#include "stress/run_cell.h"

namespace lumivox {
namespace {

using namespace stress;
using Clock = std::chrono::steady_clock;

// s for one cell: ten times what the slowest takes on a machine that does nothing else.
constexpr double kQuickLimit = 60.0, kFullLimit = 600.0;
/// A worker opens a device before it is ready.
constexpr double kStartLimit = 60.0;  // s

class Battery {
 public:
  Battery(const StressOptions& options, TechniqueSource& techniques)
      : options_(options),
        techniques_(techniques),
        jobs_(plannedStress(options, techniques)),
        cells_(jobs_.size()),
        limit_(options.timeLimit > 0.0 ? options.timeLimit
               : options.quick         ? kQuickLimit
                                       : kFullLimit) {
    // Each cell says of its own what it depends on; a worker that dies cannot.
    for (const StressJob& job : jobs_) {
      requests_.push_back(requestFor(job));
      cells_[requests_.size() - 1] =
          cellBefore(requests_.back(), job.info.family, techniques, options.repeatArguments);
    }
  }

  std::vector<StressCell> run() {
    if (options_.program.empty()) throw Error("a stress battery needs a program that serves as its workers");
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < workerCount(); ++i) threads.emplace_back([this] { work(); });
    for (std::thread& thread : threads) thread.join();
    if (failure_) std::rethrow_exception(failure_);
    nameDevices();
    return std::move(cells_);
  }

 private:
  /// A worker that died could not say what its device is; the others have the same.
  void nameDevices() {
    const auto known = std::find_if(cells_.begin(), cells_.end(),
                                    [](const StressCell& cell) { return !cell.device.empty(); });
    if (known == cells_.end()) return;
    for (StressCell& cell : cells_)
      if (cell.device.empty()) {
        cell.device = known->device;
        cell.driver = known->driver;
        cell.shaderInput = known->shaderInput;
      }
  }

  CellRequest requestFor(const StressJob& job) const {
    CellRequest request{job.pipeline, job.info.name, options_.quick, {}};
    if (!options_.output.empty())
      request.picture =
          options_.output / "pictures" / (job.pipeline.stem().string() + "__" + job.info.name + ".png");
    return request;
  }

  std::size_t workerCount() const {
    const std::size_t wanted = options_.workers > 0 ? static_cast<std::size_t>(options_.workers)
                                                    : std::max(1u, std::thread::hardware_concurrency());
    return std::clamp<std::size_t>(wanted, 1, std::max<std::size_t>(1, jobs_.size()));
  }

  /// Several workers share the processors: a software rasteriser with a thread for each would only get in its
  /// own way.
  std::vector<std::string> environment() const {
    if (workerCount() == 1 || std::getenv("LP_NUM_THREADS") != nullptr) return {};
    return {"LP_NUM_THREADS=1"};
  }

  /// The next job, pipeline by pipeline; past the end: none.
  std::size_t take() {
    const std::lock_guard lock(mutex_);
    return failure_ ? jobs_.size() : next_++;
  }

  void work() {
    try {
      std::unique_ptr<Child> child;
      for (std::size_t job = take(); job < jobs_.size(); job = take()) {
        if (child == nullptr) child = readyWorker();
        if (!ask(*child, job)) child.reset();
        finished(job);
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
    }
  }

  /// Error when a worker cannot even start: every other one would fail as well.
  std::unique_ptr<Child> readyWorker() const {
    auto child = std::make_unique<Child>(options_.program, environment());
    const Child::Answer answer = child->receive(kStartLimit);
    if (answer.state == Child::State::answered && answer.line == kReady) return child;
    throw Error(
        answer.state == Child::State::silent
            ? fmt::format("a worker of the stress battery was not ready within {:g} s", kStartLimit)
            : fmt::format("a worker of the stress battery {}: {}", child->ending(), child->lastWords()));
  }

  /// False: the worker is of no further use.
  bool ask(Child& child, std::size_t job) {
    StressCell& cell = cells_[job];
    child.forgetWords();
    child.send(lineOf(requests_[job]));
    const auto start = Clock::now();
    const Child::Answer answer = child.receive(limit_);
    if (answer.state == Child::State::answered) {
      cell = stressCellFrom(answer.line);
      return true;
    }
    cell.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    cell.outcome = StressOutcome::broken;
    if (answer.state == Child::State::silent) {
      cell.detail = fmt::format("no answer within {:g} s; its process was ended", limit_);
    } else {
      const std::string words = child.lastWords();
      cell.detail = "its process " + child.ending() + (words.empty() ? "" : ": " + words);
    }
    return false;
  }

  void finished(std::size_t job) {
    const std::lock_guard lock(mutex_);
    ++done_;
    const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    if (options_.progress)
      options_.progress(cells_[job], done_, jobs_.size(),
                        seconds / static_cast<double>(done_) * static_cast<double>(jobs_.size() - done_));
  }

  const StressOptions& options_;
  TechniqueSource& techniques_;
  const std::vector<StressJob> jobs_;
  std::vector<CellRequest> requests_;
  std::vector<StressCell> cells_;
  const double limit_;
  const Clock::time_point start_ = Clock::now();
  std::mutex mutex_;
  std::size_t next_ = 0, done_ = 0;
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
  summary.cells = Battery(options, techniques).run();
  if (store) store->add(summary.cells);
  if (!options.output.empty())
    summary.page = writeStressPage(options.output, summary.cells, options.commandLine);
  return summary;
}

}  // namespace lumivox
