#pragma once

#include "lumivox/pipeline/port.h"

namespace lumivox {

/// An unordered list of surface samples, one per triangle and voxel that it touches (Crassin & Green 2012).
struct VoxelFragments {
  static constexpr std::uint64_t kFragmentBytes = 6 * sizeof(std::uint32_t);
  GridPlacement grid;
  gpu::BufferRef fragments;
  /// Made anew whenever the list is. A reader may hold the pointer: while it is the same, so are the
  /// fragments.
  gpu::BufferRef count;
  /// Direct light that fragments are known to reflect, as a renderer computed it at visible surfaces
  /// (Mavridis & Papaioannou 2011, Sec. 3.2). Null: known for none. Otherwise a word for each of the first
  /// fragments: the radiance in W/(sr m^2) that leaves the visible side (`kSeenBehind` in
  /// shaders/common/voxel.glsl), packed by `packShared`, or kNotKnown; fragments beyond the buffer's end are
  /// not known. The other side is lit by the lights.
  gpu::BufferRef reflected;
  static constexpr std::uint32_t kNotKnown = 0xffffffffu;
  /// In a scene with static and moving geometry: `still` counts the static fragments, which come first, and
  /// `moving` those behind them. While `still` is the same buffer, its fragments and their places are
  /// unchanged; a reader may hold the pointer to compare. Null: not separated.
  gpu::BufferRef still, moving;
  std::uint64_t capacity = 0;
  int workGroupSize = 64;  ///< that the indirect dispatch assumes
  /// How the coverages of the fragments in one voxel give its opacity: by their mean (each is less than 1
  /// only where a mask has holes), or by their sum up to 1 (each covers a part of the voxel).
  enum class Coverage { mean, sum } coverage = Coverage::mean;

  /// Where the arguments of the indirect dispatch lie in `count`.
  static constexpr std::uint64_t kArgumentsBytes = sizeof(std::uint32_t);
};

template <>
struct PortTraits<VoxelFragments> {
  static PortKind kind() {
    return {
        "VoxelFragments",
        "an unordered list of surface samples, one per triangle and voxel that it touches",
        {{"fragments", "buffer", "array of VoxelFragment in shaders/common/voxel.glsl"},
         {"count", "buffer", "words: fragments written; then x, y, z of an indirect dispatch over them"},
         {"reflected", "buffer",
          "a word for each fragment: direct light that it is known to reflect; or null"},
         {"still", "buffer", "as count, for the first fragments, which are static; or null"},
         {"moving", "buffer", "as count, for the moving fragments behind them; or null"}},
        {{"occupancy", "whether a surface touches the voxel", "1"},
         {"fragments", "surface samples in the voxel", "1"}},
        "voxels with a fragment of coverage above 0",
        {{"reflected",
          "direct light that the first fragments are known to reflect to the visible side; null: known for none; kNotKnown: the reader lights the fragment itself",
          "light that is already known is computed again, in another way", "that light fragments"},
         {"coverage",
          "whether the opacity of a voxel is the mean of its fragments' coverages, or their sum up to 1",
          "voxels are too open or too closed", "that make opacities"}}};
  }
  static void contents(const VoxelFragments& port, PortContents& contents) {
    contents.buffer("fragments", port.fragments);
    contents.buffer("count", port.count);
    contents.buffer("reflected", port.reflected);
    contents.buffer("still", port.still);
    contents.buffer("moving", port.moving);
    VoxelList list{port.fragments, port.count, VoxelFragments::kFragmentBytes, port.capacity};
    const VoxelBox box = VoxelBox::of(port.grid);
    contents.field("occupancy", box, list);
    list.counts = true;
    contents.field("fragments", box, list);
    list.fills = [](const std::uint32_t* words) { return words[4] >> 16 != 0; };  // coverage, a half
    contents.occupies(port.grid, list);
  }
};

}  // namespace lumivox
