#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "gpu/counters.h"
#include "gpu/state.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"

namespace lumivox::gpu {
namespace {

GLenum targetOf(TextureKind kind) {
  switch (kind) {
    case TextureKind::d2:
      return GL_TEXTURE_2D;
    case TextureKind::d2Array:
      return GL_TEXTURE_2D_ARRAY;
    case TextureKind::d3:
      return GL_TEXTURE_3D;
  }
  return GL_TEXTURE_2D;
}

std::string sizeText(const TextureDescription& d) {
  switch (d.kind) {
    case TextureKind::d2:
      return fmt::format("{} x {} texels", d.width, d.height);
    case TextureKind::d2Array:
      return fmt::format("{} layers of {} x {} texels", d.depth, d.width, d.height);
    case TextureKind::d3:
      return fmt::format("{} x {} x {} texels", d.width, d.height, d.depth);
  }
  return {};
}

std::string describe(const TextureDescription& d, const std::string& label) {
  return fmt::format("texture '{}' ({} of {}, {} level{}, {})", label, sizeText(d), name(d.format), d.levels,
                     d.levels == 1 ? "" : "s", formatBytes(d.sizeBytes()));
}

void checkLimits(const TextureDescription& d, const std::string& label, const DeviceLimits& limits,
                 const std::string& renderer) {
  const auto refuse = [&](const std::string& why) {
    throw Error(fmt::format("{}: {}", describe(d, label), why));
  };
  if (d.width < 1 || d.height < 1 || d.depth < 1) refuse("every extent must be at least 1");
  if (d.kind == TextureKind::d2 && d.depth != 1) refuse("a d2 texture has depth 1");
  if (d.kind == TextureKind::d3 && traitsOf(d.format).depth) refuse("a volume cannot hold depth");
  const int longest = std::max(d.width, d.height);
  if (d.kind == TextureKind::d3) {
    if (std::max(longest, d.depth) > limits.textureSize3d) {
      refuse(
          fmt::format("a volume on {} has at most {} texels along an axis", renderer, limits.textureSize3d));
    }
  } else {
    if (longest > limits.textureSize2d) {
      refuse(
          fmt::format("an image on {} has at most {} texels along an axis", renderer, limits.textureSize2d));
    }
    if (d.depth > limits.textureLayers)
      refuse(fmt::format("{} has at most {} layers", renderer, limits.textureLayers));
  }
  const int full = fullLevelCount(d.width, d.height, d.kind == TextureKind::d3 ? d.depth : 1);
  if (d.levels < 1 || d.levels > full) refuse(fmt::format("this size has 1 to {} mip levels", full));
}

struct Extent {
  int width, height, depth;
};
Extent extentOf(const TextureDescription& d, int level) {
  assert(level >= 0 && level < d.levels);
  const auto halved = [level](int size) { return std::max(1, size >> level); };
  return {halved(d.width), halved(d.height), d.kind == TextureKind::d3 ? halved(d.depth) : d.depth};
}
std::size_t texelsOf(const Extent& e) {
  return static_cast<std::size_t>(e.width) * static_cast<std::size_t>(e.height) *
         static_cast<std::size_t>(e.depth);
}

void uploadAs(GLuint handle, const TextureDescription& d, int level, GLenum type, const void* data) {
  const Extent e = extentOf(d, level);
  const GLenum external = traitsOf(d.format).external;
  if (d.kind == TextureKind::d2) {
    glTextureSubImage2D(handle, level, 0, 0, e.width, e.height, external, type, data);
  } else {
    glTextureSubImage3D(handle, level, 0, 0, 0, e.width, e.height, e.depth, external, type, data);
  }
}

/// Downloads in parts, since the size argument of OpenGL has 31 bits.
void downloadSlicesAs(GLuint handle, const TextureDescription& d, int level, GLenum type, int first,
                      int count, void* data, std::size_t sizeBytes, std::uint64_t mostBytes) {
  const Extent e = extentOf(d, level);
  const std::uint64_t rowBytes =
      sizeBytes / (static_cast<std::uint64_t>(count) * static_cast<std::uint64_t>(e.height));
  for (const Rows& part : partsOf(count, e.height, rowBytes, mostBytes)) {
    glGetTextureSubImage(handle, level, 0, part.firstRow, first + part.firstSlice, e.width, part.rows,
                         part.slices, traitsOf(d.format).external, type, static_cast<GLsizei>(part.bytes),
                         static_cast<std::byte*>(data) + part.offset);
  }
}

void downloadAs(GLuint handle, const TextureDescription& d, int level, GLenum type, void* data,
                std::size_t sizeBytes, std::uint64_t mostBytes) {
  downloadSlicesAs(handle, d, level, type, 0, extentOf(d, level).depth, data, sizeBytes, mostBytes);
}

}  // namespace

Texture::Texture(Device& device, const TextureDescription& description, std::string label)
    : device_(device.state()), description_(description), label_(std::move(label)) {
  device_->use();
  checkLimits(description_, label_, device_->limits, device_->info.renderer);
  device_->requireDeviceMemory(sizeBytes(), describe(description_, label_));
  glCreateTextures(targetOf(description_.kind), 1, &handle_);
  const GLenum internal = traitsOf(description_.format).internal;
  if (description_.kind == TextureKind::d2) {
    glTextureStorage2D(handle_, description_.levels, internal, description_.width, description_.height);
  } else {
    glTextureStorage3D(handle_, description_.levels, internal, description_.width, description_.height,
                       description_.depth);
  }
  if (!label_.empty())
    glObjectLabel(GL_TEXTURE, handle_, static_cast<GLsizei>(std::min<std::size_t>(label_.size(), 200)),
                  label_.c_str());
  try {
    device_->check("allocating " + describe(description_, label_) + device_->besideText());
  } catch (...) {
    glDeleteTextures(1, &handle_);
    throw;
  }
  device_->allocated(this, sizeBytes());
}

Texture::~Texture() {
  if (device_->useToRelease()) {
    device_->framebuffers.forget(handle_);
    glDeleteTextures(1, &handle_);
    device_->forgetBindings();
  }
  device_->freed(this, sizeBytes());
}

void Texture::upload(int level, std::span<const std::byte> texels) {
  device_->use();
  device_->order();
  assert(texels.size() == texelsOf(extentOf(description_, level)) * bytesPerTexel(description_.format));
  uploadAs(handle_, description_, level, traitsOf(description_.format).type, texels.data());
  device_->transfers.uploaded += texels.size();
  device_->checkTold("uploading to " + label_);
}

std::vector<std::byte> Texture::download(int level) const {
  device_->use();
  device_->order();
  const std::uint64_t bytes = texelsOf(extentOf(description_, level)) * bytesPerTexel(description_.format);
  DeviceState::requireHostMemory(bytes, label_);
  std::vector<std::byte> texels(bytes);
  downloadAs(handle_, description_, level, traitsOf(description_.format).type, texels.data(), texels.size(),
             device_->limits.downloadBytes);
  device_->downloaded(texels.size());
  device_->check("downloading " + label_);
  return texels;
}

void Texture::downloadSlices(int level, int first, int count, std::span<std::byte> texels) const {
  device_->use();
  device_->order();
  Extent slices = extentOf(description_, level);
  assert(first >= 0 && count > 0 && first + count <= slices.depth);
  slices.depth = count;
  assert(texels.size() == texelsOf(slices) * bytesPerTexel(description_.format));
  downloadSlicesAs(handle_, description_, level, traitsOf(description_.format).type, first, count,
                   texels.data(), texels.size(), device_->limits.downloadBytes);
  device_->downloaded(texels.size());
  device_->check("downloading " + label_);
}

void Texture::uploadFloats(int level, std::span<const float> values) {
  device_->use();
  device_->order();
  assert(!traitsOf(description_.format).integer);
  assert(values.size() == texelsOf(extentOf(description_, level)) *
                              static_cast<std::size_t>(componentCount(description_.format)));
  uploadAs(handle_, description_, level, GL_FLOAT, values.data());
  device_->transfers.uploaded += values.size_bytes();
  device_->checkTold("uploading to " + label_);
}

std::vector<float> Texture::downloadFloats(int level) const {
  device_->use();
  device_->order();
  assert(!traitsOf(description_.format).integer);
  const std::size_t count =
      texelsOf(extentOf(description_, level)) * static_cast<std::size_t>(componentCount(description_.format));
  DeviceState::requireHostMemory(count * sizeof(float), label_);
  std::vector<float> values(count);
  downloadAs(handle_, description_, level, GL_FLOAT, values.data(), values.size() * sizeof(float),
             device_->limits.downloadBytes);
  device_->downloaded(values.size() * sizeof(float));
  device_->check("downloading " + label_);
  return values;
}

void Texture::clear(const glm::vec4& value, int level) {
  device_->use();
  device_->order();
  const FormatTraits& traits = traitsOf(description_.format);
  for (int i = level < 0 ? 0 : level; i < (level < 0 ? description_.levels : level + 1); ++i) {
    device_->transfers.cleared += texelsOf(extentOf(description_, i)) * bytesPerTexel(description_.format);
    if (traits.integer) {
      std::array<GLuint, 4> words{};
      for (int c = 0; c < 4; ++c)
        words[static_cast<std::size_t>(c)] = static_cast<GLuint>(std::llround(value[c]));
      glClearTexImage(handle_, i, traits.external, GL_UNSIGNED_INT, words.data());
    } else {
      glClearTexImage(handle_, i, traits.external, GL_FLOAT, &value[0]);
    }
  }
  device_->checkTold("clearing " + label_);
}

void Texture::generateLevels() {
  device_->use();
  device_->order();
  glGenerateTextureMipmap(handle_);
  device_->checkTold("making the mip levels of " + label_);
}

}  // namespace lumivox::gpu
