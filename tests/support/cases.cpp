#define CATCH_CONFIG_RUNNER
#include "support/cases.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <mutex>
#include <optional>
#include <regex>
#include <set>
#include <thread>
#include <utility>

namespace lumivox::test {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

std::string textOf(const char* variable) {
  const char* value = std::getenv(variable);
  return value == nullptr ? std::string() : value;
}

/// The name of a case for ./test: "base_file: sentence" for the sentence in base_file_test.cpp.
std::string nameOf(const Catch::TestCaseInfo& info) {
  std::string file = fs::path(info.lineInfo.file).stem().string();
  constexpr std::string_view kEnd = "_test";
  if (file.ends_with(kEnd)) file.resize(file.size() - kEnd.size());
  return file + ": " + info.name;
}

/// Lines that ./test reads. Each is written at once, so that a crash loses none.
class Events {
 public:
  void add(const std::string& line) {
    if (!file_.is_open()) {
      const std::string folder = textOf("LUMIVOX_TEST_EVENTS");
      if (folder.empty()) return;
      file_.open(fs::path(folder) /
                 fmt::format("{}.{}", fs::read_symlink("/proc/self/exe").filename().string(), getpid()));
    }
    file_ << line << std::endl;
  }

 private:
  std::ofstream file_;
};

Events& events() {
  static Events all;
  return all;
}

/// Ends the process when one case takes too long.
class Watch {
 public:
  void start(const std::string& name) {
    const std::lock_guard lock(mutex_);
    name_ = name;
    begun_ = Clock::now();
    if (!thread_.joinable()) thread_ = std::thread([this] { watch(); });
  }
  double stop() {
    const std::lock_guard lock(mutex_);
    name_.clear();
    return std::chrono::duration<double>(Clock::now() - begun_).count();
  }
  ~Watch() {
    {
      const std::lock_guard lock(mutex_);
      ends_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
  }

 private:
  void watch() {
    std::unique_lock lock(mutex_);
    while (!changed_.wait_for(lock, std::chrono::seconds(1), [this] { return ends_; })) {
      if (name_.empty() || Clock::now() - begun_ < limit_) continue;
      events().add("end\ttime-out\t" + std::to_string(limit_.count()) + "\t" + name_);
      std::cerr << name_ << ": not ended after " << limit_.count() << " s" << std::endl;
      _exit(124);
    }
  }

  const std::string given_ = textOf("LUMIVOX_TEST_LIMIT");
  const std::chrono::seconds limit_{given_.empty() ? 600 : std::stoi(given_)};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string name_;  ///< empty: nothing runs
  Clock::time_point begun_;
  bool ends_ = false;
  std::thread thread_;
};

/// The working folder and the environment, which restore() resets after a case, as if each case had its own
/// process.
class Surroundings {
 public:
  Surroundings() : folder_(fs::current_path()) {
    for (char** one = environ; *one != nullptr; ++one) {
      const std::string text = *one;
      const std::size_t equals = text.find('=');
      variables_[text.substr(0, equals)] = text.substr(equals + 1);
    }
  }
  void restore() const {
    fs::current_path(folder_);
    std::set<std::string> others;
    for (char** one = environ; *one != nullptr; ++one) {
      const std::string name = std::string(*one).substr(0, std::string_view(*one).find('='));
      if (!variables_.contains(name)) others.insert(name);
    }
    for (const std::string& name : others) unsetenv(name.c_str());
    for (const auto& [name, value] : variables_) setenv(name.c_str(), value.c_str(), 1);
  }

 private:
  fs::path folder_;
  std::map<std::string, std::string> variables_;
};

class Listener : public Catch::TestEventListenerBase {
 public:
  using TestEventListenerBase::TestEventListenerBase;
  void testCaseStarting(const Catch::TestCaseInfo& info) override {
    TestEventListenerBase::testCaseStarting(info);
    found_.emplace();
    events().add("begin\t" + nameOf(info));
    watch_.start(nameOf(info));
  }
  void testCaseEnded(const Catch::TestCaseStats& stats) override {
    const double seconds = watch_.stop();
    events().add(fmt::format("end\t{}\t{:.2f}\t{}", stats.totals.assertions.allOk() ? "passed" : "failed",
                             seconds, nameOf(stats.testInfo)));
    found_->restore();
    TestEventListenerBase::testCaseEnded(stats);
  }

 private:
  Watch watch_;
  std::optional<Surroundings> found_;
};

/// Escapes a name so that Catch2 matches it literally.
std::string escaped(const std::string& name) {
  std::string result;
  for (const char letter : name) {
    if (std::string_view("\\,[]").find(letter) != std::string_view::npos) result += '\\';
    result += letter;
  }
  return result;
}

}  // namespace

void noteSkipped(const std::string& reason) {
  events().add("skip\t" + reason);
}

int runCases(int count, char** arguments) {
  Catch::Session session;
  const bool lists = count == 2 && std::string_view(arguments[1]) == "--cases";
  if (const int wrong = lists ? 0 : session.applyCommandLine(count, arguments); wrong != 0) return wrong;
  const std::string pattern = textOf("LUMIVOX_TEST_CASES"), without = textOf("LUMIVOX_TEST_WITHOUT"),
                    share = textOf("LUMIVOX_TEST_SHARE");
  if (lists || !pattern.empty() || !without.empty() || !share.empty()) {
    const auto slash = share.find('/');
    const std::size_t shares = slash == std::string::npos ? 1 : std::stoul(share.substr(slash + 1)),
                      own = slash == std::string::npos ? 0 : std::stoul(share) - 1;
    std::size_t at = 0;
    std::set<std::string> left;
    std::ifstream file(without);
    for (std::string line; std::getline(file, line);) left.insert(line);
    const std::regex wanted(pattern);
    Catch::ConfigData data = session.configData();
    if (std::exchange(data.filenamesAsTags, false)) Catch::applyFilenamesAsTags(session.config());
    const Catch::TestSpec& spec = session.config().testSpec();
    data.testsOrTags.clear();
    for (const Catch::TestCase& one : Catch::getAllTestCasesSorted(session.config())) {
      const std::string name = nameOf(one.getTestCaseInfo());
      if (spec.hasFilters() ? !Catch::matchTest(one, spec, session.config()) : one.isHidden()) continue;
      if (at++ % shares != own || !std::regex_search(name, wanted) || left.contains(name)) continue;
      if (lists) std::cout << name << "\n";
      if (!data.testsOrTags.empty()) data.testsOrTags.emplace_back(",");
      data.testsOrTags.push_back(escaped(one.getTestCaseInfo().name));
    }
    if (lists || data.testsOrTags.empty()) return 0;
    session.useConfigData(data);
  }
  return session.run();
}

CATCH_REGISTER_LISTENER(Listener)

}  // namespace lumivox::test
