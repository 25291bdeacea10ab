// Directional light that glossy elements pass on (Dong et al. 2007, Sec. 4.3).
#pragma once

#include <memory>
#include <vector>

#include "light.h"

namespace lumivox::implicit_visibility {

/// The nodes with a glossy leaf, in order; each has a row of ElementLight::outgoing.
struct OutgoingRows {
  int leaves = 0;                        ///< of them, which come first
  std::vector<ElementTree::Run> levels;  ///< runs of rows above the leaves, in the order of pull-up
  std::uint32_t count = 0;
  gpu::BufferRef ofNodes, nodes;  ///< the row of each node, kNoElement: none; the node of each row
};

std::shared_ptr<const OutgoingRows> outgoingRows(PassContext& frame, const ElementTree& tree);

/// Number of texels of ElementLight::outgoing. Error where no texture holds them.
int outgoingTexels(const OutgoingRows& rows, int directions);

/// How sent.glsl reads ElementLight::outgoing. Null `outgoing`: binds nothing.
class OutgoingBinding : public shader::BindingSet {
 public:
  OutgoingBinding(const gpu::TextureRef& outgoing, const gpu::BufferRef& rowsOfNodes, int directions);
};

/// The largest Phong exponent that a cube of so many bins along a side resolves: its lobe falls to a half
/// within the width of a bin.
double resolvedExponent(int bins);

}  // namespace lumivox::implicit_visibility
