#include "pipeline/context.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <exception>
#include <new>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"

namespace lumivox {

GpuScene& FrameContext::scene() {
  if (!gpuScene_) {
    gpuScene_.emplace(device_, *scene_);
    gpuScene_->update(snapshot_);
  }
  return *gpuScene_;
}

gpu::TextureRef FrameContext::texture(const gpu::TextureDescription& description, const std::string& label) {
  gpu::TextureRef texture = pool_.texture(description, passName_ + ": " + label);
  bytesOfRun_ += texture->sizeBytes();
  lastResource_ = label;
  return texture;
}

gpu::BufferRef FrameContext::buffer(std::uint64_t sizeBytes, const std::string& label) {
  gpu::BufferRef buffer = pool_.buffer(sizeBytes, passName_ + ": " + label);
  bytesOfRun_ += buffer->sizeBytes();
  lastResource_ = label;
  return buffer;
}

void FrameContext::checkAfterFrame(gpu::BufferRef counts, std::uint64_t offsetBytes, CountCheck check) {
  pendingChecks_.push_back({passName_, std::move(counts), offsetBytes, std::move(check)});
}

bool FrameContext::allHadRoom() {
  // An attempt finds the need of a pass only if its inputs were complete. A chain of passes therefore takes
  // as many attempts as it has passes, and a pass that doubles its room at most as many as a word has bits.
  constexpr int kMostAttempts = 64;
  bool enough = true;
  for (const PendingCheck& one : std::exchange(pendingChecks_, {})) {
    passName_ = one.pass;
    try {
      std::uint32_t count = 0;
      std::memcpy(&count, one.counts->download(one.offsetBytes, sizeof(count)).data(), sizeof(count));
      if (one.check(*this, count)) continue;
      enough = false;
      if (attempts_ == kMostAttempts)
        throw Error(fmt::format("no room for its count ({}) after {} attempts", count, kMostAttempts));
    } catch (const std::exception& error) {
      attempts_ = 0;
      throw Error("pass " + one.pass + ": " + error.what());
    }
  }
  attempts_ = enough ? 0 : attempts_ + 1;
  return enough;
}

void FrameContext::warn(const std::string& text) {
  const std::string message = "pass " + passName_ + ": " + text;
  if (warnings_.insert(message).second) logWarning("{}", message);
}

void FrameContext::note(const std::string& text) {
  if (inspects_) notes_.push_back("pass " + passName_ + ": " + text);
}

PassContext::Kept& FrameContext::keptEntry(const std::string& what) {
  return memory_.kept(passName_, what);
}

void FrameContext::tellReused(const std::string& what) {
  reusedParts_.insert({passName_, what});
}

void FrameContext::requireHistory(const char* called) const {
  if (pass_ == nullptr || reads(pass_->readsFrom(), Reads::history)) return;
  if (std::ranges::none_of(pass_->inputs(),
                           [](const InBase* input) { return input->presence() == Presence::history; }))
    throw Error(fmt::format("it calls {}, but its readsFrom() does not return Reads::history", called));
}

History<gpu::TextureRef> FrameContext::history(const gpu::TextureDescription& description,
                                               const std::string& label) {
  requireHistory("history()");
  gpu::TextureRef current = texture(description, label);
  return accumulates_ ? memory_.history(passName_, label, std::move(current))
                      : History<gpu::TextureRef>{nullptr, std::move(current)};
}

History<gpu::BufferRef> FrameContext::history(std::uint64_t sizeBytes, const std::string& label) {
  requireHistory("history()");
  gpu::BufferRef current = buffer(sizeBytes, label);
  return accumulates_ ? memory_.history(passName_, label, std::move(current))
                      : History<gpu::BufferRef>{nullptr, std::move(current)};
}

int FrameContext::accumulated() const {
  requireHistory("accumulated()");
  return accumulated_;
}

void FrameContext::setScene(const Scene& scene, bool uploads) {
  scene_ = &scene;
  traits_ = keepsEverything_ ? SceneTraits::everything() : SceneTraits::of(scene);
  if (uploads) gpuScene_.reset();
}

void FrameContext::setFrame(SceneSnapshot snapshot, int frameIndex, bool geometryChanged) {
  pendingChecks_.clear();  // left by a frame that an error ended
  snapshot_ = std::move(snapshot);
  frameIndex_ = frameIndex;
  if (gpuScene_ && geometryChanged) gpuScene_->update(snapshot_);
}

gpu::Device::Elapsed FrameContext::run(Pass& pass, const std::string& name, bool fenced, int accumulated) {
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  };
  passName_ = name;
  pass_ = &pass;
  accumulated_ = accumulated;
  bytesOfRun_ = 0;
  lastResource_.clear();
  memory_.beginRun(name);
  if (keepsEverything_) memory_.forgetKept(name);
  gpu::Device::Elapsed elapsed{0.0, 0.0};
  std::exception_ptr failure;
  if (fenced) device_.finish();
  const auto start = Clock::now();
  device_.enterPass(name);
  try {
    pass.run(*this);
    // The writes of a pass are visible to every later pass, for every kind of read.
    device_.barrier();
    elapsed.hostMs = since(start);
  } catch (...) {
    failure = std::current_exception();
  }
  try {
    device_.leavePass();
    if (fenced) device_.finish();
  } catch (...) {
    // If the pass threw, its error came first and explains more.
    if (!failure) failure = std::current_exception();
  }
  if (fenced) elapsed.deviceMs = since(start);
  pass_ = nullptr;
  memory_.endRun(name);
  if (!failure) return elapsed;
  // The one place that names the pass in an error.
  try {
    std::rethrow_exception(failure);
  } catch (const AbsentError& error) {
    throw AbsentError("pass " + name + ": " + error.what());
  } catch (const std::bad_alloc&) {
    // The size of the request is unknown here, only the available memory.
    throw Error(fmt::format(
        "pass {}: out of memory; {}, textures and buffers take {}, of which this pass asked for {}{}", name,
        availableMemory() == ~std::uint64_t{0} ? std::string("how much is available is not known")
                                               : formatBytes(availableMemory()) + " are available",
        formatBytes(device_.allocatedBytes()), formatBytes(bytesOfRun_),
        lastResource_.empty() ? "" : ", the last one '" + lastResource_ + "'"));
  } catch (const std::exception& error) {
    throw Error("pass " + name + ": " + error.what());
  }
}

}  // namespace lumivox
