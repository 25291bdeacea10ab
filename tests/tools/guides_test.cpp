// Guides that are true: every command of each is run in its order, in a copy of the tree, at small sizes, and
// the marks beside it (guide.h) are held against what it writes and says. What is not run is listed with its
// reason in guide.cpp; the guide to techniques is followed by sdk_guide_test.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>

#include "lumivox/base/file.h"
#include "tools/cli_support.h"
#include "tools/guide.h"

using namespace lumivox;
using namespace lumivox::test;
namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

/// Its commands end well, its marks hold, and only ignored files are left.
void checkFollowed(const FollowedGuide& guide) {
  CHECK(guide.failures() == "");
  CHECK(guide.leftovers() == "");
}
void follow(const char* name) {
  checkFollowed(FollowedGuide(name));
}

using ImageSize = std::pair<std::uint32_t, std::uint32_t>;

/// From the header, which is the first chunk: big-endian width and height behind 16 bytes.
ImageSize pngSize(const fs::path& file) {
  const std::string bytes = readFileStart(file, 24);
  REQUIRE(bytes.size() == 24);
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
    return value;
  };
  return {number(16), number(20)};
}

}  // namespace

TEST_CASE("marks of a guide are about the command before them, and say where one does not hold") {
  const TemporaryDirectory folder;
  folder.write("out/a.csv", "1\n");
  folder.write("out/empty", "");
  const std::string text =
      "```sh\nlumivox a\nlumivox b  # why\n```\n<!-- checked: prints ^2 of \\d+$ ; seen -->\n"
      "<!-- checked [a]: writes out out/a.csv --> <!-- checked: runs ls -->\n<!-- checked: exits 1 -->\n"
      "```text\n<!-- checked: shown, no mark -->\n```\n";
  std::vector<Step> steps = stepsOf(text);
  REQUIRE(steps.size() == 3);
  CHECK(steps[1].command == "lumivox b");
  CHECK(steps[1].line == 3);
  CHECK(steps[0].marks.size() == 1);
  CHECK(steps[2].command == "ls");
  steps[1].result = {0, "x\n2 of 12\n", "seen\n"};
  steps[2].result.exitCode = 1;
  for (const Step& step : steps) CHECK(unheld(step, folder.path()) == "");
  // Each verb where it is not so; what is omitted has said nothing.
  steps[1].result = {0, "12 of 12\nend\n", "seen\n"};
  CHECK(unheld(steps[1], folder.path()) == "5: not so: prints ^2 of \\d+$ ; seen\n");
  const auto holds = [&](const std::string& mark) {
    std::vector<Step> one = stepsOf("```sh\nx\n```\n<!-- checked: " + mark + " -->\n");
    one.at(0).result = {0, "12 of 12\nend\n", "seen\n"};
    return unheld(one.at(0), folder.path()).empty();
  };
  for (const char* mark : {"lacks start ; begin", "ends with ^end$", "writes out/a.csv",
                           "writes no out/b.csv", "exits 0", "exits 1 if it prints start"})
    CHECK(holds(mark));
  for (const char* mark :
       {"lacks start ; seen", "ends with 12", "writes out/b.csv", "writes out/empty", "writes no out/a.csv",
        "exits 1", "exits 1 if it prints seen", "layers out/b.exr a"})
    CHECK_FALSE(holds(mark));
  steps[1].omitted = true;
  CHECK(unheld(steps[1], folder.path()) == "");
}

TEST_CASE("every guide with commands is followed, and every rule about them is needed") {
  const std::string tests = readFile(sourceDirectory() / "tests/tools/guides_test.cpp") +
                            readFile(sourceDirectory() / "tests/tools/sdk_guide_test.cpp");
  std::vector<std::string> all;
  for (const fs::path& guide : guides()) {
    const std::vector<std::string> commands = commandLinesOf(readFile(guide));
    all.insert(all.end(), commands.begin(), commands.end());
    if (commands.empty()) continue;
    INFO(guide);
    CHECK(contains(tests, "(\"" + guide.lexically_relative(sourceDirectory()).generic_string() + "\""));
  }
  const auto isUsed = [&](const char* pattern) {
    const std::regex expression(pattern);
    return std::any_of(all.begin(), all.end(),
                       [&](const std::string& command) { return std::regex_search(command, expression); });
  };
  for (const Omission& omission : omissions()) {
    INFO(omission.pattern << ": " << omission.reason);
    CHECK(isUsed(omission.pattern));
    CHECK(std::string(omission.reason).size() > 20);
  }
  for (const Reduction& reduction : reductions()) {
    INFO(reduction.pattern);
    CHECK(isUsed(reduction.pattern));
  }
}

TEST_CASE("the guide to own models is followed") {
  follow("docs/own_models.md");
}
TEST_CASE("the README is followed") {
  follow("README.md");
}
TEST_CASE("CONTRIBUTING is followed") {
  follow("CONTRIBUTING.md");
}
TEST_CASE("the first image comes out as its guide says") {
  follow("docs/first_image.md");
}
TEST_CASE("the stores of cones are drawn and compared as their guide says") {
  follow("docs/cones.md");
}
TEST_CASE("imperfect volumes with and without holes are drawn and exported as their guide says") {
  follow("docs/imperfect_volumes.md");
}
TEST_CASE("segments of elements are drawn as their guide says") {
  follow("docs/surface_elements.md");
}
TEST_CASE("the commands' guide shows commands that work together") {
  follow("docs/commands.md");
}
TEST_CASE("shares are measured and merged as the guide to clusters says") {
  follow("docs/cluster.md");
}
TEST_CASE("grids are exported and compared as their guide says") {
  follow("docs/looking_at_grids.md");
}
TEST_CASE("voxelizers are measured as their guide says") {
  follow("docs/measuring_voxels.md");
}
TEST_CASE("voxelizers are drawn as their guide says") {
  follow("docs/voxelizers.md");
}
TEST_CASE("the files that are read elsewhere are where the guide says") {
  follow("docs/reading_results.md");
}
TEST_CASE("published tables are reproduced as their guide says") {
  follow("docs/reproducing.md");
}
TEST_CASE("results stay as their guide says") {
  follow("docs/results.md");
}
TEST_CASE("the stress battery's commands do what its guide says") {
  follow("docs/stress.md");
}
TEST_CASE("texts of scenes are checked and formatted as their guide says") {
  follow("docs/writing_a_scene.md");
}
TEST_CASE("captured pictures light what their guide says") {
  follow("docs/captured_frames.md");
}
TEST_CASE("texts of pipelines are checked and measured as their guide says") {
  follow("docs/writing_a_pipeline.md");
}
TEST_CASE("what the tests need is named in commands that are there") {
  follow("tests/README.md");
}
TEST_CASE("the report's guide tells what a report writes, and its picture is of today's size") {
  const FollowedGuide guide("docs/report.md");
  checkFollowed(guide);
  // A row for each point, output and reference.
  const Json report = Json::parse(readFile(guide.file("out/report/index.json")));
  std::size_t rows = 0;
  for (const Json& point : report.at("scenes").at(0).at("points")) rows += point.at("errors").size();
  CHECK(rows > 0);
  const std::string csv = readFile(guide.file("out/report/index.csv"));
  CHECK(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')) == rows + 1);
  if (guide.omitted() == 0) {
    const ImageSize drawn = pngSize(guide.file("out/report.png"));
    CHECK(drawn == pngSize(sourceDirectory() / "docs/images/report.png"));
    CHECK(drawn == ImageSize{1400, 900});
  }
  CHECK(fs::file_size(sourceDirectory() / "docs/images/report.png") < 300 * 1024);
}
