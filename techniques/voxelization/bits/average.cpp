// Averages a list of fragments to one value per voxel, independent of the list's order: sums of integers, as
// in Crassin & Green 2012, Sec. 22.4, but exact.
#include <algorithm>

#include "bit_voxelizer.h"
#include "lumivox/toolkit/voxel_slots.h"

namespace lumivox::voxelization {

using namespace shaders::voxelization;

namespace {

class AveragePass : public Pass {
  In<VoxelFragments> fragments{this, "fragments", "surface samples"};
  Param<Masks> masks{
      this, "masks", Masks::any,
      "voxels with holes that have a bit; any: all; half: those covered by a half or more; random: each with its coverage as probability, so that a lattice keeps its mean opacity"};
  Out<AttributeGrid> attributes{this, "attributes",
                                "albedo, normal and emission, averaged with the coverage as weight"};
  Out<OccupancyGrid> opacity{this, "opacity", "mean or sum of the coverages, as the list says"};
  Out<BinaryGrid> bits{this, "bits", "one bit a voxel that has a fragment"};

  Reads readsFrom() const override { return Reads::materials; }

  std::uint64_t room_ = 0;  ///< number of slots: a guess, or what earlier frames needed

  void sumAndResolve(PassContext& frame) {
    const VoxelSlots slots = claimSlots(frame, *fragments, room_);
    const GridPlacement& grid = fragments->grid;
    const int withAttributes = attributes.wanted(), withEmission = withAttributes && frame.traits().emission;
    using namespace average_add;
    const auto zeroed = [&](bool needed, const shader::StorageSlot& block, std::uint64_t words,
                            const char* label) {
      return needed ? frame.emptyElements(block, slots.room * words, label) : nullptr;
    };
    const gpu::BufferRef brightest = zeroed(withEmission, average_add::brightest, 1, "brightest of slots"),
                         coverage = zeroed(true, coverageSums, 1, "sums of coverage"),
                         albedo = zeroed(withAttributes, albedoSums, 3, "sums of albedo"),
                         normal = zeroed(withAttributes, normalSums, 3, "sums of normals"),
                         emission = zeroed(withEmission, emissionSums, 3, "sums of emission");
    AttributeGrid averages{grid, nullptr, nullptr, nullptr};
    OccupancyGrid covered{grid, nullptr};
    if (withAttributes) {
      averages.albedo = frame.emptyVolume(grid.resolution, gpu::Format::rgba16f, "mean albedo");
      averages.normal = frame.emptyVolume(grid.resolution, gpu::Format::rgba16f, "mean normal");
    }
    if (withEmission) {
      averages.emission = frame.emptyVolume(grid.resolution, gpu::Format::rgba32f, "mean emission");
      forEachFragment(frame, frame.program(average_brightest::kProgram),
                      {average_brightest::brightest(brightest), SlotBinding(slots)}, *fragments);
    }
    if (opacity.wanted() || judgesSums())
      covered.opacity = frame.emptyVolume(grid.resolution, gpu::Format::r8, "opacity");
    const shader::BindingSet sums{
        averaging({grid.resolution, fragments->coverage == VoxelFragments::Coverage::sum}),
        coverageSums(coverage),
        albedoSums(albedo),
        normalSums(normal),
        emissionSums(emission),
        average_add::brightest(brightest)};
    forEachFragment(frame, frame.program(average_add::Variant{withAttributes, withEmission}),
                    {sums, SlotBinding(slots)}, *fragments);
    const average_resolve::Variant resolving{withAttributes, withEmission, covered.opacity != nullptr};
    forEachSlot(
        frame, frame.program(resolving),
        {sums, average_resolve::albedoImage(averages.albedo), average_resolve::normalImage(averages.normal),
         average_resolve::emissionImage(averages.emission), average_resolve::opacityImage(covered.opacity)},
        slots);
    if (withAttributes) attributes = averages;
    if (opacity.wanted()) opacity = covered;
    if (judgesSums()) bits = binaryGridOf(frame, grid, {bitsOf(frame, covered, "bits", masks), nullptr});
  }

  /// Whether bits depend on the joint coverage of a voxel's fragments.
  bool judgesSums() const {
    return bits.wanted() && masks != Masks::any && fragments->coverage == VoxelFragments::Coverage::sum;
  }

  void run(PassContext& frame) override {
    if (attributes.wanted() || opacity.wanted() || judgesSums()) sumAndResolve(frame);
    if (!bits.wanted() || judgesSums()) return;
    if (fragments->still && fragments->moving)
      bits = followedGridOf(frame, *fragments, masks);
    else
      bits = binaryGridOf(frame, fragments->grid, {bitsOf(frame, *fragments, "bits", masks), nullptr});
  }
};

}  // namespace

void addAverage(TechniqueRegistry& registry) {
  registry.add<AveragePass>("average",
                            "Averages over the fragments of each voxel, independent of their order");
}

}  // namespace lumivox::voxelization
