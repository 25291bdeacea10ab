#include "voxelizer.h"

#include <fmt/format.h>

#include <algorithm>

#include "fragment_list.h"
#include "lumivox/base/error.h"

namespace lumivox::voxelization {

shader::BindingSet appending(const VoxelFragments& list) {
  return {shader::StorageSlot{"Count"}(list.count), shader::StorageSlot{"Fragments"}(list.fragments)};
}

Bounds boundsInGrid(const Bounds& bounds, const glm::mat4& toWorld, const GridPlacement& grid) {
  Bounds inGrid;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 local((corner & 1) != 0 ? bounds.high.x : bounds.low.x,
                          (corner & 2) != 0 ? bounds.high.y : bounds.low.y,
                          (corner & 4) != 0 ? bounds.high.z : bounds.low.z);
    inGrid.grow((glm::vec3(toWorld * glm::vec4(local, 1.0f)) - grid.low) / grid.voxelSize);
  }
  inGrid.low -= 1.0f;
  inGrid.high += 1.0f;
  return inGrid;
}

Reads GridPass::readsSurface() const {
  const Reads surface = Reads::geometry | Reads::materials;
  return around == Around::camera ? surface | Reads::camera : surface;
}

std::string GridPass::checkParameters() const {
  if (around == Around::camera && !(extent > 0.0f)) return "around camera needs an extent above 0 m";
  return {};
}

GridPlacement GridPass::placement(PassContext& frame) const {
  const SceneSnapshot& snapshot = frame.snapshot();
  if (around == Around::camera) return placeGridAround(snapshot.camera.eye, extent, resolution);
  return placeGrid(snapshot.gridBounds, resolution);
}

std::uint64_t Voxelizer::expectedFragments(const Scene& scene, const GridPlacement&) const {
  // Surfaces fill about as many voxels as six sides of the grid, twice where they lie between two layers;
  // every triangle touches at least one, mostly a few.
  const auto side = static_cast<std::uint64_t>(resolution);
  return 12 * side * side + 4 * scene.triangleCount();
}

GridPass::DrawsByMotion GridPass::drawsByMotion(PassContext& frame) {
  DrawsByMotion result;
  for (const SceneDraw& draw : frame.scene().draws())
    (draw.moving ? result.moving : result.still).push_back(&draw);
  return result;
}

GridPass::StaticKey GridPass::staticKey(const PassContext& frame, const GridPlacement& grid,
                                        const Draws& still) {
  StaticKey key{grid, {}};
  for (const SceneDraw* draw : still)
    key.second.push_back(frame.snapshot().objects[static_cast<std::size_t>(draw->object)].toWorld);
  return key;
}

VoxelFragments Voxelizer::emptyList(const GridPlacement& grid) const {
  VoxelFragments list;
  list.grid = grid;
  list.workGroupSize = kWorkGroupSize;
  list.coverage = coverage();
  return list;
}

Voxelizer::StaticList Voxelizer::listOfStatic(PassContext& frame, const GridPlacement& grid,
                                              const Draws& still) {
  // A first guess is no reason to ask for more than one buffer can have.
  const std::uint64_t most = frame.device().info().maxStorageBytes / VoxelFragments::kFragmentBytes;
  if (room_ == 0)
    room_ = std::max<std::uint64_t>(std::min(expectedFragments(frame.sceneDescription(), grid), most), 1);
  VoxelFragments list = emptyList(grid);
  list.count = countBuffer(frame, "count of static geometry");
  list.fragments = frame.buffer(room_ * VoxelFragments::kFragmentBytes, "voxel fragments");
  list.capacity = room_;
  list.count->clear();
  if (!still.empty()) append(frame, list, still);
  frame.device().barrier();
  return {list.fragments, list.count, list.capacity};
}

void Voxelizer::run(PassContext& frame) {
  if (!fragments.wanted()) return;
  const auto [still, moving] = drawsByMotion(frame);
  const GridPlacement grid = placement(frame);
  const auto make = [&, &draws = still] { return listOfStatic(frame, grid, draws); };
  const StaticList first =
      still.empty() ? make()
                    : frame.kept("fragments of static geometry", staticKey(frame, grid, still), make);
  VoxelFragments list = emptyList(grid);
  list.fragments = first.fragments;
  list.capacity = first.capacity;
  // A reader of an earlier frame may still hold the old count.
  list.count = countBuffer(frame, "voxel fragment count");
  copyCount(frame, *first.count, *list.count);
  if (!moving.empty()) append(frame, list, moving);
  frame.device().barrier();
  finishList(frame, list);
  // Where nothing moves, the next list from nothing will be as long as this one.
  const bool repeats = moving.empty() && around == Around::scene;
  frame.judgeLater(list.count, kWantedOffset,
                   [this, repeats, capacity = list.capacity](PassContext&, std::uint32_t count) {
                     const bool fits = count <= capacity;
                     if (!fits || repeats) room_ = std::max<std::uint64_t>(roomFor(count, !repeats), 1);
                     return fits;
                   });
  fragments = list;
}

}  // namespace lumivox::voxelization
