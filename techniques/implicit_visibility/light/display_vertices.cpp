#include "display_vertices.h"

#include "implicit_visibility_shaders.h"
#include "lumivox/base/error.h"
#include "lumivox/toolkit/visible_surface.h"

namespace lumivox::implicit_visibility {

using namespace shaders::implicit_visibility;

Image interpolatedOverTriangles(PassContext& frame, const SurfaceElements& elements, const GBuffer& gbuffer,
                                const gpu::TextureRef& values) {
  const std::vector<std::uint32_t>& leaves = elements.tree->leafOfVertex;
  if (elements.leafCount > 0 && leaves.empty())
    throw Error(
        "implicit_visibility.display: 'interpolate vertices' has no values at vertices; expected "
        "'source vertices' in implicit_visibility.elements");
  Image result{frame.image("values at vertices")};
  if (elements.leafCount == 0) {
    result.texture->clear(glm::vec4(0.0f));
    return result;
  }
  const gpu::BufferRef ofVertices = frame.kept(
      "elements of vertices", elements.tree, [&] { return frame.uploaded(leaves, "elements of vertices"); });
  drawVisible(frame, {result.texture}, display_vertices::Variant{},
              {display_vertices::vertexLeaves(ofVertices),
               display_vertices::leafValues(values, gpu::Sampling::nearest), GBufferBinding(gbuffer)});
  return result;
}

}  // namespace lumivox::implicit_visibility
