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

/// The grids of one export, over all its frames.
class Preview {
 public:
  explicit Preview(gpu::Device& device) : shaders_(device) {}
  /// Call it while the device holds the fields. `frame` is put before the grids' names; empty if there is
  /// only one frame.
  void add(const std::vector<NamedField>& fields, const std::string& frame);
  /// All radiance is displayed with the same exposure. Of every other grid, by name, the largest value is
  /// white. Error without any grid.
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
