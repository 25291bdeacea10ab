// Common parts of the passes that light elements and show them.
#pragma once

#include "../links/element_light.h"
#include "../links/element_links.h"
#include "implicit_visibility_shaders.h"
#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"

namespace lumivox::implicit_visibility {

/// Positions, normals and numbering of nodes (nodes.glsl).
class NodeBinding : public shader::BindingSet {
 public:
  explicit NodeBinding(const SurfaceElements& elements, int bins = 0);
};

/// What leaves see (links.glsl).
class LinkBinding : public shader::BindingSet {
 public:
  explicit LinkBinding(const ElementLinks& links);
};

/// An rgba32f texture of so many zero texels, in rows of SurfaceElements::kWidth.
gpu::TextureRef emptyTexels(PassContext& frame, int texels, const std::string& label);

}  // namespace lumivox::implicit_visibility
