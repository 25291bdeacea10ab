// Puts a counter into every basic block of a SPIR-V module, and says what one pass through each block does.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "lumivox/gpu/device.h"
#include "lumivox/shader/work.h"

namespace lumivox::shader {

/// An access to a texture or image whose cost depends on what is bound.
struct TextureAccess {
  enum class Kind { sample, fetch, read, write };
  Kind kind = Kind::sample;
  std::uint32_t binding = 0;
  auto operator<=>(const TextureAccess&) const = default;
};

/// The work of one pass of one invocation through a block.
struct BlockWork {
  Work work;                               ///< the part that does not depend on bound resources
  std::map<TextureAccess, double> access;  ///< number of accesses
};

struct CountingCode {
  std::vector<std::uint32_t> spirv;
  std::vector<BlockWork> blocks;  ///< in the order of their counters
  double groupSize = 1.0;         ///< invocations of a work group
  std::size_t entry = 0;          ///< the block that every invocation starts with
};

/// Counter i is the words 2 i (low) and 2 i + 1 (high) from `firstCounter` on, in a storage buffer at
/// `binding`. Specialisation constants, bindings and results are unchanged. Error for SPIR-V of version 1.4
/// or later, in which a storage buffer is declared in another way.
CountingCode instrument(std::span<const std::uint32_t> spirv, std::uint32_t binding,
                        std::uint32_t firstCounter);

/// Bytes that the counters of so many blocks take.
constexpr std::uint64_t counterBytes(std::size_t blocks) {
  return 8 * static_cast<std::uint64_t>(blocks);
}

}  // namespace lumivox::shader
