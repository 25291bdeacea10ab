// The contents of a port as an image: a slice of a texture, or voxels as the camera sees them.
#pragma once

#include <functional>
#include <string>

#include "lumivox/base/image.h"
#include "lumivox/pipeline/port.h"
#include "viewer/channel.h"
#include "viewer/voxel_view.h"

namespace lumivox::viewer {

/// The output of a pass that is shown, even if no image needs it.
struct PortChoice {
  std::string pass, port;
  std::string texture;  ///< a texture among the kind's resources; empty: the first
  std::string field;    ///< of its voxels, or kLobes; empty: `texture`, else the first field
  int level = 0, slice = 0;
  Channel channel = Channel::colour;
  float above = 0.0f;  ///< voxels with values not above it are hidden
  bool operator==(const PortChoice&) const = default;
};

struct PortPicture {
  ImageBuffer image;       ///< values of the port
  ImageBuffer brightness;  ///< VoxelPicture::brightness; empty for a texture
  std::string shown, quantity, unit;
  bool isDirection = false;
  int levels = 1, slices = 1;  ///< numbers of those that can be shown
};

/// `view` is called only for voxels. Error for a texture, field or level that the port does not have.
PortPicture pictureOfPort(const PortContents& contents, const PortChoice& choice, const CameraView& camera,
                          const std::function<VoxelView&()>& view);

/// A level and a slice of a texture as an image. Integers are converted to floats. Error if the texture has
/// no such level, slice or component.
ImageBuffer sliceOf(const gpu::Texture& texture, int level, int slice, Channel channel = Channel::colour);

}  // namespace lumivox::viewer
