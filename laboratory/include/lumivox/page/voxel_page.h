// The page of the voxelizers, with CSV and JSON beside it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lumivox/results/report_record.h"
#include "lumivox/results/voxelizers.h"

namespace lumivox {

/// Writes `folder`/index.html, voxels.csv and voxels.json. Error (before any work: requireWritable) when one
/// cannot be written.
struct VoxelizerFiles {
  std::filesystem::path page, csv, json;
};
VoxelizerFiles voxelizerFiles(const std::filesystem::path& folder);
void writeVoxelizers(const VoxelizerFiles& files, const std::vector<VoxelizerRecord>& records,
                     const gpu::DeviceInfo& device, const std::string& commandLine);
/// The JSON alone.
std::string voxelizersJson(const std::vector<VoxelizerRecord>& records, const gpu::DeviceInfo& device,
                           const std::string& commandLine);

}  // namespace lumivox
