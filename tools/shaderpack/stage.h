// One stage of one variant: from expanded source to optimised SPIR-V, GLSL text and the interface that
// reflection finds.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lumivox/base/hash.h"
#include "lumivox/shader/pack.h"
#include "source.h"

namespace lumivox::shaderpack {

/// A member of a std140 block or of a struct in one.
struct Member {
  std::string name;
  std::string type;  ///< as in C++: "float", "glm::vec3", or the name of a nested struct
  std::uint32_t offset = 0;
  std::uint32_t alignment = 4;    ///< std140
  std::uint32_t arrayLength = 0;  ///< 0: no array
  bool operator==(const Member&) const = default;
};

struct StructLayout {
  std::string name;
  std::uint32_t size = 0;
  std::vector<Member> members;
  bool operator==(const StructLayout&) const = default;
};

/// A variable between two stages, one entry per location.
struct StageVariable {
  std::uint32_t location = 0;
  std::string type, name;
};

struct Artifact {
  std::vector<std::uint32_t> spirv;
  std::vector<shader::PackedBinding> bindings;  ///< as declared
  std::vector<std::string>
      layouts;  ///< per binding: offsets and types of a block's members; empty for textures
  /// Per binding: the stride in bytes of the unsized array that ends a storage block.
  std::vector<std::uint32_t> elementBytes;
  std::vector<std::uint8_t> used;     ///< per binding: still there after optimisation
  std::vector<StructLayout> structs;  ///< of uniform blocks; nested ones before those that hold them
  std::vector<shader::PackedConstant> constants;
  std::vector<StageVariable> inputs, outputs;  ///< inputs: those still read after optimisation
  std::vector<std::uint32_t>
      groupSize;  ///< of a compute shader: x, y, z; 0 where a specialisation constant sets it
  std::string warnings;
};

/// The source of a stage.
struct StageSource {
  const ExpandedSource* source = nullptr;
  gpu::Stage stage{};
  std::string definitions;  ///< #define lines
  std::string variant;      ///< for messages: "TEXTURES=1"

  /// Hash of everything that the artifact depends on, including the compiler.
  ContentHash key() const;
};

/// Call it before the first compileStage() of the process.
void startCompiler();
/// Throws Error with "file:line: error: ..." lines.
Artifact compileStage(const StageSource& source);

/// Reflection: fills everything but code and warnings. `declared` is the module as compiled, `optimised` the
/// module after optimisation.
void reflect(const std::vector<std::uint32_t>& declared, const std::vector<std::uint32_t>& optimised,
             const StageSource& source, Artifact& artifact);

/// Replaces matrix products, normalize and asin by sums and products in a fixed order; see lower.cpp.
std::vector<std::uint32_t> lowerToPlainArithmetic(const std::vector<std::uint32_t>& words);

/// Throws Error if a fragment shader computes derivatives after a discard, or samples with a mip level that
/// depends on them.
void requireDerivativesBeforeDiscard(const std::vector<std::uint32_t>& words, const StageSource& source);

/// For the cache. Bytes that are not a complete artifact give no result.
std::string serialise(const Artifact& artifact);
std::optional<Artifact> deserialise(std::string_view bytes);

}  // namespace lumivox::shaderpack
