// Draws the voxels of any port as a camera sees them: cubes with the values of a field, or lobes of spherical
// harmonics. They are drawn on the device that holds them.
#pragma once

#include <string>
#include <vector>

#include "lumivox/base/image.h"
#include "lumivox/pipeline/port.h"
#include "lumivox/scene/scene.h"
#include "lumivox/shader/library.h"

namespace lumivox::viewer {

/// An extra field of ports that have the harmonics Y00, Y1-1, Y10 and Y11: their sum, drawn as a lobe.
inline constexpr const char* kLobes = "lobes";

struct VoxelPicture {
  ImageBuffer values;      ///< of the visible voxels, one or three channels; 0 where there is none
  ImageBuffer brightness;  ///< of the drawn surface; 0 where no voxel is visible
  std::string quantity, unit;
  bool isDirection = false;
};

/// The names of a kind's fields that can be drawn, and kLobes; empty: none.
std::vector<std::string> drawnFields(const PortKind& kind);

/// Draws on a device; used on that device's thread only.
class VoxelView {
 public:
  explicit VoxelView(gpu::Device& device) : shaders_(device) {}

  /// A field at a level, by its name in the kind or in the value. Voxels are hidden if no value exceeds
  /// `above` in magnitude, and so is the voxel around the eye. Error for an absent field or level.
  VoxelPicture draw(const PortContents& contents, const std::string& field, int level, float above,
                    const CameraView& camera);

 private:
  shader::ShaderLibrary shaders_;
};

}  // namespace lumivox::viewer
