// A first look at exported grids: maximum intensity projections along the three axes on one sheet.
#pragma once

#include <openvdb/openvdb.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/display_options.h"
#include "lumivox/base/image.h"

namespace lumivox::vdb {

/// The largest value along x, y and z of a grid's active voxels; red, green and blue of vectors by their
/// magnitudes, else grey. Along x the view has z to the left, along z it has x to the right, both with y up;
/// along y, from above, it has z downwards. All black of an empty grid. Error for another type than float,
/// vec3s, bool or int32.
std::vector<ImageBuffer> projections(const openvdb::GridBase& grid);

/// Grids of one export, of all its frames.
class Preview {
 public:
  /// `frame`: put before the grids' names; empty: there is only one.
  void add(const std::vector<openvdb::GridBase::ConstPtr>& grids, const std::string& frame);
  /// Radiance is exposed like every image that is displayed, all of it alike; the largest value of every
  /// other quantity (by the grid's name) is white. Error without any grid.
  void write(const std::filesystem::path& file, const command::DisplayOptions& display) const;

 private:
  struct Panel {
    std::string grid, name;
    bool radiance = false;
    ImageBuffer image;
  };
  std::vector<Panel> panels_;
  int columns_ = 0;
};

}  // namespace lumivox::vdb
