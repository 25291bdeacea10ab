#include "voxeliser.h"

#include <fmt/format.h>

#include <algorithm>

#include "lumivox/base/error.h"
#include "voxelization_shaders.h"

namespace lumivox::voxelization {

namespace finishShader = shaders::voxelization::finish;

Reads Voxeliser::readsFrom() const {
  const Reads surface = Reads::geometry | Reads::materials;
  return around == "camera" ? surface | Reads::camera : surface;
}

std::string Voxeliser::checkParameters() const {
  if (around == "camera" && !(extent > 0.0f)) return "around camera needs an extent above 0 m";
  return {};
}

std::uint64_t Voxeliser::expectedFragments(const Scene& scene) const {
  // Surfaces fill about as many voxels as six sides of the grid; every triangle touches at least one, mostly
  // a few.
  const auto side = static_cast<std::uint64_t>(resolution);
  return 12 * side * side + 4 * scene.triangleCount();
}

GridPlacement Voxeliser::placement(PassContext& frame) const {
  const SceneSnapshot& snapshot = frame.snapshot();
  if (around == "camera") return placeGridAround(snapshot.camera.eye, extent, resolution, snapshot.origin);
  return placeGrid(snapshot.gridBounds, resolution);
}

Voxeliser::StillKey Voxeliser::stillKey(const PassContext& frame, const GridPlacement& grid,
                                        const Draws& still) {
  StillKey key{grid, {}, {}};
  for (const ParamBase* parameter : parameters()) key.parameters.push_back(parameter->valueText());
  for (const SceneDraw* draw : still)
    key.placements.push_back(frame.snapshot().objects[static_cast<std::size_t>(draw->object)].toWorld);
  return key;
}

/// Appends behind the first `first` fragments; returns how many there are then, or would be.
std::uint32_t Voxeliser::appendFrom(PassContext& frame, const Draws& draws, std::uint32_t first) {
  if (draws.empty()) return first;
  list_.count->uploadValues(std::span<const std::uint32_t>(&first, 1));
  append(frame, list_, draws);
  frame.device().barrier();
  std::uint32_t count = 0;
  const std::vector<std::byte> word = list_.count->download(0, sizeof(count));
  std::memcpy(&count, word.data(), sizeof(count));
  return count;
}

void Voxeliser::run(PassContext& frame) {
  Draws still, moving;
  for (const SceneDraw& draw : frame.scene().draws()) (draw.moving ? moving : still).push_back(&draw);
  const GridPlacement grid = placement(frame);
  const StillKey key = stillKey(frame, grid, still);
  bool stillKept = !frame.startsAfresh() && list_.fragments != nullptr && key == stillKey_;
  list_.grid = grid;
  list_.workGroupSize = kWorkGroupSize;
  list_.coverage = coverage();
  // A reader of an earlier frame may still hold the old count.
  list_.count = frame.buffer(4 * sizeof(std::uint32_t), "voxel fragment count");
  if (!stillKept) list_.capacity = std::max(list_.capacity, expectedFragments(frame.sceneDescription()));
  // A list that was too small is made anew with the size that it turned out to need; a frame like the last
  // one fits at once.
  std::uint32_t count = 0;
  for (;;) {
    if (!stillKept) {
      list_.fragments = frame.buffer(list_.capacity * VoxelFragments::kFragmentBytes, "voxel fragments");
      stillCount_ = appendFrom(frame, still, 0);
    }
    // Of a list that is too small already, the size of the rest is still wanted.
    count = appendFrom(frame, moving, stillCount_);
    if (count <= list_.capacity) break;
    if (count > 0x7fffffffu) throw Error(fmt::format("{} fragments do not fit into one list", count));
    list_.capacity = count;
    stillKept = false;
  }
  stillKey_ = key;
  if (stillKept && !still.empty())
    frame.reused("fragments of what stands still", "static geometry is voxelised once");

  list_.count->uploadValues(std::span<const std::uint32_t>(&count, 1));
  frame.dispatch(frame.program(finishShader::kProgram),
                 {finishShader::count(*list_.count),
                  finishShader::parameters({static_cast<int>(list_.capacity), kWorkGroupSize})},
                 {1, 1, 1}, {1, 1, 1});
  fragments = list_;
}

}  // namespace lumivox::voxelization
