// Opens technique libraries. A library whose file does not fit is never opened: it is skipped and reported
// with its path and the reason; the others still load.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "lumivox/base/hash.h"
#include "lumivox/pipeline/technique_source.h"
#include "lumivox/shader/pack.h"

namespace lumivox {

class TechniqueSet : public TechniqueSource {
 public:
  /// Looks for lib<name>.so in `directories` in order; opens nothing yet. `strict`: a library that does not
  /// fit is an Error where it would be skipped.
  explicit TechniqueSet(std::vector<std::filesystem::path> directories, bool strict = false);
  ~TechniqueSet() override;

  /// The default directories: --techniques, then $LUMIVOX_TECHNIQUES, then `techniques` beside the running
  /// program's library.
  static std::vector<std::filesystem::path> defaultDirectories(
      const std::vector<std::filesystem::path>& given = {});

  /// Opens it on first use. Null when absent or skipped; skipped() says why.
  const Technique* technique(const std::string& name) override;
  /// Names of all libraries in the directories, opened or not.
  std::vector<std::string> available() const override;
  const std::vector<SkippedTechnique>& skipped() const override;
  std::vector<std::filesystem::path> folders() const override;
  /// Names of those that were opened.
  std::vector<std::string> opened() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lumivox
