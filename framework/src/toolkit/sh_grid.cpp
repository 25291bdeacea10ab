#include "lumivox/toolkit/sh_grid.h"

#include <fmt/format.h>

#include "lumivox/base/error.h"

namespace lumivox {

ShLight readShGrid(const In<ShGrid>& input, const ShReading& reading) {
  const auto unitOf = [](ShGrid::Quantity quantity) {
    return quantity == ShGrid::Quantity::flux ? "W/sr" : kRadianceUnit;
  };
  if (input->levels.empty())
    throw Error(fmt::format("input '{}' has no grid; expected at least one", input.name()));
  if (input->quantity != reading.quantity)
    throw Error(fmt::format("input '{}' contains {} in {}; expected {} in {}", input.name(),
                            name(input->quantity), unitOf(input->quantity), name(reading.quantity),
                            unitOf(reading.quantity)));
  if (reading.unit == ShReading::Unit::one && input->unit != 1.0f)
    throw Error(fmt::format("input '{}' contains {} in units of {:g} {}; expected units of 1 {}",
                            input.name(), name(input->quantity), input->unit, unitOf(input->quantity),
                            unitOf(input->quantity)));
  if (!input->readFor.empty() && input->readFor != reading.voxels)
    throw Error(fmt::format(
        "input '{}' holds only the voxels that are read with {}, and here {}; expected the same, or {}",
        input.name(), input->readFor,
        reading.voxels.empty() ? "all voxels are read" : "they are read with " + reading.voxels,
        reading.remedy.empty() ? "a grid with values in all voxels" : reading.remedy));
  return {input->levels, input->unit};
}

ShLevelBinding::ShLevelBinding(const ShGrid::Level& level, gpu::Sampling sampling)
    : BindingSet{shader::SampledSlot{"red"}(level.channel(0), sampling),
                 shader::SampledSlot{"green"}(level.channel(1), sampling),
                 shader::SampledSlot{"blue"}(level.channel(2), sampling)} {}

}  // namespace lumivox
