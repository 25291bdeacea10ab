#include "lumivox/toolkit/volume_room.h"

#include <fmt/format.h>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"

namespace lumivox {

std::vector<gpu::TextureRef> roomFor(PassContext& frame, const glm::ivec3& size, int count,
                                     gpu::Format format, const char* label, bool mips,
                                     const std::string& what) {
  const auto levelsOf = [&](const glm::ivec3& one) {
    return mips ? gpu::fullLevelCount(one.x, one.y, one.z) : 1;
  };
  const auto made = [&](const glm::ivec3& one) {
    std::vector<gpu::TextureRef> textures;
    for (int i = 0; i < count; ++i) textures.push_back(frame.volume(one, format, label, levelsOf(one)));
    return textures;
  };
  try {
    return made(size);
  } catch (const Error& error) {
    std::uint64_t voxels = 0;
    for (int level = 0; level < levelsOf(size); ++level)
      voxels += GridPlacement{.resolution = levelResolution(size, level)}.voxelCount();
    const std::uint64_t bytes = static_cast<std::uint64_t>(count) * voxels * gpu::bytesPerTexel(format);
    const int longest = GridPlacement{.resolution = size}.longest();
    for (int halvings = 1; longest >> halvings > 0; ++halvings) {
      try {
        made(levelResolution(size, halvings));
      } catch (const Error&) {
        continue;
      }
      throw Error(fmt::format(
          "room for {} of {} voxels along the longest side takes {}; of sizes halved from it the largest that fits is {} ({})",
          what, longest, formatBytes(bytes), longest >> halvings, error.what()));
    }
    throw;
  }
}

}  // namespace lumivox
