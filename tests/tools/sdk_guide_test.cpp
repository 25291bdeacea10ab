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
  REQUIRE(guide.says("`lumivox new` prints the commands with the right paths in them"));
  const std::string& printed = guide.of("lumivox new").output;
  CHECK(contains(printed, "-DCMAKE_PREFIX_PATH=" + installed.prefix().string()));
  REQUIRE(guide.says("It has written, and this page explains"));
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
  CHECK(contains(guide.of("ctest").output, "100% tests passed"));
  REQUIRE(guide.says("A PNG shows the pipeline's image"));
  CHECK(guide.has("my_lab/out/ambient.png"));
  CHECK(guide.has("my_lab/out/report/index.html"));
  REQUIRE(guide.says("They are what `lumivox describe ambient.gather` prints"));
  for (const char* word : {"gbuffer", "radiance", "diffuse"})
    CHECK(contains(guide.of("lumivox describe ambient.gather").output, word));
  REQUIRE(guide.says("It lists the textures with their formats, and then what readers *heed*"));
  for (const char* word : {"contains red (d3 rgba16f or rgba32f, for each level)", "readers heed quantity",
                           "readers heed unit", "readers heed readFor"})
    CHECK(contains(guide.of("lumivox describe ShGrid").output, word));
  REQUIRE(
      guide.says("`lumivox stress ambient --quick --pipeline scenes/pipelines/ambient.pipeline` runs it on"));
  const CommandResult stressed = guide.run(
      "cd my_lab && lumivox stress ambient --quick --case image_1x1 --techniques "
      "build/lib/techniques --pipeline scenes/pipelines/ambient.pipeline");
  CHECK(contains(stressed.output, "1 stable"));
  REQUIRE(guide.says("Git ignores what is built there and written to `out/`"));
  if (runCommand("command -v git").exitCode != 0) return skip("git is not installed");
  const std::string others = guide.run("cd my_lab && git ls-files --others --exclude-standard").output;
  CHECK(contains(others, "techniques/ambient/ambient.cpp"));
  for (const char* folder : {"build/", "out/"})
    CHECK_FALSE(contains("\n" + others, "\n" + std::string(folder)));
}
