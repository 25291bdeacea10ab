// The guide to techniques, followed from an installed prefix: every command of it, in its order.
#include <regex>

#include "lumivox/base/file.h"
#include "tools/cli_support.h"
#include "tools/guide.h"
#include "tools/installation.h"

using namespace lumivox;
using namespace lumivox::test;

TEST_CASE("the guide to techniques leads from nothing to a technique that is measured", "[slow]") {
  const Installation installed;
  const FollowedGuide guide("docs/writing_a_technique.md",
                            {{"PREFIX", installed.prefix().string()},
                             {"SCENES", (installed.data() / "scenes").string()},
                             // The shell that follows a guide stays in the folder it went to.
                             {"ctest --test-dir", "git init -q . ; ctest --test-dir"}},
                            {installed.prefix() / "bin"});
  CHECK(guide.failures() == "");
  // The files that it lists, in a table, are those that it wrote and named.
  const std::string& printed = guide.of("lumivox new").output;
  static const std::regex row("\n\\| `([^`]+)` \\| ");
  const std::string text = readFile(sourceDirectory() / "docs/writing_a_technique.md");
  std::size_t files = 0;
  for (std::sregex_iterator match(text.begin(), text.end(), row), end; match != end; ++match) {
    const std::string file = (*match)[1];
    if (file.find('/') == std::string::npos && file != "CMakeLists.txt") continue;
    INFO(file);
    CHECK(guide.has("my_lab/" + file));
    CHECK(contains(printed, file));
    ++files;
  }
  CHECK(files == 7);
  // What is built and written is ignored.
  if (runCommand("command -v git").exitCode != 0) return skip("git is not installed");
  const std::string others = guide.run("cd my_lab && git ls-files --others --exclude-standard").output;
  CHECK(contains(others, "techniques/ambient/ambient.cpp"));
  for (const char* folder : {"build/", "out/"})
    CHECK_FALSE(contains("\n" + others, "\n" + std::string(folder)));
}
