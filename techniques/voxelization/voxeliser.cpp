#include "voxeliser.h"

#include <fmt/format.h>

#include <algorithm>

#include "fragment_list.h"
#include "lumivox/base/error.h"

namespace lumivox::voxelization {

gpu::TextureDescription volumeOf(const GridPlacement& grid, gpu::Format format) {
  gpu::TextureDescription description;
  description.kind = gpu::TextureKind::d3;
  description.format = format;
  description.width = grid.resolution.x;
  description.height = grid.resolution.y;
  description.depth = grid.resolution.z;
  return description;
}

Reads GridPass::readsSurface() const {
  const Reads surface = Reads::geometry | Reads::materials;
  return around == "camera" ? surface | Reads::camera : surface;
}

std::string GridPass::checkParameters() const {
  if (around == "camera" && !(extent > 0.0f)) return "around camera needs an extent above 0 m";
  return {};
}

GridPlacement GridPass::placement(PassContext& frame) const {
  const SceneSnapshot& snapshot = frame.snapshot();
  if (around == "camera") return placeGridAround(snapshot.camera.eye, extent, resolution);
  return placeGrid(snapshot.gridBounds, resolution);
}

std::uint64_t Voxeliser::expectedFragments(const Scene& scene) const {
  // Surfaces fill about as many voxels as six sides of the grid; every triangle touches at least one, mostly
  // a few.
  const auto side = static_cast<std::uint64_t>(resolution);
  return 12 * side * side + 4 * scene.triangleCount();
}

GridPass::StillKey GridPass::stillKey(const PassContext& frame, const GridPlacement& grid,
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
  // A list that was too small is made anew with the size that it turned out to need; a frame like the last
  // one fits at once. A first guess is no reason to ask for more than one buffer can have.
  std::uint64_t capacity = list_.capacity;
  if (!stillKept) {
    const std::uint64_t most = frame.device().info().maxStorageBytes / VoxelFragments::kFragmentBytes;
    capacity = std::max(capacity, std::min(expectedFragments(frame.sceneDescription()), most));
  }
  std::uint32_t count = 0;
  for (;;) {
    if (!stillKept) {
      list_.fragments.reset();  // before the next one is taken: the pool may give back the same
      list_.fragments = frame.buffer(capacity * VoxelFragments::kFragmentBytes, "voxel fragments");
      list_.capacity = capacity;
      stillCount_ = appendFrom(frame, still, 0);
    }
    // Of a list that is too small already, the size of the rest is still wanted.
    count = appendFrom(frame, moving, stillCount_);
    if (count <= list_.capacity) break;
    if (count > 0x7fffffffu) throw Error(fmt::format("{} fragments do not fit into one list", count));
    capacity = count;
    stillKept = false;
  }
  stillKey_ = key;
  if (stillKept && !still.empty())
    frame.reused("fragments of what stands still", "static geometry is voxelised once");

  list_.count->uploadValues(std::span<const std::uint32_t>(&count, 1));
  finishList(frame, list_);
  fragments = list_;
}

}  // namespace lumivox::voxelization
