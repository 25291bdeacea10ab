#include "lumivox/toolkit/media.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <vector>

#include "lumivox/shader/slots.h"

namespace lumivox {

MediaBinding::MediaBinding(PassContext& frame, const ScatteringGrid& grid) {
  std::vector<MediumData> data;
  std::size_t textures = 0;
  for (const ScatteringGrid::Medium& medium : grid.media) {
    if (medium.bounds.empty || medium.extinction == glm::vec3(0.0f)) continue;
    MediumData& one = data.emplace_back();
    one.lowAnisotropy = glm::vec4(medium.bounds.low, medium.anisotropy);
    one.highDensity = glm::vec4(medium.bounds.high, -1.0f);
    one.extinction = glm::vec4(medium.extinction, 0.0f);
    one.scattering = glm::vec4(medium.extinction * medium.albedo, 0.0f);
    one.gridLowVoxel = glm::vec4(medium.grid.low, medium.grid.voxelSize);
    one.gridExtent = glm::vec4(glm::vec3(medium.grid.resolution) * medium.grid.voxelSize, 0.0f);
    if (medium.density == nullptr) continue;
    assert(textures < densities_.size());  // the scene's loader refuses more
    one.highDensity.w = static_cast<float>(textures);
    densities_[textures++] = medium.density;
  }
  // Every texture binding of the shader needs a texture, also without a medium.
  for (std::size_t i = textures; i < densities_.size() && textures > 0; ++i)
    densities_[i] = densities_.front();
  const auto count = static_cast<int>(data.size());

  constexpr std::size_t kHeader = 16;  // the count, padded to the alignment of what follows
  std::vector<std::byte> bytes(kHeader + std::max<std::size_t>(data.size(), 1) * sizeof(MediumData));
  std::memcpy(bytes.data(), &count, sizeof(count));
  if (!data.empty()) std::memcpy(bytes.data() + kHeader, data.data(), data.size() * sizeof(MediumData));
  media_ = frame.buffer(bytes.size(), "media");
  media_->upload(bytes);
  axis = textures > 0 ? varying : even;
  add(shader::StorageSlot{"Media"}(media_));
  constexpr std::array<const char*, kMostVaryingMedia> kNames = {"density0", "density1", "density2",
                                                                 "density3"};
  for (std::size_t i = 0; i < kNames.size(); ++i)
    add(shader::SampledSlot{kNames[i]}(densities_[i], gpu::Sampling::linearBorder));
}

}  // namespace lumivox
