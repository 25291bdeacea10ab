// Li et al. 2005: peels layers of depth from three orthogonal views; every pixel of a layer is a voxel.
#include <fmt/format.h>

#include <algorithm>

#include "voxelizer.h"

namespace lumivox::voxelization {

using namespace shaders::voxelization;

namespace {

class DepthPeelingPass : public Voxelizer {
  Param<int> layers{this, "layers", 64, within(1, 4096), "largest number of layers peeled from one view"};

  struct Layer {
    gpu::TextureRef depth, surface, depthInGrid;
  };

  static Layer makeLayer(PassContext& frame, int side) {
    const auto texture = [&](gpu::Format format, const char* label) {
      return frame.texture({gpu::TextureKind::d2, format, side, side, 1, 1}, label);
    };
    return {texture(gpu::Format::depth32f, "depth of a layer"),
            texture(gpu::Format::rgba32ui, "surface of a layer"),
            texture(gpu::Format::r32f, "depth in voxels of a layer")};
  }

  /// Layers peeled along an axis: as many as earlier frames found and one more, which must be empty.
  struct Axis {
    int peeled = 4;
    int deepest = 0;  ///< deepest layer that showed something, counted from 1
  };

  void append(PassContext& frame, const VoxelFragments& list, const Draws& draws) override {
    const int side = list.grid.longest();
    const std::array<Layer, 2> pair{makeLayer(frame, side), makeLayer(frame, side)};
    const gpu::BufferRef deepest =
        frame.uploaded(std::array<std::uint32_t, 3>{}, "deepest layer along each axis");
    std::array<Axis, 3>& axes = draws.front()->moving ? moving_ : static_;
    for (int axis = 0; axis < 3; ++axis) {
      const shader::BindingSet view{
          viewAlong(list.grid, axis, 0.0f, static_cast<float>(list.grid.resolution[axis])), appending(list)};
      Axis& plan = axes[static_cast<std::size_t>(axis)];
      plan.peeled = std::min<int>(plan.peeled, layers);
      for (int index = 0; index < plan.peeled; ++index) {
        const Layer &now = pair[static_cast<std::size_t>(index % 2)],
                    &before = pair[static_cast<std::size_t>((index + 1) % 2)];
        peel(frame, view, draws, now, index == 0 ? nullptr : before.depth);
        frame.dispatch(frame.program(depth_peeling_append::kProgram),
                       {view, depth_peeling_append::layer({index}), depth_peeling_append::deepest(deepest),
                        depth_peeling_append::layerDepth(now.depth, gpu::Sampling::nearest),
                        depth_peeling_append::layerSurface(now.surface, gpu::Sampling::nearest),
                        depth_peeling_append::layerDepthInGrid(now.depthInGrid, gpu::Sampling::nearest)},
                       {side, side, 1});
      }
      frame.checkAfterFrame(deepest, static_cast<std::uint64_t>(axis) * sizeof(std::uint32_t),
                            [this, &plan, axis](PassContext& done, std::uint32_t count) {
                              return wereAll(done, plan, axis, static_cast<int>(count));
                            });
    }
  }

  /// Whether all layers along an axis were peeled; `count` of them showed something.
  bool wereAll(PassContext& frame, Axis& plan, int axis, int count) const {
    if (count == plan.peeled && plan.peeled < layers) {
      plan.peeled *= 2;
      return false;
    }
    if (count == layers)
      frame.warn(fmt::format("peeled {} layers along {}, as many as asked for; there may be more", count,
                             "xyz"[axis]));
    plan.deepest = std::max(plan.deepest, count);
    plan.peeled = plan.deepest + 1;
    return true;
  }

  static void peel(PassContext& frame, const shader::BindingSet& view, const Draws& draws, const Layer& layer,
                   const gpu::TextureRef& before) {
    const gpu::RenderTargets targets{.colours = {{layer.surface.get()}, {layer.depthInGrid.get()}},
                                     .depth = layer.depth.get()};
    const gpu::Drawing drawing = frame.device().drawTo(targets, {.depthTest = true, .depthWrite = true});
    for (const SceneDraw* draw : draws)
      drawPart(frame, *draw, depth_peeling::Variant{.first = before == nullptr},
               {view, depth_peeling::layerBefore(before, gpu::Sampling::nearest)});
    frame.device().barrier();
  }

  std::array<Axis, 3> static_, moving_;  ///< for static and for moving geometry
};

}  // namespace

void addDepthPeeling(TechniqueRegistry& registry) {
  registry.add<DepthPeelingPass>("depth_peeling",
                                 "Layers of depth peeled from three orthogonal views (Li et al. 2005)");
}

}  // namespace lumivox::voxelization
