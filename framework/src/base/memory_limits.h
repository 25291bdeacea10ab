// The memory left on the machine and within limits of control groups and the process. availableMemory() in
// lumivox/base/file.h is the minimum.
#pragma once

#include <cstdint>
#include <filesystem>

namespace lumivox {

/// Without a limit, or if the system does not tell it.
inline constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};

/// The least of the machine's free bytes and the remainders of this process's control groups (cgroup v1 and
/// v2) and their parents. `root`: the folder of /proc and of the control group mounts; tests use their own.
std::uint64_t sharedMemoryLeft(const std::filesystem::path& root = "/");

/// Bytes that this process may still map (RLIMIT_AS).
std::uint64_t addressSpaceLeft();

}  // namespace lumivox
