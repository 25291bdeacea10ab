// A pack: all compiled variants of one technique's shaders in one file, `<technique>.shaderpack`, beside its
// library. Written by tools/shaderpack, read here; no OpenGL.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lumivox/base/compressed.h"
#include "lumivox/base/hash.h"
#include "lumivox/gpu/device.h"
#include "lumivox/shader/slots.h"

namespace lumivox::shader {

/// Of the files; packs of another version are refused.
constexpr std::uint32_t kPackVersion = 4;

/// An axis by which a variant is chosen. The macro of the axis holds the number itself where the values are
/// numbers, and 0, 1, 2... where they are words; then every word has a macro of its own too: axis LIGHT with
/// value spot gives LIGHT_SPOT.
struct Axis {
  std::string name;                 ///< as in the shader, e.g. "GLOSSY"
  std::vector<std::string> values;  ///< in the order of declaration; the first is the default
  bool named = false;               ///< the values are words

  /// The macro of the axis for value `index`.
  int value(std::size_t index) const;
  /// The word or number for what the macro is.
  std::string text(int value) const;
};

struct PackedStage {
  gpu::Stage stage;
  std::size_t code = 0;  ///< index into ShaderPack::codes
};

/// One reachable combination of axis values.
struct PackedVariant {
  std::vector<int> values;  ///< per axis, what its macro is
  std::vector<PackedStage> stages;
  std::vector<std::uint32_t>
      bindingsUsed;  ///< see PackedProgram::bindings: indices of those that this variant reads or writes
};

enum class BindingKind { sampled, image, storage, uniform };

const char* name(BindingKind kind);

struct PackedBinding {
  std::string name;
  BindingKind kind = BindingKind::sampled;
  std::uint32_t binding = 0;
  std::string type;  ///< as in GLSL: "sampler2DArrayShadow", "image3D r32ui", or the block's name
  gpu::TextureKind textureKind = gpu::TextureKind::d2;  ///< of sampled textures and images
  bool shadow = false;                                  ///< a sampled texture that compares depth
  std::optional<gpu::Format> format;                    ///< of images
  std::uint64_t minimumBytes = 0;  ///< of blocks: without the array of open length at their end
};

enum class ConstantType { boolean, integer, unsignedInteger, real };

struct PackedConstant {
  std::string name;
  std::uint32_t id = 0;
  ConstantType type = ConstantType::integer;
  std::uint32_t defaultBits = 0;
};

struct PackedProgram {
  std::string name;  ///< stem of the entry files
  std::vector<Axis> axes;
  std::vector<PackedBinding> bindings;  ///< an image whose format follows an axis is there once per format
  std::vector<PackedConstant> constants;
  std::vector<PackedVariant> variants;
  std::size_t possible = 0;  ///< size of the full product of the axes, before constraints

  /// Null when the constraints of the shader exclude this combination.
  const PackedVariant* find(VariantKey key) const;
  /// "GLOSSY=1 LIGHT=spot"
  std::string text(const std::vector<int>& values) const;
};

/// Code shared by all variants whose SPIR-V is the same. Codes are compressed together, since variants of a
/// program are much alike; who uses one expands its block.
struct PackedCode {
  ContentHash hash;                         ///< of the SPIR-V
  std::shared_ptr<const Compressed> block;  ///< shared with the codes beside it
  std::uint64_t first = 0, bytes = 0;       ///< the SPIR-V's place in the expanded block

  std::vector<std::uint32_t> spirv() const;
  /// GLSL 4.50 by SPIRV-Cross from the SPIR-V, for devices that take no SPIR-V; specialisation constants are
  /// SPIRV_CROSS_CONSTANT_ID_n macros. Made anew at each call.
  std::string glsl() const;
};

struct PlainCode {
  ContentHash hash;
  std::span<const std::uint32_t> spirv;
};
/// Compresses codes in this order, those of one program beside each other.
std::vector<PackedCode> compressed(const std::vector<PlainCode>& codes);

struct ShaderPack {
  std::string technique;
  ContentHash hash;  ///< of everything in it
  std::vector<PackedProgram> programs;
  std::vector<PackedCode> codes;

  const PackedProgram& program(const std::string& name) const;  ///< Error listing the names otherwise
};

/// Error naming the file when it is missing, truncated, of another version, or its checksum is wrong.
ShaderPack readShaderPack(const std::filesystem::path& path);
void writeShaderPack(const std::filesystem::path& path, const ShaderPack& pack);

}  // namespace lumivox::shader
