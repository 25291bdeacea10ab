// Helpers for the tests of exported grids: reading as other programs do, and grids with known content.
#pragma once

#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include <filesystem>
#include <map>
#include <string>

#include "support/support.h"

namespace lumivox::test {

using Grids = std::map<std::string, openvdb::GridBase::Ptr>;

/// As any other program reads it: by OpenVDB's own reader, not ours.
inline Grids readByOpenVdb(const std::filesystem::path& file) {
  openvdb::initialize();
  openvdb::io::File stream(file.string());
  stream.open(/*delayLoad=*/false);
  Grids grids;
  const openvdb::GridPtrVecPtr all = stream.getGrids();
  for (const auto& grid : *all) grids[grid->getName()] = grid;
  return grids;
}

inline std::string metaText(const openvdb::GridBase& grid, const std::string& name) {
  const auto value = grid[name];
  return value ? value->str() : "(none)";
}

inline bool hasProgram(const std::string& name) {
  return runCommand("command -v " + name).exitCode == 0;
}

template <class GridType>
typename GridType::Ptr gridWithVoxels(double size, const openvdb::Vec3d& lowCorner) {
  openvdb::initialize();
  auto grid = GridType::create();
  // As exported grids lie: the index is the voxel's centre.
  grid->setTransform(std::make_shared<openvdb::math::Transform>(openvdb::math::MapBase::Ptr(
      new openvdb::math::UniformScaleTranslateMap(size, lowCorner + openvdb::Vec3d(0.5 * size)))));
  grid->setName("grid");
  return grid;
}

/// A box of voxels with values that grow along x, in steps that a float holds exactly.
inline openvdb::FloatGrid::Ptr ramp(int voxels, double size, double perMetre) {
  auto grid = gridWithVoxels<openvdb::FloatGrid>(size, openvdb::Vec3d(0.0));
  for (int z = 0; z < voxels; ++z)
    for (int y = 0; y < voxels; ++y)
      for (int x = 0; x < voxels; ++x)
        grid->tree().setValue({x, y, z}, static_cast<float>(perMetre * (x + 0.5) * size));
  return grid;
}

}  // namespace lumivox::test
