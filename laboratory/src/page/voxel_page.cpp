// The records of voxelizers as a page, JSON and CSV.
#include "lumivox/page/voxel_page.h"

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
                    csv = voxelizersCsv(records, device);
  writeFilesAtomically(std::vector<NewFile>{{files.json, json}, {files.csv, csv}, {files.page, html}});
}

}  // namespace lumivox
