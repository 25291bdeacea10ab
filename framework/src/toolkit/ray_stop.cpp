// Planes of the surface within each occupied voxel, from sums over its fragments that are the same in any
// order.
#include "lumivox/toolkit/ray_stop.h"

#include <fmt/format.h>

#include "lumivox/base/error.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/bit_grid.h"
#include "lumivox/toolkit/grid_placement.h"
#include "lumivox/toolkit/voxel_slots.h"
#include "toolkit_shaders.h"

namespace lumivox {

namespace {

namespace code = shaders::toolkit;

}  // namespace

VoxelPlanes::VoxelPlanes(gpu::TextureRef ofVoxels, gpu::BufferRef planes)
    : BindingSet{shader::StorageSlot{"VoxelPlanes"}(planes),
                 shader::SampledSlot{"planesOfVoxels"}(ofVoxels, gpu::Sampling::nearest)},
      ofVoxels_(std::move(ofVoxels)),
      planes_(std::move(planes)) {}

RayStop::RayStop(Pass* pass)
    : stop_(
          pass, "stop", Stop::box,
          "where a ray ends in an occupied voxel; box: where it enters the voxel; plane: where it meets the surface within the voxel, up to two planes fitted to 'fragments', or it passes",
          published(Stop::box)),
      fragments_(pass, "fragments", Presence::optional,
                 "with 'stop plane': the surface samples that 'bits' are made from") {}

std::string RayStop::check(bool boxesOnly, const char* parameter, const std::string& value) const {
  if (!atPlanes() || !boxesOnly) return {};
  return fmt::format("'stop plane' with '{0} {1}'; expected 'stop box', or another {0}", parameter, value);
}

VoxelPlanes RayStop::planes(PassContext& frame, const BinaryGrid& bits, const std::string& pass) {
  if (!atPlanes()) return {};
  if (!fragments_.present())
    throw Error(fmt::format("{}: 'stop plane' reads 'fragments'; expected it to be connected", pass));
  if (!(fragments_->grid == bits.grid))
    throw Error(fmt::format("{}: 'bits' have {}, and 'fragments' {}; expected one grid for both", pass,
                            inWords(bits.grid), inWords(fragments_->grid)));
  return frame.kept("planes within voxels", fragments_->count, [&] { return planesOf(frame, *fragments_); });
}

VoxelPlanes RayStop::planesOf(PassContext& frame, const VoxelFragments& fragments) {
  const VoxelSlots slots = claimSlots(frame, fragments, room_);
  const gpu::BufferRef keys =
      frame.emptyElements(code::planes_key::planeKeys, 2 * slots.room, "normals of groups");
  const gpu::BufferRef sums =
      frame.emptyElements(code::planes_add::planeSums, 2 * slots.room, "sums of groups");
  const gpu::BufferRef planes =
      frame.elements(code::planes_resolve::voxelPlanes, slots.room, "planes of voxels");
  for (int second = 0; second < 2; ++second)
    forEachFragment(frame, frame.program(code::planes_key::Variant{.second = second}),
                    {code::planes_key::planeKeys(keys), SlotBinding(slots)}, fragments);
  forEachFragment(frame, frame.program(code::planes_add::kProgram),
                  {code::planes_add::planeKeys(keys), code::planes_add::planeSums(sums), SlotBinding(slots)},
                  fragments);
  forEachSlot(frame, frame.program(code::planes_resolve::kProgram),
              {code::planes_resolve::planeSums(sums), code::planes_resolve::voxelPlanes(planes)}, slots);
  return {slots.numbers, planes};
}

std::int64_t RayStop::turns(const BinaryGrid& bits) const {
  if (!atPlanes()) return 0;
  // A voxel that the ray passes is one more step where the next one lies in the same column. Behind the last
  // one of a column the walk goes on as behind a column without voxels.
  return turnsOfBitStep(bits) * bits.grid.resolution.z;
}

}  // namespace lumivox
