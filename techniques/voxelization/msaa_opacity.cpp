// Finds opacity by multisampled rasterisation, as 3D clipmaps do (thesis Gomes 2015, Sec. 3.5.2).
#include <fmt/format.h>

#include <algorithm>

#include "lumivox/base/error.h"
#include "voxelizer.h"

namespace lumivox::voxelization {

using namespace shaders::voxelization;

namespace {

class MsaaOpacityPass : public Voxelizer {
  Param<int> samples{this, "samples", 8, within(2, 8),
                     "samples per pixel, at most as many as the device has"};
  Param<float> thickness{this, "thickness", 0.5f, within(0.0f, 1.0f),
                         "thickness of a surface seen from the side, in voxels; 0: none"};
  Param<int> supersampling{
      this, "supersampling", 1, within(1, 16),
      "largest number of pixels along a voxel for triangles that few samples hit, so that the coverage of small things changes smoothly as they move; rounded down to a power of two; 1: no supersampling"};
  Out<OccupancyGrid> opacity{this, "opacity", "opacity of the most opaque side of each voxel"};
  Out<OccupancyGrid> opacityX{this, "opacity_x", "opacity of a voxel seen along x"};
  Out<OccupancyGrid> opacityY{this, "opacity_y", "opacity of a voxel seen along y"};
  Out<OccupancyGrid> opacityZ{this, "opacity_z", "opacity of a voxel seen along z"};

 public:
  void run(PassContext& frame) override {
    const int most = frame.device().info().maxSamples;
    if (most < 2) throw Error("the device has one sample per pixel: it cannot measure coverage");
    // Devices offer powers of two.
    sampleCount_ = 2;
    while (2 * sampleCount_ <= std::min<int>(samples, most)) sampleCount_ *= 2;
    if (sampleCount_ < samples) {
      frame.warn(fmt::format("{} samples per pixel in place of {}: the device has at most {}", sampleCount_,
                             static_cast<int>(samples), most));
    }
    positions_ = frame.device().samplePositions(sampleCount_);
    Voxelizer::run(frame);
    if (opacity.wanted() || opacityX.wanted() || opacityY.wanted() || opacityZ.wanted()) countSides(frame);
  }

 private:
  VoxelFragments::Coverage coverage() const override { return VoxelFragments::Coverage::sum; }

  void append(PassContext& frame, const VoxelFragments& list, const Draws& draws) override {
    // Viewports of different sizes; each triangle is drawn in one of them. Deviates from thesis Gomes 2015,
    // Sec. 3.5.2, where a geometry stage chooses the viewport: here the vertex stage of each viewport drops
    // the triangles of the others.
    int mostScale = 1;
    while (2 * mostScale <= supersampling) mostScale *= 2;
    for (int scale = 1; scale <= mostScale; scale *= 2)
      rasterise(frame, list.grid, draws, msaa_opacity::Variant::targetList, appending(list), scale,
                mostScale);
  }

  void rasterise(PassContext& frame, const GridPlacement& grid, const Draws& draws, int target,
                 const shader::BindingSet& results, int scale = 1, int mostScale = 1) const {
    const int side = scale * grid.longest();
    SampleGrid pixels{
        .sampleCount = sampleCount_, .thickness = thickness, .scale = scale, .mostScale = mostScale};
    for (std::size_t i = 0; i < positions_.size(); ++i)
      pixels.samples[i] = glm::vec4(positions_[i], 0.0f, 0.0f);
    const gpu::Drawing drawing =
        frame.device().drawTo({.width = side, .height = side, .samples = sampleCount_}, {});
    for (const SceneDraw* draw : draws) {
      pixels.firstIndex = static_cast<int>(draw->firstIndex);
      const SceneBinding scene(frame, *draw);
      frame.shaders().draw(frame.program(scene.in(msaa_opacity::Variant{.target = target})),
                           {scene, msaa_opacity::sampleGrid(pixels), results}, draw->indexCount);
    }
    frame.device().barrier();
  }

  void countSides(PassContext& frame) {
    const GridPlacement grid = placement(frame);
    // The covered samples of every voxel's three sides.
    const gpu::TextureRef masks = markedWords(
        frame, grid, grid.resolution, "samples", [&](const gpu::Texture& marked, const Draws& draws) {
          rasterise(frame, grid, draws, msaa_opacity::Variant::targetMasks,
                    {gridBinding(grid), msaa_opacity::sampleMasks(marked)});
        });
    const std::array<Out<OccupancyGrid>*, 4> outputs{&opacityX, &opacityY, &opacityZ, &opacity};
    for (int side = 0; side < 4; ++side) {
      Out<OccupancyGrid>& output = *outputs[static_cast<std::size_t>(side)];
      if (!output.wanted()) continue;
      output = OccupancyGrid{grid, frame.volume(grid.resolution, gpu::Format::r8, output.name())};
      frame.dispatch(frame.program(msaa_opacity_count::kProgram),
                     {msaa_opacity_count::sides({sampleCount_, side}), msaa_opacity_count::sampleMasks(masks),
                      msaa_opacity_count::opacity(output->opacity)},
                     grid.resolution);
    }
  }

  int sampleCount_ = 2;
  std::vector<glm::vec2> positions_;
};

}  // namespace

void addMsaaOpacity(TechniqueRegistry& registry) {
  registry.add<MsaaOpacityPass>("msaa_opacity",
                                "Opacity by multisampled rasterisation, seen along each axis (3D clipmaps)");
}

}  // namespace lumivox::voxelization
