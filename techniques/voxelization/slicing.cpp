// Fang et al. 2000, "Hardware accelerated voxelization": one pass of the whole scene per slice of the grid,
// between two clip planes.
#include "orthogonal_view.h"

namespace lumivox::voxelization {
namespace {

namespace slicingShader = shaders::voxelization::slicing;

class SlicingPass : public Voxeliser {
  Param<int> axes{this,
                  "axes",
                  1,
                  {1, 3},
                  "1: slices along z, as published; 3: along all axes, so that no surface is lost"};

  std::string checkParameters() const override {
    if (axes == 2) return "axes must be 1 or 3";
    return Voxeliser::checkParameters();
  }

  void append(PassContext& frame, const VoxelFragments& list, const Draws& draws) override {
    gpu::RenderTargets targets;
    targets.width = targets.height = viewSide(list.grid);
    const gpu::Drawing drawing = frame.device().drawTo(targets, {});
    for (int axis = axes == 1 ? 2 : 0; axis < 3; ++axis) {
      for (int slice = 0; slice < list.grid.resolution[axis]; ++slice) {
        const auto depth = static_cast<float>(slice);
        drawSlice(frame, list, draws, viewAlong(list, axis, depth, depth + 1.0f));
      }
    }
  }

  static void drawSlice(PassContext& frame, const VoxelFragments& list, const Draws& draws,
                        const OrthogonalView& view) {
    for (const SceneDraw* draw : draws) {
      slicingShader::Variant variant;
      variant.textures = frame.keepsEverything() || draw->diffuseTexture != nullptr;
      variant.masks = frame.keepsEverything() || draw->maskTexture != nullptr;
      std::vector<gpu::ResourceBinding> bindings = viewBindings(frame, view, *draw);
      bindings.push_back(slicingShader::count(*list.count));
      bindings.push_back(slicingShader::fragments(*list.fragments));
      frame.shaders().drawIndexed(frame.program(slicingShader::kProgram, variant.key()), bindings,
                                  frame.scene().indices(), draw->firstIndex, draw->indexCount);
    }
  }
};

}  // namespace

void addSlicing(TechniqueRegistry& registry) {
  registry.add<SlicingPass>("slicing", "One clipped pass of the scene per slice (Fang et al. 2000)");
}

}  // namespace lumivox::voxelization
