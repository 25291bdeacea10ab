// The page of the voxelisers, with CSV and JSON beside it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lumivox/results/report_record.h"
#include "lumivox/results/voxelisers.h"

namespace lumivox {

/// Writes `folder`/index.html, voxels.csv and voxels.json. Error (before any work: requireWritable) when one
/// cannot be written.
struct VoxeliserFiles {
  std::filesystem::path page, csv, json;
};
VoxeliserFiles voxeliserFiles(const std::filesystem::path& folder);
void writeVoxelisers(const VoxeliserFiles& files, const std::vector<VoxeliserRecord>& records,
                     const gpu::DeviceInfo& device, const std::string& commandLine);
/// The JSON alone.
std::string voxelisersJson(const std::vector<VoxeliserRecord>& records, const gpu::DeviceInfo& device,
                           const std::string& commandLine);

}  // namespace lumivox
