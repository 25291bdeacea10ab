#include "viewer/private_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "lumivox/base/error.h"

namespace lumivox::viewer {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrefix = "lumivox_view_";

/// Whether it is a folder, not a link, that belongs to this user and that nobody else may enter.
bool isOurs(const struct stat& is) {
  return S_ISDIR(is.st_mode) && is.st_uid == geteuid() && (is.st_mode & (S_IRWXG | S_IRWXO)) == 0;
}

int opened(const fs::path& folder) {
  return open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

/// Whether the path still names the open folder.
bool isStill(int folder, const fs::path& path) {
  struct stat open {
  }, named{};
  return fstat(folder, &open) == 0 && lstat(path.c_str(), &named) == 0 && isOurs(named) &&
         open.st_dev == named.st_dev && open.st_ino == named.st_ino;
}

/// Throws if another user could replace files in the folder: anyone who may write into a folder without the
/// sticky bit may rename all files in it.
void requireKept(const fs::path& folder) {
  struct stat is {};
  if (stat(folder.c_str(), &is) != 0)
    throw Error(fmt::format("{}, the folder of temporary files: {}", folder.string(), std::strerror(errno)));
  const bool othersWrite = (is.st_mode & (S_IWGRP | S_IWOTH)) != 0;
  if ((othersWrite && (is.st_mode & S_ISVTX) == 0) || (is.st_uid != geteuid() && is.st_uid != 0))
    throw Error(
        fmt::format("{}: others may exchange what lies there, and libraries would be opened from it; "
                    "expected a folder of temporary files of this user alone, or a sticky one (chmod +t)",
                    folder.string()));
}

/// Removes the folders of processes that ended without doing so: their locks ended with them.
void removeLeftBehind() {
  std::error_code failed;
  const fs::path among = fs::temp_directory_path(failed);
  if (failed) return;
  std::vector<fs::path> found;
  for (fs::directory_iterator at(among, failed), end; !failed && at != end; at.increment(failed))
    if (at->path().filename().string().starts_with(kPrefix)) found.push_back(at->path());
  for (const fs::path& path : found) {
    const int folder = opened(path);
    if (folder < 0) continue;
    if (isStill(folder, path) && flock(folder, LOCK_EX | LOCK_NB) == 0) fs::remove_all(path, failed);
    close(folder);
  }
}

}  // namespace

PrivateFolder::PrivateFolder() {
  removeLeftBehind();
}

PrivateFolder::~PrivateFolder() {
  remove();
}

void PrivateFolder::make() {
  const fs::path among = fs::temp_directory_path();
  requireKept(among);
  constexpr int kTries = 16;
  for (int i = 0; i < kTries; ++i) {
    std::string name = (among / (std::string(kPrefix) + "XXXXXX")).string();
    if (mkdtemp(name.data()) == nullptr)
      throw Error(fmt::format("{}: no folder can be made there for changed techniques, {}", among.string(),
                              std::strerror(errno)));
    // Until it is locked, another process that starts may take it for an abandoned one and remove it.
    const int folder = opened(name);
    if (folder >= 0 && flock(folder, LOCK_EX | LOCK_NB) == 0 && isStill(folder, name)) {
      path_ = name;
      lock_ = folder;
      return;
    }
    if (folder >= 0) close(folder);
  }
  throw Error(fmt::format("{}: no folder for changed techniques stays there", among.string()));
}

bool PrivateFolder::isSound() const {
  return !path_.empty() && isStill(lock_, path_);
}

const fs::path& PrivateFolder::path() {
  if (!isSound()) {
    remove();
    make();
  }
  return path_;
}

void PrivateFolder::remove() {
  if (path_.empty()) return;
  std::error_code ignored;
  if (isSound()) fs::remove_all(path_, ignored);
  close(lock_);
  path_.clear();
  lock_ = -1;
}

}  // namespace lumivox::viewer
