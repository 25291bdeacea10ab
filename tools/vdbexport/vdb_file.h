// Writes OpenVDB files completely or not at all, and reads them with an error that states the defect.
#pragma once

#include <openvdb/openvdb.h>

#include <filesystem>
#include <string>
#include <vector>

namespace lumivox::vdb {

/// The file that holds these grids, compressed as well as this OpenVDB can. The same grids give the same
/// bytes: the file's unique tag, which OpenVDB takes from the clock, is made from the content.
std::string encode(const openvdb::GridCPtrVec& grids);

/// Writes a file beside the target, then renames it. Errors name the path.
void writeVdb(const std::filesystem::path& file, const openvdb::GridCPtrVec& grids);

/// All grids of a file, in its order. Error, naming the path, if the file is absent, is not an OpenVDB file
/// or is incomplete.
std::vector<openvdb::GridBase::Ptr> readVdb(const std::filesystem::path& file);

}  // namespace lumivox::vdb
