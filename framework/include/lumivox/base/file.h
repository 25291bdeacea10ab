// Reading and writing whole files. Nothing half-written ever has the final name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lumivox {

/// The bytes of a file. Throws Error naming the file when it is missing, unreadable, a directory or larger
/// than `limitBytes`.
std::string readFile(const std::filesystem::path& path, std::uint64_t limitBytes = std::uint64_t{4} << 30);

/// As readFile, but unpacks gzip (RFC 1952) when the name ends in ".gz"; the limit holds for the unpacked
/// size. A truncated or corrupt stream is an Error.
std::string readFileMaybeGzip(const std::filesystem::path& path,
                              std::uint64_t limitBytes = std::uint64_t{4} << 30);

/// Writes beside the target (an unnamed file where the file system can) and renames, so that a reader sees
/// the old or the new file, never half of one. Throws Error naming the path. Creates no directories.
void writeFileAtomically(const std::filesystem::path& path, std::span<const std::byte> bytes);
void writeFileAtomically(const std::filesystem::path& path, std::string_view text);

/// Creates the parent directories of a file that is about to be written; Error when that fails.
void createParentDirectories(const std::filesystem::path& file);

/// Bytes that this machine has available now; the largest number where the system does not tell.
std::uint64_t availableMemory();

/// Refuses (Error naming `what`, the bytes needed and the bytes available) when `bytes` do not fit into the
/// memory that this machine has available now. Call it before a large allocation.
void requireMemory(std::uint64_t bytes, std::string_view what);

/// "1.5 MiB"
std::string formatBytes(std::uint64_t bytes);

/// Where cached truths are kept: $LUMIVOX_CACHE, else $XDG_CACHE_HOME/lumivox, else ~/.cache/lumivox. Created
/// on first use.
std::filesystem::path cacheDirectory();

}  // namespace lumivox
