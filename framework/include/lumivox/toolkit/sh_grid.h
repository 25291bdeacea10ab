// Reads light in an ShGrid, after checking the members that say how to read it.
#pragma once

#include <span>
#include <string>

#include "lumivox/pipeline/pass.h"

namespace lumivox {

/// The ShGrids that a pass can read; others are refused.
struct ShReading {
  enum class Unit { one, any };
  ShGrid::Quantity quantity = ShGrid::Quantity::radiance;
  /// any: the pass multiplies what it reads by ShLight::unit.
  Unit unit = Unit::one;
  /// Which voxels the pass reads, in words of ShGrid::readFor; empty: it may read all of them.
  std::string voxels{};
  /// Advice in the error for a grid with values in some voxels only: how to get one with values in all.
  std::string remedy{};
};

struct ShLight {
  std::span<const ShGrid::Level> levels;  ///< at least one; finest and smallest first
  float unit = 1.0f;                      ///< that the number 1 stands for, in W/sr or W/(sr m^2)
};

/// The light of a present input. Error, with the names of both passes, if its quantity, its unit or its
/// filled voxels do not fit the reading.
ShLight readShGrid(const In<ShGrid>& input, const ShReading& reading);

/// The three colour channels of a level under the names red, green and blue. GLSL side:
/// common/spherical_harmonics.glsl; a voxel's coefficients are the components of a texel.
class ShLevelBinding : public shader::BindingSet {
 public:
  ShLevelBinding(const ShGrid::Level& level, gpu::Sampling sampling);
};

}  // namespace lumivox
