// A folder among temporary files that no other user can read, write or put in place of ours: libraries are
// opened from it.
#pragma once

#include <filesystem>

namespace lumivox::viewer {

/// Made when it is first asked for, as `lumivox_view_XXXXXX` with letters that nobody can guess and for its
/// owner alone, and removed at the end. While its process lives it is locked; what a process left that was
/// killed is removed by the next one of the same user.
class PrivateFolder {
 public:
  /// Removes folders of processes that are gone.
  PrivateFolder();
  ~PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  /// Makes it where there is none, or no longer the one that was made. Error when it cannot, or when others
  /// may exchange what lies in the folder of temporary files.
  const std::filesystem::path& path();
  /// Whether the folder that was made is still there under its name, and its user's alone.
  bool isSound() const;
  void remove();

 private:
  void make();

  std::filesystem::path path_;  ///< empty: none was made
  int lock_ = -1;
};

}  // namespace lumivox::viewer
