// The voxels of any field as a camera sees them, or along the axes of their grid, drawn by the device that
// holds them: for passes, and for tools that look at what passes made.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "lumivox/base/image.h"
#include "lumivox/pipeline/pass.h"

namespace lumivox {

/// Whose programs draw, and where their textures come from: a pass's frame, or a device without one.
struct VoxelCanvas {
  explicit VoxelCanvas(PassContext& frame);
  explicit VoxelCanvas(shader::ShaderLibrary& shaders);
  shader::ShaderLibrary& shaders;
  std::function<gpu::TextureRef(const gpu::TextureDescription&, const std::string& label)> texture;
};

/// The fields of a level of a port, one at least. Error, which names the levels that there are, where there
/// is none.
std::vector<const PortContents::Field*> fieldsOfLevel(const PortContents& contents, int level);

/// A field as shaders/toolkit/voxel_field.glsl reads it: textures as they are; the items of a list marked in
/// a volume by the device; and what only the host can read uploaded.
class VoxelField {
 public:
  /// Error for textures that do not fit the field, and for voxels outside of its grid.
  VoxelField(const VoxelCanvas& canvas, const PortContents::Field& field);

  shader::BindingSet bindings() const;
  int source() const { return source_; }      ///< of the axis SOURCE
  int channels() const { return channels_; }  ///< of a value: 1 or 3
  const glm::ivec3& resolution() const { return box_.resolution; }

 private:
  friend class VoxelTransfer;
  void take(const VoxelCanvas& canvas, const VoxelTexels& source);
  void take(const VoxelCanvas& canvas, const VoxelBits& source);
  void take(const VoxelCanvas& canvas, const VoxelList& source);
  void take(const VoxelCanvas& canvas, const VoxelsFilled& source);
  void take(const VoxelCanvas& canvas, const VoxelsRead& source);
  void makeVolume(const VoxelCanvas& canvas, gpu::Format format);

  std::string name_;
  VoxelBox box_;
  int source_ = 0, channels_ = 1, level_ = 0;
  float unit_ = 1.0f;
  bool counts_ = false;
  std::array<gpu::TextureRef, 3> textures_;  ///< of another source than texels, the first alone
  glm::ivec3 textureOf_{0}, componentOf_{0};
};

/// What the voxels of a field emit and how opaque they are, as shaders/toolkit/voxel_transfer.glsl reads it.
class VoxelTransfer {
 public:
  enum class Opacity { solid, field, absorption };  // in the order of the axis OPACITY
  struct Rule {
    Opacity opacity = Opacity::solid;
    const PortContents::Field* opacityField = nullptr;  ///< for Opacity::field: numbers, in its first channel
    float absorption = 1.0f;                            ///< 1/m at the value 1
    float rampLow = 1.0f, rampHigh = 0.0f;              ///< values at its ends; low above high: no ramp
    bool multiplied = false;                            ///< values are multiplied by the opacity already
  };
  VoxelTransfer(const VoxelCanvas& canvas, const PortContents::Field& field, const Rule& rule);

  const VoxelField& values() const { return values_; }
  shader::BindingSet bindings() const;  ///< with those of the values
  int opacity() const { return static_cast<int>(rule_.opacity); }

 private:
  VoxelField values_;
  std::vector<VoxelField> opacities_;  ///< none or one
  Rule rule_;
  bool isDirection_;
};

/// How a camera looks at voxels.
struct VoxelLook {
  enum class Shading { none, sides, edges };  // in the order of shaders/toolkit/voxel_rays.glsl
  float cut = 0.0f;                           ///< m along the view axis: what is nearer is not seen
  float above = 0.0f;  ///< cubes and lobes whose values are all at most this far from 0 are left out
  Shading shading = Shading::none;  ///< of blended voxels
  float gain = 1.0f, background = 0.0f;

  /// The block of shaders/toolkit/voxel_rays.glsl.
  shader::BindingSet rays(const CameraView& camera) const;
};

/// First voxels on the rays, but for the one around the eye: their values, and as a fourth component the
/// brightness of the side that is seen, 0 where no voxel is. As cubes with edges; or, of the first of four
/// spherical harmonics that lie in the components of three textures, as lobes. d2 rgba32f.
gpu::TextureRef firstVoxels(const VoxelCanvas& canvas, const CameraView& camera, const VoxelField& field,
                            const VoxelLook& look, bool lobes = false);

/// All voxels on the rays, each by the ray's length in it, in front of the background. d2 rgba32f.
gpu::TextureRef blendedVoxels(const VoxelCanvas& canvas, const CameraView& camera,
                              const VoxelTransfer& transfer, const VoxelLook& look);

/// The largest value of each column of voxels along x, y and z, of three channels each by itself, regardless
/// of the sign; three alike of one channel. Along x the view has z to the left, along z it has x to the
/// right, both with y up; along y, from above, it has z downwards.
std::vector<ImageBuffer> largestAlongAxes(const VoxelCanvas& canvas, const VoxelField& field);

}  // namespace lumivox
