// SPIR-V as text, for a device that takes no SPIR-V.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lumivox::shader {

/// GLSL 4.50 by SPIRV-Cross; specialisation constants are SPIRV_CROSS_CONSTANT_ID_n macros. Error saying why
/// it cannot be written so.
std::string glslOf(const std::vector<std::uint32_t>& spirv);

}  // namespace lumivox::shader
