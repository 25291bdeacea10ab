// Helpers that several test files share.
#pragma once

#include <catch2/catch.hpp>
#include <filesystem>
#include <string>

namespace lumivox::test {

/// Reports that the test does not apply on this machine; ctest counts it as skipped. Follow it with `return`.
void skip(const std::string& reason);

/// A new directory that the destructor removes.
class TemporaryDirectory {
 public:
  TemporaryDirectory();
  ~TemporaryDirectory();
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, const std::string& content) const;

 private:
  std::filesystem::path path_;
};

std::filesystem::path sourceDirectory();
std::filesystem::path binaryDirectory();

struct CommandResult {
  int exitCode = 0;
  std::string output, errors;
};
/// Runs a shell command; stdout and stderr apart. "lumivox" at its start is replaced by the built program.
CommandResult runCommand(const std::string& command);

/// The message of the exception that `work` throws; fails the test when it throws none or another type.
template <class Exception, class Work>
std::string messageOf(Work&& work) {
  try {
    work();
  } catch (const Exception& error) {
    return error.what();
  }
  FAIL("expected an error, but nothing was thrown");
  return {};
}

}  // namespace lumivox::test
