#pragma once

#include <cstdint>
#include <memory>

#include "lumivox/pipeline/port.h"

namespace lumivox {

/// The occupied bricks of a volume, unordered.
struct OccupiedBricks {
  static constexpr int kSide = 4;  ///< finest voxels along a side of a brick
  gpu::BufferRef bricks;           ///< words: i, j, k of each brick, in 10 bits each
  gpu::BufferRef count;  ///< words: bricks; then x, y, z of the indirect dispatches of one thread for each
                         ///< voxel in them at level 0, at level 1 and at level 2, in groups of kGroupSize
  static constexpr int kGroupSize = 64;
  /// Where the arguments of a level's dispatch lie in `count`.
  static constexpr std::uint64_t argumentsBytes(int level) {
    return (1 + 3 * static_cast<std::uint64_t>(level)) * sizeof(std::uint32_t);
  }
};

/// A volume that its pass updates in place: the part of its finest level that differs from the previous run.
struct ChangedBricks {
  /// The maker of the coarser levels in the same textures, and the run that they are made from. Holding the
  /// pointer keeps its address unique.
  struct Levels {
    std::shared_ptr<const void> by;
    std::uint64_t number = 0;
  };
  std::shared_ptr<Levels> levels;  ///< those of these textures; null: every run makes the volume anew
  std::uint64_t number = 0;        ///< of the run, one more than that of the run before
  OccupiedBricks bricks;           ///< bricks that are empty by now are among them; null members: all
  /// Whether `by` made the coarser levels of the previous run, so that only voxels above these bricks differ.
  /// Records `by` as the maker for this run.
  bool continues(const std::shared_ptr<const void>& by) const {
    const bool result = levels->by == by && levels->number + 1 == number && bricks.bricks != nullptr;
    *levels = {by, number};
    return result;
  }
};

/// Pre-filtered outgoing radiance, pre-multiplied by opacity, one mip per halving (Crassin et al. 2011).
struct RadianceGrid {
  GridPlacement grid;
  gpu::TextureRef radiance;
  float unit = 1.0f;     ///< W/(sr m^2): keeps very bright and very dark light within half floats
  int filledLevels = 0;  ///< mip levels that hold values, finest first; 0: all that the texture has
  /// The meaning of a coarser voxel's opacity: across the whole voxel; or along a path of one finest voxel's
  /// length in it, which the mean of the children gives for a uniform medium.
  enum class Opacity { ofVoxel, ofFinestVoxel } opacity = Opacity::ofVoxel;
  int bounces = 1;          ///< times that the light was reflected
  bool holdsMedia = false;  ///< participating media are in the voxels beside the surfaces
  /// Outside of these bricks the finest level is 0; null members: not known.
  OccupiedBricks occupied;
  ChangedBricks changed;
};

template <>
struct PortTraits<RadianceGrid> {
  static PortKind kind() {
    return {
        "RadianceGrid",
        "outgoing radiance and opacity per voxel, one mip per halving",
        {{"radiance", "d3 rgba16f or rgba32f with mips", "rgb radiance * opacity / unit, a opacity"},
         {"bricks", "buffer", "i, j, k of each occupied brick of 4 x 4 x 4 voxels, in 10 bits each; or null"},
         {"count", "buffer", "number of bricks; then indirect dispatches over their voxels; or null"}},
        {{"radiance", "outgoing radiance, multiplied by the opacity", "W/(sr m^2)"},
         {"opacity", "opacity", "1", PortField::Role::fog}},
        {},
        {radianceUnitCondition(),
         {"filledLevels", "mip levels that hold values, finest first; 0: all that the texture has",
          "undefined memory is read as light", "of coarser levels"},
         {"opacity",
          "whether the opacity of a coarser voxel is that across the whole voxel, or along a path of one finest voxel in it",
          "coarser voxels are too opaque or too transparent", "of coarser levels"},
         {"holdsMedia", "whether the voxels hold participating media beside the surfaces",
          "media count twice", "that see through media besides"}}};
  }
  static void contents(const RadianceGrid& port, PortContents& contents) {
    const int filled = port.filledLevels == 0 ? port.radiance->description().levels : port.filledLevels;
    contents.texture("radiance", port.radiance, {.levels = filled});
    contents.buffer("bricks", port.occupied.bricks);
    contents.buffer("count", port.occupied.count);
    for (int level = 0; level < filled; ++level) {
      const VoxelBox box = VoxelBox::of(port.grid, levelResolution(port.grid.resolution, level));
      const VoxelTexels radiance{{port.radiance}, {{0, 0}, {0, 1}, {0, 2}}, level, port.unit};
      contents.field("radiance", box, radiance, level);
      contents.field("opacity", box, VoxelTexels{{port.radiance}, {{0, 3}}, level}, level);
    }
  }
};

}  // namespace lumivox
