#include "apply_vertices.h"

#include <algorithm>

#include "lumivox/scene/models.h"
#include "lumivox/toolkit/visible_surface.h"
#include "virtual_area_lights_shaders.h"

namespace lumivox::virtual_area_lights {

using namespace shaders::virtual_area_lights;

namespace {

/// Mirror of VertexOwner in interpolate_vertices.comp (std430).
struct VertexOwner {
  std::uint32_t object = 0, material = 0;
  float model = 0.0f;
};

/// Whose vertex each is. Of one that parts share the first glossy one decides: a vertex has one glossy light.
std::vector<VertexOwner> ownersOf(const Scene& scene) {
  std::vector<VertexOwner> owners(scene.positions.size());
  const std::vector<std::uint32_t> models = modelsOf(scene);
  std::vector<bool> isGlossy(owners.size(), false);
  for (std::size_t o = 0; o < scene.objects.size(); ++o)
    for (const Part& part : scene.objects[o].parts)
      for (std::uint32_t i = part.firstIndex; i < part.firstIndex + part.indexCount; ++i) {
        const std::uint32_t vertex = scene.indices[i];
        if (isGlossy[vertex]) continue;
        owners[vertex] = {static_cast<std::uint32_t>(o), static_cast<std::uint32_t>(part.material),
                          static_cast<float>(models[o])};
        isGlossy[vertex] = scene.materials[static_cast<std::size_t>(part.material)].glossy();
      }
  return owners;
}

int sidesOf(const SurfacePoints& points) {
  return std::ranges::any_of(points.set->points, &SurfacePoint::back) ? 2 : 1;
}

/// VertexLight of interpolate_vertices.comp, for each side of each vertex.
gpu::BufferRef atVertices(PassContext& frame, const VertexInputs& inputs, int lobe,
                          const gpu::TextureRef& lights, const gpu::TextureRef& places) {
  const Scene& scene = frame.sceneDescription();
  const auto count = static_cast<std::uint64_t>(scene.positions.size());
  const int sides = sidesOf(inputs.points);
  const gpu::BufferRef owners = frame.kept(
      "owners of vertices", 0, [&] { return frame.uploaded(ownersOf(scene), "owners of vertices"); });
  gpu::BufferRef result = frame.elements(interpolate_vertices::vertexLights,
                                         count * static_cast<std::uint64_t>(sides), "light of vertices");
  using Variant = interpolate_vertices::Variant;
  const Variant variant{.lobe = lobe,
                        .interpolate = inputs.plain && lobe == Variant::lobeDiffuse
                                           ? Variant::interpolatePlain
                                           : Variant::interpolateAveraged};
  frame.dispatchList(
      frame.program(variant, interpolate_vertices::Constants{.neighbours = inputs.points.neighbours}),
      {interpolate_vertices::parameters({static_cast<int>(count), sides, inputs.published}),
       SceneBinding(frame, nullptr, nullptr), SurfacePointsBinding(inputs.points),
       interpolate_vertices::lights(lights, gpu::Sampling::nearest),
       interpolate_vertices::places(places, gpu::Sampling::nearest),
       interpolate_vertices::vertexOwners(owners), interpolate_vertices::vertexLights(result)},
      count);
  return result;
}

SeenLight overTriangles(PassContext& frame, const VertexInputs& inputs, const gpu::BufferRef& lights) {
  SeenLight result{frame.image("light over triangles"), frame.image("places of light over triangles")};
  drawVisible(frame, {result.first, result.second}, vertices::Variant{},
              {vertices::parameters({sidesOf(inputs.points)}), vertices::vertexLights(lights),
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
