#include "base/memory_limits.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "lumivox/base/file.h"

namespace lumivox {
namespace {

namespace fs = std::filesystem;

/// The remainder of a limit.
std::uint64_t left(std::uint64_t limit, std::uint64_t used) {
  return limit > used ? limit - used : 0;
}

/// The whole number at the start of a text; nothing for "max" and everything else.
std::optional<std::uint64_t> numberIn(const std::string& text) {
  std::uint64_t number = 0;
  if (std::from_chars(text.data(), text.data() + text.size(), number).ec != std::errc{}) return std::nullopt;
  return number;
}

std::optional<std::uint64_t> numberOf(const fs::path& file) {
  std::string word;
  std::ifstream(file) >> word;
  return numberIn(word);
}

/// The number in a line "name value" or "name: value kB" of a file.
std::optional<std::uint64_t> numberOf(const fs::path& file, const std::string& name) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line);
    std::string word, value;
    words >> word >> value;
    if (word == name) return numberIn(value);
  }
  return std::nullopt;
}

/// Names of the files of a version of control groups.
struct GroupFiles {
  const char *limit, *used, *reclaimable;  ///< `reclaimable`: a line of memory.stat
};
constexpr GroupFiles kFirst{"memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"},
    kSecond{"memory.max", "memory.current", "inactive_file"};

std::uint64_t leftInGroup(const fs::path& group, const GroupFiles& files) {
  const auto limit = numberOf(group / files.limit), used = numberOf(group / files.used);
  if (!limit || !used) return kNoLimit;
  // The kernel drops cached files before it refuses memory, so they count as available, as in MemAvailable.
  const std::uint64_t cached = numberOf(group / "memory.stat", files.reclaimable).value_or(0);
  return left(*limit, left(*used, cached));
}

/// The least remainder of the group and its parents, up to the mounted one.
std::uint64_t leftInGroups(const fs::path& mounted, const fs::path& group, const GroupFiles& files) {
  std::uint64_t least = leftInGroup(mounted, files);
  fs::path one = mounted;
  for (const fs::path& name : group) least = std::min(least, leftInGroup(one /= name, files));
  return least;
}

std::vector<std::string> wordsOf(const std::string& text, char separator) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, separator);) words.push_back(word);
  return words;
}

bool hasMemory(const std::string& controllers) {
  const std::vector<std::string> all = wordsOf(controllers, ',');
  return std::find(all.begin(), all.end(), "memory") != all.end();
}

/// cgroups(7): lines "4:memory:/a/b" of /proc/self/cgroup, "0::/a/b" for version 2.
std::optional<fs::path> ownGroup(const fs::path& root, bool second) {
  std::ifstream stream(root / "proc/self/cgroup");
  for (std::string line; std::getline(stream, line);) {
    const std::size_t first = line.find(':'), last = line.find(':', first + 1);
    if (first == std::string::npos || last == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, last - first - 1);
    if (second ? controllers.empty() && line.substr(0, first) == "0" : hasMemory(controllers))
      return fs::path(line.substr(last + 1));
  }
  return std::nullopt;
}

/// The path of a group relative to a mount that shows the hierarchy from `from` on. A group outside of it, as
/// in a container, is the mounted one.
fs::path below(const fs::path& group, const fs::path& from) {
  const fs::path relative = group.lexically_relative(from);
  return relative.empty() || *relative.begin() == ".." || relative == "." ? fs::path() : relative;
}

/// proc(5): "31 23 0:28 /from /mount options ... - type source options" of /proc/self/mountinfo.
std::uint64_t leftInControlGroups(const fs::path& root) {
  std::uint64_t least = kNoLimit;
  std::ifstream stream(root / "proc/self/mountinfo");
  for (std::string line; std::getline(stream, line);) {
    const std::size_t dash = line.find(" - ");
    if (dash == std::string::npos) continue;
    const std::vector<std::string> head = wordsOf(line, ' '), tail = wordsOf(line.substr(dash + 3), ' ');
    if (head.size() < 5 || tail.size() < 3) continue;
    const bool second = tail[0] == "cgroup2";
    if (!second && (tail[0] != "cgroup" || !hasMemory(tail[2]))) continue;
    if (const auto group = ownGroup(root, second))
      least = std::min(least, leftInGroups(root / fs::path(head[4]).relative_path(), below(*group, head[3]),
                                           second ? kSecond : kFirst));
  }
  return least;
}

}  // namespace

std::uint64_t sharedMemoryLeft(const fs::path& root) {
  const auto kibibytes = numberOf(root / "proc/meminfo", "MemAvailable:");
  return std::min(kibibytes ? *kibibytes * 1024 : kNoLimit, leftInControlGroups(root));
}

std::uint64_t addressSpaceLeft() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kNoLimit;
  // proc(5): the first number of statm is the size in pages.
  const auto pages = numberOf("/proc/self/statm");
  if (!pages) return kNoLimit;
  return left(limit.rlim_cur, *pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)));
}

std::uint64_t availableMemory() {
  return std::min(sharedMemoryLeft(), addressSpaceLeft());
}

}  // namespace lumivox
