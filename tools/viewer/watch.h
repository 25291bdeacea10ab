// Files that somebody may change while they are shown.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <vector>

namespace lumivox::viewer {

/// Compares times and sizes when asked: works on every file system, and sees files that are replaced.
class Watch {
 public:
  /// From now on these files, as they are now where they are new to the watch.
  void set(const std::set<std::filesystem::path>& files);
  /// Those that changed, came or went since the last call.
  std::vector<std::filesystem::path> changed();

 private:
  struct Stamp {
    std::filesystem::file_time_type time{};
    std::uintmax_t size = 0;
    bool there = false;
    bool operator==(const Stamp&) const = default;
  };
  static Stamp stampOf(const std::filesystem::path& file);
  std::map<std::filesystem::path, Stamp> files_;
};

}  // namespace lumivox::viewer
