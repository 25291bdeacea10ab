// Where a ray through bits ends within an occupied voxel. GLSL side: shaders/common/voxel_planes.glsl.
#pragma once

#include <cstdint>
#include <string>

#include "lumivox/pipeline/pass.h"
#include "lumivox/pipeline/ports/binary_grid.h"
#include "lumivox/pipeline/ports/voxel_fragments.h"

namespace lumivox {

/// The planes of the surface within each occupied voxel, for shaders. They last as long as this.
class VoxelPlanes : public shader::BindingSet {
 public:
  VoxelPlanes() = default;  ///< rays end at boxes, without planes
  VoxelPlanes(gpu::TextureRef ofVoxels, gpu::BufferRef planes);

 private:
  gpu::TextureRef ofVoxels_;
  gpu::BufferRef planes_;
};

/// The end of rays in occupied voxels: a parameter and an input of a pass.
class RayStop {
 public:
  explicit RayStop(Pass* pass);
  bool atPlanes() const { return stop_ == Stop::plane; }
  bool isInput(const InBase& input) const { return &input == &fragments_; }
  /// What is wrong with the parameters, in words, or empty. `boxesOnly`: the pass follows its rays in a way
  /// that ends at boxes; `parameter` and `value` choose that way.
  std::string check(bool boxesOnly, const char* parameter, const std::string& value) const;
  /// With planes, makes them from the fragments, or those of an earlier frame where the fragments are the
  /// same. Error where the fragments are missing or on another grid than the bits. `pass`: whose input they
  /// are.
  VoxelPlanes planes(PassContext& frame, const BinaryGrid& bits, const std::string& pass);
  /// How far the end of a ray may lie from the surface that a map shows, in the voxels' own measure
  /// (BackProjection::binding()): planes are nearer to it than boxes.
  float voxelsOfMap() const { return atPlanes() ? 0.5f : 1.0f; }
  /// A bound for the loop iterations that are added to those of a ray that ends at the first voxel.
  std::int64_t turns(const BinaryGrid& bits) const;

 private:
  enum class Stop { box, plane };
  VoxelPlanes planesOf(PassContext& frame, const VoxelFragments& fragments);
  Param<Stop> stop_;
  In<VoxelFragments> fragments_;
  std::uint64_t room_ = 0;  ///< number of slots: a guess, or what earlier frames needed
};

}  // namespace lumivox
