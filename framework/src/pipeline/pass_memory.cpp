#include "pipeline/pass_memory.h"

#include <fmt/format.h>

#include "lumivox/base/error.h"

namespace lumivox {

namespace {

bool sameShape(const gpu::Texture& a, const gpu::Texture& b) {
  return a.description() == b.description();
}
bool sameShape(const gpu::Buffer& a, const gpu::Buffer& b) {
  return a.sizeBytes() == b.sizeBytes();
}

template <class Resource>
History<Resource> historyOf(const std::map<std::string, Resource>& before,
                            std::map<std::string, Resource>& next, const std::string& label,
                            Resource current) {
  if (!next.emplace(label, current).second)
    throw Error(fmt::format("it asks for the history '{}' twice in one frame", label));
  const auto found = before.find(label);
  const bool fits = found != before.end() && sameShape(*found->second, *current);
  return {fits ? found->second : nullptr, std::move(current)};
}

}  // namespace

PassContext::Kept& PassMemory::kept(const std::string& pass, const std::string& what) {
  OfPass& memory = passes_[pass];
  memory.asked.insert(what);
  return memory.kept[what];
}

History<gpu::TextureRef> PassMemory::history(const std::string& pass, const std::string& label,
                                             gpu::TextureRef current) {
  OfPass& memory = passes_[pass];
  return historyOf(memory.textures, memory.nextTextures, label, std::move(current));
}

History<gpu::BufferRef> PassMemory::history(const std::string& pass, const std::string& label,
                                            gpu::BufferRef current) {
  OfPass& memory = passes_[pass];
  return historyOf(memory.buffers, memory.nextBuffers, label, std::move(current));
}

void PassMemory::beginRun(const std::string& pass) {
  passes_[pass].asked.clear();
}

void PassMemory::endRun(const std::string& pass) {
  OfPass& memory = passes_[pass];
  std::erase_if(memory.kept, [&](const auto& one) { return !memory.asked.contains(one.first); });
}

void PassMemory::commitFrame() {
  for (auto& [pass, memory] : passes_) {
    memory.textures = std::exchange(memory.nextTextures, {});
    memory.buffers = std::exchange(memory.nextBuffers, {});
  }
}

void PassMemory::abandonFrame() {
  for (auto& [pass, memory] : passes_) {
    memory.nextTextures.clear();
    memory.nextBuffers.clear();
  }
}

void PassMemory::forgetKept() {
  for (auto& [pass, memory] : passes_) memory.kept.clear();
}

void PassMemory::forgetKept(const std::string& pass) {
  passes_[pass].kept.clear();
}

void PassMemory::forgetHistories() {
  for (auto& [pass, memory] : passes_) {
    memory.textures.clear();
    memory.buffers.clear();
  }
}

}  // namespace lumivox
