#include "shader/glsl.h"

#include <fmt/format.h>

#include <spirv_cross/spirv_glsl.hpp>

#include "lumivox/base/error.h"
#include "lumivox/shader/pack.h"

namespace lumivox::shader {

std::string glslOf(const std::vector<std::uint32_t>& spirv) {
  try {
    spirv_cross::CompilerGLSL compiler(spirv);
    spirv_cross::CompilerGLSL::Options options;
    options.version = 450;
    options.es = false;
    options.separate_shader_objects = false;
    compiler.set_common_options(options);
    return compiler.compile();
  } catch (const spirv_cross::CompilerError& error) {
    throw Error(fmt::format("SPIRV-Cross cannot write the SPIR-V as GLSL: {}", error.what()));
  }
}

// In a file of its own, so that the compiler of packs does not link SPIRV-Cross for it.
std::string PackedCode::glsl() const {
  return glslOf(spirv());
}

}  // namespace lumivox::shader
