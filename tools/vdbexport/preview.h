// A first look at exported grids: maximum intensity projections along the three axes on one sheet.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/display_options.h"
#include "lumivox/base/image.h"
#include "lumivox/shader/library.h"
#include "vdbexport/export.h"

namespace lumivox::vdb {

/// Grids of one export, of all its frames.
class Preview {
 public:
  explicit Preview(gpu::Device& device) : shaders_(device) {}
  /// While the device holds the fields. `frame`: put before the grids' names; empty: there is only one.
  void add(const std::vector<NamedField>& fields, const std::string& frame);
  /// Radiance is exposed like every image that is displayed, all of it alike; the largest value of every
  /// other quantity (by the grid's name) is white. Error without any grid.
  void write(const std::filesystem::path& file, const command::DisplayOptions& display) const;

 private:
  struct Panel {
    std::string grid, name;
    bool radiance = false;
    ImageBuffer image;
  };
  shader::ShaderLibrary shaders_;
  std::vector<Panel> panels_;
  int columns_ = 0;
};

}  // namespace lumivox::vdb
