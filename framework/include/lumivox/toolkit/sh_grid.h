// Light in an ShGrid, as passes read it: only after what tells how to read it was looked at.
#pragma once

#include <span>
#include <string>

#include "lumivox/pipeline/pass.h"

namespace lumivox {

/// What a pass takes of an ShGrid; anything else is refused.
struct ShReading {
  enum class Unit { one, any };
  ShGrid::Quantity quantity = ShGrid::Quantity::radiance;
  /// any: the pass multiplies what it reads by ShLight::unit.
  Unit unit = Unit::one;
  /// Which voxels the pass reads, in words of ShGrid::readFor; empty: it may read all of them.
  std::string voxels{};
  /// How a user gets a grid with values in all voxels: told where one with some is refused.
  std::string remedy{};
};

struct ShLight {
  std::span<const ShGrid::Level> levels;  ///< at least one; finest and smallest first
  float unit = 1.0f;                      ///< that the number 1 stands for, in W/sr or W/(sr m^2)
};

/// The light of an input that is present. Error, with the names of both sides, where its quantity, its unit
/// or the voxels that hold values are not what the pass takes.
ShLight readShGrid(const In<ShGrid>& input, const ShReading& reading);

/// The three colour channels of a level under the names red, green and blue. GLSL side:
/// common/spherical_harmonics.glsl; a voxel's coefficients are the components of a texel.
class ShLevelBinding : public shader::BindingSet {
 public:
  ShLevelBinding(const ShGrid::Level& level, gpu::Sampling sampling);
};

}  // namespace lumivox
