// Levels of a clipmap from their finer ones: thesis Gomes 2015, Sec. 3.5.
#include <algorithm>
#include <memory>
#include <optional>

#include "clipmap.h"
#include "clipmap_items.h"

namespace lumivox::voxel_cone_tracing {

using namespace shaders::voxel_cone_tracing;

namespace {

class ClipmapFilterPass : public Pass {
  In<RadianceClipmap> radiance{this, "radiance", "levels as voxelized"};
  Param<float> ramp{
      this, "ramp", 0.25f, within(0.0f, 1.0f),
      "width of the transition from voxelized to filtered voxels within a level, as a share of the distance from the finer level's border to its middle; 0: no transition"};
  Param<float> border{
      this, "border", 0.25f, within(0.0f, 1.0f),
      "width of the transition of cones to the next coarser level, as a share of the same distance; 0: within a voxel"};
  Out<RadianceClipmap> mips{this, "mips",
                            "the same levels; inside the next finer level, their voxels come from its voxels",
                            Levels::all};

  /// The change up to which the blocks of these volumes are current.
  struct Made {
    gpu::BufferRef of;
    std::uint64_t number = 0;
  };

  void run(PassContext& frame) override {
    RadianceClipmap result = *radiance;
    const auto half = 0.5f * static_cast<float>(result.levels.front().own.period);
    result.ramp = 0.5f * half * ramp;  // in voxels of the coarser level
    result.border = std::max(half * border, 1.0f);
    const std::shared_ptr<Made> made = frame.kept("what is made of levels", result.occupied, [&] {
      return std::make_shared<Made>(Made{result.occupied, 0});
    });
    const bool all = result.change.all || made->number + 1 != result.change.number;
    made->number = result.change.number;
    const ItemLists lists(frame, result.levels.size(), largestMade(result));
    const gpu::BufferRef madeAnew = frame.buffer(result.occupied->sizeBytes(), "voxels of levels made anew");
    madeAnew->clear();
    std::optional<ReadCells> read;
    if (!all && result.change.cells != nullptr && stays(result)) read.emplace(frame, result);
    // Bounds of the differences as they are read, level by level.
    VoxelRange changed = result.change.voxelized.front();
    const int count = static_cast<int>(result.levels.size());
    for (int level = 1; level < count; ++level) {
      const auto i = static_cast<std::size_t>(level);
      const RadianceClipmap::Level& there = result.levels[i];
      const bool above = level >= result.around;
      const RadianceClipmap::Block& block = above ? there.own : there.inner;
      const VoxelRange addresses{block.voxels.first, block.voxels.first + block.period};
      VoxelRange touched = coarserTouching(changed);
      if (!above) touched = touched.around(result.change.voxelized[i]);
      // A moved finer level also moves its border, and with it the ramp.
      const bool anew = all || hasMoved(result, std::min(i, static_cast<std::size_t>(result.around)) - 1);
      changed = anew ? touched.around(block.voxels) : touched;
      if (anew && !all && !above) changed = changed.around(result.change.before[i].inner.voxels);
      // This is also known for the first level above those around the camera.
      const bool listed = read && level <= result.around;
      if (listed) read->find(frame, result, level);
      make(frame, result, lists, madeAnew, listed ? &read->lists : nullptr, level,
           (anew ? addresses : touched).within(addresses), all);
    }
    result.filledLevels = count;
    mips = result;
  }

  /// Number of voxels of the largest block to be made.
  static std::uint64_t largestMade(const RadianceClipmap& clipmap) {
    std::uint64_t result = 0;
    for (std::size_t level = 1; level < clipmap.levels.size(); ++level) {
      const RadianceClipmap::Level& there = clipmap.levels[level];
      const bool above = static_cast<int>(level) >= clipmap.around;
      const auto along = static_cast<std::uint64_t>((above ? there.own : there.inner).period);
      result = std::max(result, along * along * along);
    }
    return result;
  }

  /// While no level moves, the cells whose read values differ from before, listed level by level.
  struct ReadCells {
    std::uint64_t cells;
    gpu::BufferRef flags;
    ItemLists lists;

    ReadCells(PassContext& frame, const RadianceClipmap& clipmap)
        : cells(cellsOfLevel(clipmap.levels.front().own.period)),
          flags(frame.elements(clipmap_coarser::readCells,
                               cells * (static_cast<std::uint64_t>(clipmap.around) + 1),
                               "cells of levels that are read otherwise")),
          lists(frame, clipmap.levels.size(), cells) {}
    void find(PassContext& frame, const RadianceClipmap& clipmap, int level) const {
      frame.dispatchList(
          frame.program(clipmap_coarser::kProgram),
          {clipmapBinding(clipmap), clipmap_coarser::level({level}), clipmap_coarser::readCells(flags),
           clipmap_coarser::clipmapCells(clipmap.change.cells), lists.bindings()},
          cells);
    }
  };

  /// Makes the differing part of a level within these voxels.
  static void make(PassContext& frame, const RadianceClipmap& clipmap, const ItemLists& lists,
                   const gpu::BufferRef& madeAnew, const ItemLists* cells, int level, const VoxelRange& part,
                   bool all) {
    if (part.empty()) return;
    const auto i = static_cast<std::size_t>(level);
    const bool above = level >= clipmap.around;
    clipmap_anew::Level differing{.firstMade = part.first, .level = level, .endMade = part.end};
    if (!all) {
      differing.had = hadOf(clipmap.change.before[i]);
      differing.finerHad = hadOf(clipmap.change.before[i - 1]);
    }
    const shader::BindingSet bindings{clipmapBinding(clipmap),
                                      clipmap_anew::level(differing),
                                      lists.bindings(),
                                      clipmap_anew::madeAnew(madeAnew),
                                      clipmap_anew::clipmapOccupied(clipmap.occupied),
                                      clipmap_anew::clipmapCells(clipmap.change.cells)};
    clipmap_anew::Variant variant{.above = above, .cells = !all && clipmap.change.cells != nullptr};
    if (cells != nullptr) {
      variant.listed = 1;
      frame.dispatchIndirect(
          frame.program(variant),
          {bindings, clipmap_anew::cellHeads(cells->heads), clipmap_anew::cellItems(cells->items)},
          *cells->heads, ItemLists::argumentsBytes(i));
    } else {
      frame.dispatch(frame.program(variant), bindings, part.size());
    }
    frame.dispatchIndirect(
        frame.program(clipmap_filter::Variant{.above = above}),
        {clipmap_filter::level({part.first, level}), facesOf(clipmap.faces, gpu::Sampling::nearest),
         writing(clipmap), lists.bindings()},
        *lists.heads, ItemLists::argumentsBytes(i));
  }

  /// The former block of a level.
  static clipmap_anew::Had hadOf(const RadianceClipmap::Level& level) {
    int endless = 0;  // LevelEnds::endless
    for (int axis = 0; axis < 3; ++axis) {
      if (level.reachFirst[axis] <= -RadianceClipmap::kEndless) endless |= 1 << axis;
      if (level.reachEnd[axis] >= RadianceClipmap::kEndless) endless |= 8 << axis;
    }
    return {.ownFirst = {level.own.voxels.first, endless},
            .ownEnd = {level.own.voxels.end, 0},
            .innerFirst = {level.inner.voxels.first, 0},
            .innerEnd = {level.inner.voxels.end, 0}};
  }
  static bool stays(const RadianceClipmap& clipmap) {
    for (std::size_t level = 0; level < static_cast<std::size_t>(clipmap.around); ++level)
      if (hasMoved(clipmap, level)) return false;
    return true;
  }
  static bool hasMoved(const RadianceClipmap& clipmap, std::size_t level) {
    return clipmap.levels[level].own.voxels != clipmap.change.before[level].own.voxels;
  }
};

}  // namespace

void addClipmapFilter(TechniqueRegistry& registry) {
  registry.add<ClipmapFilterPass>("clipmap_filter",
                                  "Levels of a clipmap from their finer ones (thesis Sec. 3.5)");
}

}  // namespace lumivox::voxel_cone_tracing
