// Watches files for changes.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <vector>

namespace lumivox::viewer {

/// Compares each file's status when asked, which works on every file system. A replaced file is recognised by
/// its inode number: the kernel's timestamps advance only every few milliseconds, and the new file may have
/// the same size.
class Watch {
 public:
  /// Watches these files from now on; changes of a new one count from this call.
  void set(const std::set<std::filesystem::path>& files);
  /// The files that were changed, created or removed since the last call.
  std::vector<std::filesystem::path> changed();

 private:
  struct Stamp {
    bool there = false;
    std::int64_t modified = 0;  // nanoseconds
    std::int64_t changed = 0;   // of the content or the inode, nanoseconds
    std::uintmax_t size = 0;
    dev_t device = 0;
    ino_t number = 0;
    bool operator==(const Stamp&) const = default;
  };
  static Stamp stampOf(const std::filesystem::path& file);
  std::map<std::filesystem::path, Stamp> files_;
};

}  // namespace lumivox::viewer
