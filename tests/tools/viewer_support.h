// What the tests of the window share.
#pragma once

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "lumivox/base/image.h"
#include "tools/cli_support.h"

namespace lumivox::test {

using Json = nlohmann::json;

inline bool canShowWindows() {
  if (runCommand("command -v xvfb-run && command -v xauth").exitCode == 0 &&
      std::filesystem::exists(binaryDirectory() / "bin/lumivox-view"))
    return true;
  skip("xvfb-run or xauth is not installed");
  return false;
}

inline std::string windowCommand(const std::string& options) {
  return "xvfb-run -a -s '-screen 0 1400x1000x24' '" + (binaryDirectory() / "bin/lumivox-view").string() +
         "' " + options;
}

/// The little room with a pipeline in a window, and what a script does there.
inline CommandResult shown(const Workplace& place, const std::string& script, const std::string& pipeline,
                           const std::string& options = "--resolution 24x16") {
  place.write("script.view", "view \"a test\" {\n" + script + "\n}\n");
  return runCommand(windowCommand("'" + place.scene() + "' '" + pipeline + "' " + options + " --script '" +
                                  place.file("script.view") + "'"));
}

inline std::string quotedFile(const Workplace& place, const std::string& name) {
  return "\"" + place.file(name) + "\"";
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
