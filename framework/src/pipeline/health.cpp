#include "pipeline/health.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lumivox {

namespace {

bool isFloat(gpu::Format format) {
  switch (format) {
    case gpu::Format::r16f:
    case gpu::Format::rg16f:
    case gpu::Format::rgba16f:
    case gpu::Format::r32f:
    case gpu::Format::rg32f:
    case gpu::Format::rgba32f:
    case gpu::Format::depth32f:
      return true;
    default:
      return false;
  }
}

struct Bad {
  const char* what;
  std::size_t count = 0, firstTexel = 0;
};

std::string placeText(const gpu::TextureDescription& description, int level, std::size_t texel) {
  const auto extent = [level](int size) { return static_cast<std::size_t>(std::max(1, size >> level)); };
  const std::size_t width = extent(description.width), height = extent(description.height);
  const std::size_t x = texel % width, y = texel / width % height, z = texel / (width * height);
  const std::string mip = level == 0 ? "" : fmt::format(" of mip level {}", level);
  switch (description.kind) {
    case gpu::TextureKind::d2:
      return fmt::format("pixel ({}, {}){}", x, y, mip);
    case gpu::TextureKind::d2Array:
      return fmt::format("pixel ({}, {}) of layer {}{}", x, y, z, mip);
    case gpu::TextureKind::d3:
      return fmt::format("voxel ({}, {}, {}){}", x, y, z, mip);
  }
  return {};
}

}  // namespace

void scanHealth(const std::string& pass, const OutBase& output, std::vector<std::string>& findings) {
  const PortContents contents = output.contents();
  std::vector<const PortContents::Resource*> textures;
  for (const PortContents::Resource& resource : contents.resources())
    if (resource.texture) textures.push_back(&resource);
  for (std::size_t number = 0; number < textures.size(); ++number) {
    const PortContents::Resource& resource = *textures[number];
    const PortResource& what = *resource.what;
    const gpu::Texture& texture = *resource.texture;
    const gpu::TextureDescription& description = texture.description();
    if (!isFloat(description.format)) continue;
    for (int level = 0; level < resource.filled.levels.value_or(description.levels); ++level) {
      const std::vector<float> values = texture.downloadFloats(level);
      const auto extent = [level](int size) { return static_cast<std::size_t>(std::max(1, size >> level)); };
      const std::size_t texels =
          extent(description.width) * extent(description.height) *
          (description.kind == gpu::TextureKind::d3 ? extent(description.depth)
                                                    : static_cast<std::size_t>(description.depth));
      const std::size_t components =
          std::max<std::size_t>(1, values.size() / std::max<std::size_t>(1, texels));
      const std::vector<bool> inUse =
          level == 0 && resource.filled.texels ? resource.filled.texels() : std::vector<bool>();
      Bad bad[] = {{"NaN"}, {"infinite"}, {"negative"}};
      for (std::size_t i = 0; i < values.size(); ++i) {
        const float value = values[i];
        if (std::isfinite(value) && value >= 0.0f) continue;
        if (std::isfinite(value) && what.sign == PortResource::Sign::any) continue;
        if (!inUse.empty() && !inUse[i / components]) continue;
        Bad& kind = bad[std::isnan(value) ? 0 : std::isinf(value) ? 1 : 2];
        if (kind.count++ == 0) kind.firstTexel = i / components;
      }
      for (const Bad& kind : bad) {
        if (kind.count == 0) continue;
        // Textures are not named by their labels, which may stem from an earlier use of the same memory.
        const std::string name = textures.size() > 1 ? fmt::format(" ({}, texture {} of {})", what.name,
                                                                   number + 1, textures.size())
                                                     : std::string();
        findings.push_back(fmt::format("pass {}, port {}{}: {} {}, first at {}", pass, output.name(), name,
                                       kind.count, kind.what,
                                       placeText(description, level, kind.firstTexel)));
      }
    }
  }
}

}  // namespace lumivox
