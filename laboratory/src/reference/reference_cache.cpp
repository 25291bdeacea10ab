#include "lumivox/reference/reference_cache.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/image.h"
#include "reference/cache.h"

namespace lumivox {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::system_clock;

constexpr std::string_view kPrefix = "reference-", kSuffix = ".exr";
constexpr std::size_t kHashDigits = 32;

bool isEntry(const std::string& name) {
  return name.size() == kPrefix.size() + kHashDigits + kSuffix.size() && name.starts_with(kPrefix) &&
         name.ends_with(kSuffix);
}

/// Whether this is a temporary name of writeFileAtomically.
bool isHalfWritten(const std::string& name) {
  return name.starts_with(fmt::format(".{}", kPrefix)) && name.ends_with(".new");
}

Clock::time_point timeOf(const timespec& time) {
  return Clock::time_point(std::chrono::duration_cast<Clock::duration>(
      std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec)));
}

/// Calls visit(file, status) for the regular files of the cache directory.
template <class Visit>
void forEachFile(Visit&& visit) {
  std::error_code failure;
  for (fs::directory_iterator entry(cacheDirectory(), failure), end; !failure && entry != end;
       entry.increment(failure)) {
    struct stat status {};
    if (lstat(entry->path().c_str(), &status) == 0 && S_ISREG(status.st_mode)) visit(entry->path(), status);
  }
}

void removeHalfWritten(Clock::time_point now) {
  constexpr std::chrono::hours kSurelyAbandoned{24};
  forEachFile([&](const fs::path& file, const struct stat& status) {
    std::error_code ignored;
    if (isHalfWritten(file.filename().string()) && now - timeOf(status.st_mtim) > kSurelyAbandoned)
      fs::remove(file, ignored);
  });
}

}  // namespace

namespace reference {

std::string entryName(const ContentHash& key) {
  return fmt::format("{}{}{}", kPrefix, key.text(), kSuffix);
}

void markAsUsed(const fs::path& file) {
  // Sets the time of modification, since any reader changes that of access. If it cannot be set, the entry
  // only looks older.
  const timespec times[2] = {{0, UTIME_OMIT}, {0, UTIME_NOW}};
  utimensat(AT_FDCWD, file.c_str(), times, AT_SYMLINK_NOFOLLOW);
}

}  // namespace reference

std::vector<KeptReference> keptReferences(bool withAttributes) {
  std::vector<KeptReference> kept;
  forEachFile([&](const fs::path& file, const struct stat& status) {
    if (!isEntry(file.filename().string())) return;
    KeptReference entry;
    entry.file = file;
    entry.sizeBytes = static_cast<std::uint64_t>(status.st_size);
    entry.used = timeOf(status.st_mtim);
    if (withAttributes) {
      try {
        entry.attributes = readExrAttributes(file);
      } catch (const Error&) {
        // A damaged entry is listed without attributes, and rendered again when it is requested.
      }
    }
    kept.push_back(std::move(entry));
  });
  std::sort(kept.begin(), kept.end(), [](const KeptReference& a, const KeptReference& b) {
    return a.used != b.used ? a.used > b.used : a.file < b.file;
  });
  return kept;
}

std::optional<std::uint64_t> parseBytes(std::string_view text) {
  const auto isBlank = [](char c) { return c == ' '; };
  double number = 0.0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
  if (result.ec != std::errc() || !std::isfinite(number) || number < 0.0) return std::nullopt;
  std::string unit;
  for (const char* c = result.ptr; c != text.data() + text.size(); ++c)
    if (!isBlank(*c)) unit += static_cast<char>(std::tolower(static_cast<unsigned char>(*c)));
  constexpr std::string_view kPowers = "kmgt";
  double factor = 1.0;
  if (!unit.empty() && unit != "b") {
    const std::size_t power = kPowers.find(unit.front());
    const std::string_view rest = std::string_view(unit).substr(1);
    if (power == std::string_view::npos || (rest != "" && rest != "b" && rest != "ib")) return std::nullopt;
    factor = std::pow(rest == "b" ? 1000.0 : 1024.0, static_cast<double>(power + 1));
  }
  constexpr double kMost = 0x1.0p62;
  return number * factor > kMost ? std::nullopt : std::optional(static_cast<std::uint64_t>(number * factor));
}

std::uint64_t referenceCacheLimit() {
  constexpr std::uint64_t kDefault = std::uint64_t{4} << 30;
  const char* given = std::getenv("LUMIVOX_CACHE_LIMIT");
  if (given == nullptr || *given == '\0') return kDefault;
  if (const auto bytes = parseBytes(given)) return *bytes;
  throw Error(fmt::format("LUMIVOX_CACHE_LIMIT is '{}'; expected a size such as 500MiB or 4GiB", given));
}

PrunedReferences pruneReferences(std::uint64_t mostBytes, std::optional<std::chrono::seconds> unusedFor,
                                 bool dryRun) {
  const Clock::time_point now = Clock::now();
  if (!dryRun) removeHalfWritten(now);
  PrunedReferences result;
  bool full = false;
  for (const KeptReference& entry : keptReferences(/*withAttributes=*/false)) {
    // An entry above the limit by itself is removed alone.
    const bool tooLarge = entry.sizeBytes > mostBytes;
    full = full || (!tooLarge && result.keptBytes + entry.sizeBytes > mostBytes);
    if (!full && !tooLarge && !(unusedFor && now - entry.used > *unusedFor)) {
      ++result.kept;
      result.keptBytes += entry.sizeBytes;
      continue;
    }
    std::error_code failure;
    if (!dryRun && !fs::remove(entry.file, failure) && failure)
      throw Error(fmt::format("{}: cannot be removed: {}", entry.file.string(), failure.message()));
    ++result.removed;
    result.removedBytes += entry.sizeBytes;
  }
  return result;
}

}  // namespace lumivox
