#include "rays.h"

#include <fmt/format.h>

#include <array>
#include <vector>

#include "lumivox/base/error.h"
#include "lumivox/toolkit/bit_grid.h"
#include "near_field_voxels_shaders.h"

namespace lumivox::near_field_voxels {

namespace {

constexpr int kBits = BinaryGrid::kStack;
using Stack = std::array<std::uint32_t, 4>;

/// Listing 4.39, in our order of bits: mask i holds the bits from i on. Of number 128, which Listing 4.40
/// reads, there is none: a device that guards its reads returns 0.
Stack prefixMask(int i) {
  Stack mask{};
  for (int bit = i; bit < kBits; ++bit)
    mask[static_cast<std::size_t>(bit / 32)] |= 1u << static_cast<unsigned>(bit % 32);
  return mask;
}

/// Listing 4.40: texel (i, j) is mask i XOR mask j + 1.
gpu::TextureRef rayMasks(PassContext& frame) {
  std::vector<Stack> texels;
  for (int y = 0; y < kBits; ++y)
    for (int x = 0; x < kBits; ++x) {
      Stack texel = prefixMask(x);
      const Stack other = prefixMask(y + 1);
      for (std::size_t c = 0; c < 4; ++c) texel[c] ^= other[c];
      texels.push_back(texel);
    }
  const gpu::TextureRef texture =
      frame.texture({.format = gpu::Format::rgba32ui, .width = kBits, .height = kBits}, "bits between two");
  texture->upload(0, std::as_bytes(std::span(texels)));
  return texture;
}

}  // namespace

RayMethod::RayMethod(Pass* pass)
    : method_(
          pass, "method", Method::hierarchy,
          "how a ray finds its first voxel; hierarchy: from coarse texels to fine ones; stacks: by the stacks alone; plain: voxel by voxel; printed: as in Listings 4.39, 4.40 and 4.47, which miss some. The first three find the same voxel",
          published(Method::printed)),
      steps_(
          pass, "printed_steps", 256, within(1, 20000),
          "with 'method printed': number of steps after which a ray counts as free; the listing leaves it to the user"),
      behind_(
          pass, "printed_offset", 0.1f, within(0.0f, 1.0f),
          "with 'method printed': distance behind each exit at which the next step begins, in voxels along the ray; no number is published") {
}

shader::BindingSet RayMethod::binding(PassContext& frame, const BinaryGrid& bits) const {
  const GridPlacement& grid = bits.grid;
  shader::BindingSet result{shader::SampledSlot{"bitStacks"}(bits.stacks, gpu::Sampling::nearest)};
  // By name: every program that includes bit_grid.glsl has these blocks.
  namespace code = shaders::near_field_voxels::probe;
  result.add(shader::UniformSlot<code::Grid>{"Grid"}(
      {.gridLow = grid.low, .voxelSize = grid.voxelSize, .resolution = grid.resolution}));
  if (axis() != static_cast<int>(Method::printed)) return result;
  if (grid.resolution.z > kBits)
    throw Error(fmt::format(
        "'method printed' reads one texel of {} bits along z, and the grid of 'bits' is {} voxels deep; expected at most {}, or another method",
        kBits, grid.resolution.z, kBits));
  result.add(
      shader::UniformSlot<code::Printed>{"Printed"}({.printedSteps = steps_, .printedOffset = behind_}));
  const gpu::TextureRef& masks = frame.kept("bits between two", 0, [&] { return rayMasks(frame); });
  result.add(shader::SampledSlot{"rayMasks"}(masks, gpu::Sampling::nearest));
  return result;
}

std::int64_t RayMethod::turns(const BinaryGrid& bits) const {
  const glm::i64vec3 size(bits.grid.resolution);
  switch (static_cast<Method>(method_)) {
    case Method::hierarchy:
      return hierarchyTurns(bits);
    case Method::stacks:
      return turnsOfBitStep(bits) * (size.x + size.y + 1);
    case Method::plain:
      return 4 * (size.x + size.y + size.z + 1);
    case Method::printed:
      return steps_;
  }
  return 0;
}

}  // namespace lumivox::near_field_voxels
