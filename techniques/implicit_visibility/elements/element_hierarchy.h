// The hierarchy of surface elements, made once: a kind of port of this technique's own.
#pragma once

#include <memory>

#include "../forest/forest.h"
#include "lumivox/plugin/technique.h"
#include "surface_elements.h"

namespace lumivox::implicit_visibility {

/// Trees of elements and the reflectances of their nodes, without positions (Dong et al. 2007, Sec. 4.1).
struct ElementHierarchy {
  std::shared_ptr<const Forest> forest;
  SurfaceElements fixed;  ///< without position, normal and state
};

/// The parameters by which elements are made.
class ElementWords {
 public:
  explicit ElementWords(Pass* pass);
  /// Made once per run and kept.
  ElementHierarchy made(PassContext& frame) const;

 private:
  Param<Source> source_;
  Param<Segments> segments_;
  Param<int> elements_;
  Param<float> share_;
};

/// A texture with a texel for each value.
gpu::TextureRef elementTexture(PassContext& frame, std::vector<glm::vec4> values, const std::string& label);

}  // namespace lumivox::implicit_visibility

namespace lumivox {

template <>
struct PortTraits<implicit_visibility::ElementHierarchy> {
  static PortKind kind() {
    return {"ElementHierarchy",
            "trees of surface elements with their materials, without positions",
            {{"albedo", "d2 rgba32f, a texel a node", "as of SurfaceElements"},
             {"specular", "d2 rgba32f, a texel a node", "as of SurfaceElements; or null"},
             {"emission", "d2 rgba32f, a texel a node", "as of SurfaceElements; or null"},
             {"children", "buffer", "as of SurfaceElements"}}};
  }
  static void contents(const implicit_visibility::ElementHierarchy& port, PortContents& contents) {
    contents.texture("albedo", port.fixed.albedo);
    contents.texture("specular", port.fixed.specular);
    contents.texture("emission", port.fixed.emission);
    contents.buffer("children", port.fixed.children);
  }
};

}  // namespace lumivox
