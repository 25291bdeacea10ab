// The cache of references: its entries, and their removal when they exceed a limit.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lumivox {

struct KeptReference {
  std::filesystem::path file;
  std::uint64_t sizeBytes = 0;
  std::chrono::system_clock::time_point used;     ///< when it was written or last taken
  std::map<std::string, std::string> attributes;  ///< as in renderReference; empty when they cannot be read
};

/// All in the cache directory, the last used first. `withAttributes` reads the heads of the files.
std::vector<KeptReference> keptReferences(bool withAttributes = true);

/// Limit on the size of all entries together: $LUMIVOX_CACHE_LIMIT (bytes, or as "500MiB"), else 4 GiB.
/// Error when it is not a size.
std::uint64_t referenceCacheLimit();

struct PrunedReferences {
  std::size_t removed = 0, kept = 0;
  std::uint64_t removedBytes = 0, keptBytes = 0;
};

/// Removes what was not used for `unusedFor`, then what was not used for longest until the rest takes no more
/// than `mostBytes`; and what interrupted processes left half-written. `dryRun` only counts.
PrunedReferences pruneReferences(std::uint64_t mostBytes,
                                 std::optional<std::chrono::seconds> unusedFor = std::nullopt,
                                 bool dryRun = false);

/// "500MiB", "2 GB", "1048576"; nothing when it is no size.
std::optional<std::uint64_t> parseBytes(std::string_view text);

}  // namespace lumivox
