// Records of reports that nobody measured, and their pages, drawn.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "lumivox/analysis/comparison.h"
#include "lumivox/page/page.h"
#include "lumivox/results/text.h"
#include "support/drawn_page.h"

namespace lumivox::test {

inline bool lacksNode() {
  if (canDrawPages()) return false;
  skip("no node on the path");
  return true;
}

inline std::string texts(const nlohmann::json& list) {
  std::string all;
  for (const nlohmann::json& one : list) all += one.get<std::string>() + "\n";
  return all;
}

/// Rows, head included, of the table whose head begins with these cells.
inline nlohmann::json tableWith(const nlohmann::json& page, const std::vector<std::string>& head) {
  for (const nlohmann::json& table : page.at("tables")) {
    if (table.at(0).size() < head.size()) continue;
    if (std::equal(head.begin(), head.end(), table.at(0).begin())) return table;
  }
  return nlohmann::json::array();
}

inline ComponentError errorOf(const std::string& output, const std::string& component, bool bias,
                              double rmse) {
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
inline ReportRecord badlyNamedReport() {
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
  pruning.nextPrunedMs = statisticsOf({0.25, 0.25, 0.25});
  pruning.nextUnprunedMs = pruning.unprunedMs;
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

/// The same with voxels that light is gathered from: of "one" all are judged, of "two" one point has too
/// many.
inline ReportRecord reportWithVoxels() {
  ReportRecord record = badlyNamedReport();
  for (PointRecord& one : record.scenes[0].points) {
    if (!one.point.failure.empty()) continue;
    GatheredVoxels voxels;
    voxels.output = "points<b>.fragments";
    voxels.kind = "VoxelFragments";
    voxels.resolution = {32, 16, 8};
    const auto samples = static_cast<std::uint64_t>(one.point.parameters.at("samples").number);
    voxels.occupied = 20 * samples;
    voxels.error = {20 * samples, samples, 100 - 20 * samples};
    voxels.holes = {100, 40 - 10 * samples, 100, 8 - 2 * samples};
    if (one.point.pipeline[0] == 't' && samples == 4) voxels.whyNot = "there are <too> many";
    one.point.voxels = voxels;
  }
  return record;
}

/// A page that draws itself without a problem.
inline nlohmann::json drawnWell(const std::filesystem::path& file) {
  nlohmann::json page = drawnPage(file);
  INFO(texts(page.at("problems")));
  CHECK(page.at("problems").empty());
  return page;
}

/// Writes a report's page.
inline std::filesystem::path written(const ReportRecord& record, const TemporaryDirectory& place) {
  const ReportFiles files = reportFiles(place.path() / "page.html");
  writeReport(files, record);
  return files.page;
}

/// Writes it and draws it, without a problem.
inline nlohmann::json drawn(const ReportRecord& record, const TemporaryDirectory& place) {
  return drawnWell(written(record, place));
}

/// The same of a scene with more than eight points. Their table has choices of its own and is made anew when
/// another light is chosen, while page_dom.js tries the choices of the first one: its problems say nothing.
inline nlohmann::json drawnOfMany(const ReportRecord& record, const TemporaryDirectory& place) {
  return drawnPage(written(record, place));
}

}  // namespace lumivox::test
