// A list of fragments to one value per voxel, in a way that does not depend on the order of the list: sums of
// integers, as in Crassin & Green 2012, Sec. 22.4, but exact.
#include <algorithm>
#include <cstring>

#include "bit_voxelizer.h"
#include "fragment_list.h"
#include "voxelization_shaders.h"

namespace lumivox::voxelization {
namespace {

using namespace shaders::voxelization;

class AveragePass : public Pass {
  In<VoxelFragments> fragments{this, "fragments", "surface samples"};
  Out<AttributeGrid> attributes{this, "attributes",
                                "albedo, normal and emission, averaged with the coverage as weight"};
  Out<OccupancyGrid> opacity{this, "opacity", "mean or sum of the coverages, as the list says"};
  Out<BinaryGrid> bits{this, "bits", "one bit a voxel that has a fragment"};

  Reads readsFrom() const override { return Reads::materials; }

  /// Slots of sums grow in steps, so that a moving scene does not ask for another size in every frame.
  static constexpr std::uint64_t kSlotStep = 1u << 14;

  struct Slots {
    gpu::TextureRef numbers;  ///< per voxel: its slot from 1 on, or 0
    gpu::BufferRef count, voxels, fragments;
    std::uint64_t room = 0;
  };

  std::uint64_t room_ = 0;  ///< slots that there is room for: a guess, or what earlier frames needed

  static std::uint64_t inSteps(std::uint64_t slots) { return (slots / kSlotStep + 1) * kSlotStep; }

  static gpu::TextureRef emptyVolume(PassContext& frame, const GridPlacement& grid, gpu::Format format,
                                     const char* label) {
    gpu::TextureRef texture = frame.volume(grid.resolution, format, label);
    texture->clear(glm::vec4(0.0f));
    return texture;
  }

  Slots claimSlots(PassContext& frame) {
    Slots slots;
    slots.numbers = emptyVolume(frame, fragments->grid, gpu::Format::r32ui, "slots of voxels");
    slots.count = countBuffer(frame, "slot count");
    slots.count->clear();
    slots.voxels = frame.elements(average_claim::slotVoxels, fragments->capacity, "voxels of slots");
    const shader::BindingSet claimed{average_claim::slotVoxels(slots.voxels),
                                     average_claim::slotCount(slots.count),
                                     average_claim::slots(slots.numbers)};
    forEachFragment(frame, frame.program(average_claim::kProgram), claimed, *fragments);
    // A first guess: surfaces fill about as many voxels as six sides of the grid, some in two layers; never
    // more than there are fragments.
    const glm::ivec3& size = fragments->grid.resolution;
    const auto side = static_cast<std::uint64_t>(std::max({size.x, size.y, size.z}));
    room_ = std::max(room_, inSteps(std::min(8 * side * side, fragments->capacity)));
    slots.room = room_;
    finishCount(frame, *slots.count, slots.room);
    frame.judgeLater(slots.count, kWantedOffset, [this](PassContext&, std::uint32_t count) {
      if (count <= room_) return true;
      room_ = inSteps(count);
      return false;
    });
    slots.fragments = frame.elements(average_number::fragmentsOfSlot, slots.room, "fragments of slots");
    frame.dispatchIndirect(frame.program(average_number::kProgram),
                           {claimed, average_number::fragmentsOfSlot(slots.fragments)}, *slots.count,
                           kGroupsOffset);
    return slots;
  }

  void sumAndResolve(PassContext& frame) {
    const Slots slots = claimSlots(frame);
    const GridPlacement& grid = fragments->grid;
    const int withAttributes = attributes.wanted(), withEmission = withAttributes && frame.traits().emission;
    const auto zeroed = [&](bool needed, std::uint64_t wordsPerSlot, const char* label) -> gpu::BufferRef {
      if (!needed) return nullptr;
      gpu::BufferRef buffer = frame.buffer(slots.room * wordsPerSlot * sizeof(std::uint32_t), label);
      buffer->clear();
      return buffer;
    };
    const gpu::BufferRef brightest = zeroed(withEmission, 1, "brightest of slots"),
                         coverage = zeroed(true, 1, "sums of coverage"),
                         albedo = zeroed(withAttributes, 3, "sums of albedo"),
                         normal = zeroed(withAttributes, 3, "sums of normals"),
                         emission = zeroed(withEmission, 3, "sums of emission");
    AttributeGrid averages{grid, nullptr, nullptr, nullptr};
    OccupancyGrid covered{grid, nullptr};
    if (withAttributes) {
      averages.albedo = emptyVolume(frame, grid, gpu::Format::rgba16f, "mean albedo");
      averages.normal = emptyVolume(frame, grid, gpu::Format::rgba16f, "mean normal");
    }
    if (withEmission) {
      averages.emission = emptyVolume(frame, grid, gpu::Format::rgba32f, "mean emission");
      forEachFragment(frame, frame.program(average_brightest::kProgram),
                      {average_brightest::brightest(brightest), average_brightest::slots(slots.numbers)},
                      *fragments);
    }
    if (opacity.wanted()) covered.opacity = emptyVolume(frame, grid, gpu::Format::r8, "opacity");
    const shader::BindingSet sums{
        average_add::averaging({grid.resolution, fragments->coverage == VoxelFragments::Coverage::sum}),
        average_add::fragmentsOfSlot(slots.fragments),
        average_add::coverageSums(coverage),
        average_add::albedoSums(albedo),
        average_add::normalSums(normal),
        average_add::emissionSums(emission),
        average_add::brightest(brightest)};
    forEachFragment(frame, frame.program(average_add::Variant{withAttributes, withEmission}),
                    {sums, average_add::slots(slots.numbers)}, *fragments);
    const average_resolve::Variant resolving{withAttributes, withEmission, opacity.wanted()};
    frame.dispatchIndirect(
        frame.program(resolving),
        {sums, average_resolve::slotCount(slots.count), average_resolve::slotVoxels(slots.voxels),
         average_resolve::albedoImage(averages.albedo), average_resolve::normalImage(averages.normal),
         average_resolve::emissionImage(averages.emission), average_resolve::opacityImage(covered.opacity)},
        *slots.count, kGroupsOffset);
    if (withAttributes) attributes = averages;
    if (opacity.wanted()) opacity = covered;
  }

  void run(PassContext& frame) override {
    if (attributes.wanted() || opacity.wanted()) sumAndResolve(frame);
    if (bits.wanted()) {
      const gpu::TextureRef words = bitWords(frame, fragments->grid, "bits");
      markFragments(frame, *fragments, *words);
      bits = binaryGridOf(frame, fragments->grid, *words, nullptr);
    }
  }
};

}  // namespace

void addAverage(TechniqueRegistry& registry) {
  registry.add<AveragePass>("average",
                            "Averages over the fragments of each voxel, independent of their order");
}

}  // namespace lumivox::voxelization
