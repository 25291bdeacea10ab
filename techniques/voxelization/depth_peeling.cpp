// Li et al. 2005: layers of depth are peeled from three orthogonal views, and every pixel of a layer is a
// voxel.
#include <fmt/format.h>

#include <algorithm>

#include "orthogonal_view.h"

namespace lumivox::voxelization {
namespace {

namespace peelShader = shaders::voxelization::depth_peeling;
namespace appendShader = shaders::voxelization::depth_peeling_append;

class DepthPeelingPass : public Voxeliser {
  Param<int> layers{this, "layers", 64, {1, 4096}, "most layers that are peeled from one view"};

  struct Layer {
    gpu::TextureRef depth, surface, depthInGrid;
  };

  static Layer makeLayer(PassContext& frame, int side) {
    gpu::TextureDescription description;
    description.width = description.height = side;
    const auto texture = [&](gpu::Format format, const char* label) {
      description.format = format;
      return frame.texture(description, label);
    };
    return {texture(gpu::Format::depth32f, "depth of a layer"),
            texture(gpu::Format::rgba32ui, "surface of a layer"),
            texture(gpu::Format::r32f, "depth in voxels of a layer")};
  }

  /// Layers that are peeled along each axis: as many as earlier frames found and one more, which must turn
  /// out empty; of what stands still and of what moves.
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
    Plan& plan = draws.front()->moving ? moving_ : still_;
    for (int axis = 0; axis < 3; ++axis) {
      const OrthogonalView view = viewAlong(list, axis, 0.0f, static_cast<float>(list.grid.resolution[axis]));
      int& peeled = plan.peeled[static_cast<std::size_t>(axis)];
      peeled = std::min<int>(peeled, layers);
      for (int index = 0; index < peeled; ++index) {
        const Layer &now = pair[static_cast<std::size_t>(index % 2)],
                    &before = pair[static_cast<std::size_t>((index + 1) % 2)];
        peel(frame, view, draws, now, index == 0 ? nullptr : before.depth.get());
        frame.dispatch(
            frame.program(appendShader::kProgram),
            {appendShader::view(view), appendShader::layer({index}), appendShader::deepest(*deepest),
             appendShader::count(*list.count), appendShader::fragments(*list.fragments),
             appendShader::layerDepth(*now.depth, gpu::Sampling::nearest),
             appendShader::layerSurface(*now.surface, gpu::Sampling::nearest),
             appendShader::layerDepthInGrid(*now.depthInGrid, gpu::Sampling::nearest)},
            {side, side, 1}, appendShader::kGroupSize);
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
                   const gpu::Texture* before) {
    gpu::RenderTargets targets;
    targets.colours = {{layer.surface.get()}, {layer.depthInGrid.get()}};
    targets.depth = layer.depth.get();
    gpu::RasterState state;
    state.depthTest = state.depthWrite = true;
    const gpu::Drawing drawing = frame.device().drawTo(targets, state);
    for (const SceneDraw* draw : draws) {
      peelShader::Variant variant;
      variant.textures = frame.keepsEverything() || draw->diffuseTexture != nullptr;
      variant.masks = frame.keepsEverything() || draw->maskTexture != nullptr;
      variant.first = before == nullptr ? 1 : 0;
      std::vector<gpu::ResourceBinding> bindings = viewBindings(frame, view, *draw);
      if (before != nullptr) bindings.push_back(peelShader::layerBefore(*before, gpu::Sampling::nearest));
      frame.shaders().drawIndexed(frame.program(peelShader::kProgram, variant.key()), bindings,
                                  frame.scene().indices(), draw->firstIndex, draw->indexCount);
    }
    frame.device().barrier();
  }

  Plan still_, moving_;
};

}  // namespace

void addDepthPeeling(TechniqueRegistry& registry) {
  registry.add<DepthPeelingPass>("depth_peeling",
                                 "Layers of depth peeled from three orthogonal views (Li et al. 2005)");
}

}  // namespace lumivox::voxelization
