// Plots of pages: what is drawn and what is not, as a file for a paper, and with names at the points of the
// front.
#include <algorithm>
#include <map>

#include "lumivox/page/voxel_page.h"
#include "tools/cli_support.h"
#include "tools/made_reports.h"

using namespace lumivox;
using namespace lumivox::test;
using Json = nlohmann::json;

namespace {

/// Names of `charts` lie beside each other.
void checkApart(const Json& names) {
  INFO(names.dump());
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double x = names[i].at("x"), y = names[i].at("y"), width = names[i].at("width");
      const double otherX = names[j].at("x"), otherY = names[j].at("y"), otherWidth = names[j].at("width");
      CHECK((x + width <= otherX || otherX + otherWidth <= x || std::abs(y - otherY) >= 11));
    }
}

}  // namespace

TEST_CASE(
    "errors are drawn against the recall of the voxels that light is gathered from, beside their times") {
  if (lacksNode()) return;
  const TemporaryDirectory place;
  const Json page = drawn(reportWithVoxels(), place);
  CHECK(contains(texts(page.at("headings")), "Error against recall"));
  // On the first screen, and in the section both side by side.
  std::map<std::string, std::size_t> points;
  for (const Json& chart : page.at("charts"))
    points[chart.at("data-chart")] += chart.at("points").get<std::size_t>();
  REQUIRE(points.size() == 3);
  CHECK(points.at("recall") == 5);
  CHECK(points.at("time") == points.at("error"));
  const Json table = tableWith(page, {"Pipeline", "Parameters", "Voxels", "Grid"});
  REQUIRE(table.size() == 6);
  const auto& first = table[1];
  CHECK(first[0] == "one&<i>");
  CHECK(first[1] == "samples 1");
  CHECK(first[2] == "points<b>.fragments");
  CHECK(first[3] == "32 × 16 × 8");
  CHECK(first[5] == "0.2000");
  CHECK(first[6] == "0.9524");
  CHECK(first[7] == "30.0 %");
  CHECK(first[8] == "6.0 %");
  CHECK(contains(page.at("text"), "points<b>.fragments, there are <too> many"));
  // Without voxels there is no such section.
  const Json without = drawn(badlyNamedReport(), place);
  CHECK_FALSE(contains(texts(without.at("headings")), "Error against recall"));
  CHECK(without.at("charts").size() == 1);
  // The brief page does without.
  const ReportFiles brief = reportFiles(place.path() / "brief.html");
  writeReport(brief, reportWithVoxels(), ReportDetail::brief);
  const Json small = drawnWell(brief.page);
  CHECK(small.at("charts").size() == 1);
}

TEST_CASE("what has one value is not drawn, and what has one choice is not asked") {
  if (lacksNode()) return;
  const TemporaryDirectory place;
  ReportRecord record = reportWithVoxels();
  for (PointRecord& one : record.scenes[0].points) {
    if (!one.point.voxels) continue;
    one.point.voxels->error = {20, 5, 0};
    one.point.voxels->holes = {100, 40, 100, 8};
  }
  Json page = drawn(record, place);
  CHECK(page.at("charts").size() == 1);
  CHECK(contains(
      page.at("text"),
      "Not drawn, since all points have the same: recall 1; precision 0.8; holes, rays along the axes "
      "0.4; holes, oblique rays 0.08."));
  CHECK(tableWith(page, {"Pipeline", "Parameters", "Voxels", "Grid"}).size() == 6);

  // One share differs: there is nothing to choose it from.
  record.scenes[0].points[0].point.voxels->holes = {100, 41, 100, 8};
  page = drawn(record, place);
  CHECK(page.at("charts").size() == 3);
  std::string html = page.at("html");
  CHECK_FALSE(contains(html, "data-choose=\"share\""));
  CHECK(contains(html, "data-choose=\"light\""));
  CHECK(contains(html, "sort by this column"));

  // One point with one image, of which no other is known.
  record.scenes[0].points.resize(1);
  record.scenes[0].references.clear();
  record.scenes[0].points[0].isDefault = true;
  record.scenes[0].points[0].point.errors.resize(1);
  record.scenes[0].points[0].images = {{kWholeImage, "final", "png", {}}};
  record.scenes[0].pruning.clear();
  record.scenes[0].unsuited.clear();
  page = drawn(record, place);
  html = page.at("html");
  CHECK_FALSE(contains(html, "data-choose=\"light\""));
  CHECK_FALSE(contains(html, "sort by this column"));
  CHECK_FALSE(contains(html, "data-wipe"));
  CHECK(contains(html, "<div class=\"strip\">"));
}

TEST_CASE("every chart can be saved as SVG with the names of its axes and of the points on the front") {
  if (lacksNode()) return;
  const TemporaryDirectory place;
  const Json page = drawn(reportWithVoxels(), place);
  REQUIRE(page.at("svgs").size() == page.at("charts").size());
  const auto count = [](const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
    return found;
  };
  // The whole image against full transport: six points, each slower and better than the one before.
  const std::string svg = page.at("svgs")[0];
  INFO(svg);
  CHECK(contains(svg, ">frame time, ms</text>"));
  CHECK(contains(svg, ">FLIP</text>"));
  CHECK(count(svg, "class=\"point\"") == 6);
  CHECK(count(svg, "class=\"legend\"") == 3);
  CHECK(contains(svg, ">least error within a time</text>"));
  const Json all = tableWith(page, {"Pipeline", "Parameters", "Frame, ms", "Error", "Front"});
  std::size_t front = 0;
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (all[i][4] != "on the Pareto front") continue;
    ++front;
    std::string name = all[i][0].get<std::string>() + ", " + all[i][1].get<std::string>();
    for (const auto& [from, to] : {std::pair{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}})
      for (std::size_t at = name.find(from); at != std::string::npos; at = name.find(from, at + 1))
        name.replace(at, 1, to);
    INFO(name);
    CHECK(count(svg, ">" + name + "</text>") == 1);
  }
  CHECK(front > 2);
  CHECK(count(svg, "class=\"name\"") == front);
  // No name stands upon another: lines of 11 pixels, letters about 6 wide.
  std::vector<std::pair<double, double>> names;
  for (std::size_t at = svg.find("<text "); at != std::string::npos; at = svg.find("<text ", at + 1)) {
    const std::string tag = svg.substr(at, svg.find('>', at) - at);
    if (!contains(tag, "class=\"name\"")) continue;
    names.emplace_back(std::stod(tag.substr(tag.find("x=\"") + 3)),
                       std::stod(tag.substr(tag.find("y=\"") + 3)));
  }
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      CHECK((std::abs(names[i].first - names[j].first) > 60 ||
             std::abs(names[i].second - names[j].second) > 10));
  // Against recall no point is on a front.
  const std::string recall = page.at("svgs")[1];
  CHECK(contains(recall, ">recall</text>"));
  CHECK(count(recall, "class=\"point\"") == 5);
  CHECK(count(recall, "class=\"name\"") == 0);
}

TEST_CASE("the plot of the page itself names the points on the front, and no name stands upon another") {
  if (lacksNode()) return;
  const TemporaryDirectory place;
  const Json page = drawn(badlyNamedReport(), place);
  const Json names = page.at("charts").at(0).at("names");
  INFO(names.dump());
  const Json all = tableWith(page, {"Pipeline", "Parameters", "Frame, ms", "Error", "Front"});
  std::size_t front = 0;
  for (std::size_t i = 1; i < all.size(); ++i) {
    const std::string pipeline = all[i][0], name = pipeline + ", " + all[i][1].get<std::string>();
    const bool isOnFront = all[i][4] == "on the Pareto front";
    front += isOnFront ? 1 : 0;
    CHECK(std::count_if(names.begin(), names.end(),
                        [&](const Json& one) { return one.at("text") == name; }) == (isOnFront ? 1 : 0));
  }
  CHECK(front > 2);
  CHECK(names.size() == front);
  checkApart(names);
  for (const Json& name : names) {
    const double x = name.at("x"), y = name.at("y"), width = name.at("width");
    CHECK((x >= 50 && x + width <= 600 && y >= 0 && y <= 400));
  }

  // Of points that all lie at one place no more are named than there is room for.
  ReportRecord crowd = badlyNamedReport();
  const PointRecord first = crowd.scenes[0].points.front();
  crowd.scenes[0].points.clear();
  constexpr int kCrowd = 40;
  for (int i = 0; i < kCrowd; ++i) {
    PointRecord point = first;
    point.isDefault = i == 0;
    point.point.parameters["samples"].number = i;
    const double ms = 1.0 + 0.2 * i;
    point.point.frameMs = statisticsOf({ms, ms, ms});
    for (ComponentError& error : point.point.errors) error.error.flip = 0.5 - 0.01 * i;
    crowd.scenes[0].points.push_back(point);
  }
  const Json crowded = drawnOfMany(crowd, place).at("charts").at(0).at("names");
  CHECK(crowded.size() > 3);
  CHECK(crowded.size() < kCrowd);
  checkApart(crowded);
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
  const Json page = drawnWell(files.page);
  // All have as many triangles.
  CHECK(page.at("charts").size() == 2);
  CHECK(contains(page.at("text"), "x, triangles: not drawn, since all points have the same triangles, 100."));
  CHECK(tableWith(page, {"Scene", "Voxelizer"}).size() == 4);
  CHECK(contains(page.at("text"), "it is <lost>"));
  const Json growth = tableWith(page, {"Source", "Voxelizer"});
  REQUIRE(growth.size() == 11);
  CHECK(growth.back() == Json({"here, x", "atlas", "voxels along a side", "2"}));
  CHECK(growth[1][3] == "0.739");  // log(22 / 2) / log(262267 / 10219)
}
