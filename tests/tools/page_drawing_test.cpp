// Pages draw themselves from their records: every section is there, every number of the records reaches its
// table, and a text stays a text. The drawing itself is tried on pages that are broken.
#include <algorithm>

#include "lumivox/page/page.h"
#include "lumivox/page/reproduction_page.h"
#include "lumivox/page/stress_page.h"
#include "lumivox/page/voxel_page.h"
#include "support/drawn_page.h"
#include "support/page_check.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;
using Json = nlohmann::json;

namespace {

bool lacksNode() {
  if (canDrawPages()) return false;
  skip("no node on the path");
  return true;
}

std::string texts(const Json& list) {
  std::string all;
  for (const Json& one : list) all += one.get<std::string>() + "\n";
  return all;
}

/// Rows, head included, of the table whose head begins with these cells.
Json tableWith(const Json& page, const std::vector<std::string>& head) {
  for (const Json& table : page.at("tables")) {
    if (table.at(0).size() < head.size()) continue;
    if (std::equal(head.begin(), head.end(), table.at(0).begin())) return table;
  }
  return Json::array();
}

constexpr const char* kDirect =
    "pipeline \"Direct <b>\" {\n  param samples 4 in 1..16\n  pass gbuffer direct_lighting.gbuffer { }\n"
    "  pass shadow direct_lighting.shadow_map { size 64  area_samples $samples }\n"
    "  pass direct direct_lighting.shade { gbuffer gbuffer  shadow shadow.depth }\n  output direct "
    "direct.radiance\n}\nsweep samples { samples [1 2 4] }\n";

ComponentError errorOf(const std::string& output, const std::string& component, bool bias, double rmse) {
  ComponentError error;
  error.output = output;
  error.component = component;
  error.reference = bias ? "one_bounce" : "full";
  error.bias = bias;
  error.seeds = 3;
  error.error.rmse = {rmse, 0.01 * rmse};
  error.error.relativeMse = {rmse, 0.01};
  error.error.percentile95 = rmse;
  error.error.flip = rmse;
  error.errorOfNothing.rmse.value = 1.0;
  return error;
}

/// Two pipelines at three points each, whose names are as bad as a name can be; nothing is rendered.
ReportRecord badlyNamedReport() {
  ReportRecord record;
  record.commandLine = "lumivox report '</script><script>alert(1)</script>'";
  record.device.renderer = "A & B <device>";
  SceneRecord scene;
  scene.file = "x.scene";
  scene.name = "<img src=x onerror=alert(1)>";
  scene.width = scene.height = 8;
  scene.references.push_back({"full", "png", 1.0, 0.01, 0.5, 1.0});
  for (const std::string name : {"one", "two"})
    for (const double samples : {1.0, 2.0, 4.0}) {
      PointRecord point;
      point.point.scene = scene.file;
      point.point.pipeline = name + "&<i>.pipeline";
      point.point.parameters["samples"].number = samples;
      point.isDefault = samples == 2.0;
      const double ms = samples * (name == "one" ? 1.0 : 3.0);
      point.point.frameMs = statisticsOf({0.99 * ms, ms, 1.01 * ms});
      point.point.nextFrameMs = statisticsOf({ms, ms, ms});
      point.point.movedFrameMs = statisticsOf({0.5 * ms, 0.5 * ms, 0.5 * ms});
      point.point.stillFrameMs = statisticsOf({0.25 * ms, 0.25 * ms, 0.25 * ms});
      point.point.passOrder = {"paint"};
      point.point.passDeviceMs["paint"] = point.point.frameMs;
      point.point.passBytes["paint"] = 3u << 20;
      point.point.errors = {errorOf(kWholeImage, "final", true, 0.4 / ms),
                            errorOf(kWholeImage, "final", false, 0.5 / ms)};
      point.point.notes = {"pass paint: 12 of \"3\""};
      point.point.command = "lumivox report <x>";
      scene.points.push_back(point);
    }
  PointRecord failed = scene.points.front();
  failed.point = {};
  failed.point.pipeline = "three.pipeline";
  failed.point.failure = "it does not fit <at all>";
  scene.points.push_back(failed);
  PruningRecord pruning;
  pruning.pipeline = scene.points[1].point.pipeline;
  pruning.prunedMs = statisticsOf({1.0, 1.0, 1.0});
  pruning.unprunedMs = statisticsOf({4.0, 4.0, 4.0});
  pruning.nextPrunedMs = pruning.nextUnprunedMs = pruning.prunedMs;
  pruning.explanation.passesKept = 2;
  pruning.explanation.passesTotal = 5;
  pruning.explanation.leftOut.push_back(
      {LeftOut::Level::pass, "paint <b>", "nobody looks", "paint", 2048, 1.5});
  pruning.passOrder = {"paint"};
  pruning.unprunedPassMs["paint"] = pruning.unprunedMs;
  pruning.unprunedBytes = 4u << 20;
  pruning.sameImage = true;
  scene.pruning.push_back(pruning);
  scene.unsuited.emplace_back("four.pipeline", "the scene has no <light>");
  record.scenes.push_back(scene);
  return record;
}

/// Writes a report's page and draws it.
Json drawn(const ReportRecord& record, const TemporaryDirectory& place) {
  const ReportFiles files = reportFiles(place.path() / "page.html");
  writeReport(files, record);
  return drawnPage(files.page);
}

}  // namespace

TEST_CASE(
    "a measured report draws every section, chart and control, and its tables hold the numbers of its JSON") {
  if (lacksNode()) return;
  const Workplace place;
  place.write("direct.pipeline", kDirect);
  const CommandResult made =
      runCommand("lumivox report '" + place.scene() + "' --pipeline '" + place.file("direct.pipeline") +
                 "' --pipeline '" + committedPipeline("voxel_cone_tracing") +
                 "' -q --set resolution=8 --spp 16 --subpixels 1 --repeats 3 --voxels 4 -o '" +
                 place.file("page.html") + "'");
  INFO(made.errors);
  REQUIRE(made.exitCode == 0);
  const Json page = drawnPage(place.file("page.html")), json = Json::parse(place.read("page.json"));
  INFO(texts(page.at("problems")));
  CHECK(page.at("problems").empty());
  const std::string headings = texts(page.at("headings"));
  for (const char* heading :
       {"Lumivox report", "Summary", "What was needed", "Little room", "Error against run time",
        "Images, reference and FLIP maps", "Error numbers", "Bias and noise apart", "Convergence",
        "Time and memory per pass", "What was left out, and what that saved", "Health",
        "Commands that repeat the points", "Voxels", "Recall against time", "Growth, published and here",
        "Device, driver and contents"}) {
    INFO(heading);
    CHECK(contains(headings, heading));
  }
  const std::string text = page.at("text");
  CHECK(contains(text, "Every output of every pass was scanned"));
  CHECK(contains(text, "lumivox device measures it, once"));
  CHECK(contains(text, "Same image, bit for bit: yes"));

  const Json& points = json.at("scenes").at(0).at("points");
  CHECK(tableWith(page, {"Scene", "Pipeline", "Parameters"}).size() == 1 + points.size());
  std::size_t errors = 0;
  for (const Json& point : points) {
    errors += point.at("errors").size();
    CHECK(contains(text, point.at("command").get<std::string>()));
  }
  const Json table = tableWith(page, {"Pipeline", "Parameters", "Output", "Reference", "Says"});
  REQUIRE(table.size() == 1 + errors);
  const double rmse = points.at(0).at("errors").at(0).at("rmse").at("value");
  CHECK(std::stod(table.at(1).at(5).get<std::string>()) == Approx(rmse).epsilon(0.006));
  // Errors, times, memory, voxels; sliders and choices between images; the choices of the fronts.
  CHECK(page.at("charts").size() >= 6);
  CHECK(page.at("images").size() > 8);
  CHECK(page.at("controls").size() >= 8);
  for (const Json& control : page.at("controls")) CHECK(control.at("changed").get<int>() >= 1);
  CHECK(externalLoad(place.read("page.html")).empty());
}

TEST_CASE("a broken record, script or image is found out when its page is drawn") {
  if (lacksNode()) return;
  const TemporaryDirectory place;
  CHECK(drawn(badlyNamedReport(), place).at("problems").empty());
  const std::string page = readFile(place.path() / "page.html");
  const auto problemsWith = [&](const std::string& from, const std::string& to) {
    std::string broken = page;
    const std::size_t at = broken.find(from);
    REQUIRE(at != std::string::npos);
    return texts(drawnPage(place.write("broken.html", broken.replace(at, from.size(), to))).at("problems"));
  };
  CHECK(contains(problemsWith("\"health_findings\"", "\"ill_findings\""), "script: "));
  CHECK(contains(problemsWith("\"passes_kept\"", "\"passes_lost\""), "undefined of 5"));
  CHECK(contains(problemsWith("id: \"summary\"", "id: \"winter\""), "leads nowhere: #summary"));
  CHECK(contains(problemsWith("followers.forEach(", "[].forEach("), "SELECT changes nothing"));
}

TEST_CASE("names and commands stay texts on the page, whatever they hold") {
  if (lacksNode()) return;
  const TemporaryDirectory place;
  const Json page = drawn(badlyNamedReport(), place);
  INFO(texts(page.at("problems")));
  CHECK(page.at("problems").empty());
  const std::string text = page.at("text"), html = readFile(place.path() / "page.html");
  for (const char* part :
       {"<img src=x onerror=alert(1)>", "</script><script>alert(1)</script>", "A & B <device>", "one&<i>",
        "it does not fit <at all>", "four: the scene has no <light>", "lumivox report <x>", "12 of \"3\""}) {
    INFO(part);
    CHECK(contains(text, part));
  }
  CHECK_FALSE(contains(html, "<script>alert"));
  CHECK_FALSE(contains(html, "<img src=x"));
}

TEST_CASE("the summary, the fronts and the matrix of what was needed say what the records say") {
  if (lacksNode()) return;
  const TemporaryDirectory place;
  const Json page = drawn(badlyNamedReport(), place);
  const Json summary = tableWith(page, {"Scene", "Pipeline"});
  REQUIRE(summary.size() == 8);
  CHECK(summary[1][2] == "samples 1");
  CHECK(summary[1][3] == "1 [0.995, 1]");
  CHECK(summary[1][4] == "0.5 ± 0.005");
  CHECK(summary[2][7] == "75.0 %; 0.0 %");
  CHECK(summary[1][8] == "on the Pareto front");
  CHECK(summary[7][9] == "failed");
  CHECK(summary[7][3] == "-");
  const Json ranges = tableWith(page, {"Budget, ms", "Least error"});
  REQUIRE(ranges.size() > 2);
  CHECK(ranges[1][2] == "one&<i>");
  const Json needed = tableWith(page, {"Scene", "four", "one&<i>"});
  REQUIRE(needed.size() == 2);
  CHECK(contains(needed[1][1], "not run: the scene has no <light>"));
  CHECK(contains(needed[1][2], "2 of 5"));
  CHECK(contains(needed[1][2], "first frame saves3 of 4 ms"));
  CHECK(contains(needed[1][2], "later ones savenot measurable, of 1 ms"));
  CHECK(contains(needed[1][3], "failed: it does not fit <at all>"));
  const Json slopes = tableWith(page, {"Pipeline", "Parameter", "Others"});
  REQUIRE(slopes.size() > 2);
  CHECK(slopes[1][1] == "samples 1 .. 4");
  const Json passes = tableWith(page, {"Pass", "samples 1: ms"});
  REQUIRE(passes.size() == 8);
  CHECK(passes[5][0] == "done once (preprocessing)");
  CHECK(contains(passes[5][1], "0.5 ± "));
  CHECK(contains(passes[6][1], "0.25 ± "));
  CHECK(passes[7][1] == "0.25 ± 0");
  CHECK(passes[1][0] == "paint");
  CHECK(passes[1][4] == "3.0 MiB");
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
  const Json page = drawnPage(writeStressPage(place.path(), cells, "lumivox stress <all>"));
  INFO(texts(page.at("problems")));
  CHECK(page.at("problems").empty());
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

TEST_CASE("the page of the voxelizers draws its charts and both kinds of growth") {
  if (lacksNode()) return;
  const TemporaryDirectory place;
  std::vector<VoxelizerRecord> records;
  for (const int resolution : {16, 32, 64}) {
    VoxelizerRecord record;
    record.scene = "x.scene";
    record.pipeline = "atlas.pipeline";
    record.resolution = resolution;
    record.triangles = 100;
    record.frameMs = statisticsOf({0.01 * resolution * resolution});
    record.occupied = 7;
    record.error.truePositive = 5;
    records.push_back(record);
  }
  records.push_back(records.back());
  records.back().whyNot = "it is <lost>";
  const VoxelizerFiles files = voxelizerFiles(place.path());
  gpu::DeviceInfo device;
  device.renderer = "device";
  writeVoxelizers(files, records, device, "lumivox voxels");
  const Json page = drawnPage(files.page);
  INFO(texts(page.at("problems")));
  CHECK(page.at("problems").empty());
  CHECK(page.at("charts").size() == 3);
  CHECK(tableWith(page, {"Scene", "Voxelizer"}).size() == 4);
  CHECK(contains(page.at("text"), "it is <lost>"));
  const Json growth = tableWith(page, {"Source", "Voxelizer"});
  REQUIRE(growth.size() == 11);
  CHECK(growth.back() == Json({"here, x", "atlas", "voxels along a side", "2"}));
  CHECK(growth[1][3] == "0.739");  // log(22 / 2) / log(262267 / 10219)
}
