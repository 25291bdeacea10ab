// OpenVDB files as bytes: written whole or not at all, read with an error that says what is wrong.
#pragma once

#include <openvdb/openvdb.h>

#include <filesystem>
#include <string>
#include <vector>

namespace lumivox::vdb {

/// The file that holds these grids, compressed as well as this OpenVDB can. The same grids give the same
/// bytes: the file's unique tag, which OpenVDB takes from the clock, is made from the content.
std::string encode(const openvdb::GridCPtrVec& grids);

/// Writes beside the target and renames. Error naming the path.
void writeVdb(const std::filesystem::path& file, const openvdb::GridCPtrVec& grids);

/// All grids of a file in its order. Error naming the path when it is absent, no OpenVDB file or not whole.
std::vector<openvdb::GridBase::Ptr> readVdb(const std::filesystem::path& file);

}  // namespace lumivox::vdb
