// The command line in a process of its own, for tests that interrupt it or run it twice at once, and points
// that are measured fast, slowly or until they fail.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "tools/cli_support.h"

namespace lumivox::test {

/// A command in a process of its own that can be sent a signal. What it says on standard error goes to a file
/// where one is named; at a value that is named the pipeline `slow` stays until a signal comes.
class Started {
 public:
  explicit Started(std::vector<std::string> arguments, const std::string& errors = {},
                   const std::string& holdAt = {}) {
    const std::string program = (binaryDirectory() / "bin/lumivox").string();
    pid_ = fork();
    if (pid_ != 0) return;
    const int nowhere = open("/dev/null", O_RDWR);
    for (const int descriptor : {0, 1, 2}) dup2(nowhere, descriptor);
    if (!errors.empty()) dup2(open(errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), 2);
    if (!holdAt.empty()) setenv("LUMIVOX_TEST_HOLD_AT", holdAt.c_str(), 1);
    std::vector<char*> pointers{const_cast<char*>(program.c_str())};
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    execv(program.c_str(), pointers.data());
    _exit(127);
  }
  ~Started() {
    if (!ended_) {
      kill(pid_, SIGKILL);
      wait();
    }
  }
  void signalAfter(std::chrono::milliseconds delay, int signal) {
    std::this_thread::sleep_for(delay);
    kill(pid_, signal);
  }
  int process() const { return pid_; }
  /// The status as waitpid gives it.
  int wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    ended_ = true;
    return status;
  }

 private:
  pid_t pid_ = -1;
  bool ended_ = false;
};

/// Waits until something holds, at most a minute, which is far more than any step of a test takes.
template <class Condition>
bool becomes(const Condition& condition) {
  for (int i = 0; i < 3000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return false;
}

/// The little room, and pipelines of the technique that does what none may do: `fast` and `slow`, which rests
/// in every frame, with a sweep of four points, and `tire`, which fails sooner or later.
class Place : public Workplace {
 public:
  Place() {
    const auto swept = [](const std::string& title, const std::string& deed) {
      return "pipeline \"" + title + "\" {\n  param value 1 in 0..10\n  pass paint hostile.paint { deed " +
             deed +
             "  value $value }\n\n  output direct paint.radiance\n}\n\nsweep values { value [1 2 3 4] }\n";
    };
    write("fast.pipeline", swept("Fast", "paint"));
    write("slow.pipeline", swept("Slow", "rest"));
    write(
        "tire.pipeline",
        "pipeline \"Tire\" {\n  pass paint hostile.paint { deed tire }\n\n  output direct paint.radiance\n}\n");
  }
  /// A pipeline of its own with a sweep over these values, which rests in every frame.
  void writeSlow(const std::string& name, const std::string& values) const {
    write(name + ".pipeline",
          "pipeline \"" + name +
              "\" {\n  param value 1 in 0..10\n  pass paint hostile.paint { deed rest  value $value "
              "}\n\n  output direct paint.radiance\n}\n\nsweep values { value [" +
              values + "] }\n");
  }
  std::string quoted(const std::string& name) const { return "'" + file(name) + "'"; }
  /// The only scene of a page's JSON.
  nlohmann::json sceneOf(const std::string& json) const {
    return nlohmann::json::parse(read(json)).at("scenes").at(0);
  }
  static std::string techniques() { return (binaryDirectory() / "tests/plugins/hostile").string(); }
  /// The program with that technique.
  static std::string program() { return "lumivox --techniques '" + techniques() + "' "; }
  /// Options that measure as little as can be.
  static std::vector<std::string> quickWords() {
    return {"--resolution", "8x8", "--spp", "4", "--subpixels", "1", "--repeats", "3", "--seeds", "2"};
  }
  static std::string quick() {
    std::string text = " ";
    for (const std::string& word : quickWords()) text += word + " ";
    return text;
  }
  /// A command with its words on the little room, of these pipelines, at those options.
  std::vector<std::string> words(const std::string& command, const std::vector<std::string>& pipelines,
                                 const std::vector<std::string>& more) const {
    std::vector<std::string> words{"--techniques", techniques(), command, scene()};
    for (const std::string& pipeline : pipelines)
      words.insert(words.end(), {"--pipeline", file(pipeline + ".pipeline")});
    const std::vector<std::string> options = quickWords();
    words.insert(words.end(), options.begin(), options.end());
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// A measuring command of the room, as little as can be, with that technique.
  template <class... Words>
  CommandResult measured(const Before& before, const char* command, const char* pipeline,
                         const Words&... words) const {
    return typed(before, "--techniques", techniques(), command, scene(), "--pipeline", file(pipeline),
                 Raw{quick()}, words...);
  }
  /// Whether what a command says in a file comes to the work at a value.
  bool comesTo(const std::string& value, const std::string& said = "said.txt") const {
    return becomes([&] { return has(said) && contains(read(said), "value=" + value); });
  }
  /// Ends a command by a signal at the work at a value; its status as waitpid gives it.
  int endedAt(const std::string& value, const std::vector<std::string>& words, int signal = SIGKILL) const {
    std::filesystem::remove(path() / "said.txt");
    Started command(words, file("said.txt"), value);
    REQUIRE(comesTo(value));
    command.signalAfter(std::chrono::milliseconds(0), signal);
    return command.wait();
  }
  CommandResult run(const std::string& command, const std::vector<std::string>& pipelines,
                    const std::vector<std::string>& more) const {
    std::string line;
    for (const std::string& word : words(command, pipelines, more)) line += " '" + word + "'";
    return typed(Raw{line});
  }
};

}  // namespace lumivox::test
