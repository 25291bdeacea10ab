// Voxels of any port that holds some, as a camera sees them: cubes with the values of a field, or lobes of
// spherical harmonics. They are drawn by the device that made them.
#pragma once

#include <string>
#include <vector>

#include "lumivox/base/image.h"
#include "lumivox/pipeline/port.h"
#include "lumivox/scene/scene.h"
#include "lumivox/shader/library.h"

namespace lumivox::viewer {

/// Beside the fields of a port that has the harmonics Y00, Y1-1, Y10 and Y11: their sum, drawn as a lobe.
inline constexpr const char* kLobes = "lobes";

struct VoxelPicture {
  ImageBuffer values;      ///< of what is seen, one or three channels; 0 where nothing is
  ImageBuffer brightness;  ///< of its surface as it is drawn; 0 where no voxel is seen
  std::string quantity, unit;
  bool isDirection = false;
};

/// What can be drawn of a kind's values: its fields, and kLobes; empty: nothing.
std::vector<std::string> drawnFields(const PortKind& kind);

/// Draws on the device whose thread this is.
class VoxelView {
 public:
  explicit VoxelView(gpu::Device& device) : shaders_(device) {}

  /// A field at a level, by the name in the kind or in the value. Voxels whose values are all at most `above`
  /// from 0 are left out, and so is the one around the eye. Error for a field or level that is not there.
  VoxelPicture draw(const PortContents& contents, const std::string& field, int level, float above,
                    const CameraView& camera);

 private:
  shader::ShaderLibrary shaders_;
};

}  // namespace lumivox::viewer
