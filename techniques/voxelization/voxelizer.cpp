#include "voxelizer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "lumivox/base/error.h"

namespace lumivox::voxelization {

using namespace shaders::voxelization;

Bounds boundsInGrid(const Bounds& bounds, const glm::mat4& toWorld, const GridPlacement& grid) {
  Bounds inGrid;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 local = glm::mix(bounds.low, bounds.high, glm::bvec3(corner & 1, corner & 2, corner & 4));
    inGrid.grow((glm::vec3(toWorld * glm::vec4(local, 1.0f)) - grid.low) / grid.voxelSize);
  }
  inGrid.low -= 1.0f;
  inGrid.high += 1.0f;
  return inGrid;
}

VoxelFragments listBehind(PassContext& frame, const GridPlacement& grid, const VoxelFragments* base,
                          std::uint64_t more) {
  VoxelFragments list;
  list.grid = grid;
  list.workGroupSize = kWorkGroupSize;
  list.capacity = more + (base != nullptr ? base->capacity : 0);
  requireListable(list.capacity);
  list.count = countBuffer(frame, "voxel fragment count");
  list.fragments = frame.elements(copy::fragments, list.capacity, "voxel fragments");
  if (base == nullptr) return list;
  assert(base->workGroupSize == kWorkGroupSize);
  list.coverage = base->coverage;
  list.reflected = base->reflected;  // shared by the first fragments, which are the same
  frame.dispatchIndirect(
      frame.program(copy::kProgram),
      {copy::baseCount(base->count), copy::baseFragments(base->fragments), appending(list)}, *base->count,
      VoxelFragments::kArgumentsBytes);
  return list;
}

gpu::ResourceBinding gridBinding(const GridPlacement& grid, std::uint64_t capacity) {
  return shader::UniformSlot<ListGrid>{"ListGrid"}(
      {grid.low, grid.voxelSize, grid.resolution, static_cast<int>(capacity)});
}

shader::BindingSet appending(const VoxelFragments& list) {
  return {gridBinding(list.grid, list.capacity), shader::StorageSlot{"Count"}(list.count),
          shader::StorageSlot{"Fragments"}(list.fragments)};
}

gpu::ResourceBinding viewAlong(const GridPlacement& grid, int axis, float depthLow, float depthHigh) {
  return shader::UniformSlot<View>{"View"}({static_cast<float>(grid.longest()), axis, depthLow, depthHigh});
}

std::string GridPass::checkParameters() const {
  if (around == Around::camera && !(extent > 0.0f)) return "around camera needs an extent above 0 m";
  return {};
}

Reads GridPass::readsFrom() const {
  const Reads surface = Reads::geometry | Reads::materials;
  return around == Around::camera ? surface | Reads::camera : surface;
}

GridPlacement GridPass::placement(PassContext& frame) const {
  const SceneSnapshot& snapshot = frame.snapshot();
  if (around == Around::camera) return placeGridAround(snapshot.camera.eye, extent, resolution);
  return placeGrid(snapshot.gridBounds, resolution);
}

GridPass::DrawsByMotion GridPass::drawsByMotion(PassContext& frame) {
  DrawsByMotion result;
  for (const SceneDraw& draw : frame.scene().draws())
    (draw.moving ? result.moving : result.still).push_back(&draw);
  return result;
}

gpu::TextureRef GridPass::markedWords(PassContext& frame, const GridPlacement& grid, const glm::ivec3& size,
                                      const std::string& label, const Mark& mark) {
  const auto [still, moving] = drawsByMotion(frame);
  const std::string ofStatic = label + " of static geometry";
  const gpu::TextureRef first = keptWhile(frame, grid, still, ofStatic, [&, &draws = still] {
    gpu::TextureRef words = frame.emptyVolume(size, gpu::Format::r32ui, ofStatic);
    if (!draws.empty()) mark(*words, draws);
    return words;
  });
  if (moving.empty()) return first;
  const gpu::TextureRef words = frame.volume(size, gpu::Format::r32ui, label);
  frame.dispatch(frame.program(bits_copy::kProgram), {bits_copy::source(first), bits_copy::target(words)},
                 size);
  mark(*words, moving);
  return words;
}

std::uint64_t Voxelizer::expectedFragments(const Scene& scene, const GridPlacement&) const {
  // Surfaces fill about as many voxels as the grid's six sides, twice as many between two layers; every
  // triangle touches at least one, usually a few.
  const auto side = static_cast<std::uint64_t>(resolution);
  return 12 * side * side + 4 * scene.triangleCount();
}

VoxelFragments Voxelizer::listOfStatic(PassContext& frame, const GridPlacement& grid, const Draws& still) {
  // A first guess must not exceed what one buffer can hold.
  const std::uint64_t most = frame.device().info().maxStorageBytes / VoxelFragments::kFragmentBytes;
  if (room_ == 0)
    room_ = std::max<std::uint64_t>(std::min(expectedFragments(frame.sceneDescription(), grid), most), 1);
  VoxelFragments list = listBehind(frame, grid, nullptr, room_);
  list.coverage = coverage();
  if (!still.empty()) append(frame, list, still);
  frame.device().barrier();
  list.still = countBuffer(frame, "static voxel fragment count");
  frame.dispatch(frame.program(copy_count::kProgram),
                 {copy_count::from(list.count), copy_count::to(list.still)}, {1, 1, 1});
  finishCount(frame, list.still, list.capacity);
  return list;
}

void Voxelizer::run(PassContext& frame) {
  if (!fragments.wanted()) return;
  const auto [still, moving] = drawsByMotion(frame);
  const GridPlacement grid = placement(frame);
  VoxelFragments list = keptWhile(frame, grid, still, "fragments of static geometry",
                                  [&, &draws = still] { return listOfStatic(frame, grid, draws); });
  // A reader of an earlier frame may still hold the old count.
  const gpu::BufferRef countOfStatic = std::exchange(list.count, countBuffer(frame, "voxel fragment count"));
  frame.dispatch(frame.program(copy_count::kProgram),
                 {copy_count::from(countOfStatic), copy_count::to(list.count)}, {1, 1, 1});
  if (!moving.empty()) append(frame, list, moving);
  frame.device().barrier();
  if (still.empty() || moving.empty()) {
    list.still = nullptr;
  } else {
    list.moving = countBuffer(frame, "moving voxel fragment count");
    frame.dispatch(
        frame.program(count_behind::kProgram),
        {count_behind::first(list.still), count_behind::count(list.count), count_behind::behind(list.moving),
         count_behind::parameters({static_cast<int>(list.capacity), kWorkGroupSize})},
        {1, 1, 1});
  }
  // Where nothing moves, the next list made from nothing will be as long as this one.
  finishGuessed(frame, list.count, list.capacity, 0, room_, moving.empty() && around == Around::scene);
  fragments = list;
}

}  // namespace lumivox::voxelization
