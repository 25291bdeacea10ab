// Requirements on a device beyond an OpenGL 4.5 core context: docs/gpu.md.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace lumivox::gpu {

struct Requirement {
  unsigned int limit;  ///< as glGetInteger64v takes it, or glGetInteger64i_v with an index
  int index;           ///< negative: the limit is one number
  const char* name;    ///< with its index in brackets
  std::int64_t least;
  std::int64_t promised;  ///< the minimum of every OpenGL 4.5 device (tables 23.53 to 23.74)
  const char* why;
};
std::span<const Requirement> requirements();

/// A line such as "GL_MAX_... is 0, and 8 are needed: why" for every limit that is too low; empty if none is.
std::string unmetRequirements(const std::function<std::int64_t(const Requirement&)>& valueOf);

}  // namespace lumivox::gpu
