#include "apply_vertices.h"

#include <algorithm>

#include "lumivox/toolkit/visible_surface.h"
#include "vertex_neighbours.h"
#include "virtual_area_lights_shaders.h"

namespace lumivox::virtual_area_lights {

using namespace shaders::virtual_area_lights;

namespace {

/// What does not change while the set of points stays.
struct VertexBuffers {
  int sides = 1;
  gpu::BufferRef objects, any, glossy;
};

const VertexBuffers& buffersOf(PassContext& frame, const SurfacePoints& points) {
  return frame.kept("neighbours of vertices", points.set, [&] {
    const Scene& scene = frame.sceneDescription();
    const VertexNeighbours found = neighboursOfVertices(scene, *points.set, points.neighbours);
    std::vector<std::uint32_t> objects(scene.positions.size());
    for (std::size_t o = 0; o < scene.objects.size(); ++o)
      std::fill_n(objects.begin() + scene.objects[o].firstVertex, scene.objects[o].vertexCount,
                  static_cast<std::uint32_t>(o));
    return VertexBuffers{found.sides, frame.uploaded(objects, "objects of vertices"),
                         frame.uploaded(found.any, "points of vertices"),
                         frame.uploaded(found.glossy, "glossy points of vertices")};
  });
}

/// VertexLight of interpolate_vertices.comp, for each side of each vertex.
gpu::BufferRef atVertices(PassContext& frame, const VertexInputs& inputs, int lobe,
                          const gpu::TextureRef& lights, const gpu::TextureRef& places) {
  const VertexBuffers& buffers = buffersOf(frame, inputs.points);
  const auto count = static_cast<std::uint64_t>(frame.sceneDescription().positions.size());
  gpu::BufferRef result =
      frame.elements(interpolate_vertices::vertexLights, count * static_cast<std::uint64_t>(buffers.sides),
                     "light of vertices");
  using Variant = interpolate_vertices::Variant;
  const bool glossy = lobe == Variant::lobeGlossy;
  frame.dispatchList(
      frame.program(Variant{.lobe = lobe,
                            .interpolate = inputs.plain && !glossy ? Variant::interpolatePlain
                                                                   : Variant::interpolateAveraged},
                    interpolate_vertices::Constants{.neighbours = inputs.points.neighbours}),
      {interpolate_vertices::parameters({static_cast<int>(count), buffers.sides, inputs.published}),
       SceneBinding(frame, nullptr, nullptr), SurfacePointsBinding(inputs.points),
       interpolate_vertices::lights(lights, gpu::Sampling::nearest),
       interpolate_vertices::places(places, gpu::Sampling::nearest),
       interpolate_vertices::vertexObjects(buffers.objects),
       interpolate_vertices::vertexPoints(glossy ? buffers.glossy : buffers.any),
       interpolate_vertices::vertexLights(result)},
      count);
  return result;
}

SeenLight overTriangles(PassContext& frame, const VertexInputs& inputs, const gpu::BufferRef& lights) {
  SeenLight result{frame.image("light over triangles"), frame.image("places of light over triangles")};
  drawVisible(frame, {result.first, result.second}, vertices::Variant{},
              {vertices::vertexSides({buffersOf(frame, inputs.points).sides}), vertices::vertexLights(lights),
               GBufferBinding(inputs.gbuffer)});
  return result;
}

}  // namespace

SeenLight diffuseOverTriangles(PassContext& frame, const VertexInputs& inputs, const gpu::TextureRef& lights,
                               const gpu::TextureRef& places) {
  // It does not look at the camera.
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
