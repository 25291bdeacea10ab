// Pages draw themselves from their records: every section is there, every number of the records reaches its
// table, and a text stays a text. The drawing itself is tried on pages that are broken.
#include <algorithm>

#include "lumivox/page/stress_page.h"
#include "support/page_check.h"
#include "tools/cli_support.h"
#include "tools/made_reports.h"

using namespace lumivox;
using namespace lumivox::test;
using Json = nlohmann::json;

namespace {

constexpr const char* kDirect =
    "pipeline \"Direct <b>\" {\n  param samples 4 in 1..16\n  pass gbuffer direct_lighting.gbuffer { }\n"
    "  pass shadow direct_lighting.shadow_map { size 64  area_samples $samples }\n"
    "  pass direct direct_lighting.shade { gbuffer gbuffer  shadow shadow.depth }\n  output direct "
    "direct.radiance\n}\nsweep samples { samples [1 2 4] }\n";

}  // namespace

TEST_CASE(
    "a measured report draws every section, chart and control, and its tables hold the numbers of its JSON") {
  if (lacksNode()) return;
  const Workplace place;
  place.write("direct.pipeline", kDirect);
  ran("report", place.scene(), "--pipeline", place / "direct.pipeline", "--pipeline",
      committedPipeline("voxel_cone_tracing"),
      "-q --set resolution=8 --spp 16 --subpixels 1 --repeats 3 --voxels 4 -o", place / "page.html");
  const Json page = drawnWell(place.file("page.html")), json = Json::parse(place.read("page.json"));
  const std::string headings = texts(page.at("headings"));
  for (const char* heading :
       {"Lumivox report", "Little room", "Fronts, equal time, equal error", "Error against recall",
        "Images, reference and FLIP maps", "Error numbers", "Bias and noise apart", "Convergence",
        "Time and memory per pass", "What was needed", "What was left out, and why", "Health",
        "Parameters and commands", "The reference and its noise", "All scenes and points", "Voxels",
        "Recall against time", "Growth, published and here", "Device, driver and contents"}) {
    INFO(heading);
    CHECK(contains(headings, heading));
  }
  const std::string text = page.at("text");
  CHECK(contains(text, "Every output of every pass was scanned"));
  CHECK(contains(text, "lumivox device measures it, once"));
  CHECK(contains(text, "changes no image by a single bit"));

  const Json& points = json.at("scenes").at(0).at("points");
  CHECK(tableWith(page, {"Scene", "Pipeline", "Parameters"}).size() == 1 + points.size());
  // The first screen: one row for each pipeline at its default parameters.
  CHECK(tableWith(page, {"Pipeline", "Frame, ms", "FLIP, whole image"}).size() == 3);
  std::size_t errors = 0;
  for (const Json& point : points) {
    errors += point.at("errors").size();
    CHECK(contains(text, point.at("command").get<std::string>()));
  }
  const Json table = tableWith(page, {"Pipeline", "Parameters", "Output", "Reference", "Says"});
  REQUIRE(table.size() == 1 + errors);
  const auto& first = points.at(0).at("errors").at(0);
  CHECK(std::stod(table.at(1).at(5).get<std::string>()) ==
        Approx(first.at("metrics").at("flip").at("value").get<double>()).epsilon(0.06));
  CHECK(std::stod(table.at(1).at(6).get<std::string>()) ==
        Approx(first.at("metrics").at("rmse").at("value").get<double>()).epsilon(0.06));
  // Errors against time, and the voxelizers; against recall nothing, since all voxels are right. Sliders and
  // choices between images; the choices of the fronts; boxes and choices of tables.
  CHECK(page.at("charts").size() == 2);
  CHECK(contains(text, "Not drawn, since all points have the same: recall 1;"));
  CHECK(page.at("images").size() > 8);
  CHECK(page.at("controls").size() >= 8);
  for (const Json& control : page.at("controls")) CHECK(control.at("changed").get<int>() >= 1);
  CHECK(externalLoad(place.read("page.html")).empty());
}

TEST_CASE("a broken record, script or image is found out when its page is drawn") {
  if (lacksNode()) return;
  const TemporaryDirectory place;
  drawn(badlyNamedReport(), place);
  const std::string page = readFile(place.path() / "page.html");
  const auto problemsWith = [&](const std::string& from, const std::string& to) {
    std::string broken = page;
    const std::size_t at = broken.find(from);
    REQUIRE(at != std::string::npos);
    return texts(drawnPage(place.write("broken.html", broken.replace(at, from.size(), to))).at("problems"));
  };
  CHECK(contains(problemsWith("\"health_findings\"", "\"ill_findings\""), "script: "));
  CHECK(contains(problemsWith("\"passes_kept\"", "\"passes_lost\""), "undefined of 5"));
  CHECK(contains(problemsWith("section(\"summary\"", "section(\"winter\""), "leads nowhere: #summary"));
  CHECK(contains(problemsWith("followers.forEach(", "[].forEach("), "SELECT changes nothing"));
  CHECK(contains(problemsWith("lines.sort(", "[].sort("), "sorting changes nothing"));
  CHECK(contains(problemsWith("hide(index, !box.checked)", "0"), "INPUT changes nothing"));
}

TEST_CASE("names and commands stay texts on the page, whatever they hold") {
  if (lacksNode()) return;
  const TemporaryDirectory place;
  const Json page = drawn(badlyNamedReport(), place);
  const std::string text = page.at("text"), html = readFile(place.path() / "page.html");
  for (const char* part : {"<img src=x onerror=alert(1)>", "</script><script>alert(1)</script>",
                           "A & B <device>", "one&<i>", "it does not fit <at all>",
                           "not run: the scene has no <light>", "lumivox report <x>", "12 of \"3\""}) {
    INFO(part);
    CHECK(contains(text, part));
  }
  CHECK_FALSE(contains(html, "<script>alert"));
  CHECK_FALSE(contains(html, "<img src=x"));
}

TEST_CASE("the first screen, the fronts and the table of what was needed say what the records say") {
  if (lacksNode()) return;
  const TemporaryDirectory place;
  const Json page = drawn(badlyNamedReport(), place);
  const std::string text = page.at("text");
  // Neither has indirect light, so that the whole image leads; the least error stands first.
  const Json defaults = tableWith(page, {"Pipeline", "Frame, ms", "FLIP, whole image", "Memory"});
  REQUIRE(defaults.size() == 3);
  CHECK(defaults[1][0] == "two&<i>");
  CHECK(defaults[1][1] == "6.00");
  CHECK(defaults[2][0] == "one&<i>");
  CHECK(defaults[2][2] == "0.25 ± 0");
  CHECK(defaults[2][4] == "75.0 %");
  CHECK(defaults[2][5] == "on it");
  CHECK(contains(text, "What breaks: 1 point of three failed."));
  CHECK(contains(
      text,
      "What was needed: 2 of 5 passes of 1 pipeline; leaving out the rest saves up to 75.0 % of a first "
      "frame (one&<i>) and 4.0 MiB of memory, and changes no image by a single bit. While the camera moves, what "
      "stands still saves up to 75.0 % of a first frame (one&<i>)."));
  const Json summary = tableWith(page, {"Scene", "Pipeline", "Parameters"});
  REQUIRE(summary.size() == 8);
  CHECK(summary[1][2] == "samples 1");
  CHECK(summary[2][2] == "default");
  CHECK(summary[1][3] == "1.00 [0.995, 1.00]");
  CHECK(summary[1][5] == "0.500 ± 0.005");
  CHECK(summary[1][7] == "on the Pareto front");
  CHECK(summary[7][8] == "failed");
  const Json ranges = tableWith(page, {"Frame time, ms", "Least error"});
  REQUIRE(ranges.size() > 2);
  CHECK(ranges[1][2] == "one&<i>");
  const Json needed = tableWith(page, {"Pipeline", "Passes", "Variants"});
  REQUIRE(needed.size() == 5);
  CHECK(needed[1][0] == "four");
  CHECK(needed[1][6] == "not run: the scene has no <light>");
  CHECK(needed[2][1] == "2 of 5");
  CHECK(needed[2][4] == "3.00 of 4.00 ms");
  CHECK(needed[2][5] == "0.750 of 1.00 ms");
  CHECK(needed[2][6] == "yes");
  CHECK(needed[3][6] == "failed: it does not fit <at all>");
  CHECK(needed[4][6] == "not measured");
  const Json slopes = tableWith(page, {"Pipeline", "Parameter", "Others"});
  REQUIRE(slopes.size() > 2);
  CHECK(slopes[1][1] == "samples 1 .. 4");
  const Json frames =
      tableWith(page, {"Pipeline", "Parameters", "Frame, ms", "Next frame, only what changed, ms"});
  REQUIRE(frames.size() == 7);
  CHECK(contains(frames[1][4], "0.500 ± "));
  CHECK(contains(frames[1][5], "0.250 ± "));
  CHECK(frames[1][6] == "0.250 ± 0");
  const Json passes = tableWith(page, {"Pipeline", "Parameters", "Pass"});
  REQUIRE(passes.size() == 7);
  CHECK(passes[1][2] == "paint");
  CHECK(passes[1][5] == "3.0 MiB");
}

TEST_CASE("pipelines that come to the same passes share a row, and light that all make alike is a sentence") {
  if (lacksNode()) return;
  const TemporaryDirectory place;
  ReportRecord record = badlyNamedReport();
  for (PointRecord& point : record.scenes[0].points) {
    if (!point.point.failure.empty()) continue;
    ComponentError direct = errorOf("direct", "direct", true, 0.125);
    point.point.errors.push_back(direct);
  }
  // "two" becomes what "one" is.
  for (std::size_t i = 0; i < 3; ++i)
    record.scenes[0].points[3 + i].point.errors = record.scenes[0].points[i].point.errors;
  PointRecord other = record.scenes[0].points[0];
  other.point.pipeline = "other.pipeline";
  other.point.passOrder = {"draw"};
  other.isDefault = true;
  record.scenes[0].points.push_back(other);
  const Json page = drawn(record, place);
  const Json defaults = tableWith(page, {"Pipeline", "Frame, ms"});
  REQUIRE(defaults.size() == 3);  // one and two; other
  CHECK(contains(texts(Json::array({defaults[1][0], defaults[2][0]})),
                 "one&<i> and two&<i>: the same passes here"));
  CHECK(contains(page.at("text"), "Direct light is the same in all pipelines (FLIP 0.125 ± 0)"));
  CHECK(contains(page.at("text"), "two&<i> comes to the same passes as one&<i> in this scene"));
}

TEST_CASE(
    "a brief page holds the first screens and the images of the default points alone, its files everything") {
  if (lacksNode()) return;
  const TemporaryDirectory place;
  ReportRecord record = badlyNamedReport();
  for (PointRecord& point : record.scenes[0].points) point.images = {{kWholeImage, "final", "png", {}}};
  const ReportFiles whole = reportFiles(place.path() / "whole.html"),
                    brief = reportFiles(place.path() / "brief.html");
  writeReport(whole, record);
  writeReport(brief, record, ReportDetail::brief);
  CHECK(readFile(whole.json) == readFile(brief.json));
  CHECK(readFile(whole.csv) == readFile(brief.csv));
  const auto images = [](const ReportFiles& files) {
    std::size_t count = 0;
    const Json records = pageRecords(readFile(files.page), "images");
    for (const Json& point : records.at("scenes").at(0).at("points")) count += point.size();
    return count;
  };
  CHECK(images(whole) == 7);
  CHECK(images(brief) == 2);
  const Json page = drawnWell(brief.page);
  CHECK(page.at("charts").size() == 1);
  CHECK(contains(page.at("text"), "What was needed: 2 of 5 passes"));
  CHECK_FALSE(contains(texts(page.at("headings")), "Error numbers"));
}

TEST_CASE("long lists are folded and say how many there are, one is one, and captions break at underscores") {
  if (lacksNode()) return;
  const TemporaryDirectory place;
  ReportRecord record = reportWithVoxels();
  SceneRecord& scene = record.scenes[0];
  record.complete = true;
  record.budgetSeconds = 5.0;
  scene.leftOutPoints.emplace_back().pipeline = "late.pipeline";
  for (PointRecord& point : scene.points)
    point.images = {{kWholeImage, "final", "png", {{"one_bounce", "png", 0.25}}}};
  scene.references.push_back({"one_bounce", "png", 1.0, 0.01, 0.5, 1.0});
  Json page = drawn(record, place);
  std::string text = page.at("text"), html = page.at("html");
  CHECK(contains(text, "Not judged:two&<i>"));
  CHECK(contains(text, "What was found:three"));
  CHECK(contains(text, "For 1 point there was no time within 5 s."));
  CHECK(contains(text, "Which ones: 1 point"));
  CHECK(contains(text, "Whole image: 7 images"));
  CHECK(contains(html, "style=\"--figures:3\""));
  CHECK(contains(html, "<span class=\"soft\">one_<wbr></wbr>bounce</span></figcaption>"));
  CHECK(contains(html, "FLIP against one_<wbr></wbr>bounce: mean 0.250</figcaption>"));

  const PointRecord notJudged = scene.points[5];
  for (int i = 0; i < 11; ++i) scene.points.push_back(notJudged);
  scene.points.front().point.healthFindings.assign(10, "pass paint: NaN");
  page = drawnOfMany(record, place);
  text = page.at("text");
  html = page.at("html");
  CHECK(contains(html, "<details><summary>Not judged: 12 points</summary>"));
  CHECK(contains(html, "<details><summary>What was found: 11 findings</summary>"));
}

TEST_CASE("what HDR-FLIP says stands beside its first number, and two frames have no quartiles") {
  if (lacksNode()) return;
  const TemporaryDirectory place;
  ReportRecord record = badlyNamedReport();
  record.scenes[0].points[0].point.frameMs = statisticsOf({0.8, 1.2});
  const Json page = drawn(record, place);
  CHECK(contains(page.at("text"), kDefaultMetricSays));
  const Json summary = tableWith(page, {"Scene", "Pipeline", "Parameters"});
  REQUIRE(summary.size() == 8);
  CHECK(summary[1][3] == "1.00");
  CHECK(summary[2][3] == "2.00 [1.99, 2.01]");
  CHECK(formatQuartiles(statisticsOf({1.0, 2.0})).empty());
  CHECK(formatQuartiles(statisticsOf({1.0, 2.0, 3.0})) == "[1.5, 2.5]");
}

TEST_CASE(
    "where no pass is left out, the page says so, and what is left out within them only where there is any") {
  if (lacksNode()) return;
  const TemporaryDirectory place;
  ReportRecord record = badlyNamedReport();
  PruningRecord& pruning = record.scenes[0].pruning[0];
  pruning.explanation.passesKept = pruning.explanation.passesTotal;
  std::string text = drawn(record, place).at("text");
  CHECK(contains(
      text,
      "What was needed: all 5 passes of 1 pipeline. What is left out within them saves up to 75.0 % of a "
      "first frame (one&<i>) and 4.0 MiB of memory, and changes no image by a single bit."));
  CHECK_FALSE(contains(text, "leaving out the rest"));
  pruning.unprunedMs = pruning.prunedMs;
  pruning.unprunedBytes = pruning.prunedBytes;
  text = drawn(record, place).at("text");
  CHECK(contains(text,
                 "What was needed: all 5 passes of 1 pipeline. Nothing is left out that could be measured."));
  CHECK_FALSE(contains(text, "0 B of memory"));
}

TEST_CASE("the page of the stress battery draws its matrix, its concerns and their images") {
  if (lacksNode()) return;
  const TemporaryDirectory place;
  std::vector<StressCell> cells;
  for (const auto outcome :
       {StressOutcome::broken, StressOutcome::stable, StressOutcome::biased, StressOutcome::notApplicable}) {
    StressCell cell;
    cell.family = cells.size() < 2 ? "light" : "size";
    cell.name = "case_" + std::to_string(cells.size());
    cell.pipeline = "a_<b>.pipeline";
    cell.technique = "a";
    cell.outcome = outcome;
    cell.created = "2026-01-0" + std::to_string(cells.size() + 1) + " 00:00:00 UTC";
    cell.device = "device";
    cell.measure = outcome == StressOutcome::broken ? "" : "RMSE";
    cell.value = {0.031, 0.002};
    cell.limit = 0.02;
    cell.detail = "first at pixel (3, 2)";
    cell.image = "images/" + cell.name + ".png";
    cell.command = "lumivox stress";
    cells.push_back(cell);
  }
  std::filesystem::create_directories(place.path() / "images");
  place.write("images/case_0.png", "x");
  const Json page = drawnWell(writeStressPage(place.path(), cells, "lumivox stress <all>"));
  const std::string text = page.at("text"), html = page.at("html");
  CHECK(contains(text, "4 cells on device, 2026-01-01 to 2026-01-04, by lumivox stress <all>"));
  CHECK(contains(text, "first at pixel (3, 2)"));
  CHECK(contains(html, "src=\"images/case_0.png\""));
  CHECK_FALSE(contains(html, "images/case_1.png"));  // it is not there
  const Json matrix = page.at("tables").at(1);
  CHECK(matrix.at(1) == Json({"case", "a <b>"}));
  CHECK(matrix.at(2) == Json({"light"}));
  CHECK(matrix.at(3) == Json({"case 0", "broken"}));
  CHECK(matrix.at(4) == Json({"case 1", "0.031"}));
  CHECK(matrix.at(7) == Json({"case 3", ""}));
  CHECK(contains(text, "RMSE: 0.031 ± 0.002; limit 0.02"));
}
