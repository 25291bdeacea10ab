// The report on a tiny scene: one page that needs nothing else, and the same numbers in CSV and JSON.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "lumivox/base/image.h"
#include "support/drawn_page.h"
#include "support/page_check.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// RFC 4180, as far as these files need it.
std::vector<std::map<std::string, std::string>> parseCsv(const std::string& text) {
  std::vector<std::vector<std::string>> rows{{""}};
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '"' && i + 1 < text.size() && text[i + 1] == '"') {
        rows.back().back() += text[++i];
      } else if (c == '"') {
        quoted = false;
      } else {
        rows.back().back() += c;
      }
    } else if (c == '"') {
      quoted = true;
    } else if (c == ',') {
      rows.back().emplace_back();
    } else if (c == '\n') {
      rows.push_back({""});
    } else if (c != '\r') {
      rows.back().back() += c;
    }
  }
  rows.pop_back();
  std::vector<std::map<std::string, std::string>> records;
  for (std::size_t row = 1; row < rows.size(); ++row) {
    REQUIRE(rows[row].size() == rows[0].size());
    std::map<std::string, std::string> record;
    for (std::size_t column = 0; column < rows[0].size(); ++column)
      record[rows[0][column]] = rows[row][column];
    records.push_back(std::move(record));
  }
  return records;
}

/// A pipeline with two points, quick enough for a test.
constexpr const char* kQuickPipeline =
    "pipeline \"Quick\" {\n  param samples 4 in 1..16\n  pass gbuffer direct_lighting.gbuffer { }\n"
    "  pass shadow direct_lighting.shadow_map { size 64  area_samples $samples }\n"
    "  pass direct direct_lighting.shade { gbuffer gbuffer  shadow shadow.depth }\n  output direct "
    "direct.radiance\n}\n"
    "sweep samples { samples [1 4] }\n";

CommandResult makeReport(const Workplace& place, const std::string& more = {},
                         const std::string& page = "out/page.html") {
  place.write("quick.pipeline", kQuickPipeline);
  return typed("report", place.scene(), "--pipeline", place.file("quick.pipeline"),
               "-q --spp 16 --repeats 2 -o", place.file(page), Raw{more});
}

}  // namespace

TEST_CASE(
    "a report is one page that loads nothing from elsewhere, with CSV and JSON of the same numbers beside "
    "it") {
  const Workplace place;
  const CommandResult result = makeReport(place);
  INFO(result.errors);
  REQUIRE(result.exitCode == 0);

  // The terminal: a table, and the page's path as the last line.
  const std::string lastLine = result.output.substr(result.output.rfind('\n', result.output.size() - 2) + 1);
  CHECK(lastLine == place.file("out/page.html") + "\n");
  CHECK(contains(result.output, "Frame ms"));

  const std::string page = place.read("out/page.html");
  CHECK(contains(page, "Chart.js v3"));
  CHECK(contains(page, "Little room"));
  const nlohmann::json images = pageRecords(page, "images").at("scenes").at(0);
  CHECK(images.at("points").size() == 2);
  CHECK(images.at("points").at(0).at(0).at("png").get<std::string>().rfind("iVBORw0KGgo", 0) == 0);  // PNG
  CHECK(externalLoad(page).empty());
  CHECK_FALSE(contains(page, "<link"));

  const auto json = nlohmann::json::parse(place.read("out/page.json"));
  const auto rows = parseCsv(place.read("out/page.csv"));
  const auto& points = json.at("scenes").at(0).at("points");
  CHECK(points.size() == 2);
  std::size_t row = 0;
  for (const auto& point : points) {
    for (const auto& error : point.at("errors")) {
      REQUIRE(row < rows.size());
      const auto& record = rows[row++];
      CHECK(record.at("output") == error.at("output").get<std::string>());
      CHECK(record.at("reference") == error.at("reference").get<std::string>());
      CHECK(std::stod(record.at("rmse")) == error.at("metrics").at("rmse").at("value").get<double>());
      CHECK(std::stod(record.at("rmse_uncertainty")) ==
            error.at("metrics").at("rmse").at("uncertainty").get<double>());
      CHECK(std::stod(record.at("frame_ms")) == point.at("frame_ms").at("median").get<double>());
      CHECK(record.at("command") == point.at("command").get<std::string>());
      CHECK(error.at("metrics").at("rmse").at("uncertainty").get<double>() >
            0.0);  // the reference has noise, and says so
      CHECK(error.at("metrics").at("rmse").at("of_nothing").get<double>() > 0.0);
    }
    CHECK(point.at("frame_ms").at("repeats") == 2);
    CHECK(point.at("passes").size() == 3);
  }
  CHECK(row == rows.size());
  CHECK(json.at("scenes").at(0).at("pruning").at(0).at("same_image").get<bool>());
  CHECK_FALSE(json.at("device").at("renderer").get<std::string>().empty());
  CHECK(json.at("device").contains("timer_note"));

  // The page holds the same records.
  CHECK(pageRecords(page) == json);
}

TEST_CASE("a report for a look takes one frame, one seed and four positions, says so, and decides nothing") {
  const Workplace place;
  place.write("quick.pipeline", kQuickPipeline);
  const auto made = [&](const std::string& more) {
    const CommandResult result =
        ran("report", place.scene(), "--pipeline", place.file("quick.pipeline"),
            "-q --spp 16 --no-sweep --quick -o", place.file("out/page.html"), Raw{more});
    return nlohmann::json::parse(place.read("out/page.json"));
  };
  const nlohmann::json look = made("");
  CHECK(look.at("look") == true);
  const nlohmann::json point = look.at("scenes").at(0).at("points").at(0);
  CHECK(point.at("frame_ms").at("repeats") == 1);
  CHECK(contains(point.at("command"), "--subpixels 4 "));
  CHECK(point.at("errors").at(0).at("seeds") == 1);
  if (canDrawPages()) CHECK(contains(drawnPage(place.file("out/page.html")).at("text"), "A LOOK (--quick)"));
  // What is said beside it holds.
  const nlohmann::json sharper = made("--repeats 3 --subpixels 1").at("scenes").at(0).at("points").at(0);
  CHECK(sharper.at("frame_ms").at("repeats") == 3);
  CHECK(contains(sharper.at("command"), "--subpixels 1 "));
}

TEST_CASE("a report shows and judges all images of a scene at one exposure, and says which everywhere") {
  const Workplace place;
  const auto made = [&](const std::string& options) {
    const CommandResult result = makeReport(place, "--no-sweep --seeds 1 " + options);
    INFO(result.errors);
    REQUIRE(result.exitCode == 0);
    const auto scene = nlohmann::json::parse(place.read("out/page.json")).at("scenes").at(0);
    const double exposure = scene.at("reference").at("exposure_ev");
    CHECK(
        contains(result.output, fmt::format("room: images, SSIM and LDR-FLIP at {:+.2f} EV, tone {}",
                                            exposure, scene.at("reference").at("tone").get<std::string>())));
    for (const auto& layer : scene.at("reference").at("layers")) CHECK(layer.at("exposure_ev") == exposure);
    for (const auto& error : scene.at("points").at(0).at("errors"))
      CHECK(error.at("metrics").at("exposure_ev").at("value") == exposure);
    for (const auto& record : parseCsv(place.read("out/page.csv")))
      CHECK(std::stod(record.at("exposure_ev")) == exposure);
    return scene;
  };
  const auto images = [&] {
    return pageRecords(place.read("out/page.html"), "images").at("scenes").at(0).dump();
  };
  const auto automatic = made("");
  const double exposure = automatic.at("reference").at("exposure_ev");
  CHECK(automatic.at("reference").at("exposure_from") == "log-average of the full reference");
  const std::string usual = images();
  // What `reference` says of the same image.
  ran("reference", place.scene(), "-q --spp 16 -o", place.file("t.exr"));
  CHECK(std::stod(readExrAttributes(place.path() / "t.exr").at("lumivox.exposure_ev")) == exposure);

  const auto given = made("--exposure -1.5 --tone srgb");
  CHECK(given.at("reference").at("exposure_ev") == -1.5);
  CHECK(given.at("reference").at("exposure_from") == "--exposure");
  CHECK(images() != usual);
  const auto& before = automatic.at("points").at(0).at("errors").at(0).at("metrics");
  const auto& after = given.at("points").at(0).at("errors").at(0).at("metrics");
  CHECK(before.at("rmse") == after.at("rmse"));
  CHECK(before.at("flip") == after.at("flip"));
  CHECK(before.at("ssim") != after.at("ssim"));
  CHECK(contains(given.at("points").at(0).at("command"), "--exposure -1.5 --tone srgb"));
}

TEST_CASE("a report and the store that it adds to give the same CSV, with a column for each parameter") {
  const Workplace place;
  const CommandResult printed = makeReport(place, "--csv --store '" + place.file("results.sqlite") + "'");
  INFO(printed.errors);
  REQUIRE(printed.exitCode == 0);
  const std::string report = place.read("out/page.csv");
  CHECK(printed.output == report);
  const CommandResult exported = ran("results export --store", place.file("results.sqlite"));
  CHECK(report.substr(0, report.find('\n')) == exported.output.substr(0, exported.output.find('\n')));
  auto rows = parseCsv(report), stored = parseCsv(exported.output);
  REQUIRE(rows.size() == stored.size());
  const auto byCommand = [](const auto& a, const auto& b) {
    return a.at("command") + a.at("output") + a.at("against") <
           b.at("command") + b.at("output") + b.at("against");
  };
  std::sort(rows.begin(), rows.end(), byCommand);
  std::sort(stored.begin(), stored.end(), byCommand);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (const auto& [column, value] : rows[i]) {
      INFO(column);
      if (column != "run") CHECK(value == stored[i].at(column));
    }
  CHECK(rows.front().at("parameter_samples") == "1");
  CHECK(rows.back().at("parameter_samples") == "4");
  CHECK(rows.front().at("run").empty());
}

TEST_CASE("the command of a point repeats it with the same error") {
  const Workplace place;
  REQUIRE(makeReport(place).exitCode == 0);
  const auto first = nlohmann::json::parse(place.read("out/page.json")).at("scenes").at(0).at("points").at(0);
  const std::string command = first.at("command");
  REQUIRE(command.rfind("lumivox report ", 0) == 0);
  const CommandResult again = runCommand(command + " -q --json -o '" + place.file("again.html") + "'");
  INFO(again.errors);
  REQUIRE(again.exitCode == 0);
  const auto points = nlohmann::json::parse(again.output).at("scenes").at(0).at("points");
  REQUIRE(points.size() == 1);
  CHECK(points[0].at("parameters") == first.at("parameters"));
  CHECK(points[0].at("errors").at(0).at("metrics").at("rmse") ==
        first.at("errors").at(0).at("metrics").at("rmse"));
}

TEST_CASE("a setting pins its axis of the sweep, and one that no pipeline knows is refused") {
  const Workplace place;
  REQUIRE(makeReport(place, "--set samples=2").exitCode == 0);
  const auto points = nlohmann::json::parse(place.read("out/page.json")).at("scenes").at(0).at("points");
  REQUIRE(points.size() == 1);
  CHECK(points[0].at("parameters").at("samples") == "2");
  checkRefused(makeReport(place, "--set sampels=2"), "did you mean 'samples'");
}

TEST_CASE("a report that cannot be made says so before the work and leaves the earlier page alone") {
  const Workplace place;
  place.write("out/page.html", "an earlier page");
  checkRefused(typed("report", place.file("nowhere.scene"), "-o", place.file("out/page.html")),
               "nowhere.scene");
  place.write("wrong.pipeline", "pipeline \"Wrong\" {\n  output direct nothing.radiance\n}\n");
  checkRefused(typed("report", place.scene(), "--pipeline", place.file("wrong.pipeline"), "-o",
                     place.file("out/page.html")),
               "wrong.pipeline");
  CHECK(place.read("out/page.html") == "an earlier page");
  std::filesystem::create_directories(place.path() / "cache");
  std::filesystem::create_directories(place.path() /
                                      "cache/index.html");  // a folder in the place of the page
  checkRefused(makeReport(place, "", "cache"), place.file("cache"));
  checkRefused(makeReport(place, "", "room.obj/page.html"), "room.obj");
  checkRefused(typed(Before{"LUMIVOX_CHART_JS=/nowhere/chart.js"}, "report", place.scene(), "--pipeline",
                     place / "quick.pipeline", "-o", place / "page.html"),
               "libjs-chart.js");
}
