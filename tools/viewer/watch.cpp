#include "viewer/watch.h"

#include <sys/stat.h>

namespace lumivox::viewer {

Watch::Stamp Watch::stampOf(const std::filesystem::path& file) {
  struct stat found {};
  if (stat(file.c_str(), &found) != 0) return {};
  const auto nanoseconds = [](const timespec& time) { return time.tv_sec * 1'000'000'000LL + time.tv_nsec; };
  return {true,
          nanoseconds(found.st_mtim),
          nanoseconds(found.st_ctim),
          static_cast<std::uintmax_t>(found.st_size),
          found.st_dev,
          found.st_ino};
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
