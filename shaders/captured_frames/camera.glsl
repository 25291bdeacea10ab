// The depth camera of captured frames. C++ side: techniques/captured_frames/lights.cpp, framework/include/lumivox/scene/capture.h.
#ifndef LUMIVOX_CAPTURE_CAMERA
#define LUMIVOX_CAPTURE_CAMERA
#include "distortion.glsl"

// Where a frame was taken: x right, y down, z forward.
struct CapturedPose {
  vec4 eye;  // posWorld
  vec4 right, down, forward;
};

const int kNoiseKinect = 0, kNoiseShare = 1;  // in the order of the parameter `noise`

layout(std140, binding = 1) uniform CaptureCamera {
  vec2 focal, centre;  // pixels; (0, 0) is the middle of the upper left pixel
  vec4 radial;         // k1, k2, k3
  vec2 tangential;     // p1, p2
  int noise;
  float noiseShare;    // of the depth
};

// Standard deviation of a depth, m. Kinect: Nguyen, Izadi and Lovell 2012, the axial noise of surfaces that face the camera.
float depthDeviation(float depth) {
  if (noise == kNoiseShare) return noiseShare * depth;
  float beyond = depth - 0.4;
  return 0.0012 + 0.0019 * beyond * beyond;
}

#endif
