#include "viewer/port_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "lumivox/base/error.h"

namespace lumivox::viewer {
namespace {

/// Converts a light's depths, 0..1 between its near and far plane, to metres behind the near plane.
void makeDistances(ImageBuffer& depths, const glm::mat4& worldToClip) {
  const glm::dmat4 clipToWorld = glm::inverse(glm::dmat4(worldToClip));
  const auto placeOf = [&](double x, double y, double depth) {
    const glm::dvec4 place = clipToWorld * glm::dvec4(x, y, depth, 1.0);
    return glm::dvec3(place) / place.w;
  };
  for (int row = 0; row < depths.height(); ++row)
    for (int column = 0; column < depths.width(); ++column) {
      const double x = 2.0 * (column + 0.5) / depths.width() - 1.0,
                   y = 1.0 - 2.0 * (row + 0.5) / depths.height();
      float& depth = depths.at(column, row, 0);
      depth = static_cast<float>(glm::distance(placeOf(x, y, depth), placeOf(x, y, 0.0)));
    }
}

}  // namespace

PortPicture pictureOfPort(const PortContents& contents, const PortChoice& choice, const CameraView& camera,
                          const std::function<VoxelView&()>& view) {
  const auto texture = std::find_if(
      contents.resources().begin(), contents.resources().end(), [&](const PortContents::Resource& resource) {
        return resource.texture != nullptr &&
               (choice.texture.empty() || resource.what->name == choice.texture);
      });
  PortPicture picture;
  std::string field = choice.field;
  if (field.empty() && texture == contents.resources().end() && choice.texture.empty() &&
      !contents.kind().fields.empty())
    field = drawnFields(contents.kind()).front();
  if (!field.empty()) {
    VoxelPicture voxels = view().draw(contents, field, choice.level, choice.above, camera);
    for (const PortContents::Field& one : contents.fields())
      picture.levels = std::max(picture.levels, one.level + 1);
    picture.image = std::move(voxels.values);
    picture.brightness = std::move(voxels.brightness);
    picture.shown = std::move(field);
    picture.quantity = std::move(voxels.quantity);
    picture.unit = std::move(voxels.unit);
    picture.isDirection = voxels.isDirection;
    return picture;
  }
  if (texture == contents.resources().end())
    throw Error(fmt::format("{}.{} has no texture{}", choice.pass, choice.port,
                            choice.texture.empty() ? "" : " '" + choice.texture + "'"));
  const gpu::TextureDescription& is = texture->texture->description();
  picture.image = sliceOf(*texture->texture, choice.level, choice.slice, choice.channel);
  picture.shown = texture->what->name;
  picture.quantity = texture->what->meaning;
  const auto views = std::find_if(contents.resources().begin(), contents.resources().end(),
                                  [](const PortContents::Resource& resource) {
                                    return resource.buffer != nullptr && resource.what->name == "views";
                                  });
  if (is.format == gpu::Format::depth32f && choice.level == 0 && views != contents.resources().end()) {
    glm::mat4 worldToClip;
    const std::vector<std::byte> bytes = views->buffer->download(
        static_cast<std::uint64_t>(choice.slice) * sizeof(worldToClip), sizeof(worldToClip));
    std::memcpy(&worldToClip, bytes.data(), sizeof(worldToClip));
    makeDistances(picture.image, worldToClip);
    picture.quantity = "way behind the near plane of the light's view";
    picture.unit = "m";
  }
  picture.levels = is.levels;
  picture.slices = is.kind == gpu::TextureKind::d3 ? std::max(1, is.depth >> choice.level) : is.depth;
  return picture;
}

ImageBuffer sliceOf(const gpu::Texture& texture, int level, int slice, Channel channel) {
  const gpu::TextureDescription& is = texture.description();
  if (level < 0 || level >= is.levels)
    throw Error(
        fmt::format("{} has no level {}; expected one of 0..{}", texture.label(), level, is.levels - 1));
  const int width = std::max(1, is.width >> level), height = std::max(1, is.height >> level);
  const int depth = is.kind == gpu::TextureKind::d3 ? std::max(1, is.depth >> level) : is.depth;
  if (slice < 0 || slice >= depth)
    throw Error(fmt::format("{} has no slice {}; expected one of 0..{}", texture.label(), slice, depth - 1));
  const int components = gpu::componentCount(is.format);
  const int first = channel == Channel::colour ? 0 : static_cast<int>(channel) - static_cast<int>(Channel::x);
  if (first >= components)
    throw Error(fmt::format("{} has no component {}; it is {}", texture.label(),
                            channelWords()[static_cast<std::size_t>(channel)], name(is.format)));
  const int channels = channel != Channel::colour || components == 1 ? 1 : 3;
  const bool integers = is.format == gpu::Format::r32ui || is.format == gpu::Format::rg32ui ||
                        is.format == gpu::Format::rgba32ui;
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const std::size_t before = pixels * static_cast<std::size_t>(slice) * static_cast<std::size_t>(components);
  std::vector<float> values;
  if (integers) {
    const std::vector<std::byte> bytes = texture.download(level);
    values.resize(bytes.size() / sizeof(std::uint32_t));
    for (std::size_t i = 0; i < values.size(); ++i) {
      std::uint32_t word = 0;
      std::memcpy(&word, bytes.data() + i * sizeof(word), sizeof(word));
      values[i] = static_cast<float>(word);
    }
  } else {
    values = texture.downloadFloats(level);
  }
  ImageBuffer image(width, height, channels);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel)
    for (int c = 0; c < std::min(channels, components - first); ++c)
      image.values()[pixel * static_cast<std::size_t>(channels) + static_cast<std::size_t>(c)] =
          values[before + pixel * static_cast<std::size_t>(components) + static_cast<std::size_t>(first + c)];
  return image;
}

}  // namespace lumivox::viewer
