// The memory of passes across frames: results that are kept, and histories.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>

#include "lumivox/pipeline/pass.h"

namespace lumivox {

/// Memory of all passes, by name. A run of a pass lies between begin() and end(). Its histories become
/// visible to the next frame when the frame is committed.
class PassMemory {
 public:
  PassContext::Kept& kept(const std::string& pass, const std::string& what);
  /// The history of this frame: the given `current`, and what the previous frame left under the label.
  History<gpu::TextureRef> history(const std::string& pass, const std::string& label,
                                   gpu::TextureRef current);
  History<gpu::BufferRef> history(const std::string& pass, const std::string& label, gpu::BufferRef current);

  void beginRun(const std::string& pass);
  /// Releases kept results that this run did not request.
  void endRun(const std::string& pass);
  /// Passes the histories of this frame on to the next.
  void commitFrame();
  /// Drops the histories of this frame, which failed or is rendered again.
  void abandonFrame();

  void forgetKept();                         ///< of all passes
  void forgetKept(const std::string& pass);  ///< of one
  void forgetHistories();

 private:
  struct OfPass {
    std::map<std::string, PassContext::Kept> kept;
    std::set<std::string> asked;  ///< kept results requested in this run
    std::map<std::string, gpu::TextureRef> textures, nextTextures;
    std::map<std::string, gpu::BufferRef> buffers, nextBuffers;
  };
  std::map<std::string, OfPass> passes_;
};

}  // namespace lumivox
