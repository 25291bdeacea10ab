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

/// The largest files of each kind that are read, in bytes: far above useful sizes, far below the memory of a
/// machine.
inline constexpr std::uint64_t kLargestTextFile = std::uint64_t{64}
                                                  << 20;  ///< texts, materials, cards, shaders
inline constexpr std::uint64_t kLargestModelFile = std::uint64_t{4} << 30;    ///< OBJ, also when unpacked
inline constexpr std::uint64_t kLargestImageFile = std::uint64_t{1} << 30;    ///< PNG, JPG, TGA
inline constexpr std::uint64_t kLargestExrFile = std::uint64_t{4} << 30;      ///< many layers of floats
inline constexpr std::uint64_t kLargestVolumeFile = std::uint64_t{8} << 30;   ///< OpenVDB
inline constexpr std::uint64_t kLargestLibraryFile = std::uint64_t{1} << 30;  ///< techniques

/// The bytes of a file. All files are read by this function. Only regular files, or links to them: a
/// directory, a device, a FIFO or a socket is refused and never waited for. Throws Error naming the file when
/// it is missing, unreadable, none of those, larger than `limitBytes` or larger than the memory there is.
std::string readFile(const std::filesystem::path& path, std::uint64_t limitBytes = kLargestTextFile);

/// The first bytes of a file, at most `limitBytes`; refuses what readFile refuses, but no size.
std::string readFileStart(const std::filesystem::path& path, std::uint64_t limitBytes);

/// So many bytes from `offset` on. Refuses what readFile refuses, but no size; Error where the file ends
/// before.
std::string readFilePart(const std::filesystem::path& path, std::uint64_t offset, std::uint64_t bytes);

/// Error when the name exists and is not a regular file: for libraries that open files by themselves.
void requireRegularFile(const std::filesystem::path& path);

/// Whether this process has read the file, under this name or another one (by device and inode), with one of
/// the functions above or a library that they allowed to open it. A file that the process has written since
/// does not count.
bool wasRead(const std::filesystem::path& path);

/// As readFile, but unpacks gzip (RFC 1952) when the name ends in ".gz"; the limit holds for the unpacked
/// size. A truncated or corrupt stream is an Error.
std::string readFileMaybeGzip(const std::filesystem::path& path, std::uint64_t limitBytes);

/// Writes beside the target (an unnamed file where the file system can) and renames, so that a reader sees
/// the old or the new file, never half of one; a file that is replaced hands on its permissions. A symbolic
/// link is followed: the file that it names, present or not, is written and the link stays. What is no file
/// but takes bytes (/dev/null, /dev/stdout, a terminal, a FIFO that somebody reads) is written through.
/// Throws Error naming the path, also for a directory, a block device or a socket. Creates no directories.
void writeFileAtomically(const std::filesystem::path& path, std::span<const std::byte> bytes);
void writeFileAtomically(const std::filesystem::path& path, std::string_view text);

/// Refuses a file name that writeFileAtomically could not write to, and creates its parent directories:
/// before work whose result would be lost. Makes a file beside it, and removes it.
void requireWritable(const std::filesystem::path& file);

/// Creates the parent directories of a file that is about to be written; Error when that fails.
void createParentDirectories(const std::filesystem::path& file);

/// Bytes that this process can still take: the least of what the machine has available, what its control
/// groups (cgroup v1 and v2) leave, and what RLIMIT_AS leaves. The largest number where the system does not
/// tell.
std::uint64_t availableMemory();

/// Refuses (Error naming `what`, the bytes needed and the bytes available) when `bytes` do not fit into the
/// memory that is available now. Call it before a large allocation.
void requireMemory(std::uint64_t bytes, std::string_view what);

/// "1.5 MiB"
std::string formatBytes(std::uint64_t bytes);

/// Where references are kept: $LUMIVOX_CACHE, else $XDG_CACHE_HOME/lumivox, else ~/.cache/lumivox, else a
/// folder of this user beside other temporary files. Created on first use, for this user alone (mode 0700).
/// The last is refused (Error) unless it belongs to this user: anybody may make a folder there, under any
/// name.
std::filesystem::path cacheDirectory();

}  // namespace lumivox
