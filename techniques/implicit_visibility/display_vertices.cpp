#include "display_vertices.h"

#include "implicit_visibility_shaders.h"
#include "lumivox/base/error.h"
#include "lumivox/toolkit/bindings.h"
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
  const glm::ivec3 size = pixels(frame);
  const gpu::TextureRef depth = frame.texture(
      {gpu::TextureKind::d2, gpu::Format::depth32f, size.x, size.y, 1, 1}, "depth of values at vertices");
  const gpu::Drawing drawing =
      frame.device().drawTo({.colours = {{result.texture.get(), -1}}, .depth = depth.get()}, kVisibleSurface);
  for (const SceneDraw& draw : frame.scene().draws())
    drawPart(frame, draw, display_vertices::Variant{},
             {display_vertices::view({worldToClip(frame.snapshot())}),
              display_vertices::eye({frame.snapshot().camera.eye, glm::vec2(size)}),
              display_vertices::vertexLeaves(ofVertices),
              display_vertices::leafValues(values, gpu::Sampling::nearest), GBufferBinding(gbuffer)});
  return result;
}

}  // namespace lumivox::implicit_visibility
