// Fields of ports, as their kinds declare them (pipeline/port.h), prepared for conversion to OpenVDB grids.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "lumivox/pipeline/pass.h"

namespace lumivox::vdb {

/// One quantity at one level of a port, which becomes one grid. Voxel (i,j,k) covers low + [i,i+1] x [j,j+1]
/// x [k,k+1] voxel sizes and has the index (i,j,k) in the grid.
struct Field {
  std::string name;           ///< "radiance"; unique in its port and level
  int level = 0;              ///< 0 is the finest
  std::string type;           ///< as OpenVDB calls it: "float", "vec3s", "bool", "int32"
  std::string quantity;       ///< what a value is
  std::string unit;           ///< "1" for a pure number
  glm::dvec3 low{0.0};        ///< corner of voxel (0,0,0), m, relative to the snapshot's origin
  glm::dvec3 voxelSize{1.0};  ///< m; differs between axes if a coarser level does not divide evenly
  glm::ivec3 resolution{0};
  std::uint64_t deviceBytes = 0;  ///< of the level's resources on the device; fields may share them
  openvdb::GridClass gridClass = openvdb::GRID_UNKNOWN;
  openvdb::VecType vectorType = openvdb::VEC_INVARIANT;
  openvdb::MetaMap constants;      ///< needed to interpret the values, such as a medium's extinction
  bool mediumDensity = false;      ///< viewers expect the grid name "density"
  PortContents::Field onDevice{};  ///< as the kind declares it
  /// Downloads and converts the values into a grid without transform and metadata. Call it once.
  std::function<openvdb::GridBase::Ptr()> values;
};

/// All fields at all levels of an output that has a value. Downloads nothing: Field::values does.
std::vector<Field> fieldsOf(const OutBase& output);

}  // namespace lumivox::vdb
