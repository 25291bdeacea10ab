// The frame as a pass sees it while it runs, for the executor and the harness alike.
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "lumivox/pipeline/gpu_scene.h"
#include "lumivox/pipeline/pass.h"
#include "pipeline/pass_memory.h"
#include "pipeline/pool.h"

namespace lumivox {

class FrameContext : public PassContext {
 public:
  FrameContext(gpu::Device& device, const Scene& scene, bool keepsEverything,
               const std::shared_ptr<TransientMemory>& transientMemory = nullptr)
      : device_(device),
        scene_(&scene),
        keepsEverything_(keepsEverything),
        traits_(keepsEverything ? SceneTraits::everything() : SceneTraits::of(scene)),
        shaders_(device),
        pool_(device, !keepsEverything, transientMemory) {}

  gpu::Device& device() override { return device_; }
  shader::ShaderLibrary& shaders() override { return shaders_; }
  GpuScene& scene() override;
  const Scene& sceneDescription() const override { return *scene_; }
  const SceneSnapshot& snapshot() const override { return snapshot_; }
  const SceneTraits& traits() const override { return traits_; }
  bool keepsEverything() const override { return keepsEverything_; }
  int frameIndex() const override { return frameIndex_; }
  std::uint64_t seed() const override {
    if (pass_ != nullptr) seeded_.insert(passName_);
    return seed_;
  }
  gpu::TextureRef texture(const gpu::TextureDescription& description, const std::string& label) override;
  gpu::BufferRef buffer(std::uint64_t sizeBytes, const std::string& label) override;
  void checkAfterFrame(gpu::BufferRef counts, std::uint64_t offsetBytes, CountCheck check) override;
  void warn(const std::string& text) override;
  History<gpu::TextureRef> history(const gpu::TextureDescription& description,
                                   const std::string& label) override;
  History<gpu::BufferRef> history(std::uint64_t sizeBytes, const std::string& label) override;
  int accumulated() const override;
  bool inspects() const override { return inspects_; }
  void note(const std::string& text) override;

  ResourcePool& pool() { return pool_; }
  PassMemory& memory() { return memory_; }
  /// Replaces the scene. `uploads`: the device's copy of the old one cannot be used and is uploaded anew.
  void setScene(const Scene& scene, bool uploads);
  void setSeed(std::uint64_t seed) { seed_ = seed; }
  /// Names of the passes that have asked for the seed in any frame so far.
  const std::set<std::string>& seeded() const { return seeded_; }
  /// Updates the device's copy of the scene if `geometryChanged`.
  void setFrame(SceneSnapshot snapshot, int frameIndex, bool geometryChanged);
  /// Whether histories are carried from frame to frame.
  void setAccumulates(bool accumulates) { accumulates_ = accumulates; }
  void setInspects(bool inspects) { inspects_ = inspects; }
  /// Notes of passes about themselves since the last call, each with its pass's name.
  std::vector<std::string> takeNotes() { return std::exchange(notes_, {}); }
  /// Results of PassContext::kept() that were reused from earlier frames, by pass.
  struct Reused {
    std::string pass, what;
    auto operator<=>(const Reused&) const = default;
  };
  const std::set<Reused>& reusedParts() const { return reusedParts_; }

  /// Runs one pass. Errors of the pass and of the driver carry its name, once. `fenced`: waits for the device
  /// before and after and returns the time between; otherwise the time is 0. `accumulated`: the value of
  /// PassContext::accumulated().
  gpu::Device::Elapsed run(Pass& pass, const std::string& name, bool fenced = false, int accumulated = 0);
  /// Whether a pass of the frame has left a count to be checked.
  bool hasCounts() const { return !pendingChecks_.empty(); }
  /// Checks the counts of the frame; call it when the device is idle. Returns false if a pass had too little
  /// room: the frame must then be rendered again, without anything kept. Throws Error after too many
  /// attempts.
  bool allHadRoom();
  /// Bytes that the last run requested from the pool.
  std::uint64_t bytesOfRun() const { return bytesOfRun_; }

 private:
  Kept& keptEntry(const std::string& what) override;
  void tellReused(const std::string& what) override;
  /// Throws Error if the pass does not declare Reads::history.
  void requireHistory(const char* called) const;

  gpu::Device& device_;
  const Scene* scene_;
  bool keepsEverything_;
  SceneTraits traits_;
  shader::ShaderLibrary shaders_;
  ResourcePool pool_;
  PassMemory memory_;
  std::optional<GpuScene> gpuScene_;
  SceneSnapshot snapshot_;
  int frameIndex_ = 0;
  std::uint64_t seed_ = 1, bytesOfRun_ = 0;
  std::string passName_, lastResource_;  ///< lastResource_: label, as this run asked the pool for it
  const Pass* pass_ = nullptr;           ///< the pass that runs
  int accumulated_ = 0;
  bool accumulates_ = false, inspects_ = false;
  struct PendingCheck {
    std::string pass;
    gpu::BufferRef counts;
    std::uint64_t offsetBytes;
    CountCheck check;
  };
  std::vector<PendingCheck> pendingChecks_;  ///< of this frame
  int attempts_ = 0;                         ///< attempts at this frame that had too little room
  std::vector<std::string> notes_;
  std::set<std::string> warnings_;
  mutable std::set<std::string> seeded_;
  std::set<Reused> reusedParts_;
};

}  // namespace lumivox
