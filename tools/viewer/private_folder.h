// A temporary folder that no other user can read, write or replace, since the program opens libraries from
// it.
#pragma once

#include <filesystem>

namespace lumivox::viewer {

/// Made on first use as `lumivox_view_XXXXXX`, with unpredictable letters and access for its owner alone;
/// removed by the destructor. It is locked while its process lives, so that the next process of the same user
/// can remove the folder of one that was killed.
class PrivateFolder {
 public:
  /// Removes folders of processes that are gone.
  PrivateFolder();
  ~PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  /// The folder, which is made anew if it is absent or is no longer the one that was made. Error if that
  /// fails, or if other users may replace files in the system's temporary folder.
  const std::filesystem::path& path();
  /// Whether the folder still exists under its name, for this user alone.
  bool isSound() const;
  void remove();

 private:
  void make();

  std::filesystem::path path_;  ///< empty: none was made
  int lock_ = -1;
};

}  // namespace lumivox::viewer
