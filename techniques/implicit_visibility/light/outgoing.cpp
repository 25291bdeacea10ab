#include "outgoing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lumivox/base/error.h"

namespace lumivox::implicit_visibility {

using namespace shaders::implicit_visibility;

std::shared_ptr<const OutgoingRows> outgoingRows(PassContext& frame, const ElementTree& tree) {
  OutgoingRows rows;
  std::vector<std::uint32_t> ofNodes(tree.nodeCount, kNoElement), nodes;
  for (const ElementTree::Run& level : tree.levels) {
    const auto first = static_cast<std::uint32_t>(nodes.size());
    for (std::uint32_t node = level.first; node < level.first + level.count; ++node) {
      if (!tree.glossy[node]) continue;
      ofNodes[node] = static_cast<std::uint32_t>(nodes.size());
      nodes.push_back(node);
    }
    const std::uint32_t count = static_cast<std::uint32_t>(nodes.size()) - first;
    if (level.first < tree.leafCount)
      rows.leaves = static_cast<int>(count);
    else if (count > 0)
      rows.levels.push_back({first, count});
  }
  rows.count = static_cast<std::uint32_t>(nodes.size());
  rows.ofNodes = frame.uploaded(ofNodes, "rows of glossy elements");
  rows.nodes = frame.uploaded(nodes, "glossy elements");
  return std::make_shared<const OutgoingRows>(std::move(rows));
}

int outgoingTexels(const OutgoingRows& rows, int directions) {
  constexpr std::uint64_t kMostRows = 16384;  // rows of texels that OpenGL guarantees (4.5, table 23.53)
  const std::uint64_t perNode =
                          6 * static_cast<std::uint64_t>(directions) * static_cast<std::uint64_t>(directions),
                      texels = rows.count * perNode, most = kMostRows * ElementLight::kWidth;
  if (texels > most)
    throw Error(fmt::format(
        "what {} glossy elements and nodes above them pass on in 6 x {} x {} directions needs {} texels; a texture "
        "holds {}, enough for {} of them",
        rows.count, directions, directions, texels, most, most / perNode));
  return static_cast<int>(texels);
}

OutgoingBinding::OutgoingBinding(const gpu::TextureRef& outgoing, const gpu::BufferRef& rowsOfNodes,
                                 int directions) {
  if (outgoing == nullptr) return;
  // Half the diagonal of the largest bin, which lies in the middle of a face.
  const double half = std::atan(std::numbers::sqrt2 * std::tan(0.25 * std::numbers::pi / directions));
  add(shader::UniformSlot<illuminate::Outgoing>{"Outgoing"}(
      {directions, static_cast<float>(std::tan(half))}));
  add(shader::StorageSlot{"OutgoingRows"}(rowsOfNodes));
  add(shader::SampledSlot{"outgoingRadiance"}(outgoing, gpu::Sampling::nearest));
}

double resolvedExponent(int bins) {
  return std::log(0.5) / std::log(std::cos(0.5 * std::numbers::pi / bins));
}

}  // namespace lumivox::implicit_visibility
