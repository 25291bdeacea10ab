#pragma once

#include "lumivox/pipeline/port.h"
#include "lumivox/scene/capture.h"

namespace lumivox::captured_frames {

/// Frames of a depth camera on the device, one per layer, the newest first.
struct CapturedFrames {
  gpu::TextureRef colour, depth, rays;
  gpu::BufferRef poses;
  int count = 0;
  CaptureCamera camera;
  std::vector<CaptureState> states;  ///< of the layers
};

}  // namespace lumivox::captured_frames

namespace lumivox {

template <>
struct PortTraits<captured_frames::CapturedFrames> {
  static PortKind kind() {
    return {
        "CapturedFrames",
        "frames of a depth camera, the newest first",
        {{"colour", "d2Array rgba32f, a layer a frame",
          "linear radiance, W/(sr m^2); w 0 where it is not known, 2 where the file's range ends, else 1"},
         {"depth", "d2Array r32f", "m along the view axis; 0 in holes"},
         {"rays", "d2 rgba32f",
          "xy of the ray (x, y, 1) through the middle of a pixel, x right and y down; z the area of the pixel in "
          "the plane of depth 1, 0 where the distortion has no inverse",
          PortResource::Sign::any},
         {"poses", "buffer", "array of CapturedPose in shaders/captured_frames/camera.glsl"}}};
  }
  static void contents(const captured_frames::CapturedFrames& port, PortContents& contents) {
    contents.texture("colour", port.colour);
    contents.texture("depth", port.depth);
    contents.texture("rays", port.rays);
    contents.buffer("poses", port.poses);
  }
};

}  // namespace lumivox
