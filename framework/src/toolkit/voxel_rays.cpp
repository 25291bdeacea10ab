#include "lumivox/toolkit/voxel_rays.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <vector>

#include "lumivox/base/error.h"
#include "lumivox/toolkit/bit_grid.h"
#include "lumivox/toolkit/light_samples.h"

namespace lumivox {

namespace {

/// Block Grid of common/bit_rays.glsl.
struct alignas(16) GridBlock {
  glm::vec3 low;
  float voxelSize;
  glm::ivec3 resolution;
};
/// Block Printed of common/bit_grid.glsl.
struct alignas(16) PrintedBlock {
  std::int32_t steps;
  float offset;
};
/// Block BackProjection of common/back_projection.glsl.
struct alignas(16) BackProjectionBlock {
  float voxelDiagonal, tolerance, cap, leastCosine;
  std::int32_t firstLight, lightsAtOnce;
};

constexpr float kLargestTolerance = 1000.0f;
// Lower bounds of the cosine between surface and light: that of the map's areas, and the printed one.
constexpr float kLeastCosine = 0.02f, kPrintedLeastCosine = 0.001f;

constexpr int kBits = BinaryGrid::kStack;
using Stack = std::array<std::uint32_t, 4>;

/// Listing 4.39, in our order of bits: mask i holds the bits from i on. Mask 128, which Listing 4.40 reads,
/// does not exist: a device that guards its reads returns 0.
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
  result.add(shader::UniformSlot<GridBlock>{"Grid"}({grid.low, grid.voxelSize, grid.resolution}));
  if (axis() != static_cast<int>(Method::printed)) return result;
  if (grid.resolution.z > kBits)
    throw Error(fmt::format(
        "'method printed' reads one texel of {} bits along z, and the grid of 'bits' is {} voxels deep; expected at most {}, or another method",
        kBits, grid.resolution.z, kBits));
  result.add(shader::UniformSlot<PrintedBlock>{"Printed"}({steps_, behind_}));
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

BackProjection::BackProjection(Pass* pass)
    : taps_(pass, "taps", 1, within(1, 4),
            "texels of the map read for each hit: 1, or 4 with bilinear weights"),
      tolerance_(
          pass, "tolerance", 1.0f, within(0.0f, kLargestTolerance),
          "factor on the largest distance between a hit and its texel's surface at which the texel counts; the largest value: no limit"),
      cap_(pass, "cap", 4.0f, within(0.0f, 1000.0f),
           "bound of this distance, in diagonals of a voxel (Listing 4.49); 0: no bound (Sec. 3.2.3)"),
      front_(pass, "front", true, "surfaces that face away from the receiver contribute nothing") {}

std::string BackProjection::check() const {
  return taps_ == 1 || taps_ == 4 ? std::string()
                                  : fmt::format("'taps' is {}; expected 1 or 4", static_cast<int>(taps_));
}

shader::BindingSet BackProjection::binding(float voxelSize, bool printed, int first, int count) const {
  const float diagonal = std::sqrt(3.0f) * voxelSize;
  return {shader::UniformSlot<BackProjectionBlock>{"BackProjection"}(
      {diagonal, tolerance_ < kLargestTolerance ? static_cast<float>(tolerance_) : -1.0f,
       cap_ > 0.0f ? cap_ * diagonal : -1.0f, printed ? kPrintedLeastCosine : kLeastCosine, first, count})};
}

void requireWhole(const ReflectiveShadowMap& map, const std::string& pass) {
  const auto lights = map.lights->sizeBytes() / sizeof(LightSampleData),
             views = map.views->sizeBytes() / sizeof(glm::mat4);
  const auto layers = static_cast<std::uint64_t>(map.position->description().depth);
  const auto wanted = static_cast<std::uint64_t>(map.layerCount);
  if (lights < static_cast<std::uint64_t>(map.lightCount) || views < wanted || layers < wanted)
    throw Error(fmt::format(
        "{}: 'map' tells of {} lights in {} layers, and holds {} lights, {} views and {} layers; expected those of one reflective shadow map",
        pass, map.lightCount, map.layerCount, lights, views, layers));
}

}  // namespace lumivox
