// The records of voxelizers as a page, JSON and CSV.
#include "lumivox/page/voxel_page.h"

#include <limits>

#include "base/file_set.h"
#include "lumivox/analysis/scaling.h"
#include "lumivox/results/csv.h"
#include "lumivox/results/json.h"
#include "page/document.h"
#include "page/voxel_json.h"
#include "page_assets.h"

namespace lumivox::page {

using Json = nlohmann::ordered_json;

Json scalingJson(const std::vector<VoxelizerRecord>& records) {
  Json list = Json::array();
  for (const VoxelizerScaling& scaling : scalingOf(records)) {
    Json one = {{"scene", scaling.scene}, {"label", scaling.label}};
    if (scaling.withResolution) one["with_resolution"] = *scaling.withResolution;
    if (scaling.withTriangles) one["with_triangles"] = *scaling.withTriangles;
    list.push_back(std::move(one));
  }
  return list;
}

namespace {

/// What it shares with runs is called as in theirs: results/csv.h.
std::string recordsCsv(const std::vector<VoxelizerRecord>& records, const gpu::DeviceInfo& device) {
  CsvTable table;
  for (const VoxelizerRecord& record : records) {
    table.beginRow();
    table.add("scene", record.scene);
    table.add("pipeline", record.pipeline);
    table.add("default", record.isDefault);
    table.add("device", device.renderer);
    table.add("driver", device.version);
    table.add("frame_ms", record.frameMs);
    table.add("repeats", static_cast<std::uint64_t>(record.frameMs.repeats));
    table.add("failure", record.whyNot);
    table.add("output", record.output);
    table.add("label", record.label());
    table.add("resolution", record.resolution);
    table.add("triangles", std::uint64_t{record.triangles});
    table.add("subdivisions", record.subdivisions);
    const auto number = [&](const char* column, double value) {
      table.add(column, record.whyNot.empty() ? value : std::numeric_limits<double>::quiet_NaN());
    };
    number("fragments", static_cast<double>(record.fragments));
    number("occupied", static_cast<double>(record.occupied));
    number("reference", static_cast<double>(record.reference));
    number("undecided", static_cast<double>(record.undecided));
    number("recall", record.error.recall());
    number("precision", record.error.precision());
    number("axis_holes", record.holes.axisShare());
    number("oblique_holes", record.holes.obliqueShare());
    number("bytes", static_cast<double>(record.bytes));
    number("allocated_bytes", static_cast<double>(record.allocatedBytes));
    for (const auto& [name, value] : record.parameters) table.addParameter(name, value.text());
  }
  return table.text();
}

}  // namespace
}  // namespace lumivox::page

namespace lumivox {

VoxelizerFiles voxelizerFiles(const std::filesystem::path& folder) {
  return {folder / "index.html", folder / "voxels.csv", folder / "voxels.json"};
}

std::string voxelizersJson(const std::vector<VoxelizerRecord>& records, const gpu::DeviceInfo& device,
                           const std::string& commandLine) {
  return textOf({{"command", commandLine},
                 {"device", device.renderer},
                 {"driver", device.version},
                 {"software", device.software},
                 {"records", toJson(records)},
                 {"scaling", page::scalingJson(records)}},
                1) +
         "\n";
}

void writeVoxelizers(const VoxelizerFiles& files, const std::vector<VoxelizerRecord>& records,
                     const gpu::DeviceInfo& device, const std::string& commandLine) {
  page::Document document;
  document.title = "Lumivox voxelizers";
  document.data = {{"command", commandLine},
                   {"device", device.renderer},
                   {"voxels", toJson(records)},
                   {"scaling", page::scalingJson(records)}};
  document.charts = true;
  document.scripts = {page::assets::kVoxelsJs, page::assets::kVoxelsPageJs};
  const std::string html = page::html(document), json = voxelizersJson(records, device, commandLine),
                    csv = page::recordsCsv(records, device);
  writeFilesAtomically(std::vector<NewFile>{{files.json, json}, {files.csv, csv}, {files.page, html}});
}

}  // namespace lumivox
