// Techniques that are changed while they are shown: libraries and shader packs are watched, shaders compiled
// anew in the background. What is loaded stays as it is; a changed technique is opened beside it from a
// folder of its own.
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
  std::string error;  ///< the compiler's words; empty: the pack is there
};

class LiveTechniques {
 public:
  /// `directories`: where techniques are sought. `wake` is called when a compilation has ended.
  LiveTechniques(std::vector<std::filesystem::path> directories, std::function<void()> wake);
  ~LiveTechniques();
  LiveTechniques(const LiveTechniques&) = delete;
  LiveTechniques& operator=(const LiveTechniques&) = delete;

  /// Watches these techniques from now on.
  void use(const std::set<std::string>& techniques);
  /// The directories, those of changed techniques first.
  const std::vector<std::filesystem::path>& directories() const { return directories_; }
  /// Looks at the files and at what was compiled. Whether directories() changed or a message did.
  bool update();
  /// As if all files had changed.
  void reload();
  /// What the compiler found wrong, by technique; goes away when it is mended.
  const std::map<std::string, std::string>& errors() const { return errors_; }
  bool compiles() const { return compiler_.busy(); }
  void stop() { compiler_.stop(); }
  /// Those of changed techniques, which are of this process alone.
  void removeFiles() { folder_.remove(); }

 private:
  std::filesystem::path libraryOf(const std::string& technique) const;
  /// A new folder with the technique's library and a pack, in front of the others.
  void stage(const std::string& technique, const std::filesystem::path& pack);
  void compile(const std::string& technique);
  void changed(const std::string& technique, bool shaders);
  /// Whether staged techniques had to be given up, because their folder is no longer what was made.
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
