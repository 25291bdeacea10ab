// The records of voxelizers as a page, JSON and CSV.
#include "lumivox/page/voxel_page.h"

#include <fmt/format.h>

#include "lumivox/analysis/scaling.h"
#include "lumivox/base/file.h"
#include "lumivox/results/json.h"
#include "page/document.h"
#include "page/markup.h"
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

std::string recordsCsv(const std::vector<VoxelizerRecord>& records) {
  std::string csv =
      "scene,pipeline,output,label,resolution,triangles,subdivisions,median_ms,lower_quartile_ms,"
      "upper_quartile_ms,fragments,occupied,reference,undecided,recall,precision,axis_holes,oblique_holes,bytes,"
      "allocated_bytes,why_not\n";
  const auto quoted = [](const std::string& text) { return "\"" + replaced(text, "\"", "\"\"") + "\""; };
  for (const VoxelizerRecord& record : records) {
    csv += fmt::format("{},{},{},{},{},{},{},", quoted(record.scene), quoted(record.pipeline),
                       quoted(record.output), quoted(record.label()), record.resolution, record.triangles,
                       record.subdivisions);
    csv += record.whyNot.empty()
               ? fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},\n", record.frameMs.median,
                             record.frameMs.lowerQuartile, record.frameMs.upperQuartile, record.fragments,
                             record.occupied, record.reference, record.undecided, record.error.recall(),
                             record.error.precision(), record.holes.axisShare(), record.holes.obliqueShare(),
                             record.bytes, record.allocatedBytes)
               : std::string(13, ',') + quoted(record.whyNot) + "\n";
  }
  return csv;
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
  const std::string html = page::html(document);
  writeFileAtomically(files.json, voxelizersJson(records, device, commandLine));
  writeFileAtomically(files.csv, page::recordsCsv(records));
  writeFileAtomically(files.page, html);
}

}  // namespace lumivox
