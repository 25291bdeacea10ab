#include "support/support.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <sstream>

#include "support/cases.h"

namespace lumivox::test {

std::filesystem::path sourceDirectory() {
  return LUMIVOX_SOURCE_DIRECTORY;
}

std::filesystem::path binaryDirectory() {
  return LUMIVOX_BINARY_DIRECTORY;
}

void skip(const std::string& reason) {
  std::cout << "SKIPPED: " << reason << std::endl;
  noteSkipped(reason);
  SUCCEED("skipped");
}

TemporaryDirectory::TemporaryDirectory() {
  std::string pattern = (std::filesystem::temp_directory_path() / "lumivox-test-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make a temporary directory");
  path_ = pattern;
}

TemporaryDirectory::~TemporaryDirectory() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path TemporaryDirectory::write(const std::string& name, const std::string& content) const {
  const auto file = path_ / name;
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << content;
  return file;
}

CommandResult runCommand(const std::string& command) {
  const TemporaryDirectory directory;
  std::string line = command;
  if (line.rfind("lumivox", 0) == 0)
    line = "'" + (binaryDirectory() / "bin/lumivox").string() + "'" + line.substr(7);
  line = "( " + line + " ) >'" + (directory.path() / "out").string() + "' 2>'" +
         (directory.path() / "err").string() + "' </dev/null";
  const int status = std::system(line.c_str());
  const auto read = [&](const char* name) {
    std::ifstream stream(directory.path() / name, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read("out"), read("err")};
}

}  // namespace lumivox::test
