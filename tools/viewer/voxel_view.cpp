#include "viewer/voxel_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "lumivox/base/error.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/toolkit/voxel_view.h"

namespace lumivox::viewer {
namespace {

constexpr std::array kHarmonics{"Y00", "Y1-1", "Y10", "Y11"};

const PortContents::Field& fieldNamed(const PortContents& contents, const std::string& name, int level) {
  std::vector<std::string> names;
  for (const PortContents::Field* field : fieldsOfLevel(contents, level)) {
    if (field->name == name || field->what->name == name) return *field;
    names.push_back(field->name);
  }
  throw Error(fmt::format("voxels {}: a {} has no such field; expected one of {}", name, contents.kind().name,
                          fmt::join(names, ", ")));
}

/// The field Y00 of a port whose textures hold one harmonic in each component.
const PortContents::Field& harmonicsOf(const PortContents& contents, int level) {
  const PortContents::Field& first = fieldNamed(contents, kHarmonics[0], level);
  for (std::size_t k = 0; k < kHarmonics.size(); ++k) {
    const auto* const texels = std::get_if<VoxelTexels>(&fieldNamed(contents, kHarmonics[k], level).source);
    const auto* const all = std::get_if<VoxelTexels>(&first.source);
    const bool fits = texels != nullptr && all != nullptr && texels->textures == all->textures &&
                      std::all_of(texels->channels.begin(), texels->channels.end(),
                                  [&](const VoxelTexels::Channel& channel) {
                                    return channel.component == static_cast<int>(k);
                                  });
    if (!fits || texels->channels.size() != 3)
      throw Error(
          fmt::format("voxels {}: {} is not component {} of three textures", kLobes, kHarmonics[k], k));
  }
  return first;
}

}  // namespace

std::vector<std::string> drawnFields(const PortKind& kind) {
  std::vector<std::string> names;
  for (const PortField& field : kind.fields) names.push_back(field.name);
  if (std::all_of(kHarmonics.begin(), kHarmonics.end(), [&](const char* name) {
        return std::find(names.begin(), names.end(), name) != names.end();
      }))
    names.insert(names.begin(), kLobes);
  return names;
}

VoxelPicture VoxelView::draw(const PortContents& contents, const std::string& name, int level, float above,
                             const CameraView& camera) {
  const bool lobes = name == kLobes;
  const PortContents::Field& field = lobes ? harmonicsOf(contents, level) : fieldNamed(contents, name, level);
  shaders_.device().barrier();  // the draw reads what passes wrote
  const VoxelCanvas canvas(shaders_);
  const VoxelField voxels(canvas, field);
  const ImageBuffer seen = imageOf(*firstVoxels(canvas, camera, voxels, {.above = above}, lobes), 4);
  VoxelPicture picture;
  picture.values = ImageBuffer(camera.width, camera.height, voxels.channels());
  picture.brightness = ImageBuffer(camera.width, camera.height, 1);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      for (int c = 0; c < voxels.channels(); ++c) picture.values.at(x, y, c) = seen.at(x, y, c);
      picture.brightness.at(x, y, 0) = seen.at(x, y, 3);
    }
  picture.quantity =
      lobes ? "spherical harmonics in the direction of each point of the lobe" : field.what->quantity;
  picture.unit = field.unit;
  picture.isDirection = field.what->role == PortField::Role::direction;
  return picture;
}

}  // namespace lumivox::viewer
