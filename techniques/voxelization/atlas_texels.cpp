#include "atlas_texels.h"

#include <algorithm>
#include <glm/gtc/packing.hpp>

#include "lumivox/base/log.h"
#include "voxelization_shaders.h"

namespace lumivox::voxelization {

void AtlasTexels::update(PassContext& frame, double texelSize) {
  if (triangles_ != nullptr && texelSize == texelSize_) return;
  const SurfaceAtlas atlas = makeSurfaceAtlas(frame.sceneDescription(), texelSize);
  logDetails("atlas: {} texels of {:.3g} m in {} charts, in a square of {} texels a side",
             atlas.texels.size(), texelSize, atlas.chartCount, atlas.side);
  parts_ = atlas.parts;
  std::vector<std::uint32_t> triangles, places;
  triangles.reserve(atlas.texels.size());
  places.reserve(atlas.texels.size());
  for (const AtlasTexel& texel : atlas.texels) {
    triangles.push_back(texel.triangle);
    places.push_back(glm::packUnorm2x16({texel.second, texel.third}));
  }
  const auto uploaded = [&](std::vector<std::uint32_t>& words, const char* label) {
    words.resize(std::max<std::size_t>(words.size(), 1));
    gpu::BufferRef buffer = frame.buffer(words.size() * sizeof(std::uint32_t), label);
    buffer->upload(std::as_bytes(std::span(words)));
    return buffer;
  };
  triangles_ = uploaded(triangles, "atlas texels: triangles");
  places_ = uploaded(places, "atlas texels: places");
  texelSize_ = texelSize;
}

shader::BindingSet AtlasTexels::bindings(const AtlasPart& texels) const {
  using Texels = shaders::voxelization::Texels;
  return {shader::StorageSlot{"TexelTriangles"}(triangles_), shader::StorageSlot{"TexelPlaces"}(places_),
          shader::UniformSlot<Texels>{"Texels"}(
              {static_cast<int>(texels.firstTexel), static_cast<int>(texels.texelCount)})};
}

AtlasPart AtlasTexels::texelsOf(PassContext& frame, const SceneDraw& draw) const {
  // Draws are the parts of all objects in their order.
  return parts_.at(static_cast<std::size_t>(&draw - frame.scene().draws().data()));
}

}  // namespace lumivox::voxelization
