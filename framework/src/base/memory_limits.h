// How much memory is left, of the machine and within the limits that somebody set. availableMemory() in
// lumivox/base/file.h is the least of all.
#pragma once

#include <cstdint>
#include <filesystem>

namespace lumivox {

/// Where nothing limits, or the system does not tell.
inline constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};

/// Bytes that the machine has left, and the control groups (cgroup v1 and v2) of this process and those
/// around them: what all its processes share. `root`: where /proc and the mounts of control groups are; tests
/// have their own.
std::uint64_t sharedMemoryLeft(const std::filesystem::path& root = "/");

/// Bytes that this process may still map (RLIMIT_AS).
std::uint64_t addressSpaceLeft();

}  // namespace lumivox
