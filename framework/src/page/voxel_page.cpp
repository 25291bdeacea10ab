// How voxelisers do: records as JSON, CSV and a section of the page, with the published figures beside.
#include "page/voxel_page.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "lumivox/analysis/scaling.h"
#include "lumivox/base/file.h"
#include "lumivox/page/voxel_page.h"
#include "lumivox/results/json.h"
#include "lumivox/results/text.h"
#include "page/data.h"
#include "page/page_parts.h"

namespace lumivox::page {
namespace {

using Json = nlohmann::ordered_json;

/// Published growth of time, as the exponent of a power law between the first and the last row of a table.
struct PublishedGrowth {
  const char *source, *method, *with;
  double firstX, lastX, firstMs, lastMs;
  double exponent() const { return std::log(lastMs / firstMs) / std::log(lastX / firstX); }
};

// Mavridis & Papaioannou 2011, Table 1: 64^3 voxels, from the scene with the fewest triangles whose time is
// lowest (arena) to the one with the most (sponza). Thiedemann et al. 2011: grids of N^2 x 128 voxels; the
// vertices grow with them, from 15 000 on.
const PublishedGrowth kPublished[] = {
    {"Mavridis & Papaioannou 2011, Table 1", "3 points a triangle", "triangles", 10219, 262267, 2, 22},
    {"Mavridis & Papaioannou 2011, Table 1", "7 points a triangle", "triangles", 10219, 262267, 4, 52},
    {"Mavridis & Papaioannou 2011, Table 1", "12 points a triangle", "triangles", 10219, 262267, 5, 86},
    {"Mavridis & Papaioannou 2011, Table 1", "19 points a triangle", "triangles", 10219, 262267, 7, 125},
    {"Mavridis & Papaioannou 2011, Table 1", "sponza, 3 to 19 points a triangle", "points", 3, 19, 22, 125},
    {"Thiedemann et al. 2011", "atlas, binary", "voxels along a side", 64, 512, 0.52, 3.37},
    {"Thiedemann et al. 2011", "atlas, binary", "vertices", 15e3, 791e3, 0.52, 3.37},
    {"Thiedemann et al. 2011", "atlas, multi-valued", "voxels along a side", 64, 256, 1.23, 4.29},
    {"Thiedemann et al. 2011", "atlas, multi-valued", "vertices", 15e3, 285e3, 1.23, 4.29},
};

/// Mavridis & Papaioannou 2011, Table 1: times by points a triangle, as ratios to the time with 19; and that
/// of the reprojection of 512^2 points.
struct PublishedPoints {
  const char* scene;
  int triangles;
  double ms[4], reprojectionMs;
};
constexpr int kPublishedPoints[] = {3, 7, 12, 19};
const PublishedPoints kPointTimes[] = {{"sponza", 262267, {22, 52, 86, 125}, 0.7},
                                       {"knossos", 109168, {11, 22, 35, 55}, 0.7},
                                       {"arena", 10219, {2, 4, 5, 7}, 0.7},
                                       {"room", 8760, {4, 5.4, 8, 10}, 0.7}};

std::string fourDigits(double share) {
  return fmt::format("{:.4f}", share);
}

std::string resultTable(const std::vector<VoxeliserRecord>& records) {
  Table table({{"Scene"},
               {"Voxeliser", "wide"},
               {"Resolution", "number"},
               {"Triangles", "number"},
               {"Time, ms", "number"},
               {"Occupied", "number"},
               {"Recall", "number"},
               {"Precision", "number"},
               {"Holes, axis rays", "number"},
               {"Holes, oblique rays", "number"},
               {"Fragments", "number"},
               {"Output", "number"},
               {"Bytes per fragment", "number"},
               {"Bytes per voxel", "number"},
               {"All memory", "number"}});
  std::string notMeasured;
  for (const VoxeliserRecord& record : records) {
    std::vector<std::string> cells{escaped(shortName(record.scene)), escaped(record.label()),
                                   std::to_string(record.resolution), std::to_string(record.triangles)};
    if (!record.whyNot.empty()) {
      notMeasured += fmt::format("<li>{}, resolution {}, {} triangles: {}</li>\n", escaped(record.label()),
                                 record.resolution, record.triangles, escaped(record.whyNot));
      continue;
    }
    for (const std::string& cell :
         {withQuartiles(record.frameMs), std::to_string(record.occupied), fourDigits(record.error.recall()),
          fourDigits(record.error.precision()), percent(record.holes.axisShare()),
          percent(record.holes.obliqueShare()),
          record.fragments == 0 ? std::string("-") : std::to_string(record.fragments),
          formatBytes(record.bytes),
          record.fragments == 0 ? std::string("-") : number(record.bytesPerFragment()),
          number(record.bytesPerVoxel()), formatBytes(record.allocatedBytes)})
      cells.push_back(cell);
    table.row(cells, record.isDefault ? "default" : "");
  }
  if (!notMeasured.empty()) notMeasured = "<p>Not measured:</p>\n<ul>\n" + notMeasured + "</ul>\n";
  return table.html() + notMeasured;
}

std::string scalingTables(const std::vector<VoxeliserRecord>& records) {
  Table table({{"Source"}, {"Voxeliser", "wide"}, {"Time grows with"}, {"Exponent", "number"}});
  for (const PublishedGrowth& published : kPublished)
    table.row({escaped(published.source), published.method, published.with, number(published.exponent())});
  for (const VoxeliserScaling& scaling : scalingOf(records)) {
    const auto add = [&](const char* with, const std::optional<double>& exponent) {
      if (exponent)
        table.row(
            {"here, " + escaped(shortName(scaling.scene)), escaped(scaling.label), with, number(*exponent)},
            "default");
    };
    add("voxels along a side", scaling.withResolution);
    add("triangles", scaling.withTriangles);
  }
  Table points({{"Scene"},
                {"Triangles", "number"},
                {"3 points", "number"},
                {"7 points", "number"},
                {"12 points", "number"},
                {"19 points", "number"},
                {"Reprojection", "number"}});
  for (const PublishedPoints& row : kPointTimes) {
    const double whole = row.ms[3];
    points.row({row.scene, std::to_string(row.triangles), number(row.ms[0] / whole),
                number(row.ms[1] / whole), number(row.ms[2] / whole), "1",
                number(row.reprojectionMs / whole)});
  }
  return "<h3>Growth, published and here</h3>\n<p class=\"caption\">The exponent p of a power law, time ~ x^p: 1 is "
         "proportional; for a surface in a grid, voxels along a side have the exponent 2 where the time is that of "
         "the voxels it fills. Published: between the first and last row of a table. Here: least squares through "
         "the medians; triangles by splitting each into four, which leaves the surface and its voxels as they "
         "are.</p>\n" +
         table.html() +
         "<p class=\"caption\">Mavridis &amp; Papaioannou 2011, Table 1, as ratios to the time with 19 points a "
         "triangle. Ours with other numbers of points are rows of the table above.</p>\n" +
         points.html();
}

}  // namespace

std::string voxelSection(const std::vector<VoxeliserRecord>& records) {
  if (records.empty()) return {};
  std::string html =
      "<h2 id=\"voxels\">Voxels</h2>\n<p class=\"caption\">Every voxeliser against the exact test of triangles and "
      "boxes. Recall: share of the touched voxels that are occupied. Precision: share of the occupied voxels that "
      "are touched. Holes: share of the crossings of straight rays with the surface at which the ray meets no "
      "occupied voxel within a voxel and a half. Time: a frame in which everything that the output needs is made "
      "anew, median [quartiles].</p>\n<h3>Recall against time</h3>\n<div class=\"charts\">\n";
  std::set<std::string> scenes;
  for (const VoxeliserRecord& record : records) scenes.insert(record.scene);
  for (const std::string& scene : scenes)
    html += "<figure><h4>" + escaped(shortName(scene)) +
            "</h4><div class=\"chart tall\"><canvas data-voxels=\"recall\" data-scene=\"" + escaped(scene) +
            "\"></canvas></div></figure>\n";
  html += "</div>\n";
  if (!scalingOf(records).empty()) {
    html += "<h3>Time against resolution and triangles</h3>\n<div class=\"charts\">\n";
    for (const std::string& scene : scenes)
      for (const char* with : {"resolution", "triangles"})
        html += fmt::format(
            "<figure><h4>{}, {}</h4><div class=\"chart tall\"><canvas data-voxels=\"{}\" data-scene=\"{}\">"
            "</canvas></div></figure>\n",
            escaped(shortName(scene)), with, with, escaped(scene));
    html += "</div>\n";
  }
  return html + resultTable(records) + scalingTables(records);
}

const char* const kVoxelScript = R"js(
"use strict";
(function () {
  const { data, style, shortName } = lumivoxPage;
  const records = data.voxels.filter(record => !record.why_not);
  const axes = {
    recall: { of: record => record.frame_ms.median, value: record => record.recall, title: "time, ms", other: "recall" },
    resolution: { of: record => record.resolution, value: record => record.frame_ms.median, title: "voxels along a side", other: "time, ms" },
    triangles: { of: record => record.triangles, value: record => record.frame_ms.median, title: "triangles", other: "time, ms" } };
  for (const canvas of document.querySelectorAll("canvas[data-voxels]")) {
    const kind = canvas.dataset.voxels, axis = axes[kind];
    const mine = records.filter(record => record.scene === canvas.dataset.scene);
    const first = mine.length ? mine[0].resolution : 0;
    const series = new Map();
    for (const record of mine) {
      if (kind !== "triangles" && record.subdivisions > 0) continue;
      if (kind === "triangles" && record.resolution !== first) continue;
      if (kind !== "recall" && !record.is_default) continue;
      const key = kind === "recall" ? shortName(record.pipeline) : record.label;
      if (!series.has(key)) series.set(key, { record, label: key, data: [] });
      series.get(key).data.push({ x: axis.of(record), y: axis.value(record),
        text: record.label + ", resolution " + record.resolution + ", " + record.triangles + " triangles" });
    }
    const datasets = [...series.values()].map(one => {
      const { colour, shape } = style(one.record.pipeline);
      return { label: one.label, data: one.data.sort((a, b) => a.x - b.x), showLine: kind !== "recall", borderWidth: 1.5,
               pointRadius: 5, pointStyle: shape, borderColor: colour, backgroundColor: colour };
    });
    new Chart(canvas, {
      type: "scatter", data: { datasets },
      options: {
        animation: false, maintainAspectRatio: false,
        scales: {
          x: { type: "logarithmic", title: { display: true, text: axis.title } },
          y: kind === "recall" ? { min: 0, max: 1.02, title: { display: true, text: axis.other } }
                               : { type: "logarithmic", title: { display: true, text: axis.other } } },
        plugins: {
          legend: { position: "bottom", labels: { boxWidth: 14, font: { size: 11 }, usePointStyle: true } },
          tooltip: { callbacks: { label: item => item.raw.text + ": " + Number(item.raw.x).toPrecision(3) + ", " + Number(item.raw.y).toPrecision(4) } } } } });
  }
})();
)js";

namespace {

std::string recordsCsv(const std::vector<VoxeliserRecord>& records) {
  std::string csv =
      "scene,pipeline,output,label,resolution,triangles,subdivisions,median_ms,lower_quartile_ms,"
      "upper_quartile_ms,fragments,occupied,truth,undecided,recall,precision,axis_holes,oblique_holes,bytes,"
      "allocated_bytes,why_not\n";
  const auto quoted = [](const std::string& text) { return "\"" + replaced(text, "\"", "\"\"") + "\""; };
  for (const VoxeliserRecord& record : records) {
    csv += fmt::format("{},{},{},{},{},{},{},", quoted(record.scene), quoted(record.pipeline),
                       quoted(record.output), quoted(record.label()), record.resolution, record.triangles,
                       record.subdivisions);
    csv += record.whyNot.empty()
               ? fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},\n", record.frameMs.median,
                             record.frameMs.lowerQuartile, record.frameMs.upperQuartile, record.fragments,
                             record.occupied, record.truth, record.undecided, record.error.recall(),
                             record.error.precision(), record.holes.axisShare(), record.holes.obliqueShare(),
                             record.bytes, record.allocatedBytes)
               : std::string(13, ',') + quoted(record.whyNot) + "\n";
  }
  return csv;
}

}  // namespace
}  // namespace lumivox::page

namespace lumivox {

using namespace page;

VoxeliserFiles voxeliserFiles(const std::filesystem::path& folder) {
  return {folder / "index.html", folder / "voxels.csv", folder / "voxels.json"};
}

std::string voxelisersJson(const std::vector<VoxeliserRecord>& records, const gpu::DeviceInfo& device,
                           const std::string& commandLine) {
  nlohmann::ordered_json json = {{"command", commandLine},
                                 {"device", device.renderer},
                                 {"driver", device.version},
                                 {"software", device.software},
                                 {"records", toJson(records)}};
  json["scaling"] = nlohmann::ordered_json::array();
  for (const VoxeliserScaling& scaling : scalingOf(records)) {
    nlohmann::ordered_json one = {{"scene", scaling.scene}, {"label", scaling.label}};
    if (scaling.withResolution) one["with_resolution"] = *scaling.withResolution;
    if (scaling.withTriangles) one["with_triangles"] = *scaling.withTriangles;
    json["scaling"].push_back(std::move(one));
  }
  return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

void writeVoxelisers(const VoxeliserFiles& files, const std::vector<VoxeliserRecord>& records,
                     const gpu::DeviceInfo& device, const std::string& commandLine) {
  const std::string library = chartLibrary();
  std::string body = "<header>\n<h1>Lumivox voxelisers</h1>\n<p class=\"soft\">Measured on " +
                     escaped(device.renderer) + ", by <code>" + escaped(commandLine) +
                     "</code>. The same numbers stand in voxels.csv and voxels.json beside this "
                     "page.</p>\n</header>\n<main>\n" +
                     voxelSection(records) + "</main>\n" +
                     dataBlock("data", Json{{"voxels", toJson(records)}}.dump());
  writeFileAtomically(files.json, voxelisersJson(records, device, commandLine));
  writeFileAtomically(files.csv, recordsCsv(records));
  writeFileAtomically(files.page, wholePage("Lumivox voxelisers", {}, body, library, kVoxelScript));
}

}  // namespace lumivox
