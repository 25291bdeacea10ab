#include "gpu/requirements.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

namespace lumivox::gpu {
namespace {

#define LUMIVOX_REQUIREMENT(limit, least, promised, why) \
  Requirement {                                          \
    limit, -1, #limit, least, promised, why              \
  }
#define LUMIVOX_REQUIREMENT_ALONG(limit, axis, least, promised, why) \
  Requirement {                                                      \
    limit, axis, #limit "[" #axis "]", least, promised, why          \
  }

// Every limit that the committed shaders depend on or come near to, with some reserve; a test reads their
// needs from the packs. OpenGL 4.5 promises fewer storage buffers and written resources.
constexpr Requirement kRequirements[] = {
    LUMIVOX_REQUIREMENT(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS, 16, 8, "storage buffers bound at a time"),
    LUMIVOX_REQUIREMENT(GL_MAX_COMBINED_SHADER_STORAGE_BLOCKS, 16, 8, "storage buffers of a program"),
    LUMIVOX_REQUIREMENT(GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS, 16, 8, "storage buffers of a compute shader"),
    LUMIVOX_REQUIREMENT(GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS, 8, 0, "vertices are read from storage buffers"),
    LUMIVOX_REQUIREMENT(GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS, 8, 8, "voxelizers append to storage buffers"),
    LUMIVOX_REQUIREMENT(GL_MAX_COMBINED_SHADER_OUTPUT_RESOURCES, 16, 8,
                        "storage buffers, images and targets of a program together"),
    LUMIVOX_REQUIREMENT(GL_MAX_FRAGMENT_IMAGE_UNIFORMS, 4, 8, "voxelizers mark volumes"),
    LUMIVOX_REQUIREMENT(GL_MAX_COMPUTE_IMAGE_UNIFORMS, 8, 8, "volumes written by a compute shader"),
    LUMIVOX_REQUIREMENT(GL_MAX_COMBINED_IMAGE_UNIFORMS, 8, 8, "volumes written by a program"),
    LUMIVOX_REQUIREMENT(GL_MAX_IMAGE_UNITS, 8, 8, "volumes written at a time"),
    LUMIVOX_REQUIREMENT(GL_MAX_DRAW_BUFFERS, 8, 8, "targets of a draw"),
    LUMIVOX_REQUIREMENT(GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS, 32, 96, "textures read at a time"),
    LUMIVOX_REQUIREMENT(GL_MAX_VERTEX_TEXTURE_IMAGE_UNITS, 16, 16, "textures read by a vertex shader"),
    LUMIVOX_REQUIREMENT(GL_MAX_TEXTURE_IMAGE_UNITS, 16, 16, "textures read by a fragment shader"),
    LUMIVOX_REQUIREMENT(GL_MAX_COMPUTE_TEXTURE_IMAGE_UNITS, 16, 16, "textures read by a compute shader"),
    LUMIVOX_REQUIREMENT(GL_MAX_UNIFORM_BUFFER_BINDINGS, 36, 84, "uniform blocks bound at a time"),
    LUMIVOX_REQUIREMENT(GL_MAX_COMBINED_UNIFORM_BLOCKS, 24, 70, "uniform blocks of a program"),
    LUMIVOX_REQUIREMENT(GL_MAX_VERTEX_UNIFORM_BLOCKS, 12, 14, "uniform blocks of a vertex shader"),
    LUMIVOX_REQUIREMENT(GL_MAX_FRAGMENT_UNIFORM_BLOCKS, 12, 14, "uniform blocks of a fragment shader"),
    LUMIVOX_REQUIREMENT(GL_MAX_COMPUTE_UNIFORM_BLOCKS, 12, 14, "uniform blocks of a compute shader"),
    LUMIVOX_REQUIREMENT(GL_MAX_UNIFORM_BLOCK_SIZE, 16384, 16384, "bytes of a uniform block"),
    LUMIVOX_REQUIREMENT(GL_MAX_VERTEX_OUTPUT_COMPONENTS, 64, 64, "numbers that a vertex shader hands on"),
    LUMIVOX_REQUIREMENT(GL_MAX_FRAGMENT_INPUT_COMPONENTS, 64, 128,
                        "numbers that a fragment shader is handed"),
    LUMIVOX_REQUIREMENT(GL_MAX_VARYING_VECTORS, 15, 15, "vectors that a stage hands to the next one"),
    LUMIVOX_REQUIREMENT(GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS, 512, 1024, "invocations of a work group"),
    LUMIVOX_REQUIREMENT_ALONG(GL_MAX_COMPUTE_WORK_GROUP_SIZE, 0, 512, 1024,
                              "invocations of a work group along x"),
    LUMIVOX_REQUIREMENT_ALONG(GL_MAX_COMPUTE_WORK_GROUP_SIZE, 1, 512, 1024,
                              "invocations of a work group along y"),
    LUMIVOX_REQUIREMENT_ALONG(GL_MAX_COMPUTE_WORK_GROUP_SIZE, 2, 64, 64,
                              "invocations of a work group along z"),
    LUMIVOX_REQUIREMENT(GL_MAX_COMPUTE_SHARED_MEMORY_SIZE, 32768, 32768, "bytes that a work group shares"),
};

#undef LUMIVOX_REQUIREMENT_ALONG
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
