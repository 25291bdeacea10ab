// Guides that are true: every command of each is run in its order, in a copy of the tree, at small sizes, and
// the sentences around it are held against what it writes and says. What is not run is listed with its reason
// in guide.cpp; the guide to techniques is followed by sdk_guide_test.
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "lumivox/base/file.h"
#include "lumivox/base/image.h"
#include "tools/cli_support.h"
#include "tools/guide.h"

using namespace lumivox;
using namespace lumivox::test;
namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

/// Everything that is true of every guide: its commands end well, and only ignored files are left.
void checkFollowed(const FollowedGuide& guide, const std::vector<std::string>& mayFail = {}) {
  CHECK(guide.failures(mayFail) == "");
  CHECK(guide.leftovers() == "");
}

std::string lastLine(const std::string& text) {
  const std::string lines = text.substr(0, text.find_last_not_of('\n') + 1);
  return lines.substr(lines.rfind('\n') + 1);
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

std::size_t linesOf(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

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

TEST_CASE("the README's commands do what it says") {
  const FollowedGuide guide("README.md");
  checkFollowed(guide);
  REQUIRE(
      guide.says("installs what is missing, builds, and measures each technique on the Cornell box: "
                 "out/report/index.html"));
  CHECK(guide.has("out/report/index.html"));
  REQUIRE(guide.says("./test # the same set-up, then the tests"));
  REQUIRE(guide.says("pass their arguments on: to `lumivox` and to `ctest`"));
  CHECK(contains(guide.of("./test -R").errors, "ninja all"));
  CHECK(contains(guide.of("./test -R").output, " -R ^(dsl_format|"));
  CHECK(guide.has("out/arcade.png"));
}

TEST_CASE("the first image comes out as its guide says") {
  const FollowedGuide guide("docs/first_image.md");
  checkFollowed(guide);
  REQUIRE(guide.says("`./run` builds first when something changed"));
  CHECK(contains(guide.of("out/cornell.png").errors, "ninja laboratory"));
  REQUIRE(guide.says("exposed so that what is lit is middle grey on the average"));
  REQUIRE(guide.says("the terminal says which"));
  CHECK(std::regex_search(guide.of("out/cornell.png").errors,
                          std::regex("out/cornell\\.png: .* ms, [+-][0-9.]+ EV")));
  REQUIRE(guide.says("An `.exr` name in place of `.png` keeps every output of the pipeline as a layer"));
  const LayeredImage fine = readExr(guide.file("out/fine.exr"));
  for (const char* layer : {"direct", "indirect_diffuse", "final"}) CHECK(fine.layers.count(layer) == 1);
  REQUIRE(guide.says("Compare the layer of indirect light with the reference of one bounce"));
  CHECK(contains(guide.of("run compare").output, "indirect_diffuse = one_bounce_diffuse"));
  REQUIRE(guide.says("ends with the path of one HTML page that opens offline"));
  const CommandResult& report = guide.of("run report");
  CHECK(lastLine(report.output) == "out/report/index.html");
  REQUIRE(
      guide.says("The reference is cached, so a second report does not trace its paths again; everything "
                 "else is measured anew"));
  const CommandResult again = guide.run(reduced("./run report scenes/cornell.scene"));
  CHECK(contains(report.errors, "reference of "));
  CHECK_FALSE(contains(again.errors, "reference of "));
  CHECK(contains(again.errors, "measuring: 2 of 2 points"));
  CHECK_FALSE(contains(again.errors, "taken up"));
  REQUIRE(guide.says("Every pass of this pipeline is still needed"));
  CHECK(contains(guide.of("run explain").output, "8 of 8 passes kept"));
  REQUIRE(guide.says("`render --keep-everything` turns this off; the image is the same, bit for bit"));
  CHECK(contains(guide.of("run explain").output, "same image: yes"));
}

TEST_CASE("the stores of cones are drawn and compared as their guide says") {
  const FollowedGuide guide("docs/cones.md");
  checkFollowed(guide);
  for (const char* sheet : {"out/cone_stores.png", "out/coarse.png"}) CHECK(guide.has(sheet));
}

TEST_CASE("imperfect volumes with and without holes are drawn and exported as their guide says") {
  const FollowedGuide guide("docs/imperfect_volumes.md");
  checkFollowed(guide);
  for (const char* image : {"out/points_few.png", "out/points_many.png", "out/holes.png", "out/whole.png"})
    CHECK(guide.has(image));
  CHECK(readFile(guide.file("out/points_few.png")) != readFile(guide.file("out/points_many.png")));
  const CommandResult light = guide.run("vdbexport --list out/light.vdb");
  for (const char* field : {"inject.reflected.Y00", "march.incoming.Y00", "march.incoming.Y11"})
    CHECK(contains(light.output, field));
  CHECK(contains(guide.run("vdbexport --list out/openness.vdb").output, "occlude.visibility.Y00"));
}

TEST_CASE("segments of elements are drawn as their guide says") {
  const FollowedGuide guide("docs/surface_elements.md");
  checkFollowed(guide);
  CHECK(readFile(guide.file("out/segments.png")) != readFile(guide.file("out/vertices.png")));
}

TEST_CASE("the report's guide tells what a report writes") {
  const FollowedGuide guide("docs/report.md");
  checkFollowed(guide);
  REQUIRE(guide.says("writes `out/report/index.html` with `index.csv` and `index.json` beside it"));
  REQUIRE(guide.says("The last line in the terminal is its path"));
  CHECK(lastLine(guide.of("lumivox report").output) == "out/report/index.html");
  std::set<std::string> files;
  for (const auto& entry : fs::directory_iterator(guide.file("out/report")))
    files.insert(entry.path().filename().string());
  REQUIRE(guide.says("(`index.unfinished.sqlite`)"));
  REQUIRE(guide.says("The file goes when the page is written"));
  CHECK(files == std::set<std::string>{"index.html", "index.csv", "index.json"});
  REQUIRE(guide.says("`index.csv` has a row for each point, output and reference"));
  const Json report = Json::parse(readFile(guide.file("out/report/index.json")));
  std::size_t rows = 0;
  for (const Json& point : report.at("scenes").at(0).at("points")) rows += point.at("errors").size();
  CHECK(rows > 0);
  CHECK(linesOf(readFile(guide.file("out/report/index.csv"))) == rows + 1);
  if (guide.omitted() == 0) {
    const ImageSize drawn = pngSize(guide.file("out/report.png"));
    CHECK(drawn == pngSize(sourceDirectory() / "docs/images/report.png"));
    CHECK(drawn == ImageSize{1400, 900});
  }
  CHECK(fs::file_size(sourceDirectory() / "docs/images/report.png") < 300 * 1024);
  REQUIRE(guide.says("The page needs nothing else: it opens without a network"));
  const std::string page = readFile(guide.file("out/report/index.html"), kLargestLibraryFile);
  CHECK_FALSE(
      std::regex_search(page.substr(0, 20'000), std::regex("<(script|link|img)[^>]*(src|href)=.http")));
}

TEST_CASE("the commands' guide shows commands that work together") {
  const FollowedGuide guide("docs/commands.md");
  checkFollowed(guide, {"vdbexport --diff", "lumivox tune"});
  REQUIRE(guide.says("`new technique NAME [--in FOLDER]` writes a technique of each part"));
  CHECK(guide.has("out/my_lab/techniques/my_paper/my_paper.cpp"));
  REQUIRE(guide.says("an `.exr` holds every output of the pipeline as a layer of its name"));
  CHECK(readExr(guide.file("out/arcade.exr")).layers.count("indirect_diffuse") == 1);
  REQUIRE(guide.says("numbers the images (`out_0007.exr`, or a run of `#` in the name)"));
  CHECK(guide.has("out/box_0000.png"));
  CHECK(guide.has("out/box_0047.png"));
  CHECK_FALSE(guide.has("out/box_0048.png"));
  REQUIRE(
      guide.says("with the layers `direct`, `one_bounce_diffuse`, `one_bounce_glossy`, `indirect_diffuse`, "
                 "`indirect_glossy`, `full` and `ambient_occlusion`, and beside each `NAME.variance`"));
  const LayeredImage reference = readExr(guide.file("out/reference.exr"));
  for (const char* layer : {"direct", "one_bounce_diffuse", "one_bounce_glossy", "indirect_diffuse",
                            "indirect_glossy", "full", "ambient_occlusion"}) {
    INFO(layer);
    CHECK(reference.layers.count(layer) == 1);
    CHECK(reference.layers.count(std::string(layer) + ".variance") == 1);
  }
  REQUIRE(guide.says("The last line says at which exposure SSIM and LDR-FLIP were taken"));
  CHECK(contains(lastLine(guide.of("lumivox compare out").output), " EV (the header of out/reference.exr)"));
  CHECK(contains(guide.of("lumivox compare-runs").output, " 0 of "));
  REQUIRE(guide.says("Exit code 1: they differ by more than `--tolerance`"));
  CHECK(guide.of("vdbexport --diff").exitCode == 1);
}

TEST_CASE("grids are exported and compared as their guide says") {
  const FollowedGuide guide("docs/looking_at_grids.md");
  checkFollowed(guide, {"vdbexport --diff"});
  REQUIRE(
      guide.says("The first line lists what the pipeline could export, without running anything; the second "
                 "also sizes and levels on this scene"));
  const CommandResult &pipeline = guide.of("--list scenes/pipelines"),
                      &scene = guide.of("--list scenes/cornell");
  CHECK_FALSE(contains(pipeline.errors, "device: "));
  CHECK_FALSE(contains(pipeline.output, "32x32"));
  CHECK(contains(pipeline.output, "grid.mips"));
  CHECK(contains(scene.output, "32x32x32"));
  REQUIRE(guide.says("A grid is called `PASS.PORT.FIELD`, with `.level2` behind it for a coarser level"));
  const CommandResult fine = guide.run("vdbexport --list out/fine.vdb");
  for (const char* grid : {"grid.mips.radiance", "grid.mips.opacity", "grid.mips.radiance.level2"}) {
    INFO(grid << "\n" << fine.output);
    CHECK(contains(fine.output, grid));
  }
  REQUIRE(guide.says("`RadianceGrid`: `radiance` (vector"));
  REQUIRE(guide.says("writes `out/frames_0000.vdb` to `out/frames_0002.vdb`"));
  for (const char* frame : {"out/frames_0000.vdb", "out/frames_0001.vdb", "out/frames_0002.vdb"})
    CHECK(guide.has(frame));
  CHECK_FALSE(guide.has("out/frames_0003.vdb"));
  REQUIRE(guide.says("reports for each grid how many voxels differ"));
  REQUIRE(guide.says("Exit code 1 means that they differ"));
  CHECK(guide.of("--diff").exitCode == 1);
  CHECK(contains(guide.of("--diff").output, "grid.mips.opacity"));
}

TEST_CASE("voxelizers are measured and drawn as their guides say") {
  const FollowedGuide measured("docs/measuring_voxels.md");
  checkFollowed(measured);
  REQUIRE(measured.says("time ~ (voxels along a side)^p"));
  if (measured.omitted() == 0) {
    CHECK(contains(measured.of("lumivox voxels").output, "time ~ (voxels along a side)^"));
    for (const char* file : {"index.html", "voxels.csv", "voxels.json"})
      CHECK(measured.has(std::string("out/voxels/") + file));
  }
  const FollowedGuide drawn("docs/voxelizers.md");
  checkFollowed(drawn);
  CHECK((drawn.omitted() == 1 || drawn.has("out/hollow.png")));
}

TEST_CASE("the files that are read elsewhere are where the guide says") {
  const FollowedGuide guide("docs/reading_results.md");
  checkFollowed(guide);
  for (const char* file : {"image.exr", "index.csv", "index.json", "results.sqlite"})
    CHECK(guide.has(std::string("out/") + file));
  REQUIRE(guide.says("Lines end in CR LF"));
  const std::string csv = readFile(guide.file("out/index.csv"));
  CHECK(contains(csv.substr(0, csv.find('\n')), "parameter_area_samples"));
  std::size_t ends = 0;
  for (std::size_t at = csv.find("\r\n"); at != std::string::npos; at = csv.find("\r\n", at + 1)) ++ends;
  CHECK(ends == linesOf(csv));
}

TEST_CASE("published tables are reproduced as their guide says") {
  const FollowedGuide guide("docs/reproducing.md");
  checkFollowed(guide);
  CHECK(contains(guide.of("--list").output, "gomes2015-table-3"));
  REQUIRE(guide.says("Sheets and curves go to the folder of `--figures`, `out/reproductions` by default"));
  CHECK(guide.has("out/reproductions/004-figure-20.png"));
  REQUIRE(guide.says("writes nothing and reports where a text differs"));
  CHECK(guide.of("--cards --check").exitCode == 0);
}

TEST_CASE("results stay as their guide says") {
  const FollowedGuide guide("docs/results.md");
  checkFollowed(guide, {"lumivox tune"});
  REQUIRE(guide.says("A point that the store already has is not measured again"));
  CHECK(contains(guide.of("lumivox sweep scenes/cornell").output, "0 measured, 4 already in the store"));
  CHECK(contains(guide.of("techniques.sweep").output, "not measured yet: "));
  CHECK(contains(guide.of("results list").output, "reflective_shadow_maps"));
  CHECK_FALSE(contains(guide.of("results list").output, "arcade"));
  CHECK(contains(readFile(guide.file("out/results.csv")), "parameter_samples"));
  CHECK(contains(guide.of("compare-runs").output, "4 points compared, 0 of "));
  REQUIRE(guide.says("`-o` writes the winning text with its parameters as defaults"));
  REQUIRE(guide.says("Exit code 1: nothing fits"));
  for (const char* part : {"tune scenes/cornell.scene --frame-time", "tune scenes/cornell.scene --error"}) {
    const CommandResult& tuned = guide.of(part);
    INFO(part << tuned.output << tuned.errors);
    CHECK((tuned.exitCode == 0) != contains(tuned.output, "nothing fits"));
    CHECK(tuned.exitCode <= 1);
  }
  if (guide.of("--frame-time 100ms").exitCode == 0)
    CHECK(guide.run("lumivox check out/best.pipeline").exitCode == 0);
}

TEST_CASE("the stress battery's commands do what its guide says") {
  const FollowedGuide guide("docs/stress.md");
  checkFollowed(guide);
  CHECK(contains(guide.of("--case image_1x1").output, "1 stable"));
  REQUIRE(guide.says("every case with its meaning"));
  REQUIRE(guide.says("`lumivox stress --list` explains every case in one sentence"));
  const std::string& list = guide.of("--list").output;
  for (const char* family : {"stiff_transport", "geometry", "scale_and_place", "light", "image_and_camera",
                             "time", "refinement", "repeatability", "parameters"}) {
    REQUIRE(guide.says(std::string("- `") + family + "`: "));
    CHECK(contains(list, "\n" + std::string(family)));
  }
  REQUIRE(
      guide.says("The page *Where each technique breaks* (`FOLDER/index.html`, `index.json`, `images/`)"));
  const CommandResult page = guide.run(
      "lumivox stress --quick --case image_1x1 --pipeline scenes/pipelines/direct_lighting.pipeline -o out/stress");
  CHECK(page.exitCode == 0);
  for (const char* file : {"index.html", "index.json", "images"})
    CHECK(guide.has(std::string("out/stress/") + file));
}

TEST_CASE("texts of scenes and pipelines are checked, formatted and measured as their guides say") {
  const FollowedGuide scene("docs/writing_a_scene.md");
  checkFollowed(scene);
  CHECK(contains(scene.of("run check").output, "my_room.scene: good"));
  REQUIRE(scene.says(
      "`lumivox describe scene` lists its blocks, `lumivox describe material` (or another block) every "
      "word in one with unit, range and default"));
  const std::string blocks = scene.run("lumivox describe scene").output,
                    words = scene.of("describe material").output;
  for (const char* block : {"camera NAME", "mesh NAME", "light [NAME]", "medium NAME", "animate NAME"})
    CHECK(contains(blocks, block));
  for (const char* word : {"exponent", "emission", "W/(sr m^2)", "from 0 to 1", "default"}) {
    INFO(word << "\n" << words);
    CHECK(contains(words, word));
  }
  CHECK(contains(scene.of("describe material").output, "exponent"));
  REQUIRE(scene.says("The first camera is used unless `--camera walk` asks for another"));

  const FollowedGuide pipeline("docs/writing_a_pipeline.md");
  checkFollowed(pipeline);
  CHECK(contains(pipeline.of("run check").output, "my_cones.pipeline: good"));
  CHECK(contains(pipeline.of("list passes").output, "voxel_cone_tracing.gather"));
  CHECK(contains(pipeline.of("run describe").output, "cones"));
  REQUIRE(pipeline.says("`explain` lists all of it, with the reason. It never changes the image."));
  CHECK(contains(pipeline.of("run explain").output, "same image: yes"));
  CHECK(pipeline.has("out/report/index.html"));
}

TEST_CASE("what the tests need is named in commands that are there") {
  const FollowedGuide guide("tests/README.md");
  checkFollowed(guide);
  CHECK(guide.omitted() == 2);
  CHECK(guide.has("tests/fuzz/nightly"));
}

TEST_CASE("a part and a technique are built and tested as CONTRIBUTING says") {
  const FollowedGuide guide("CONTRIBUTING.md");
  checkFollowed(guide);
  CHECK(contains(guide.of("run list techniques").output, "voxel_cone_tracing"));
  CHECK(contains(guide.of("tests/run -R '^dsl'").output, " -R ^(dsl_format|"));
  CHECK(contains(guide.of("tests/run -R '^voxel_cone_tracing'").output, " -R ^(voxel_cone_tracing"));
  for (const char* script :
       {".ci/run", "tests/clean_room/run", "tests/fuzz/nightly", "tests/mutation/mutate"}) {
    REQUIRE(guide.says(std::string("`") + script));
    CHECK(guide.has(script));
  }
}
