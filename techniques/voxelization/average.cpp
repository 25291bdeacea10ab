// A list of fragments to one value per voxel, in a way that does not depend on the order of the list: sums of
// integers, as in Crassin & Green 2012, Sec. 22.4, but exact.
#include <algorithm>
#include <cstring>

#include "bit_voxeliser.h"
#include "fragment_list.h"
#include "voxelization_shaders.h"

namespace lumivox::voxelization {
namespace {

namespace claimShader = shaders::voxelization::average_claim;
namespace numberShader = shaders::voxelization::average_number;
namespace brightestShader = shaders::voxelization::average_brightest;
namespace addShader = shaders::voxelization::average_add;
namespace resolveShader = shaders::voxelization::average_resolve;

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
    gpu::TextureRef texture = frame.texture(volumeOf(grid, format), label);
    texture->clear(glm::vec4(0.0f));
    return texture;
  }

  Slots claimSlots(PassContext& frame) {
    Slots slots;
    slots.numbers = emptyVolume(frame, fragments->grid, gpu::Format::r32ui, "slots of voxels");
    slots.count = countBuffer(frame, "slot count");
    slots.count->clear();
    slots.voxels = frame.buffer(std::max<std::uint64_t>(fragments->capacity, 1) * sizeof(std::uint32_t),
                                "voxels of slots");
    frame.shaders().dispatchIndirect(
        frame.program(claimShader::kProgram),
        {claimShader::fragmentCount(*fragments->count), claimShader::fragments(*fragments->fragments),
         claimShader::slotCount(*slots.count), claimShader::slotVoxels(*slots.voxels),
         claimShader::slots(*slots.numbers)},
        *fragments->count, kGroupsOffset);
    frame.device().barrier();
    // A first guess: surfaces fill about as many voxels as three sides of the grid; never more than there are
    // fragments.
    const glm::ivec3& size = fragments->grid.resolution;
    const auto side = static_cast<std::uint64_t>(std::max({size.x, size.y, size.z}));
    room_ = std::max(room_, inSteps(std::min(3 * side * side, fragments->capacity)));
    slots.room = room_;
    finishCount(frame, *slots.count, slots.room);
    frame.judgeLater(slots.count, kWantedOffset, [this](PassContext&, std::uint32_t count) {
      if (count <= room_) return true;
      room_ = inSteps(count);
      return false;
    });
    slots.fragments = frame.buffer(slots.room * sizeof(std::uint32_t), "fragments of slots");
    frame.shaders().dispatchIndirect(
        frame.program(numberShader::kProgram),
        {numberShader::slotCount(*slots.count), numberShader::slotVoxels(*slots.voxels),
         numberShader::fragmentsOfSlot(*slots.fragments), numberShader::slots(*slots.numbers)},
        *slots.count, kGroupsOffset);
    frame.device().barrier();
    return slots;
  }

  /// The largest emission of a fragment of each slot.
  gpu::BufferRef brightestOfSlots(PassContext& frame, const Slots& slots) const {
    gpu::BufferRef brightest = frame.buffer(slots.room * sizeof(std::uint32_t), "brightest of slots");
    brightest->clear();
    frame.shaders().dispatchIndirect(
        frame.program(brightestShader::kProgram),
        {brightestShader::fragmentCount(*fragments->count), brightestShader::fragments(*fragments->fragments),
         brightestShader::brightest(*brightest), brightestShader::slots(*slots.numbers)},
        *fragments->count, kGroupsOffset);
    frame.device().barrier();
    return brightest;
  }

  void sumAndResolve(PassContext& frame) {
    const Slots slots = claimSlots(frame);
    const bool withAttributes = attributes.wanted();
    const bool withEmission = withAttributes && frame.traits().emission;
    const auto zeroed = [&](std::uint64_t wordsPerSlot, const char* label) {
      gpu::BufferRef buffer = frame.buffer(slots.room * wordsPerSlot * sizeof(std::uint32_t), label);
      buffer->clear();
      return buffer;
    };
    const gpu::BufferRef coverage = zeroed(1, "sums of coverage");
    gpu::BufferRef albedo, normal, emission, brightest;
    const GridPlacement& grid = fragments->grid;
    addShader::Variant adding;
    resolveShader::Variant resolving;
    adding.attributes = resolving.attributes = withAttributes;
    adding.emission = resolving.emission = withEmission;
    resolving.opacity = opacity.wanted();
    const addShader::Averaging averaging{grid.resolution,
                                         fragments->coverage == VoxelFragments::Coverage::sum ? 1 : 0};
    std::vector<gpu::ResourceBinding> add{addShader::averaging(averaging),
                                          addShader::fragmentCount(*fragments->count),
                                          addShader::fragments(*fragments->fragments),
                                          addShader::fragmentsOfSlot(*slots.fragments),
                                          addShader::coverageSums(*coverage),
                                          addShader::slots(*slots.numbers)};
    std::vector<gpu::ResourceBinding> resolve{
        resolveShader::averaging(averaging), resolveShader::slotCount(*slots.count),
        resolveShader::slotVoxels(*slots.voxels), resolveShader::fragmentsOfSlot(*slots.fragments),
        resolveShader::coverageSums(*coverage)};
    if (withAttributes) {
      AttributeGrid result;
      result.grid = grid;
      result.albedo = emptyVolume(frame, grid, gpu::Format::rgba16f, "mean albedo");
      result.normal = emptyVolume(frame, grid, gpu::Format::rgba16f, "mean normal");
      albedo = zeroed(3, "sums of albedo");
      normal = zeroed(3, "sums of normals");
      add.insert(add.end(), {addShader::albedoSums(*albedo), addShader::normalSums(*normal)});
      resolve.insert(resolve.end(), {resolveShader::albedoSums(*albedo), resolveShader::normalSums(*normal),
                                     resolveShader::albedoImage(*result.albedo),
                                     resolveShader::normalImage(*result.normal)});
      if (withEmission) {
        result.emission = emptyVolume(frame, grid, gpu::Format::rgba32f, "mean emission");
        emission = zeroed(3, "sums of emission");
        brightest = brightestOfSlots(frame, slots);
        add.insert(add.end(), {addShader::emissionSums(*emission), addShader::brightest(*brightest)});
        resolve.insert(resolve.end(),
                       {resolveShader::emissionSums(*emission), resolveShader::brightest(*brightest),
                        resolveShader::emissionImage(*result.emission)});
      }
      attributes = result;
    }
    if (opacity.wanted()) {
      OccupancyGrid result;
      result.grid = grid;
      result.opacity = emptyVolume(frame, grid, gpu::Format::r8, "opacity");
      resolve.push_back(resolveShader::opacityImage(*result.opacity));
      opacity = result;
    }
    frame.shaders().dispatchIndirect(frame.program(addShader::kProgram, adding.key()), add, *fragments->count,
                                     kGroupsOffset);
    frame.device().barrier();
    frame.shaders().dispatchIndirect(frame.program(resolveShader::kProgram, resolving.key()), resolve,
                                     *slots.count, kGroupsOffset);
    frame.device().barrier();
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
