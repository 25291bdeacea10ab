#include "apply_vertices.h"

#include "lumivox/toolkit/visible_surface.h"
#include "virtual_area_lights_shaders.h"

namespace lumivox::virtual_area_lights {

using namespace shaders::virtual_area_lights;

namespace {

/// VertexLight of interpolate_vertices.comp, for each side of each vertex.
gpu::BufferRef atVertices(PassContext& frame, const VertexInputs& inputs, int lobe,
                          const gpu::TextureRef& lights, const gpu::TextureRef& places) {
  const VertexPoints& referred = inputs.vertices;
  const auto count = static_cast<std::uint64_t>(frame.sceneDescription().positions.size());
  gpu::BufferRef result =
      frame.elements(interpolate_vertices::vertexLights, count * static_cast<std::uint64_t>(referred.sides),
                     "light of vertices");
  using Variant = interpolate_vertices::Variant;
  const bool glossy = lobe == Variant::lobeGlossy;
  frame.dispatchList(
      frame.program(Variant{.lobe = lobe,
                            .interpolate = inputs.plain && !glossy ? Variant::interpolatePlain
                                                                   : Variant::interpolateAveraged},
                    interpolate_vertices::Constants{.neighbours = referred.neighbours}),
      {interpolate_vertices::parameters({static_cast<int>(count), referred.sides, inputs.published}),
       SceneBinding(frame, nullptr, nullptr), SurfacePointsBinding(inputs.points),
       interpolate_vertices::lights(lights, gpu::Sampling::nearest),
       interpolate_vertices::places(places, gpu::Sampling::nearest),
       interpolate_vertices::vertexObjects(referred.objects),
       interpolate_vertices::vertexPoints(glossy ? referred.glossy : referred.any),
       interpolate_vertices::vertexLights(result)},
      count);
  return result;
}

SeenLight overTriangles(PassContext& frame, const VertexInputs& inputs, const gpu::BufferRef& lights) {
  SeenLight result{frame.image("light over triangles"), frame.image("places of light over triangles")};
  drawVisible(frame, {result.first, result.second}, vertices::Variant{},
              {vertices::vertexSides({inputs.vertices.sides}), vertices::vertexLights(lights),
               GBufferBinding(inputs.gbuffer)});
  return result;
}

}  // namespace

SeenLight diffuseOverTriangles(PassContext& frame, const VertexInputs& inputs, const gpu::TextureRef& lights,
                               const gpu::TextureRef& places) {
  // It does not depend on the camera.
  return overTriangles(frame, inputs, frame.kept("diffuse light of vertices", lights, [&] {
    return atVertices(frame, inputs, interpolate_vertices::Variant::lobeDiffuse, lights, places);
  }));
}

SeenLight glossyOverTriangles(PassContext& frame, const VertexInputs& inputs, const gpu::TextureRef& lights,
                              const gpu::TextureRef& places) {
  return overTriangles(frame, inputs,
                       atVertices(frame, inputs, interpolate_vertices::Variant::lobeGlossy, lights, places));
}

}  // namespace lumivox::virtual_area_lights
