#pragma once

#include "lumivox/pipeline/port.h"
#include "lumivox/scene/scene.h"

namespace lumivox {

/// Scattering media. Extinction and scattering of one medium are its density times its constants; they end at
/// its bounds.
struct ScatteringGrid {
  struct Medium {
    std::string name;
    Bounds bounds;       ///< of all of it, metres relative to the snapshot's origin
    GridPlacement grid;  ///< where the density is stored; zero resolution when homogeneous
    gpu::TextureRef density;
    glm::vec3 extinction{0.0f};  ///< sigma_t at density 1, 1/m
    glm::vec3 albedo{0.0f};      ///< sigma_s / sigma_t
    float anisotropy = 0.0f;     ///< Henyey-Greenstein mean cosine g
  };
  std::vector<Medium> media;
};

template <>
struct PortTraits<ScatteringGrid> {
  static PortKind kind() {
    return {
        "ScatteringGrid",
        "participating media: density per voxel, and constants",
        {{"density", "d3 r32f, for each medium", "0 outside the grid; null: the density is 1 in the bounds"}},
        {{"density", "density, a factor of the medium's extinction", "1", PortField::Role::density}}};
  }
  static void contents(const ScatteringGrid& port, PortContents& contents) {
    for (const ScatteringGrid::Medium& medium : port.media) {
      contents.texture("density", medium.density);
      if (!medium.density && medium.bounds.empty) continue;
      VoxelBox box = VoxelBox::of(medium.grid);
      VoxelSource source = VoxelTexels{{medium.density}, {{0, 0}}};
      if (!medium.density) {
        constexpr int kVoxels =
            8;  // along each side, shaped like the box: a leaf of OpenVDB, which becomes one tile
        const glm::dvec3 low(medium.bounds.low), extent = glm::dvec3(medium.bounds.high) - low;
        box = {low, extent / static_cast<double>(kVoxels), glm::ivec3(kVoxels)};
        source = VoxelsFilled{};
      }
      PortContents::Field& field = contents.field("density", box, std::move(source));
      if (port.media.size() > 1) field.name += "_" + medium.name;
      field.constants = {{"medium", medium.name},
                         {"extinction", medium.extinction},
                         {"extinction_unit", std::string("/m at density 1")},
                         {"albedo", medium.albedo},
                         {"anisotropy", medium.anisotropy}};
    }
  }
};

}  // namespace lumivox
