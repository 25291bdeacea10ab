// What is built, installed as somebody would install it who never sees the tree.
#pragma once

#include <filesystem>
#include <string>

#include "support/support.h"

namespace lumivox::test {

inline std::string quoted(const std::filesystem::path& path) {
  return "'" + path.string() + "'";
}

/// An installation of what is built, in a prefix of its own, and a home folder; commands see neither the
/// environment of the tests nor the tree.
class Installation {
 public:
  Installation() {
    const CommandResult result =
        runCommand("cmake --install " + quoted(binaryDirectory()) + " --prefix " + quoted(prefix()));
    INFO(result.output << result.errors);
    REQUIRE(result.exitCode == 0);
    std::filesystem::create_directories(folder_.path() / "home");
  }
  std::filesystem::path prefix() const { return folder_.path() / "prefix"; }
  std::filesystem::path data() const { return prefix() / "share/lumivox"; }
  std::filesystem::path work() const { return folder_.path() / "home"; }
  /// Runs a command in `folder`; the installed programs come first on the PATH.
  CommandResult run(const std::filesystem::path& folder, const std::string& command) const {
    return runCommand("cd " + quoted(folder) + " && env -i PATH=" + quoted(prefix() / "bin") +
                      ":/usr/bin:/bin HOME=" + quoted(work()) + " sh -c '" + command + "'");
  }
  /// The same; it must end well. Returns its output.
  std::string mustRun(const std::filesystem::path& folder, const std::string& command) const {
    const CommandResult result = run(folder, command);
    INFO(command << "\n" << result.output << result.errors);
    REQUIRE(result.exitCode == 0);
    return result.output;
  }

 private:
  TemporaryDirectory folder_;
};

}  // namespace lumivox::test
