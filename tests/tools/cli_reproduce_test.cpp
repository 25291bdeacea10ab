// Published tables: read, checked, measured on a small one, written.
#include <set>

#include "lumivox/dsl/document.h"
#include "lumivox/report/reproduce.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;
using Json = nlohmann::json;
namespace fs = std::filesystem;

namespace {

std::string data(const std::string& name) {
  return (sourceDirectory() / "tests/tools/data/reproductions" / name).string();
}

const Json& rowNamed(const Json& table, const std::string& name) {
  for (const Json& row : table["rows"])
    if (row["row"] == name) return row;
  FAIL("no row " << name);
  return table;
}

}  // namespace

TEST_CASE("check tells everything that is wrong in a published table, each at its place") {
  const CommandResult shapes = runCommand("lumivox check " + data("wrong.reproduction"));
  checkRefused(shapes, "wrong.reproduction:1:1: block 'reproduction \"wrong\"' lacks the property 'paper'");
  for (const char* finding : {"wrong.reproduction:6:18: 2 of property 'software_scale' is out of range",
                              "wrong.reproduction:7:23: 0 of property 'published' is out of range",
                              "wrong.reproduction:7:35: unknown value 'seconds' of property 'measures'",
                              "wrong.reproduction:8:3: block 'row \"b\"' lacks the property 'published'",
                              "wrong.reproduction:9:3: unknown property 'colour'"}) {
    INFO(finding << "\n" << shapes.errors);
    CHECK(contains(shapes.errors, finding));
  }
  const CommandResult references = runCommand("lumivox check " + data("wrong_references.reproduction"));
  checkRefused(references, "wrong_references.reproduction:4:9: there is no file");
  for (const char* finding :
       {"wrong_references.reproduction:6:11: no row's pipeline has a parameter 'resolution'",
        "wrong_references.reproduction:7:9: pipeline \"Direct lighting\" has no parameter 'shadow_sise'",
        "did you mean 'shadow_size'",
        "wrong_references.reproduction:7:24: this value does not fit the parameter 'area_samples'",
        "wrong_references.reproduction:8:34: pipeline \"Direct lighting\" has no pass 'gbufer'",
        "did you mean 'gbuffer'", "wrong_references.reproduction:9:3: row 'b' does not say whose fragments",
        "wrong_references.reproduction:10:33: this names no output of a pass",
        "wrong_references.reproduction:11:35: there is no file",
        "wrong_references.reproduction:12:47: a frame rate is that of the frame"}) {
    INFO(finding << "\n" << references.errors);
    CHECK(contains(references.errors, finding));
  }
}

TEST_CASE("the committed tables pass check, stand in the canonical layout and have names of their own") {
  std::set<std::string> names;
  const fs::path folder = sourceDirectory() / "scenes/reproductions";
  for (const auto& entry : fs::directory_iterator(folder)) {
    INFO(entry.path());
    const dsl::Document document = dsl::parse(readFile(entry.path()), entry.path());
    REQUIRE(document.findings.empty());
    CHECK(dsl::format(document) == readFile(entry.path()));
    if (entry.path().extension() == ".scene") continue;  // its model may be absent
    const CommandResult result = runCommand("lumivox check '" + entry.path().string() + "'");
    INFO(result.errors);
    CHECK(result.exitCode == 0);
    if (entry.path().extension() != ".reproduction") continue;
    const std::string id = PublishedTable::load(entry.path()).id;
    CHECK(names.insert(id).second);
    // The file is called as the table, in the house's way.
    std::string stem = id;
    std::replace(stem.begin(), stem.end(), '-', '_');
    CHECK(entry.path().stem() == stem);
  }
  const Json list = Json::parse(runCommand("lumivox reproduce --list --json").output);
  CHECK(list.size() == names.size());
  for (const char* id : {"000-table-1", "001-voxelisation-binary", "001-voxelisation-multi-valued",
                         "004-table-1", "004-table-2", "004-table-3", "004-table-4"})
    CHECK(names.count(id) == 1);
}

TEST_CASE("a table that is not there is refused with the nearest name, and so are other wrong requests") {
  checkRefused(runCommand("lumivox reproduce 004-table-33 --list"), "did you mean '004-table-3'");
  checkRefused(runCommand("lumivox reproduce " + data("missing.reproduction")), "missing.reproduction");
  checkRefused(runCommand("lumivox reproduce " + data("room.reproduction") + " -o table.txt"),
               ".html or .md");
  checkRefused(runCommand("lumivox reproduce " + data("room.reproduction") + " --scale 3"), "--scale");
}

TEST_CASE("describe knows the words of published tables") {
  CHECK(contains(runCommand("lumivox describe reproduction").output, "lumivox reproduce ID"));
  CHECK(contains(runCommand("lumivox describe software_scale").output, "software rasteriser"));
}

TEST_CASE("a small table is measured: ratios to its first row, a verdict for each, a page and a store") {
  const TemporaryDirectory directory;
  const std::string page = (directory.path() / "tables.md").string();
  const std::string store = (directory.path() / "results.sqlite").string();
  const CommandResult result =
      runCommand("lumivox -q reproduce " + data("room.reproduction") +
                 " --repeats 2 --scale 0.5 --spp 16 --json -o " + page + " --store " + store);
  INFO(result.errors);
  REQUIRE(result.exitCode == 0);
  const Json tables = Json::parse(result.output);
  REQUIRE(tables.size() == 1);
  const Json& table = tables[0];
  REQUIRE(table["rows"].size() == 11);
  CHECK(table["scale"] == 0.5);
  // Half of 32 and of 64 voxels, 64 x 48 pixels, and another pipeline: three set-ups for all rows.
  REQUIRE(table["set_ups"].size() == 3);
  CHECK(contains(table["set_ups"][0].get<std::string>(), "cones=1 resolution=16, 32 x 24 pixels"));
  CHECK(contains(table["set_ups"][1].get<std::string>(), "resolution=32"));

  CHECK(rowNamed(table, "gather")["verdict"] == "reference");
  CHECK(rowNamed(table, "gather")["ratio"] == 1.0);
  const Json& both = rowNamed(table, "frame, 2 passes");
  CHECK(both["ratio"] > 1.0);
  CHECK(both["measured"]["repeats"] == 2);
  // 50 frames a second are 20 ms: 20 times the first row.
  CHECK(rowNamed(table, "frame")["published_ratio"] == 20.0);
  CHECK(rowNamed(table, "frame")["ratio"] > both["ratio"]);
  // Fragments are counted, not timed: on walls four times as many with half the voxel, and more at edges.
  CHECK(rowNamed(table, "voxels")["verdict"] == "reference");
  CHECK(rowNamed(table, "voxels, 64")["verdict"] == "reproduced");
  CHECK(rowNamed(table, "voxels, 64")["ratio_low"] == rowNamed(table, "voxels, 64")["ratio_high"]);
  CHECK(rowNamed(table, "memory")["measured"]["median"] > 0.0);
  for (const auto& [name, why] :
       {std::pair("another machine", "it was sold"),
        std::pair("nothing to march", "pass 'march' was left out: "), std::pair("another room", "this one"),
        std::pair("a model of others", "lost.obj")}) {
    CHECK(rowNamed(table, name)["verdict"] == "not comparable");
    CHECK(contains(rowNamed(table, name)["why"].get<std::string>(), why));
    CHECK(rowNamed(table, name)["failed"] == false);
  }
  CHECK(rowNamed(table, "another room")["ratio"] == 1.0);
  CHECK(rowNamed(table, "another machine")["ratio"].is_null());

  const std::string text = readFile(page);
  CHECK(contains(text, "| gather | 1 ms |"));
  CHECK(contains(text, "Reduced: picture sides, resolution times 0.5."));
  CHECK(contains(text, "factor of 1.5"));

  const Json runs = Json::parse(runCommand("lumivox results export --format json --store " + store).output);
  REQUIRE(runs.size() == 3);
  // All that a sweep measures: errors and work too.
  for (const Json& run : runs) {
    INFO(run.dump());
    CHECK(run["failure"] == "");
    CHECK(run["identity"]["truth_samples"] == 16);
    CHECK(run["errors"].size() > 0);
    CHECK(run["frame"]["repeats"] == 2);
    CHECK(run["next_frame"]["repeats"] == 2);
    for (const Json& pass : run["passes"]) CHECK(pass["work"].size() > 0);
    CHECK(contains(run["command"].get<std::string>(), "reproduce"));
    CHECK(contains(run["command"].get<std::string>(), "--spp 16"));
  }
  CHECK(runs[0]["identity"]["kept"] == Json::array({"voxels.fragments"}));
  CHECK(runs[2]["identity"]["kept"].empty());
  checkRefused(runCommand("lumivox reproduce " + data("room.reproduction") + " --spp 16"), "--store");
}

TEST_CASE("the page of a reproduced table escapes what the texts say") {
  const TemporaryDirectory directory;
  const std::string text = readFile(data("room.reproduction"));
  std::string harmful = text;
  harmful.replace(harmful.find("it was sold"), 11, "<script>alert(1)</script> & more");
  // Paths are beside the text: all but absent rows go.
  std::string kept;
  for (const std::string& line :
       {std::string("reproduction \"harm\" {\n  title \"a < b\"\n  paper \"x | y\"\n"),
        harmful.substr(harmful.find("  row \"another machine\""),
                       harmful.find("  row \"another room\"") - harmful.find("  row \"another machine\"")),
        std::string("}\n")})
    kept += line;
  const fs::path file = directory.write("harm.reproduction", kept);
  const fs::path page = directory.path() / "page.html";
  const CommandResult result = runCommand("lumivox -q reproduce " + file.string() + " -o " + page.string());
  INFO(result.errors);
  REQUIRE(result.exitCode == 0);
  const std::string html = readFile(page);
  CHECK(contains(html, "a &lt; b"));
  CHECK(contains(html, "&lt;script&gt;alert(1)&lt;/script&gt; &amp; more"));
  CHECK_FALSE(contains(html, "<script>alert"));
}
