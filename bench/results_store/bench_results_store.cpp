// The results store with many runs: adding, reading, filtering, planning and merging, as medians and
// quartiles in s; and how many stores are damaged after their process was killed.
// usage: bench_results_store [--quick | REPEATS [FOLDER]] (default: 5; FOLDER: where the stores lie and stay,
// by default a new one that is removed), from the project's folder. --quick: seconds of work, whose figures
// mean nothing, for the tests. Exit code 1: the store of a killed process cannot be read or lacks a run that
// add() had confirmed.
#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "../spread.h"
#include "laboratory/stored_records.h"
#include "lumivox/base/error.h"

namespace {

using namespace lumivox;
namespace fs = std::filesystem;

double secondsOf(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// `prepare` is not timed.
void row(
    const std::string& what, int repeats, const std::function<void()>& work,
    const std::function<void()>& prepare = [] {}) {
  std::vector<double> seconds;
  for (int i = 0; i < repeats; ++i) {
    prepare();
    seconds.push_back(secondsOf(work));
  }
  const Spread spread = spreadOf(seconds);
  fmt::print("  {:<60} {:.3g} [{:.3g}, {:.3g}] s\n", what, spread.median, spread.lower, spread.upper);
}

void fill(const fs::path& file, int first, int count) {
  fs::remove(file);
  ResultsStore store(file);
  for (int i = 0; i < count; ++i) store.add(test::runNumber(first + i));
}

void measureOne(const fs::path& folder, int runs, int planned, int repeats) {
  const fs::path file = folder / "many.sqlite";
  row(fmt::format("add {} runs, each in a transaction", runs), repeats, [&] { fill(file, 0, runs); });
  const ResultsStore store(file, ResultsStore::Mode::read);
  std::size_t found = 0;
  row(fmt::format("read {} runs", runs), repeats, [&] { found = store.runs().size(); });
  if (found != static_cast<std::size_t>(runs)) throw Error(fmt::format("{} of {} runs read", found, runs));
  RunFilter none;
  none.pipeline = "no_such_pipeline";
  row("a filter that matches none of them", repeats, [&] { found = store.runs(none).size(); });
  std::vector<std::string> keys;
  for (int i = 0; i < planned; ++i) keys.push_back(test::runNumber(i).identity.key());
  row(fmt::format("plan {} points: which of them are there", planned), repeats, [&] {
    found = 0;
    for (const std::string& key : keys) found += store.contains(key);
  });
  if (found != static_cast<std::size_t>(std::min(runs, planned))) throw Error("points are missing");
  fmt::print("  {:<60} {:.1f} MB\n", "the file", static_cast<double>(fs::file_size(file)) / 1e6);
}

void measureMerging(const fs::path& folder, int stores, int repeats) {
  const fs::path parts = folder / "parts", whole = folder / "whole.sqlite";
  fs::create_directories(parts);
  const auto part = [&](int i) { return parts / fmt::format("{}.sqlite", i); };
  for (int i = 0; i < stores; ++i) fill(part(i), i, 1);
  row(
      fmt::format("merge {} stores of a run each", stores), repeats,
      [&] {
        ResultsStore store(whole);
        for (int i = 0; i < stores; ++i) store.merge(ResultsStore(part(i), ResultsStore::Mode::read));
        if (store.count().runs != static_cast<std::size_t>(stores)) throw Error("merged runs are missing");
      },
      [&] { fs::remove(whole); });
}

/// Kills `kills` processes at random moments while they add runs. Returns how many left a store that cannot
/// be read or lacks a run for which add() had returned.
int brokenByKills(const fs::path& folder, int kills) {
  const fs::path file = folder / "killed.sqlite";
  std::mt19937 random(1);
  int broken = 0, told = 0;
  for (int i = 0; i < kills; ++i) {
    fs::remove(file);
    int pipe[2];
    if (::pipe(pipe) != 0) throw Error("no pipe");
    const pid_t child = fork();
    if (child == 0) {
      close(pipe[0]);
      ResultsStore store(file);
      for (int number = 0;; ++number) {
        store.add(test::runNumber(number));
        if (::write(pipe[1], "x", 1) != 1) _exit(1);
      }
    }
    close(pipe[1]);
    std::this_thread::sleep_for(
        std::chrono::microseconds(std::uniform_int_distribution(2000, 60000)(random)));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    std::size_t stored = 0;
    char buffer[256];
    for (ssize_t n; (n = ::read(pipe[0], buffer, sizeof buffer)) > 0;) stored += static_cast<std::size_t>(n);
    close(pipe[0]);
    told += static_cast<int>(stored);
    try {
      // The last run may be stored although its add() had not yet reported it.
      const std::size_t there = ResultsStore(file).runs().size();
      broken += there < stored || there > stored + 1;
    } catch (const Error& error) {
      fmt::print(stderr, "{}\n", error.what());
      ++broken;
    }
  }
  fmt::print("  {:<60} {} of {} ({} runs stored before)\n", "broken by kills at random moments", broken,
             kills, told);
  return broken;
}

/// A temporary folder that the destructor removes.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "bench_results_store_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw Error("cannot make a folder in " + fs::temp_directory_path().string());
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

int main(int argc, char** argv) {
  try {
    const bool quick = argc > 1 && std::string_view(argv[1]) == "--quick";
    const int repeats = quick ? 1 : argc > 1 ? std::atoi(argv[1]) : 5;
    if (repeats < 1) throw Error("expected [--quick | REPEATS [FOLDER]], with at least one repeat");
    const Folder own;
    const fs::path folder = argc > 2 ? fs::path(argv[2]) : own.path();
    fs::create_directories(folder);
    measureOne(folder, quick ? 20 : 3000, quick ? 100 : 100000, repeats);
    measureMerging(folder, quick ? 5 : 1000, repeats);
    return brokenByKills(folder, quick ? 3 : 200) == 0 ? 0 : 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_results_store: {}\n", error.what());
    return 2;
  }
}
