// How long large stores take. Hidden: `./test --slow`.
#include <sys/resource.h>

#include <chrono>

#include "lumivox/results/json.h"
#include "results_sql.h"
#include "stored_records.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

TEST_CASE("a thousand stores of a thousand points merge in a minute", "[.]") {
  const TemporaryDirectory directory;
  constexpr int kStores = 1000, kPoints = 1000;
  std::vector<std::filesystem::path> files;
  // Each is filled by merging one that was written point by point, under other keys.
  const auto first = directory.path() / "0.sqlite";
  for (int i = 0; i < kStores; ++i) {
    files.push_back(directory.path() / (std::to_string(i) + ".sqlite"));
    if (i == 0) {
      ResultsStore store(first);
      for (int number = 0; number < kPoints; ++number) store.add(runNumber(number));
      continue;
    }
    std::filesystem::copy_file(first, files.back());
    execute(files.back(),
            "UPDATE runs SET key = printf('%08d', " + std::to_string(i) + ") || substr(key, 9)");
  }
  using Clock = std::chrono::steady_clock;
  const auto processorSeconds = [] {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto secondsOf = [](const timeval& time) {
      return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    return secondsOf(usage.ru_utime) + secondsOf(usage.ru_stime);
  };
  const auto start = Clock::now();
  const double processorBefore = processorSeconds();
  ResultsStore all(directory.path() / "all.sqlite");
  std::size_t runs = 0;
  for (const MergeCount& count : all.merge(files, /*mixed=*/false)) runs += count.runs;
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  CHECK(runs == std::size_t{kStores} * kPoints);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  // Other work on the machine says nothing about the merge.
  const double processor = processorSeconds() - processorBefore;
  WARN(seconds << " s, " << processor << " s of a processor, " << usage.ru_maxrss / 1024 << " MiB, "
               << std::filesystem::file_size(directory.path() / "all.sqlite") / (1 << 20)
               << " MiB of results");
  CHECK(processor < 60.0);
}
