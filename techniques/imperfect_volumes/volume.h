// Common parts of all stages: the volume and its look-up at a surface point.
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

/// Three volumes of coefficients, rgba32f by default. Where they do not fit, an Error names the bytes and the
/// largest size that fits.
std::array<gpu::TextureRef, 3> coefficientVolumes(PassContext& frame, const glm::ivec3& resolution,
                                                  const char* label,
                                                  gpu::Format format = gpu::Format::rgba32f);

/// The three volumes under the names redImage, greenImage and blueImage.
shader::BindingSet images(const std::array<gpu::TextureRef, 3>& volumes);

/// A volume of radiance with its unit, the value of a stored 1.
struct RadianceVolume {
  const ShGrid::Level& level;
  float unit;
};
/// The volume of an input. Error for another quantity, for several levels, or where the voxels that hold
/// values (ShGrid::readFor) are not those of `voxels`, which is empty where all are read.
RadianceVolume volumeOf(const In<ShGrid>& light, const std::string& voxels = {});

/// Error where a grid is not that of the others.
void requireSameGrid(const char* input, const GridPlacement& grid, const char* other,
                     const GridPlacement& otherGrid);

/// The voxels that a surface point reads around it (Sec. 3.4), as members of a pass. March and gather compare
/// inWords(): they must agree wherever not all of the volume is filled.
class Neighbours {
 public:
  explicit Neighbours(Pass* pass);
  /// "'voxels six', 'filter on' and 'shift 0.5'"
  std::string inWords() const;
  gpu::ResourceBinding binding() const;
  /// Whether only free neighbours count, where there are any.
  bool onlyFree() const { return blend_ == Blend::free; }
  /// The generated Constants with these settings.
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

/// Each function registers the passes of its file.
void addInject(TechniqueRegistry& registry);
void addMarch(TechniqueRegistry& registry);
void addGather(TechniqueRegistry& registry);

}  // namespace lumivox::imperfect_volumes
