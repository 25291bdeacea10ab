#include "volume.h"

#include <fmt/format.h>

#include "lumivox/base/error.h"
#include "lumivox/toolkit/volume_room.h"

namespace lumivox::imperfect_volumes {

namespace code = shaders::imperfect_volumes;

gpu::ResourceBinding volumeBinding(const GridPlacement& grid, float occupied) {
  return shader::UniformSlot<code::Volume>{"Volume"}({.gridLow = grid.low,
                                                      .voxelSize = grid.voxelSize,
                                                      .resolution = grid.resolution,
                                                      .occupied = occupied});
}

std::array<gpu::TextureRef, 3> coefficientVolumes(PassContext& frame, const glm::ivec3& resolution,
                                                  const char* label, gpu::Format format) {
  const std::vector<gpu::TextureRef> rooms =
      roomFor(frame, resolution, 3, format, label, false, "three volumes of coefficients");
  return {rooms[0], rooms[1], rooms[2]};
}

shader::BindingSet images(const std::array<gpu::TextureRef, 3>& volumes) {
  return {shader::ImageSlot{"redImage"}(volumes[0]), shader::ImageSlot{"greenImage"}(volumes[1]),
          shader::ImageSlot{"blueImage"}(volumes[2])};
}

RadianceVolume volumeOf(const In<ShGrid>& light, const std::string& voxels) {
  const ShLight read = readShGrid(light, {.quantity = ShGrid::Quantity::radiance,
                                          .unit = ShReading::Unit::any,
                                          .voxels = voxels,
                                          .remedy = "'cover all' where it is made"});
  if (read.levels.size() != 1)
    throw Error(
        fmt::format("input '{}' has {} nested grids; expected one volume", light.name(), read.levels.size()));
  return {read.levels.front(), read.unit};
}

void requireSameGrid(const char* input, const GridPlacement& grid, const char* other,
                     const GridPlacement& otherGrid) {
  if (grid == otherGrid) return;
  throw Error(fmt::format("'{}' has {}, and '{}' {}; expected one grid for both", input, inWords(grid), other,
                          inWords(otherGrid)));
}

Neighbours::Neighbours(Pass* pass)
    : voxels_(
          pass, "voxels", Voxels::six,
          "that a surface point reads: the six across the faces of its own, once it is shifted, as in the paper's implementation; the eight around it, as in its Fig. 2; without a shift its own, as on the left of Fig. 3; or what lies there, trilinearly"),
      filter_(pass, "filter", true,
              "six or eight: places as far from the shifted point, read trilinearly; off: whole voxels"),
      shift_(pass, "shift", 0.5f, within(0.0f, 8.0f),
             "of a surface point along its normal before it reads, in voxels"),
      blend_(
          pass, "blend", Blend::free,
          "which neighbours count: only those that are free and open to the surface, where there are any; or all, of which occupied ones are dark",
          published(Blend::all)) {}

std::string Neighbours::inWords() const {
  return fmt::format("'voxels {}', 'filter {}' and 'shift {}'", voxels_.valueText(), filter_.valueText(),
                     shift_.valueText());
}

gpu::ResourceBinding Neighbours::binding() const {
  return shader::UniformSlot<code::Neighbours>{"Neighbours"}({.shift = shift_});
}

}  // namespace lumivox::imperfect_volumes
