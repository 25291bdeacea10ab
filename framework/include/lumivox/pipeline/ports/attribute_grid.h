#pragma once

#include "lumivox/pipeline/port.h"

namespace lumivox {

/// Averages over the surface in each voxel.
struct AttributeGrid {
  GridPlacement grid;
  gpu::TextureRef albedo;
  gpu::TextureRef normal;
  gpu::TextureRef emission;
};

template <>
struct PortTraits<AttributeGrid> {
  static PortKind kind() {
    return {"AttributeGrid",
            "averages over the surface in each voxel",
            {{"albedo", "d3 rgba16f", "rgb mean diffuse albedo; a covered fraction (0: no surface)"},
             {"normal", "d3 rgba16f",
              "xyz mean of the unit normals, not normalised, so that its length shows how far they agree",
              PortResource::Sign::any},
             {"emission", "d3 rgba32f", "rgb mean emitted radiance; null when nothing emits"}},
            {{"albedo", "mean diffuse albedo of the surface in the voxel", "1"},
             {"coverage", "covered fraction", "1", PortField::Role::fog},
             {"normal", "mean of the unit normals, not normalised", "1", PortField::Role::direction},
             {"emission", "mean emitted radiance", "W/(sr m^2)"}},
            "voxels with a covered fraction above 0"};
  }
  static void contents(const AttributeGrid& port, PortContents& contents) {
    contents.texture("albedo", port.albedo);
    contents.texture("normal", port.normal);
    contents.texture("emission", port.emission);
    const VoxelBox box = VoxelBox::of(port.grid);
    const VoxelTexels coverage{{port.albedo}, {{0, 3}}};
    const auto rgb = [](const gpu::TextureRef& texture) {
      return VoxelTexels{{texture}, {{0, 0}, {0, 1}, {0, 2}}};
    };
    contents.field("albedo", box, rgb(port.albedo));
    contents.field("coverage", box, coverage);
    contents.field("normal", box, rgb(port.normal));
    if (port.emission) contents.field("emission", box, rgb(port.emission));
    contents.occupies(port.grid, coverage);
  }
};

}  // namespace lumivox
