// Files that somebody may change while they are shown.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <vector>

namespace lumivox::viewer {

/// Compares what the file system says of a file when asked: works on every file system. A file that is
/// replaced is seen by its number, since a kernel's clock stands still for milliseconds at a time, and a new
/// file may be as long as the old one.
class Watch {
 public:
  /// From now on these files, as they are now where they are new to the watch.
  void set(const std::set<std::filesystem::path>& files);
  /// Those that changed, came or went since the last call.
  std::vector<std::filesystem::path> changed();

 private:
  struct Stamp {
    bool there = false;
    std::int64_t modified = 0;  // nanoseconds
    std::int64_t changed = 0;   // of the file or of what stands about it, nanoseconds
    std::uintmax_t size = 0;
    dev_t device = 0;
    ino_t number = 0;
    bool operator==(const Stamp&) const = default;
  };
  static Stamp stampOf(const std::filesystem::path& file);
  std::map<std::filesystem::path, Stamp> files_;
};

}  // namespace lumivox::viewer
