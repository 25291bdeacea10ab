#include "gpu/requirements.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

namespace lumivox::gpu {
namespace {

#define LUMIVOX_REQUIREMENT(limit, least, why) \
  Requirement {                                \
    limit, #limit, least, why                  \
  }

// Resources that the committed techniques may use. OpenGL 4.5 (tables 23.55 to 23.72) promises less of
// storage buffers, of which a vertex shader may have none, and enough of the others.
constexpr Requirement kRequirements[] = {
    LUMIVOX_REQUIREMENT(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS, 16, "storage buffers bound at a time"),
    LUMIVOX_REQUIREMENT(GL_MAX_COMBINED_SHADER_STORAGE_BLOCKS, 16, "storage buffers of a program"),
    LUMIVOX_REQUIREMENT(GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS, 16, "storage buffers of a compute shader"),
    LUMIVOX_REQUIREMENT(GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS, 8, "vertices are read from storage buffers"),
    LUMIVOX_REQUIREMENT(GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS, 8, "voxelizers append to storage buffers"),
    LUMIVOX_REQUIREMENT(GL_MAX_FRAGMENT_IMAGE_UNIFORMS, 4, "voxelizers mark volumes"),
    LUMIVOX_REQUIREMENT(GL_MAX_COMPUTE_IMAGE_UNIFORMS, 8, "volumes written by a compute shader"),
    LUMIVOX_REQUIREMENT(GL_MAX_IMAGE_UNITS, 8, "volumes written at a time"),
    LUMIVOX_REQUIREMENT(GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS, 32, "textures read at a time"),
    LUMIVOX_REQUIREMENT(GL_MAX_COMPUTE_TEXTURE_IMAGE_UNITS, 16, "textures read by a compute shader"),
    LUMIVOX_REQUIREMENT(GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS, 512, "invocations of a work group"),
};

#undef LUMIVOX_REQUIREMENT

}  // namespace

std::span<const Requirement> requirements() {
  return kRequirements;
}

std::string unmetRequirements(const std::function<std::int64_t(const Requirement&)>& valueOf) {
  std::string unmet;
  for (const Requirement& one : kRequirements) {
    const std::int64_t value = valueOf(one);
    if (value < one.least)
      unmet += fmt::format("{}{} is {}, and {} are needed ({})", unmet.empty() ? "" : "\n", one.name, value,
                           one.least, one.why);
  }
  return unmet;
}

}  // namespace lumivox::gpu
