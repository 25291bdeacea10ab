// Fang & Chen 2000, "Hardware accelerated voxelization": one pass of the whole scene per slice of the grid,
// between two clip planes.
#include <map>

#include "voxelizer.h"

namespace lumivox::voxelization {

using namespace shaders::voxelization;

namespace {

class SlicingPass : public Voxelizer {
  Param<int> axes{this, "axes", 1, within(1, 3),
                  "1: slices along z, as published; 3: slices along all axes, so that no surface is missed"};

  std::string checkParameters() const override {
    if (axes == 2) return "axes must be 1 or 3";
    return Voxelizer::checkParameters();
  }

  void append(PassContext& frame, const VoxelFragments& list, const Draws& draws) override {
    const int side = list.grid.longest();
    std::vector<Bounds> bounds;
    for (const SceneDraw* draw : draws) bounds.push_back(boundsOf(frame, *draw, list.grid));
    const gpu::Drawing drawing = frame.device().drawTo({.width = side, .height = side}, {});
    for (int axis = axes == 1 ? 2 : 0; axis < 3; ++axis) {
      for (int slice = 0; slice < list.grid.resolution[axis]; ++slice) {
        const auto low = static_cast<float>(slice), high = low + 1.0f;
        const shader::BindingSet bindings{viewAlong(list.grid, axis, low, high), appending(list)};
        for (std::size_t i = 0; i < draws.size(); ++i) {
          if (bounds[i].high[axis] < low || bounds[i].low[axis] > high) continue;
          drawPart(frame, *draws[i], slicing::Variant{}, bindings);
        }
      }
    }
  }

  /// Bounds in voxels; a draw wholly outside a slice's clip planes is skipped for it.
  Bounds boundsOf(PassContext& frame, const SceneDraw& draw, const GridPlacement& grid) {
    const ObjectState& state = frame.snapshot().objects[static_cast<std::size_t>(draw.object)];
    if (!state.positions.empty()) return {glm::vec3(-1e30f), glm::vec3(1e30f)};  // it deforms
    const auto [known, isNew] = atRest_.try_emplace(draw.firstIndex);
    if (isNew) {
      const Scene& scene = frame.sceneDescription();
      for (std::uint32_t i = draw.firstIndex; i < draw.firstIndex + draw.indexCount; ++i)
        known->second.grow(scene.positions[scene.indices[i]]);
    }
    return boundsInGrid(known->second, state.toWorld, grid);
  }

  std::map<std::uint32_t, Bounds> atRest_;  ///< of draws, by first index; object space
};

}  // namespace

void addSlicing(TechniqueRegistry& registry) {
  registry.add<SlicingPass>("slicing", "One clipped pass of the scene per slice (Fang & Chen 2000)");
}

}  // namespace lumivox::voxelization
