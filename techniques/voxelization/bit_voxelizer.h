// Common parts of voxelizers of single bits: words for atomic operations, and the output for a gatherer.
#pragma once

#include <cstdint>

#include "voxelizer.h"

namespace lumivox::voxelization {

/// One bit per voxel in 32-bit words along z, which shaders can change atomically: bit b of texel (i, j, w)
/// is voxel (i, j, 32 w + b). d3 r32ui.
gpu::TextureRef bitWords(PassContext& frame, const GridPlacement& grid, const char* label);

/// Sets the bits of the voxels of a list.
void markFragments(PassContext& frame, const VoxelFragments& fragments, const gpu::Texture& words);

/// The stacks, with their hierarchy, of the voxels in `voxels` and, where there is one, in `surface`.
BinaryGrid binaryGridOf(PassContext& frame, const GridPlacement& grid, const gpu::Texture& voxels,
                        const gpu::Texture* surface);

/// The bits of static geometry are kept, and in every frame those of what moves are added to a copy of
/// them.
class BitVoxelizer : public GridPass {
 public:
  Reads readsFrom() const override { return readsSurface(); }
  void run(PassContext& frame) override;

 protected:
  /// Sets the bits of these draws.
  virtual void mark(PassContext& frame, const GridPlacement& grid, const gpu::Texture& words,
                    const Draws& draws) = 0;
  /// Surface samples whose voxels belong to the result too, and whose grid it takes; null: none.
  virtual const VoxelFragments* surface() const { return nullptr; }

  Out<BinaryGrid> bits{this, "bits", "one bit a voxel, in stacks of 128 along z with a hierarchy in x and y"};
  Out<OccupancyGrid> opacity{this, "opacity", "1 in every voxel whose bit is set, else 0"};
  Out<VoxelFragments> fragments{this, "fragments",
                                "a black opaque fragment for every set voxel that has no surface sample"};

 private:
  /// Words of the result: what was voxelized, and the voxels of given surface samples (null: none).
  struct Words {
    gpu::TextureRef voxels, surface;
  };
  /// For the binding that variants without a surface do not have.
  static const gpu::Texture& surfaceOf(const Words& words);
  gpu::TextureRef wordsOf(PassContext& frame, const GridPlacement& grid);
  OccupancyGrid opacityOf(PassContext& frame, const GridPlacement& grid, const Words& words) const;
  VoxelFragments fragmentsOf(PassContext& frame, const GridPlacement& grid, const Words& words);

  std::uint64_t room_ = 0;  ///< fragments that the list is made for, beside those of the surface
};

}  // namespace lumivox::voxelization
