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
          "voxels that a shifted surface point reads; six: those across the faces of its voxel, as in the paper's implementation; eight: those around it, as in the paper's Fig. 2; own: its voxel without the shift, as on the left of Fig. 3; trilinear: one trilinear read"),
      filter_(
          pass, "filter", true,
          "with 'voxels six' or 'eight'; on: trilinear reads at the same offsets from the shifted point; off: whole voxels"),
      shift_(pass, "shift", 0.5f, within(0.0f, 8.0f),
             "distance by which a surface point moves along its normal before it reads, in voxels"),
      blend_(
          pass, "blend", Blend::free,
          "neighbours that count; all: all of them, occupied ones as dark; free: only free ones with an unoccluded line to the surface, where there are any",
          published(Blend::all)) {}

std::string Neighbours::inWords() const {
  return fmt::format("'voxels {}', 'filter {}' and 'shift {}'", voxels_.valueText(), filter_.valueText(),
                     shift_.valueText());
}

gpu::ResourceBinding Neighbours::binding() const {
  return shader::UniformSlot<code::Neighbours>{"Neighbours"}({.shift = shift_});
}

}  // namespace lumivox::imperfect_volumes
