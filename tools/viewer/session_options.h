// The initial settings of a session.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lumivox/gpu/device.h"
#include "lumivox/scene/scene.h"

namespace lumivox::viewer {

struct SessionOptions {
  std::filesystem::path scene;
  std::vector<std::filesystem::path> pipelines;  ///< empty: all committed ones that suit the scene
  std::vector<std::string> settings;             ///< "name=value" of the first pipeline
  std::string camera;
  double time = 0.0;
  std::uint64_t seed = 1;     ///< of the random numbers of techniques
  int width = 0, height = 0;  ///< 0: the camera's
  std::vector<std::filesystem::path> techniques;
  bool strict = false;  ///< Error if a library of the first pipelines cannot be used
  SceneLoadOptions sceneLoad;
  gpu::DeviceOptions device;
};

}  // namespace lumivox::viewer
