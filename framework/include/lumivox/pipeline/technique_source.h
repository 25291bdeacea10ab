// Where the graph gets its passes from. The plugin loader is one such source; a test can be another.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lumivox/base/hash.h"
#include "lumivox/shader/pack.h"

namespace lumivox {

class Pass;

struct PassEntry {
  std::string name;
  std::string meaning;  ///< one line, with the paper and section
  std::function<std::unique_ptr<Pass>()> make;
};

struct Technique {
  std::string name;  ///< folder and library name: lib<name>.so, <name>.shaderpack beside it
  std::filesystem::path library;
  ContentHash hash;  ///< of the library file
  std::string meaning, paper;
  std::vector<PassEntry> passes;
  shader::ShaderPack shaders;  ///< empty when it has none
  const PassEntry* find(const std::string& pass) const;
};

struct SkippedTechnique {
  std::filesystem::path library;
  std::string reason;
};

class TechniqueSource {
 public:
  virtual ~TechniqueSource() = default;
  /// Opens it on first use. Null when absent or skipped; skipped() says why.
  virtual const Technique* technique(const std::string& name) = 0;
  /// Names of all techniques, opened or not.
  virtual std::vector<std::string> available() const = 0;
  virtual const std::vector<SkippedTechnique>& skipped() const = 0;
  /// Folders that it searches, in order; none where techniques come from no folder.
  virtual std::vector<std::filesystem::path> folders() const { return {}; }
};

}  // namespace lumivox
