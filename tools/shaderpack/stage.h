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
  std::string type;  ///< in C++: "float", "glm::vec3", or the name of a nested struct
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
  /// Per binding: of the array of open length at the end of a storage block, from one element to the next.
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

  /// Of everything that the artifact depends on, the compiler included.
  ContentHash key() const;
};

/// Before the first compile of the process.
void startCompiler();
/// Throws Error with "file:line: error: ..." lines.
Artifact compileStage(const StageSource& source);

/// Reflection: fills everything but code and warnings. `declared` is the module as compiled, `optimised` what
/// is left of it.
void reflect(const std::vector<std::uint32_t>& declared, const std::vector<std::uint32_t>& optimised,
             const StageSource& source, Artifact& artifact);

/// Matrix products, normalize and asin as sums and products in one order; see lower.cpp.
std::vector<std::uint32_t> lowerToPlainArithmetic(const std::vector<std::uint32_t>& words);

/// Throws Error where a fragment shader needs derivatives, or samples with a mip level that follows from
/// them, after a discard.
void requireDerivativesBeforeDiscard(const std::vector<std::uint32_t>& words, const StageSource& source);

/// For the cache. Nothing comes back for bytes that are not a whole artifact.
std::string serialise(const Artifact& artifact);
std::optional<Artifact> deserialise(std::string_view bytes);

}  // namespace lumivox::shaderpack
