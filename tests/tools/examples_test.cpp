// The examples that come with the program, whose files the guide to techniques quotes.
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;
namespace fs = std::filesystem;

TEST_CASE("each example passes the test that it brings, in a folder of its own") {
  const fs::path built = binaryDirectory() / "tests/examples";
  int count = 0;
  for (const auto& entry : fs::directory_iterator(sourceDirectory() / "examples")) {
    const std::string name = entry.path().filename().string();
    const CommandResult result =
        runCommand("cd '" + entry.path().string() + "' && LUMIVOX_TECHNIQUES='" + built.string() + "' '" +
                   (built / (name + "_test")).string() + "'");
    INFO(name << "\n" << result.output << result.errors);
    CHECK(result.exitCode == 0);
    CHECK(result.output.find("All tests passed") != std::string::npos);
    ++count;
  }
  CHECK(count == 2);
}
