// Memory of passes for later frames: results that are made once and kept, and histories.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>

#include "lumivox/pipeline/pass.h"

namespace lumivox {

/// Of all passes, by name. A run of a pass is between begin() and end(); what it left becomes what the next
/// frame finds when the frame is committed.
class PassMemory {
 public:
  PassContext::Kept& kept(const std::string& pass, const std::string& what);
  /// The histories of this frame: `current` as given, beside what the frame before left under the label.
  History<gpu::TextureRef> history(const std::string& pass, const std::string& label,
                                   gpu::TextureRef current);
  History<gpu::BufferRef> history(const std::string& pass, const std::string& label, gpu::BufferRef current);

  void beginRun(const std::string& pass);
  /// Gives back what was kept and this run did not ask for.
  void endRun(const std::string& pass);
  /// Hands what the frame left to the next one.
  void commitFrame();
  /// The frame is rendered again, or failed: what it left is forgotten.
  void abandonFrame();

  void forgetKept();                         ///< of all passes
  void forgetKept(const std::string& pass);  ///< of one
  void forgetHistories();

 private:
  struct OfPass {
    std::map<std::string, PassContext::Kept> kept;
    std::set<std::string> asked;  ///< of what is kept, in this run
    std::map<std::string, gpu::TextureRef> textures, nextTextures;
    std::map<std::string, gpu::BufferRef> buffers, nextBuffers;
  };
  std::map<std::string, OfPass> passes_;
};

}  // namespace lumivox
