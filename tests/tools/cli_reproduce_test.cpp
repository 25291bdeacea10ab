// Published tables and figures: read, checked, measured on small ones, written, kept, quoted.
#include <set>
#include <sstream>

#include "lumivox/base/file.h"
#include "lumivox/base/image.h"
#include "lumivox/dsl/document.h"
#include "lumivox/experiment/reproduce.h"
#include "support/drawn_page.h"
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

TEST_CASE("check tells everything that is wrong in published tables and figures, each at its place") {
  const auto places = [](const std::string& file, const std::vector<Finding>& findings) {
    std::vector<Finding> all;
    for (const Finding& one : findings) all.push_back({file + ".reproduction:" + one.place, one.facts});
    return all;
  };
  const CommandResult checked =
      typed("check", data("wrong.reproduction"), data("wrong_references.reproduction"),
            data("wrong_shapes.reproduction"), data("wrong_figure.reproduction"), data("empty.reproduction"));
  checkFindings(checked, places("wrong", {{"1:1", Tells("reproduction \"wrong\"", "paper")},
                                          {"6:18", Tells(2, "software_scale")},
                                          {"7:23", Tells(0, "published")},
                                          {"7:35", Tells("seconds", "measures")},
                                          {"8:3", Tells("row \"b\"", "published")},
                                          {"9:3", Tells("colour")}}));
  checkFindings(checked,
                places("wrong_references",
                       {{"4:9", Tells("no file")},
                        {"6:11", Tells("resolution")},
                        {"7:9", Tells("Direct lighting", "shadow_sise", "did you mean", "shadow_size")},
                        {"7:24", Tells("area_samples")},
                        {"8:34", Tells("Direct lighting", "gbufer", "did you mean", "gbuffer")},
                        {"9:3", Tells("b", "fragments")},
                        {"10:33", Tells("output")},
                        {"11:35", Tells("no file")},
                        {"12:55", Tells("Direct lighting", "gbufer")}}));
  checkFindings(checked, places("wrong_shapes", {{"4:11", Tells(0, "columns")},
                                                 {"5:3", Tells("curve \"a\"", "over")},
                                                 {"5:3", Tells("curve \"a\"", "point")},
                                                 {"5:22", Tells("sideways", "growth")},
                                                 {"8:26", Tells(9, "subdivisions")},
                                                 {"10:21", Tells("everything", "reference")},
                                                 {"10:3", Tells("panel", "name")},
                                                 {"11:15", Tells("published")},
                                                 {"13:3", Tells("row", "d", "twice")}}));
  checkFindings(checked,
                places("wrong_figure",
                       {{"8:31", Tells("row", "aa", "did you mean", "a")},
                        {"9:31", Tells("c", "c")},
                        {"10:31", Tells("d", "a")},
                        {"12:10", Tells("Volumetric smoke", "resolutions", "did you mean", "resolution")},
                        {"17:10", Tells("pixels", "word")},
                        {"22:5", Tells("point", "curve")},
                        {"24:22", Tells("output")},
                        {"26:11", Tells("Volumetric smoke", "stepz")},
                        {"28:37", Tells("no file")},
                        {"30:10", Tells("panel", "pp", "did you mean", "p")},
                        {"32:13", Tells("panel", "nobody")},
                        {"34:3", Tells("itself")}}));
  checkFindings(checked, places("empty", {{"1:1", Tells("empty")}}));
}

TEST_CASE(
    "the committed tables and figures pass check, stand in the canonical layout and have names of their own") {
  std::set<std::string> names;
  std::string texts;
  const fs::path folder = sourceDirectory() / "scenes/reproductions";
  for (const auto& entry : fs::directory_iterator(folder)) {
    INFO(entry.path());
    const dsl::Document document = dsl::parse(readFile(entry.path()), entry.path());
    REQUIRE(document.findings.empty());
    CHECK(dsl::format(document) == readFile(entry.path()));
    if (entry.path().extension() == ".scene") continue;  // its model may be absent
    texts += " '" + entry.path().string() + "'";
    if (entry.path().extension() != ".reproduction") continue;
    const std::string id = PublishedResult::load(entry.path()).id;
    CHECK(names.insert(id).second);
    // The file is called as the table, in the house's way.
    std::string stem = id;
    std::replace(stem.begin(), stem.end(), '-', '_');
    CHECK(entry.path().stem() == stem);
  }
  ran("check", Raw{texts});
  CHECK(answered("reproduce --list --json").size() == names.size());
  for (const char* id : {"000-table-1", "000-figure-4", "001-multi-valued-over-binary",
                         "001-voxelization-binary", "001-voxelization-multi-valued"})
    CHECK(names.count(id) == 1);
  for (const int figure : {18, 19, 20, 21, 61, 62, 63, 65, 66, 75, 76, 77, 82, 83, 84, 85, 86})
    CHECK(names.count("004-figure-" + std::to_string(figure)) == 1);
  for (const int table : {1, 2, 3, 4}) CHECK(names.count("004-table-" + std::to_string(table)) == 1);
}

TEST_CASE("tables and figures are listed by first author and year, and taken by that name or by their id") {
  const Json list = answered("reproduce --list --json");
  std::set<std::string> names;
  for (const Json& one : list) {
    const std::string id = one["id"], name = one["name"];
    INFO(id);
    CHECK(names.insert(name).second);
    CHECK(name.substr(name.find('-')) == id.substr(id.find('-')));
  }
  for (const char* name : {"mavridis2011-table-1", "thiedemann2011-near-field", "dong2007-table-1",
                           "lensing2013-figure-5", "gomes2015-figure-18"}) {
    INFO(name);
    CHECK(names.count(name) == 1);
  }
  const std::string byName = ran(columns(160), "reproduce --list mavridis2011-table-1").output;
  CHECK(byName == typed(columns(160), "reproduce --list 000-table-1").output);
  CHECK_THAT(byName, Tells("mavridis2011-table-1", 5, "of", 20));
  checkRefused(typed("reproduce mavridis2011-table-11 --list"), "did you mean", "mavridis2011-table-1");
  // Names and titles fit a narrow terminal in two lines each.
  const std::string narrow = typed(columns(80), "reproduce --list").output;
  CHECK(static_cast<std::size_t>(std::count(narrow.begin(), narrow.end(), '\n')) < 1 + 3 * list.size());
}

TEST_CASE("every committed figure makes a claim that its images test, and the figures' page quotes it") {
  const std::string page = readFile(sourceDirectory() / "docs/benchmarks/figures.md");
  std::size_t claims = 0;
  for (const auto& entry : fs::directory_iterator(sourceDirectory() / "scenes/reproductions")) {
    if (entry.path().extension() != ".reproduction") continue;
    const PublishedResult text = PublishedResult::load(entry.path());
    INFO(text.id);
    CHECK(text.panels.empty() == text.claims.empty());
    for (const PublishedClaim& claim : text.claims) {
      INFO(claim.name);
      CHECK(contains(page, "<!-- reproduced claim " + text.id + "; " + claim.name + " -->"));
      ++claims;
      // Pixels that are chosen for being dark in a noisy image are too dark in that image.
      for (const PublishedPanel& panel : text.panels)
        if (!panel.reference.empty() && (panel.name == claim.less || panel.name == claim.than))
          CHECK(claim.darkIn != panel.name);
    }
  }
  CHECK(claims >= 30);
}

TEST_CASE("a table that is not there is refused with the nearest name, and so are other wrong requests") {
  checkRefused(typed("reproduce 004-table-33 --list"), "did you mean", "004-table-3");
  checkRefused(typed("reproduce", data("missing.reproduction")), "missing.reproduction");
  checkRefused(typed("reproduce", data("room.reproduction"), "-o table.txt"), ".html", ".md");
  checkRefused(typed("reproduce", data("room.reproduction"), "--scale 3"), "--scale");
  checkRefused(typed("reproduce", data("room.reproduction"), "--spp 16"), "--store");
}

TEST_CASE(
    "published tables are measured on the ground that their papers print, and what is made once is not timed") {
  struct Asked {
    const char* file;
    std::vector<std::string> holds, lacks;
  };
  const std::vector<std::string> madeOnce{" points ", "[points", " points]", "vertices "};
  for (const Asked& asked : std::vector<Asked>{
           // Gomes 2015, Sec. 4.6: near-field light alone was tested on Sibenik cathedral.
           {"004_table_5.reproduction",
            {"scene \"../sibenik.scene\"", "image 1024 768"},
            {"scaled", "Sponza"}},
           // Slides on Thiedemann et al. 2011, the horse.
           {"001_near_field.reproduction",
            {"scene \"../horse_arena.scene\"", "image 1024 768", "resolution 128", "rays 20",
             "pixels quarter"},
            {"scaled"}},
           // Lensing & Broll 2013, Sec. 3.2: points and those that vertices refer to are found in advance.
           {"003_table_1.reproduction", {"points 4096", "map 128"}, {"scaled", "in every frame"}},
           {"003_table_2.reproduction", {"points 4096", "map 128"}, {"scaled"}},
           {"003_figure_5.reproduction", {}, {"scaled"}},
           // Dong et al. 2007, Sec. 4.1 and 5: the hierarchy is made once, in 72 ms.
           {"002_table_1.reproduction", {"published 72", "passes [hierarchy]"}, {"published 84"}},
           {"002_table_1.pipeline", {"hierarchy hierarchy.hierarchy"}, {}},
           // Gomes 2015, Listings 4.17 to 4.25.
           {"004_table_3_octree.pipeline",
            {"thesis_cone_tracing.octree {", "thesis_cone_tracing.octree_relight {",
             "thesis_cone_tracing.octree_mipmap { radiance surfaces.radiance }",
             "thesis_cone_tracing.gather {"},
            {"voxel_cone_tracing.o", "voxel_cone_tracing.gather", "shadow shadow.depth\n    tree",
             "at_corners", "added"}}}) {
    const std::string text = readFile(sourceDirectory() / "scenes/reproductions" / asked.file);
    for (const std::string& part : asked.holds) {
      CAPTURE(asked.file, part);
      CHECK(contains(text, part));
    }
    for (const std::string& part : asked.lacks) {
      CAPTURE(asked.file, part);
      CHECK_FALSE(contains(text, part));
    }
    if (std::string(asked.file).rfind("003", 0) != 0) continue;
    for (std::size_t at = text.find("passes ["); at != std::string::npos;
         at = text.find("passes [", at + 1)) {
      const std::string passes = text.substr(at, text.find(']', at) + 1 - at);
      CAPTURE(asked.file, passes);
      for (const std::string& pass : madeOnce) CHECK_FALSE(contains(passes, pass));
    }
  }
}

TEST_CASE("describe knows the words of published tables and figures") {
  for (const auto& [word, fact] : {std::pair("reproduction", "lumivox reproduce ID"),
                                   {"software_scale", "software rasteriser"},
                                   {"panel", "image of a figure"},
                                   {"growth", "sublinear, linear, superlinear"},
                                   {"reference", "path-traced"}})
    CHECK_THAT(typed("describe", word).output, Catch::Contains(fact));
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
  REQUIRE(table["rows"].size() == 13);
  CHECK(table["scale"] == 0.5);
  // Half of 32 and of 64 voxels, 64 x 48 pixels, and another pipeline: three set-ups for all rows.
  REQUIRE(table["set_ups"].size() == 3);
  CHECK(contains(table["set_ups"][0].get<std::string>(),
                 "cones=1 lobes=diffuse resolution=16, 32 x 24 pixels"));
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
  // A grid of 16 voxels along its longest side with its mips in 16 bytes a voxel, and the words of its
  // bricks; of its voxels the walls are about a quarter.
  const double held = rowNamed(table, "finest grid")["measured"]["median"],
               each = rowNamed(table, "bytes a voxel")["measured"]["median"];
  CHECK(held > 1e-6 * 16 * 16 * 16 * 16);
  CHECK(held < 1.3e-6 * 16 * 16 * 16 * 16);
  const double voxels = 1e6 * held / each;
  CHECK(voxels == Approx(std::round(voxels)).epsilon(1e-9));
  CHECK(voxels > 5 * 14 * 14);
  CHECK(voxels < 16 * 16 * 16 / 2);
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
  CHECK(contains(text, "Reduced: image sides, resolution times 0.5."));
  CHECK(contains(text, "factor of 1.5"));

  const Json runs = Json::parse(typed("results export --format json --store", Raw{store}).output);
  REQUIRE(runs.size() == 3);
  // All that a sweep measures: errors and work too.
  for (const Json& run : runs) {
    INFO(run.dump());
    CHECK(run["failure"] == "");
    CHECK(run["reference_samples"] == 16);
    CHECK(run["errors"].size() > 0);
    CHECK(run["frame_ms"]["repeats"] == 2);
    CHECK(run["next_frame_ms"]["repeats"] == 2);
    for (const Json& pass : run["passes"]) CHECK(pass["work"].size() > 0);
    CHECK(contains(run["command"].get<std::string>(), "reproduce"));
    CHECK(contains(run["command"].get<std::string>(), "--spp 16"));
  }
  CHECK(runs[0]["kept"] == Json::array({"light.radiance", "voxels.fragments"}));
  CHECK(runs[2]["kept"].empty());
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
  const CommandResult result = ran("-q reproduce", file, "-o", page);
  CHECK_FALSE(contains(readFile(page), "<script>alert"));
  if (!canDrawPages()) return skip("no node on the path");
  const Json drawn = drawnPage(page);
  CHECK(drawn.at("problems").empty());
  CHECK(contains(drawn.at("text"), "a < b"));
  CHECK(contains(drawn.at("text"), "<script>alert(1)</script> & more"));
}

TEST_CASE(
    "a small figure is made: a sheet of its panels, curves with a verdict, and reasons for what is absent") {
  const TemporaryDirectory directory;
  const fs::path figures = directory.path() / "figures", page = directory.path() / "page.html";
  const CommandResult result = ran("-q reproduce", data("figure.reproduction"),
                                   "--repeats 1 --spp 4 --json --figures", figures, "-o", page);
  const Json figure = Json::parse(result.output).at(0);
  // Voxels that a surface touches grow as the square of the voxels along a side.
  const Json& curve = figure["curves"][0];
  CHECK(curve["verdict"] == "reproduced");
  CHECK(curve["exponent"].get<double>() == Approx(2.0).margin(0.35));
  CHECK(curve["points"][2]["x"] == 32);
  // A split triangle covers the same voxels; a shared voxel has one fragment of each part.
  const Json& split = figure["curves"][1];
  const double triangles = split["points"][0]["x"];
  CHECK(split["points"][1]["x"] == 4 * triangles);
  CHECK(split["points"][2]["x"] == 16 * triangles);
  CHECK(split["exponent"].get<double>() > 0.0);
  CHECK(split["exponent"].get<double>() < 0.5);
  CHECK(split["why"] == "the paper does not say how it grows");
  CHECK(figure["curves"][2]["verdict"] == "not comparable");
  CHECK(figure["curves"][2]["why"] == "it was sold");

  const Json& panels = figure["panels"];
  REQUIRE(panels.size() == 6);
  const double whole = panels[0]["mean_luminance"], indirect = panels[1]["mean_luminance"],
               reference = panels[2]["mean_luminance"];
  CHECK(whole > indirect);
  CHECK(indirect == Approx(reference).epsilon(0.5));
  CHECK(panels[0]["why_not"] == "");
  CHECK(contains(panels[3]["why_not"].get<std::string>(), "march.scattered was left out"));
  CHECK(contains(panels[4]["why_not"].get<std::string>(), "lost.obj"));
  CHECK(panels[5]["why_not"] == "it was sold");
  for (const Json& panel : panels) CHECK(panel["failed"] == false);

  const Json& claims = figure["claims"];
  REQUIRE(claims.size() == 5);
  CHECK(claims[0]["verdict"] == "reproduced");
  CHECK(claims[0]["less_value"].get<double>() == Approx(indirect).epsilon(1e-6));
  CHECK(claims[0]["than_value"].get<double>() == Approx(whole).epsilon(1e-6));
  // Where the reference is darkest it has less than its mean, and direct light is there as well.
  CHECK(claims[1]["verdict"] == "not reproduced");
  CHECK(claims[1]["than_value"].get<double>() < 0.8 * reference);
  CHECK(claims[2]["verdict"] == "reproduced");
  CHECK(claims[3]["verdict"] == "not reproduced");
  CHECK(claims[4]["verdict"] == "not comparable");
  CHECK(contains(claims[4]["why"].get<std::string>(), "lost.obj"));
  CHECK(contains(readFile(page), "direct light adds to the indirect: reproduced ('indirect' "));
  // A software rasteriser gets no smaller image without software_scale.
  const ByteImage sheet = readByteImage(figures / "figure.png");
  CHECK(sheet.width == 3 * (160 + 6) + 6);
  CHECK(contains(readFile(figures / "figure.csv"), "\"light by voxels\",resolution,32,fragments,"));
  CHECK(contains(readFile(figures / "figure.svg"), "<svg"));
  const Json shown = pageRecords(readFile(page), "images").at("results").at(0);
  CHECK(contains(shown.at("sheet"), "iVBORw0KGgo"));       // PNG
  CHECK(contains(shown.at("curves"), "PHN2ZyB4bWxucz0"));  // <svg xmlns=
  // Under one exposure the indirect light alone is darker than all light, in the middle of their panels: the
  // 64 x 48 pixels fill 160 x 120.
  const auto meanOf = [&](int left, int top) {
    double sum = 0.0;
    for (int y = top; y < top + 120; ++y)
      for (int x = left; x < left + 160; ++x)
        sum += sheet.values[static_cast<std::size_t>((y * sheet.width + x) * sheet.channels)];
    return sum / (120 * 160);
  };
  CHECK(meanOf(6, 28) > meanOf(172, 28));
  CHECK(meanOf(172, 28) > 0.0);
}

TEST_CASE("figures that are rendered again have the light and the claims that were kept of them") {
  // One of media, one of noise and one of voxels: a second each.
  for (const std::string id : {"004-figure-18", "004-figure-19", "004-figure-64"}) {
    CAPTURE(id);
    const CommandResult result = ran("-q reproduce", Raw{id}, "--repeats 1 --json");
    const Json made = Json::parse(result.output).at(0);
    const Json all =
        Json::parse(readFile(sourceDirectory() / "docs/benchmarks/reproductions.json")).at("results");
    const auto kept = std::find_if(all.begin(), all.end(), [&](const Json& one) { return one["id"] == id; });
    REQUIRE(kept != all.end());
    REQUIRE(made["panels"].size() == (*kept)["panels"].size());
    for (std::size_t i = 0; i < made["panels"].size(); ++i) {
      CAPTURE(i);
      CHECK(made["panels"][i]["panel"] == (*kept)["panels"][i]["panel"]);
      CHECK(made["panels"][i]["mean_luminance"].get<double>() ==
            Approx((*kept)["panels"][i]["mean_luminance"].get<double>()).epsilon(1e-3));
    }
    REQUIRE(made["claims"].size() == (*kept)["claims"].size());
    for (std::size_t i = 0; i < made["claims"].size(); ++i) {
      CHECK(made["claims"][i]["verdict"] == (*kept)["claims"][i]["verdict"]);
      for (const char* side : {"less_value", "than_value"})
        CHECK(made["claims"][i][side].get<double>() ==
              Approx((*kept)["claims"][i][side].get<double>()).epsilon(0.01));
    }
  }
}

TEST_CASE("openness is shown as it is beside light that is exposed") {
  const TemporaryDirectory directory;
  const CommandResult result =
      ran("-q reproduce", data("occlusion.reproduction"), "--repeats 1 --json --figures", directory.path());
  const Json figure = Json::parse(result.output).at(0);
  CHECK(figure["panels"][0]["radiance"] == true);
  CHECK(figure["panels"][1]["radiance"] == false);
  const double open = figure["panels"][1]["mean_luminance"], exposure = figure["exposure_ev"];
  CHECK(open > 0.3);
  CHECK(open < 0.99);
  CHECK(std::abs(exposure) > 0.3);
  // 64 x 48 pixels fill 160 x 120; the second panel lies below a line of title and the first one.
  const ByteImage sheet = readByteImage(directory.path() / "occlusion.png");
  double sum = 0.0;
  for (int y = 28 + 148; y < 28 + 148 + 120; ++y)
    for (int x = 6; x < 166; ++x)
      sum += sheet.values[static_cast<std::size_t>((y * sheet.width + x) * sheet.channels)];
  // The curve is concave: a mean of its values lies a little below that of the mean.
  const double encoded = linearToSrgb(static_cast<float>(open)), seen = sum / (120 * 160 * 255.0);
  CHECK(seen <= encoded + 0.01);
  CHECK(seen > encoded - 0.08);
}

TEST_CASE(
    "kept results take the place of older ones, and the cards that quote them are written and checked") {
  const TemporaryDirectory directory;
  // A project of one table, with one card and a guide.
  const auto inProject = [&](const std::string& arguments) {
    return runCommand("cd " + directory.path().string() + " && " +
                      (binaryDirectory() / "bin/lumivox").string() + " -q reproduce " + arguments);
  };
  for (const char* folder : {"scenes/pipelines", "scenes/reproductions", "techniques/one", "docs/benchmarks"})
    fs::create_directories(directory.path() / folder);
  std::string text = readFile(data("room.reproduction"));
  for (std::size_t at; (at = text.find("../../../../scenes")) != std::string::npos;)
    text.replace(at, 18, (sourceDirectory() / "scenes").string());
  text = text.substr(0, text.find("  row \"a model of others\"")) + "}\n";
  directory.write("scenes/reproductions/room.reproduction", text);
  directory.write("techniques/one/README.md",
                  "a <!-- reproduced ratios room; voxels; voxels, 64 --><!-- end --> z\n");
  const std::string kept = "docs/benchmarks/reproductions.json";
  const CommandResult first = inProject("--repeats 1 --scale 0.5 --record " + kept + " --cards");
  INFO(first.errors);
  REQUIRE(first.exitCode == 0);
  const std::string card = readFile(directory.path() / "techniques/one/README.md");
  CHECK(contains(card, "a <!-- reproduced ratios room; voxels; voxels, 64 -->voxels : voxels, 64 = 1 : "));
  CHECK(contains(card, ", published 1 : 4.5: *reproduced*"));
  CHECK(contains(readFile(directory.path() / "docs/benchmarks/reproductions.md"), "## room: "));
  CHECK(inProject("--cards --check").exitCode == 0);
  // Measured again, there is still one of it.
  REQUIRE(inProject("room --repeats 2 --scale 0.25 --record " + kept).exitCode == 0);
  const Json again = Json::parse(readFile(directory.path() / kept));
  REQUIRE(again["results"].size() == 1);
  CHECK(again["results"][0]["scale"] == 0.25);
  CHECK(again["results"][0]["repeats"] == 2);

  const auto changed = inProject("--cards --check");
  CHECK(changed.exitCode == 1);
  CHECK(contains(changed.errors, "reproductions.md:"));
  const std::string untouched = readFile(directory.path() / "docs/benchmarks/reproductions.md");
  CHECK(contains(untouched, "--scale 0.5"));
  REQUIRE(inProject("--cards").exitCode == 0);
  REQUIRE(inProject("--cards --check").exitCode == 0);

  // Somebody betters a figure by hand.
  const std::string honest = readFile(directory.path() / "techniques/one/README.md");
  std::string flattering = honest;
  flattering.replace(flattering.find(" = 1 : ") + 7, 1, "9");
  directory.write("techniques/one/README.md", flattering);
  const auto flattered = inProject("--cards --check");
  CHECK(flattered.exitCode == 1);
  CHECK(contains(flattered.errors, "techniques/one/README.md:1: this differs from the measurement"));
  CHECK(readFile(directory.path() / "techniques/one/README.md") == flattering);
  REQUIRE(inProject("--cards").exitCode == 0);
  CHECK(readFile(directory.path() / "techniques/one/README.md") == honest);

  // A published number is mended, and what was measured by the old one is told.
  std::string mended = text;
  mended.replace(mended.find("published 45"), 12, "published 46");
  directory.write("scenes/reproductions/room.reproduction", mended);
  const auto stale = inProject("--cards --check");
  CHECK(stale.exitCode == 1);
  CHECK(contains(stale.errors, "row 'voxels, 64' is recorded with 45 as published, but the text has 46"));

  // A damaged file is refused before anything is measured, and stays as it is.
  directory.write(kept, "{");
  const auto damaged = inProject("room --record " + kept);
  checkRefused(damaged, "reproductions.json");
  CHECK(readFile(directory.path() / kept) == "{");
}

TEST_CASE("what the cards and guides quote of published tables and figures is what was measured") {
  const CommandResult result =
      runCommand("cd " + sourceDirectory().string() + " && " + (binaryDirectory() / "bin/lumivox").string() +
                 " reproduce --cards --check");
  INFO(result.errors);
  CHECK(result.exitCode == 0);
}

TEST_CASE("a card that speaks of a reproduced table has its figures from the kept results") {
  std::size_t quoted = 0;
  for (const auto& entry : fs::recursive_directory_iterator(sourceDirectory() / "techniques")) {
    if (entry.path().filename() != "README.md") continue;
    // Where it names the command, the sentence goes on with the figures, within the next lines of its item.
    std::istringstream card(readFile(entry.path()));
    std::string item;
    const auto check = [&] {
      if (contains(item, "lumivox reproduce ")) {
        INFO(entry.path() << "\n" << item);
        ++quoted;
        CHECK(contains(item, "<!-- reproduced "));
      }
      item.clear();
    };
    for (std::string line; std::getline(card, line); item += line + "\n")
      if (line.empty() || line.starts_with("- ")) check();
    check();
  }
  CHECK(quoted >= 8);
}
