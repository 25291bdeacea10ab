// Colours at vertices, the paper's way of showing light (Dong et al. 2007, Sec. 4.3.1).
#pragma once

#include "../elements/surface_elements.h"
#include "lumivox/plugin/technique.h"

namespace lumivox::implicit_visibility {

/// Values of leaves on vertices (two texels per leaf: front and back), interpolated over the triangles that
/// the camera sees; w is 1 where there is a value. Error where leaves do not stand on vertices.
Image interpolatedOverTriangles(PassContext& frame, const SurfaceElements& elements, const GBuffer& gbuffer,
                                const gpu::TextureRef& values);

}  // namespace lumivox::implicit_visibility
