// What a port holds as an image: a slice of a texture, or voxels in the view of the camera.
#pragma once

#include <functional>
#include <string>

#include "lumivox/base/image.h"
#include "lumivox/pipeline/port.h"
#include "viewer/channel.h"
#include "viewer/voxel_view.h"

namespace lumivox::viewer {

/// An output of a pass that is looked at although no image needs it.
struct PortChoice {
  std::string pass, port;
  std::string texture;  ///< a resource of the port's kind; empty: its first texture
  std::string field;    ///< a field of its voxels, or kLobes, in place of a texture; empty: where it has none
  int level = 0, slice = 0;
  Channel channel = Channel::colour;
  float above = 0.0f;  ///< of voxels: those not above it are left out
  bool operator==(const PortChoice&) const = default;
};

struct PortPicture {
  ImageBuffer image;       ///< values as the port has them
  ImageBuffer brightness;  ///< of voxels: VoxelPicture::brightness; empty: a texture
  std::string shown, quantity, unit;
  bool isDirection = false;
  int levels = 1, slices = 1;  ///< that could be shown
};

/// `view` is called for voxels alone. Error for what the port does not have.
PortPicture pictureOfPort(const PortContents& contents, const PortChoice& choice, const CameraView& camera,
                          const std::function<VoxelView&()>& view);

/// A level and a slice of a texture as an image. Integers are shown as numbers. Error for one that has no
/// such level, slice or component.
ImageBuffer sliceOf(const gpu::Texture& texture, int level, int slice, Channel channel = Channel::colour);

}  // namespace lumivox::viewer
