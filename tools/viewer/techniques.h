// Reloads techniques that change while they are shown. It watches libraries and shader packs, and compiles
// changed shaders in the background. Loaded libraries stay loaded; a changed technique is opened in addition,
// from a folder of its own.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "viewer/latest_worker.h"
#include "viewer/private_folder.h"
#include "viewer/watch.h"

namespace lumivox::viewer {

struct CompileWish {
  std::string technique;
  std::filesystem::path source, includes, common, cache, pack, header;
};
struct Compiled {
  CompileWish wish;
  std::string error;  ///< the compiler's message; empty: the pack was written
};

class LiveTechniques {
 public:
  /// `directories`: the folders with technique libraries. `wake` is called when a compilation has ended.
  LiveTechniques(std::vector<std::filesystem::path> directories, std::function<void()> wake);
  ~LiveTechniques();
  LiveTechniques(const LiveTechniques&) = delete;
  LiveTechniques& operator=(const LiveTechniques&) = delete;

  /// Watches these techniques from now on.
  void use(const std::set<std::string>& techniques);
  /// The directories, those of changed techniques first.
  const std::vector<std::filesystem::path>& directories() const { return directories_; }
  /// Checks the files and the compiler. Returns whether directories() or errors() changed.
  bool update();
  /// Treats all files as changed.
  void reload();
  /// The compiler's errors by technique; each is removed when the shader compiles.
  const std::map<std::string, std::string>& errors() const { return errors_; }
  bool compiles() const { return compiler_.busy(); }
  void stop() { compiler_.stop(); }
  /// Removes the staged files of changed techniques, which only this process uses.
  void removeFiles() { folder_.remove(); }

 private:
  std::filesystem::path libraryOf(const std::string& technique) const;
  /// Adds a folder with the technique's library and a pack in front of the other directories.
  void stage(const std::string& technique, const std::filesystem::path& pack);
  void compile(const std::string& technique);
  void changed(const std::string& technique, bool shaders);
  /// Drops all staged techniques if their folder was removed or replaced. Returns whether it did.
  bool dropLost();

  std::vector<std::filesystem::path> given_, directories_;
  PrivateFolder folder_;  ///< of staged techniques
  int stages_ = 0;
  std::set<std::string> used_, waiting_;
  Watch watch_;
  std::map<std::filesystem::path, std::pair<std::string, bool>>
      files_;  ///< technique, whether it is a shader
  std::map<std::string, std::string> errors_;
  std::map<std::string, std::filesystem::path> staged_;  ///< by technique
  LatestWorker<CompileWish, Compiled> compiler_;
};

}  // namespace lumivox::viewer
