#pragma once

#include <algorithm>
#include <memory>

#include "element_tree.h"
#include "lumivox/pipeline/port.h"

namespace lumivox::implicit_visibility {

/// The surface as discs, and trees above them (Dong, Kautz, Theobalt and Seidel 2007, Sec. 4.1). The textures
/// hold all nodes, numbered as in ElementTree: node i is texel (i % kWidth, i / kWidth).
struct SurfaceElements {
  static constexpr int kWidth = 1024;
  gpu::TextureRef position, normal, albedo;
  gpu::TextureRef specular;  ///< null where nothing is glossy
  gpu::TextureRef emission;  ///< null where nothing emits
  gpu::BufferRef children;
  int leafCount = 0, firstGroup = 0, nodeCount = 0;  ///< of `tree`
  std::shared_ptr<const ElementTree> tree;
  std::shared_ptr<const ElementState> state;

  /// Texels of a texture with a value for each of so many nodes.
  static glm::ivec2 sizeFor(int nodes) { return {kWidth, std::max((nodes + kWidth - 1) / kWidth, 1)}; }
};

}  // namespace lumivox::implicit_visibility

namespace lumivox {

template <>
struct PortTraits<implicit_visibility::SurfaceElements> {
  static PortKind kind() {
    constexpr auto kAny = PortResource::Sign::any;
    return {"SurfaceElements",
            "the surface as discs, and trees of discs above them, on the host and on the device",
            {{"position", "d2 rgba32f, a texel a node", "xyz mean position, m; w area, m^2", kAny},
             {"normal", "d2 rgba32f, a texel a node",
              "discs: xyz mean normal, w radius, m; groups: xyz area shown along x, y, z, m^2, w radius, m",
              kAny},
             {"albedo", "d2 rgba32f, a texel a node", "xyz diffuse albedo, mean by area; w 1"},
             {"specular", "d2 rgba32f, a texel a node", "xyz Phong albedo, mean by area; w Phong exponent"},
             {"emission", "d2 rgba32f, a texel a node",
              "xyz radiance from the front, W/(sr m^2), mean by area; w 0; of groups 0"},
             {"children", "buffer", "uvec4 for each node above the leaves: its children, 2^32 - 1: none"}}};
  }
  static void contents(const implicit_visibility::SurfaceElements& port, PortContents& contents) {
    contents.texture("position", port.position);
    contents.texture("normal", port.normal);
    contents.texture("albedo", port.albedo);
    contents.texture("specular", port.specular);
    contents.texture("emission", port.emission);
    contents.buffer("children", port.children);
  }
};

}  // namespace lumivox
