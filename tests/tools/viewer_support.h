// What the tests of the window share.
#pragma once

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <string>
#include <thread>

#include "lumivox/base/image.h"
#include "tools/cli_support.h"
#include "tools/display.h"
#include "tools/started.h"
#include "viewer/session.h"

namespace lumivox::test {

using Json = nlohmann::json;

/// A variable of the environment while it lives.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    setenv(name, value.c_str(), 1);
  }
  ~Variable() {
    if (before_)
      setenv(name_, before_->c_str(), 1);
    else
      unsetenv(name_);
  }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_;
};

inline bool canShowWindows() {
  if (std::filesystem::exists(binaryDirectory() / "bin/lumivox-view") && display().there()) return true;
  skip("Xvfb is not installed");
  return false;
}

/// On that display.
inline std::string windowCommand(const std::string& options) {
  return "'" + (binaryDirectory() / "bin/lumivox-view").string() + "' " + options;
}

inline std::string quotedFile(const Workplace& place, const std::string& name) {
  return "\"" + place.file(name) + "\"";
}

/// A script whose files, in single quotes, lie in the workplace.
inline std::string scriptOf(const Workplace& place, const std::string& script) {
  static const std::regex file("'([^']*)'");
  return std::regex_replace(script, file, "\"" + place.path().string() + "/$1\"");
}

/// The little room with a pipeline in a window, and what a script does there.
inline CommandResult shown(const Workplace& place, const std::string& script, const std::string& pipeline,
                           const std::string& options = "--resolution 24x16") {
  place.write("script.view", "view \"a test\" {\n" + scriptOf(place, script) + "\n}\n");
  return runCommand(windowCommand("'" + place.scene() + "' '" + pipeline + "' " + options + " --script '" +
                                  place.file("script.view") + "'"));
}
/// The same of a script that must end well.
inline CommandResult showed(const Workplace& place, const std::string& script, const std::string& pipeline,
                            const std::string& options = "--resolution 24x16") {
  CommandResult result = shown(place, script, pipeline, options);
  INFO(result.errors);
  REQUIRE(result.exitCode == 0);
  return result;
}

/// A window with a script that goes on beside a test, and ends well. `texts` are its scene, pipelines and
/// options; each action is done once the file before it is there.
inline void showedWhile(const Workplace& place, const std::string& texts, const std::string& script,
                        const std::vector<std::pair<const char*, std::function<void()>>>& actions) {
  place.write("script.view", "view \"a test\" {\n" + scriptOf(place, script) + "\n}\n");
  CommandResult done;
  std::thread window(
      [&] { done = runCommand(windowCommand(texts + " --script '" + place.file("script.view") + "'")); });
  bool came = true;
  for (const auto& [file, action] : actions) {
    came = came && becomes([&, name = file] { return place.has(name); });
    action();
  }
  window.join();
  INFO(done.errors);
  REQUIRE(came);
  REQUIRE(done.exitCode == 0);
}

/// What `record` wrote.
inline Json recordOf(const Workplace& place, const std::string& name) {
  return Json::parse(place.read(name));
}

/// What happens in the window, without one.
inline std::unique_ptr<viewer::Session> sessionOf(const std::string& scene, const std::string& pipeline) {
  viewer::SessionOptions options;
  options.scene = scene;
  options.pipelines = {std::filesystem::exists(pipeline) ? pipeline : committedPipeline(pipeline)};
  options.techniques = {binaryDirectory() / "lib/techniques"};
  return std::make_unique<viewer::Session>(options, [] {});
}

/// The value of a row of a panel in a record.
inline std::string rowOf(const Json& record, const std::string& panel, const std::string& row) {
  for (const Json& one : record.at("panels").at(panel))
    if (one.at("name") == row) return one.value("value", "");
  return "absent";
}

inline void checkSamePixels(const std::filesystem::path& a, const std::filesystem::path& b) {
  const LayeredImage first = readExr(a), second = readExr(b);
  REQUIRE(first.layers.size() == second.layers.size());
  for (const auto& [name, image] : first.layers) {
    INFO(name);
    REQUIRE(second.layers.count(name) == 1);
    CHECK(image.values() == second.layers.at(name).values());
  }
}

}  // namespace lumivox::test
