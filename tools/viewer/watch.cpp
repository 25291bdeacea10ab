#include "viewer/watch.h"

#include <system_error>

namespace lumivox::viewer {

Watch::Stamp Watch::stampOf(const std::filesystem::path& file) {
  Stamp stamp;
  std::error_code failed;
  stamp.time = std::filesystem::last_write_time(file, failed);
  if (failed) return {};
  stamp.size = std::filesystem::is_regular_file(file, failed) ? std::filesystem::file_size(file, failed) : 0;
  if (failed) return {};
  stamp.there = true;
  return stamp;
}

void Watch::set(const std::set<std::filesystem::path>& files) {
  std::erase_if(files_, [&](const auto& file) { return files.count(file.first) == 0; });
  for (const std::filesystem::path& file : files)
    if (files_.count(file) == 0) files_[file] = stampOf(file);
}

std::vector<std::filesystem::path> Watch::changed() {
  std::vector<std::filesystem::path> result;
  for (auto& [file, stamp] : files_) {
    const Stamp now = stampOf(file);
    if (now == stamp) continue;
    stamp = now;
    result.push_back(file);
  }
  return result;
}

}  // namespace lumivox::viewer
