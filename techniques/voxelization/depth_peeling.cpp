// Li et al. 2005: layers of depth are peeled from three orthogonal views, and every pixel of a layer is a
// voxel.
#include <fmt/format.h>

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

  void append(PassContext& frame, const VoxelFragments& list, const Draws& draws) override {
    const int side = viewSide(list.grid);
    const std::array<Layer, 2> pair{makeLayer(frame, side), makeLayer(frame, side)};
    const gpu::BufferRef found = frame.buffer(sizeof(std::uint32_t), "whether a layer shows something");
    for (int axis = 0; axis < 3; ++axis) {
      const OrthogonalView view = viewAlong(list, axis, 0.0f, static_cast<float>(list.grid.resolution[axis]));
      for (int index = 0;; ++index) {
        const Layer &now = pair[static_cast<std::size_t>(index % 2)],
                    &before = pair[static_cast<std::size_t>((index + 1) % 2)];
        peel(frame, view, draws, now, index == 0 ? nullptr : before.depth.get());
        found->clear();
        frame.dispatch(frame.program(appendShader::kProgram),
                       {appendShader::view(view), appendShader::found(*found),
                        appendShader::count(*list.count), appendShader::fragments(*list.fragments),
                        appendShader::layerDepth(*now.depth, gpu::Sampling::nearest),
                        appendShader::layerSurface(*now.surface, gpu::Sampling::nearest),
                        appendShader::layerDepthInGrid(*now.depthInGrid, gpu::Sampling::nearest)},
                       {side, side, 1}, appendShader::kGroupSize);
        if (found->downloadValues<std::uint32_t>().at(0) == 0) break;
        if (index + 1 == layers) {
          frame.warn(fmt::format("peeled {} layers along {}, as many as asked for; there may be more",
                                 index + 1, "xyz"[axis]));
          break;
        }
      }
    }
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
};

}  // namespace

void addDepthPeeling(TechniqueRegistry& registry) {
  registry.add<DepthPeelingPass>("depth_peeling",
                                 "Layers of depth peeled from three orthogonal views (Li et al. 2005)");
}

}  // namespace lumivox::voxelization
