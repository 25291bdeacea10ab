// The bench of one pipeline; cases.h declares what cases use.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "stress/cases.h"

namespace lumivox::stress {

/// The environment of a bench, the same for all cells of a worker but for the pipeline.
struct Ground {
  gpu::Device& device;
  gpu::DeviceOptions deviceOptions;  ///< for a second device like the first
  TechniqueSource& techniques;
  SceneLoadOptions sceneLoad;
  std::filesystem::path scenes;      ///< the folder of the committed ones
  std::vector<std::string> program;  ///< words of the command line that starts a worker; empty: none
  bool quick = false;
};

class PipelineBench : public Bench {
 public:
  PipelineBench(Ground& ground, const Pipeline& pipeline);
  ~PipelineBench() override;

  bool quick() const override;
  const Pipeline& pipeline() const override;
  const PipelineParameter* parameter(const std::string& name) const override;
  TechniqueSource& techniques() override;
  Scene sceneFromText(const std::string& text) const override;
  Scene committedScene(const std::string& name) const override;
  Frame render(const Scene& scene, const Shot& shot) override;
  std::vector<Frame> renderSequence(const Scene& scene, const std::vector<double>& times, const Shot& shot,
                                    const Edit& edit) override;
  std::uint64_t contentOf(const Scene& scene, const Shot& shot) override;
  std::uint64_t contentOfSequence(const Scene& scene, const std::vector<double>& times, const Shot& shot,
                                  const Edit& edit) override;
  std::uint64_t contentElsewhere(const std::string& committedScene, const Shot& shot,
                                 const std::vector<std::string>& environment) override;
  std::uint64_t contentOnSecondDevice(const Scene& scene, const Shot& shot) override;
  std::optional<VoxelError> voxelError(const Scene& scene, const Shot& shot) override;
  LayeredImage reference(const Scene& scene, const Shot& shot, int samplesPerPixel, int threads) override;
  void show(const ImageBuffer& image) override;

  /// The image last given to show(), else the last whole image rendered; may be empty.
  const ImageBuffer& shown() const;
  /// Finds exposures from now on, which path-traces a small image of every scene rendered.
  void meterScenes();
  /// EV at which shown() is displayed: that of the last scene rendered, the same for every pipeline, or the
  /// image's own if there is none.
  double exposure() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lumivox::stress
