// Common parts of voxelizers of single bits: words for atomic operations, and the output for a gatherer.
#pragma once

#include "../voxelizer.h"

namespace lumivox::voxelization {

/// One bit per voxel in 32-bit words along z, which shaders can change atomically: bit b of texel (i, j, w)
/// is voxel (i, j, 32 w + b). d3 r32ui.
gpu::TextureRef bitWords(PassContext& frame, const GridPlacement& grid, const char* label);

/// When a voxel with holes is set: always; from half coverage on; or with the probability of its coverage. In
/// the order of masks.glsl.
enum class Masks { any, half, random };

/// The bits of a list's voxels. Fragments are judged one by one, even in a list whose coverages add up.
gpu::TextureRef bitsOf(PassContext& frame, const VoxelFragments& fragments, const char* label,
                       Masks masks = Masks::any);
/// The bits by the joint coverage of a voxel's fragments; voxels without coverage are not set.
gpu::TextureRef bitsOf(PassContext& frame, const OccupancyGrid& opacity, const char* label, Masks masks);

/// Words of voxels and of surface samples beside them (null: none); bits.glsl.
struct BitWords {
  gpu::TextureRef voxels, surface;
  shader::BindingSet bindings() const;
};

/// The stacks, with their hierarchy, of all of these voxels.
BinaryGrid binaryGridOf(PassContext& frame, const GridPlacement& grid, const BitWords& words);

/// The stacks of a list that tells moving from still fragments (VoxelFragments::still). Still ones are kept,
/// and only columns in which something moves or moved are made anew, in place. The bits are the same as
/// without.
BinaryGrid followedGridOf(PassContext& frame, const VoxelFragments& fragments, Masks masks);

/// Keeps the bits of static geometry; every frame adds those of moving geometry to a copy of them.
class BitVoxelizer : public GridPass {
 public:
  void run(PassContext& frame) override;

 protected:
  /// Sets the bits of these draws.
  virtual void mark(PassContext& frame, const GridPlacement& grid, const gpu::Texture& words,
                    const Draws& draws) = 0;
  /// Surface samples whose voxels also belong to the result, and whose grid it takes; null: none.
  virtual const VoxelFragments* surface() const { return nullptr; }

  Out<BinaryGrid> bits{this, "bits", "one bit a voxel, in stacks of 128 along z with a hierarchy in x and y"};
  Out<OccupancyGrid> opacity{this, "opacity", "1 in every voxel whose bit is set, else 0"};
  Out<VoxelFragments> fragments{this, "fragments",
                                "a black opaque fragment for every set voxel that has no surface sample"};

 private:
  VoxelFragments fragmentsOf(PassContext& frame, const GridPlacement& grid, const BitWords& words);

  std::uint64_t room_ = 0;  ///< fragments that the list has room for, beside those of the surface
};

}  // namespace lumivox::voxelization
