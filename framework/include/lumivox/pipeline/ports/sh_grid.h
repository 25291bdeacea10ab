#pragma once

#include <array>
#include <string>

#include "lumivox/pipeline/port.h"

namespace lumivox {

/// Light in voxels as spherical-harmonic coefficients up to band 1, in one or more nested grids. Passes read
/// it by readShGrid() of toolkit/sh_grid.h, which refuses what they do not take.
struct ShGrid {
  /// The quantity of the coefficients. flux: of the intensity, W/sr, of the light that a voxel sends or that
  /// passes it, which grows with the voxel's face. radiance: of the radiance there, W/(sr m^2).
  enum class Quantity { flux, radiance };
  struct Level {
    GridPlacement grid;
    /// One volume for each colour channel; or the first alone, for light without colour.
    std::array<gpu::TextureRef, 3> coefficients;
    const gpu::TextureRef& channel(std::size_t i) const {
      return coefficients[i] ? coefficients[i] : coefficients[0];
    }
  };
  std::vector<Level> levels;  ///< finest and smallest first
  Quantity quantity = Quantity::flux;
  float unit = 1.0f;  ///< that the number 1 stands for, in W/sr or W/(sr m^2)
  /// The one reading whose voxels hold their values, in words of the technique, while all others are 0; a
  /// pass that reads otherwise must refuse the grid. Empty: all voxels hold their values.
  std::string readFor;
};

/// "flux" or "radiance".
inline const char* name(ShGrid::Quantity quantity) {
  return quantity == ShGrid::Quantity::flux ? "flux" : "radiance";
}

template <>
struct PortTraits<ShGrid> {
  static PortKind kind() {
    constexpr auto kAny = PortResource::Sign::any;
    const char *const shape = "d3 rgba16f or rgba32f, for each level",
                      *const quantity = "coefficients of the spherical harmonic ",
                      *const unit = "W/sr for a flux, W/(sr m^2) for a radiance";
    PortKind kind{"ShGrid",
                  "flux or radiance per voxel as spherical harmonics up to band 1, in nested grids",
                  {{"red", shape, "Y00, Y1-1, Y10, Y11", kAny},
                   {"green", shape, "as red; null: equal to red", kAny},
                   {"blue", shape, "as red; null: equal to red", kAny}}};
    kind.conditions = {
        {"quantity",
         "flux: coefficients of the intensity, W/sr, that a voxel sends or that passes it, which grows with the voxel's face; radiance: coefficients of the radiance there, W/(sr m^2)",
         "light depends on the size of the voxels"},
        {"unit", "the value that the number 1 stands for, W/sr or W/(sr m^2)",
         "light is too bright or too dark by this factor"},
        {"readFor",
         "the one reading, in words of the technique, whose voxels hold values, while all others are 0; empty: all voxels hold values",
         "light is missing where other voxels are read"}};
    for (const char* harmonic : {"Y00", "Y1-1", "Y10", "Y11"})
      kind.fields.push_back({harmonic, quantity + std::string(harmonic) + " for red, green and blue", unit});
    return kind;
  }
  static void contents(const ShGrid& port, PortContents& contents) {
    for (std::size_t i = 0; i < port.levels.size(); ++i) {
      const ShGrid::Level& level = port.levels[i];
      contents.texture("red", level.coefficients[0]);
      contents.texture("green", level.coefficients[1]);
      contents.texture("blue", level.coefficients[2]);
      for (int k = 0; k < 4; ++k) {
        const VoxelTexels texels{
            {level.channel(0), level.channel(1), level.channel(2)}, {{0, k}, {1, k}, {2, k}}, 0, port.unit};
        const std::string& harmonic = contents.kind().fields[static_cast<std::size_t>(k)].name;
        PortContents::Field& field =
            contents.field(harmonic, VoxelBox::of(level.grid), texels, static_cast<int>(i));
        field.unit = port.quantity == ShGrid::Quantity::flux ? "W/sr" : "W/(sr m^2)";
        field.constants = {{"coefficients_of", std::string(name(port.quantity))}};
        if (!port.readFor.empty()) field.constants.emplace_back("read_for", port.readFor);
      }
    }
  }
};

}  // namespace lumivox
