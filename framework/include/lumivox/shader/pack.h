// A pack: all compiled variants of one technique's shaders in one file, `<technique>.shaderpack`, beside its library.
// Written by tools/shaderpack, read here; no OpenGL.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lumivox/base/hash.h"
#include "lumivox/gpu/device.h"
#include "lumivox/shader/slots.h"

namespace lumivox::shader {

struct Axis {
  std::string name;                 ///< as in the shader, e.g. "GLOSSY"
  std::vector<std::string> values;  ///< value i is defined as i; named values are defined as macros too
};

struct PackedStage {
  gpu::Stage stage;
  std::size_t code = 0;             ///< index into ShaderPack::codes
};

/// One reachable combination of axis values.
struct PackedVariant {
  std::vector<int> values;          ///< per axis
  std::vector<PackedStage> stages;
  std::vector<std::uint32_t> bindingsUsed;  ///< see PackedProgram::bindings: indices of those that this variant reads or writes
};

enum class BindingKind { sampled, image, storage, uniform };

struct PackedBinding {
  std::string name;
  BindingKind kind;
  std::uint32_t binding;
};

struct PackedProgram {
  std::string name;                 ///< stem of the entry files
  std::vector<Axis> axes;
  std::vector<PackedBinding> bindings;
  std::vector<PackedVariant> variants;
  std::size_t possible = 0;         ///< size of the full product of the axes, before constraints
};

/// Code shared by all variants whose SPIR-V is the same.
struct PackedCode {
  ContentHash hash;
  std::vector<std::uint32_t> spirv;
  std::string glsl;                 ///< GLSL 4.50 by SPIRV-Cross from `spirv`; specialisation constants as SPIRV_CROSS_CONSTANT_ID_n macros
};

struct ShaderPack {
  std::string technique;
  ContentHash hash;                 ///< of everything in it
  std::vector<PackedProgram> programs;
  std::vector<PackedCode> codes;

  const PackedProgram& program(const std::string& name) const;  ///< Error listing the names otherwise
};

/// Error naming the file when it is missing, truncated, of another version, or its checksum is wrong.
ShaderPack readShaderPack(const std::filesystem::path& path);
void writeShaderPack(const std::filesystem::path& path, const ShaderPack& pack);

}  // namespace lumivox::shader
