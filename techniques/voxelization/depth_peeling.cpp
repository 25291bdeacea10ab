// Li et al. 2005: layers of depth are peeled from three orthogonal views, and every pixel of a layer is a
// voxel.
#include <fmt/format.h>

#include <algorithm>

#include "orthogonal_view.h"

namespace lumivox::voxelization {
namespace {

using namespace shaders::voxelization;

class DepthPeelingPass : public Voxelizer {
  Param<int> layers{this, "layers", 64, within(1, 4096), "most layers that are peeled from one view"};

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

  /// Layers that are peeled along each axis: as many as earlier frames found and one more, which must turn
  /// out empty; of static geometry and of what moves.
  struct Plan {
    static constexpr int kFirst = 4;
    std::array<int, 3> peeled{kFirst, kFirst, kFirst};
    std::array<int, 3> deepest{};  ///< layer that showed something, counted from 1
  };

  void append(PassContext& frame, const VoxelFragments& list, const Draws& draws) override {
    const int side = viewSide(list.grid);
    const std::array<Layer, 2> pair{makeLayer(frame, side), makeLayer(frame, side)};
    const gpu::BufferRef deepest = frame.buffer(3 * sizeof(std::uint32_t), "deepest layer along each axis");
    deepest->clear();
    Plan& plan = draws.front()->moving ? moving_ : static_;
    for (int axis = 0; axis < 3; ++axis) {
      const OrthogonalView view = viewAlong(list, axis, 0.0f, static_cast<float>(list.grid.resolution[axis]));
      int& peeled = plan.peeled[static_cast<std::size_t>(axis)];
      peeled = std::min<int>(peeled, layers);
      for (int index = 0; index < peeled; ++index) {
        const Layer &now = pair[static_cast<std::size_t>(index % 2)],
                    &before = pair[static_cast<std::size_t>((index + 1) % 2)];
        peel(frame, view, draws, now, index == 0 ? nullptr : before.depth);
        frame.dispatch(frame.program(depth_peeling_append::kProgram),
                       {viewBinding(view), appending(list), depth_peeling_append::layer({index}),
                        depth_peeling_append::deepest(deepest),
                        depth_peeling_append::layerDepth(now.depth, gpu::Sampling::nearest),
                        depth_peeling_append::layerSurface(now.surface, gpu::Sampling::nearest),
                        depth_peeling_append::layerDepthInGrid(now.depthInGrid, gpu::Sampling::nearest)},
                       {side, side, 1});
      }
      frame.judgeLater(deepest, static_cast<std::uint64_t>(axis) * sizeof(std::uint32_t),
                       [this, &plan, axis](PassContext& done, std::uint32_t count) {
                         return wereAll(done, plan, axis, static_cast<int>(count));
                       });
    }
  }

  /// Whether the layers along an axis were all of them; `count` of them showed something.
  bool wereAll(PassContext& frame, Plan& plan, int axis, int count) const {
    int &peeled = plan.peeled[static_cast<std::size_t>(axis)],
        &deepest = plan.deepest[static_cast<std::size_t>(axis)];
    if (count == peeled && peeled < layers) {
      peeled *= 2;
      return false;
    }
    if (count == layers)
      frame.warn(fmt::format("peeled {} layers along {}, as many as asked for; there may be more", count,
                             "xyz"[axis]));
    deepest = std::max(deepest, count);
    peeled = deepest + 1;
    return true;
  }

  static void peel(PassContext& frame, const OrthogonalView& view, const Draws& draws, const Layer& layer,
                   const gpu::TextureRef& before) {
    gpu::RenderTargets targets;
    targets.colours = {{layer.surface.get()}, {layer.depthInGrid.get()}};
    targets.depth = layer.depth.get();
    gpu::RasterState state;
    state.depthTest = state.depthWrite = true;
    const gpu::Drawing drawing = frame.device().drawTo(targets, state);
    for (const SceneDraw* draw : draws) {
      const SceneBinding scene(frame, *draw);
      const depth_peeling::Variant variant{scene.textures, scene.masks, before == nullptr};
      drawPart(frame, frame.program(variant),
               {scene, viewBinding(view), depth_peeling::layerBefore(before, gpu::Sampling::nearest)}, *draw);
    }
    frame.device().barrier();
  }

  Plan static_, moving_;
};

}  // namespace

void addDepthPeeling(TechniqueRegistry& registry) {
  registry.add<DepthPeelingPass>("depth_peeling",
                                 "Layers of depth peeled from three orthogonal views (Li et al. 2005)");
}

}  // namespace lumivox::voxelization
