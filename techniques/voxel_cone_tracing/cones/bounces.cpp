#include "bounces.h"

#include <algorithm>
#include <utility>

#include "../octree/octree.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/counts.h"
#include "lumivox/toolkit/environment.h"
#include "lumivox/toolkit/media.h"

namespace lumivox::voxel_cone_tracing {

using namespace shaders::voxel_cone_tracing;

namespace {

/// What locates the sums in an octree; bound before the store that cones read, which has a tree of its own.
shader::BindingSet placesInTree(const ReflectingVoxels& voxels) {
  if (voxels.tree == nullptr) return {};
  return {shader::StorageSlot{"OctreeRanks"}(voxels.tree->ranks),
          shader::StorageSlot{"OctreeLevels"}(voxels.tree->levels)};
}

/// Bytes of what each voxel reflects that there are sums for.
std::uint64_t reflectedBytes(const VoxelSums& sums) {
  const std::uint64_t each = sums.directional ? add::directionalSums.elementBytes : add::sums.elementBytes;
  return sums.voxels->sizeBytes() / each * Bounces::bytesOfVoxel(sums.directional);
}

}  // namespace

float brightestAfter(PassContext& frame, float direct, int bounces) {
  if (bounces == 1) return direct;
  const glm::vec3 sky = brightestOfEnvironment(frame.sceneDescription());
  return static_cast<float>(bounces) * direct + std::max({sky.r, sky.g, sky.b});
}

Bounces::Bounces(Pass* pass, const DirectLight& light, Within within)
    : light_(light),
      cones_(pass, "bounce_cones", 6, lumivox::within(1, 256), "cones for each side of a fragment"),
      turns_(
          pass, "turns", kMostTurns, lumivox::within(1, kMostTurns),
          "with 'before': frames in which each voxel gathers light once, neighbours in different ones; between, it reflects what it did; 1, 2, 4 or 8") {
  if (within == Within::frame)
    count_.emplace(
        pass, "bounces", 1, lumivox::within(1, kMost),
        "number of reflections of the light in the voxels within a frame; 1: as published; for each further one, cones gather light at every fragment from the grid of the previous one");
}

std::string Bounces::check() const {
  if ((turns_ & (turns_ - 1)) == 0) return {};
  return "turns: voxels are divided by their places into 1, 2, 4 or 8 parts; expected one of these numbers";
}

Bounces::Moment Bounces::momentOf(const ReflectingVoxels& voxels, gpu::BufferRef reflected) {
  Moment moment;
  moment.reflected = std::move(reflected);
  moment.grid = voxels.fragments.grid;
  moment.firstOfLevels = voxels.firstOfLevels;
  moment.bricks = voxels.sums.bricks;
  if (voxels.tree == nullptr) return moment;
  moment.ranks = voxels.tree->ranks;
  moment.levels = voxels.tree->levels;
  return moment;
}

gpu::BufferRef Bounces::ofStore(PassContext& frame, const ReflectingVoxels& voxels, const StoreBinding& store,
                                float mostRadiance) const {
  Moment now = momentOf(voxels, frame.buffer(reflectedBytes(voxels.sums), "light that voxels reflect"));
  gather(frame, voxels, store, mostRadiance, nullptr, now);
  return now.reflected;
}

gpu::BufferRef Bounces::ofStoreBefore(PassContext& frame, const ReflectingVoxels& voxels,
                                      const StoreBinding& store, float mostRadiance) {
  const History<gpu::BufferRef> kept =
      frame.history(reflectedBytes(voxels.sums), "light that voxels reflect of the frame before");
  std::erase_if(moments_, [&](const Moment& moment) { return moment.reflected != kept.previous; });
  moments_.push_back(momentOf(voxels, kept.current));
  const bool follows = moments_.size() > 1 && moments_.front().grid == moments_.back().grid &&
                       moments_.front().firstOfLevels == moments_.back().firstOfLevels;
  gather(frame, voxels, store, mostRadiance, follows ? &moments_.front() : nullptr, moments_.back());
  return kept.current;
}

void Bounces::gather(PassContext& frame, const ReflectingVoxels& voxels, const StoreBinding& store,
                     float mostRadiance, const Moment* before, Moment& now) const {
  const VoxelFragments& all = voxels.fragments;
  const bool isTree = voxels.tree != nullptr;
  // Without a frame before all voxels gather; what is bound in its place is not read.
  const Moment& other = before != nullptr ? *before : now;
  if (before != nullptr) now.turn = (before->turn + 1) % turns_;
  shader::BindingSet turn{turns::turns({.turnBricks = voxels.sums.brickCount,
                                        .turns = before != nullptr ? static_cast<int>(turns_) : 1,
                                        .turn = before != nullptr ? now.turn : 0,
                                        .followsFrame = before != nullptr,
                                        .facesOfVoxel = voxels.sums.directional ? 6 : 1}),
                          turns::reflectedBefore(other.reflected), turns::bricksBefore(other.bricks)};
  if (isTree)
    turn.add(shader::BindingSet{OctreeBinding(*voxels.tree), turns::ranksBefore(other.ranks),
                                turns::levelsBefore(other.levels)});

  ChangedCells listed;  // only the list
  listed.fragments = frame.elements(turns::listedFragments, all.capacity, "fragments that gather light");
  listed.count = countBuffer(frame, "number of fragments that gather light");
  forEachFragment(frame, frame.program(turns::Variant{.tree = isTree}),
                  {turn, turns::listedCount(listed.count), turns::listedFragments(listed.fragments)}, all);
  finishCount(frame, listed.count, all.capacity);

  VoxelSums sums = voxels.sums;
  sums.voxels = frame.buffer(voxels.sums.voxels->sizeBytes(), "sums of light that voxels reflect");
  sums.voxels->clear();
  sums.changed = &listed;
  const gpu::BufferRef radiances = radiancesOf(frame, all, sums);
  const MediaBinding bound(frame, light_.media, !store.holdsMedia);
  const bounce::Variant variant{.directions = sums.directional,
                                .store = store.axis,
                                .faces = store.faces,
                                .environment = frame.traits().environment,
                                .medium = bound.axis,
                                .places = sums.kind};
  // In a closed room cones lose nothing if they see partly covered finest voxels and, with six faces, the
  // voxel in which they begin. With one value for all sides the voxel in which they begin is the surface
  // itself.
  const MarchSettings march{.start = sums.directional ? 0.0f : 1.0f, .refinement = 0.0f};
  VoxelFragments some = all;
  some.count = listed.count;
  frame.dispatchIndirect(frame.program(variant, bounce::Constants{.environmentMap = environmentMapOf(frame)}),
                         {FragmentBinding(some), EnvironmentBinding(frame),
                          bounce::parameters({.gridLow = all.grid.low,
                                              .voxelSize = all.grid.voxelSize,
                                              .brickCount = sums.brickCount,
                                              .coneCount = cones_,
                                              .mostRadiance = mostRadiance,
                                              .twoSided = light_.twoSided,
                                              .glossy = light_.glossy(frame)}),
                          bounce::listedFragments(listed.fragments), bounce::radiances(radiances),
                          placesInTree(voxels), store, sums.bindings(), march.binding(frame, store), bound},
                         *listed.count, kGroupsOffset);
  addUp(frame, all, sums, radiances);

  const auto& program = frame.program(reflected::Variant{.directions = sums.directional, .tree = isTree});
  const shader::BindingSet bindings{turn, sums.bindings(), reflected::reflectedNow(now.reflected)};
  if (isTree) {
    forEachBrick(frame, program, bindings, *voxels.tree, voxels.tree->depth, VoxelOctree::kBrickVoxels);
  } else {
    frame.dispatchIndirect(
        program,
        {bindings, reflected::brickList(voxels.bricks->bricks), reflected::brickCount(voxels.bricks->count)},
        *voxels.bricks->count, OccupiedBricks::argumentsBytes(0));
  }
}

}  // namespace lumivox::voxel_cone_tracing
