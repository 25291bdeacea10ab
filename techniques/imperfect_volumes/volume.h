// Common parts of all stages: the volume, what a surface point reads of it, and the voxels that are read.
#pragma once

#include <optional>
#include <string>

#include "imperfect_volumes_shaders.h"
#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/grid_placement.h"
#include "lumivox/toolkit/sh_grid.h"

namespace lumivox::imperfect_volumes {

/// Block Volume of volume.glsl. `occupied`: coverage above which a voxel is occupied.
gpu::ResourceBinding volumeBinding(const GridPlacement& grid, float occupied = 0.0f);

/// Three volumes of coefficients, rgba32f unless another format is said. Error with the bytes, and the
/// largest size that fits, where they do not fit.
std::array<gpu::TextureRef, 3> coefficientVolumes(PassContext& frame, const glm::ivec3& resolution,
                                                  const char* label,
                                                  gpu::Format format = gpu::Format::rgba32f);

/// The three volumes under the names redImage, greenImage and blueImage.
shader::BindingSet images(const std::array<gpu::TextureRef, 3>& volumes);

/// A volume of radiance, and the value that the number 1 in it stands for.
struct RadianceVolume {
  const ShGrid::Level& level;
  float unit;
};
/// The volume of an input. Error for another quantity, several levels, or where only the voxels of another
/// reading (ShGrid::readFor) hold values than of `voxels`; empty: all of them are read.
RadianceVolume volumeOf(const In<ShGrid>& light, const std::string& voxels = {});

/// Error where a grid is not that of the others.
void requireSameGrid(const char* input, const GridPlacement& grid, const char* other,
                     const GridPlacement& otherGrid);

/// What a surface point reads around it (Sec. 3.4): members of a pass. March and gather must agree in it
/// wherever not all of the volume is filled, which they find by the words.
class Neighbours {
 public:
  explicit Neighbours(Pass* pass);
  /// "six voxels, filtered, shifted by 0.5 voxels"
  std::string inWords() const;
  gpu::ResourceBinding binding() const;
  /// Whether only free neighbours count, where there are any.
  bool onlyFree() const { return blend_ == Blend::free; }
  /// Generated Constants with these settings in them.
  template <class Constants>
  Constants in(Constants constants) const {
    constants.voxels = static_cast<int>(Voxels(voxels_));
    constants.filtered = filter_;
    if constexpr (requires { constants.onlyFree; }) constants.onlyFree = onlyFree();
    return constants;
  }

 private:
  // In the order of their numbers in neighbours.glsl.
  enum class Voxels { six, eight, own, trilinear };
  enum class Blend { all, free };
  Param<Voxels> voxels_;
  Param<bool> filter_;
  Param<float> shift_;
  Param<Blend> blend_;
};

/// Each registers the passes of its file.
void addInject(TechniqueRegistry& registry);
void addMarch(TechniqueRegistry& registry);
void addGather(TechniqueRegistry& registry);

}  // namespace lumivox::imperfect_volumes
