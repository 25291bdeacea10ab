// SPIR-V as GLSL text, for devices without SPIR-V.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lumivox::shader {

/// GLSL 4.50 by SPIRV-Cross; specialisation constants are macros SPIRV_CROSS_CONSTANT_ID_n. Error with the
/// reason if there is no such text.
std::string glslOf(const std::vector<std::uint32_t>& spirv);

}  // namespace lumivox::shader
