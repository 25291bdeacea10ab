// Clipmaps with given contents, and their voxels read back.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "../../techniques/voxel_cone_tracing/clipmap/radiance_clipmap.h"
#include "support/cones.h"
#include "support/voxel_fragments.h"

namespace lumivox::voxel_cone_tracing {

/// The name of gather's input for this store, for test::cones::gather.
inline const char* inputOf(const RadianceClipmap&) {
  return "clipmap";
}

}  // namespace lumivox::voxel_cone_tracing

namespace lumivox::test::clipmap {

using voxel_cone_tracing::RadianceClipmap;
using voxel_cone_tracing::VoxelRange;

struct ClipmapSettings {
  int resolution = 32, levels = 3;
  double extent = 0.0;
  const char* coverage = "touched";
  const char* precision = "float";
  double ramp = 0.25, border = 0.25;
  double ambient = 0.0;
  bool lights = true;
};

/// The clipmap of a static scene around its camera, as voxelized.
inline RadianceClipmap voxelized(const Scene& scene, const ClipmapSettings& settings = {}) {
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  PassHarness harness(device(), techniques(), "voxel_cone_tracing", "clipmap", scene, snapshot);
  harness.setParameter("resolution", settings.resolution);
  harness.setParameter("levels", settings.levels);
  harness.setParameter("extent", settings.extent);
  harness.setParameter("coverage", std::string(settings.coverage));
  harness.setParameter("precision", std::string(settings.precision));
  harness.setParameter("ambient", settings.ambient);
  PassHarness shadow(device(), techniques(), "direct_lighting", "shadow_map", scene, snapshot);
  if (settings.lights) {
    shadow.run();
    harness.setInput("shadow", shadow.output<ShadowMap>("depth"));
  }
  harness.run();
  return harness.output<RadianceClipmap>("radiance");
}

inline RadianceClipmap filtered(const RadianceClipmap& levels, const ClipmapSettings& settings = {}) {
  const Scene scene = cones::emptyScene();
  PassHarness harness(device(), techniques(), "voxel_cone_tracing", "clipmap_filter", scene,
                      snapshotOf(scene, 0.0));
  harness.setParameter("ramp", settings.ramp);
  harness.setParameter("border", settings.border);
  harness.setInput("radiance", levels);
  harness.run();
  return harness.output<RadianceClipmap>("mips");
}

/// A filtered clipmap around `eye`. `fill` gives the value of a voxel's face from the level, the voxel's
/// centre (m) and the face.
using Fill = std::function<glm::vec4(int level, const glm::vec3& middle, int face)>;
inline RadianceClipmap madeClipmap(const ClipmapSettings& settings, const glm::vec3& eye, const Fill& fill) {
  Scene scene = cones::emptyScene();
  scene.cameras.front().eye = eye;
  scene.cameras.front().target = glm::dvec3(eye) - glm::dvec3(0, 0, 1);
  RadianceClipmap result = voxelized(scene, settings);
  const gpu::TextureDescription& volume = result.faces[0]->description();
  std::vector<std::uint32_t> bits = result.occupied->downloadValues<std::uint32_t>();
  for (std::size_t face = 0; face < 6; ++face) {
    std::vector<float> texels(4 * static_cast<std::size_t>(volume.width * volume.height * volume.depth),
                              0.0f);
    for (int level = 0; level < result.around; ++level) {
      const RadianceClipmap::Block& block = result.levels[static_cast<std::size_t>(level)].own;
      // The border texels of the block repeat the voxels of the opposite side.
      for (int z = -1; z <= block.period; ++z)
        for (int y = -1; y <= block.period; ++y)
          for (int x = -1; x <= block.period; ++x) {
            const glm::ivec3 address = VoxelRange::addressOf({x, y, z}, block.period),
                             first = VoxelRange::addressOf(block.voxels.first, block.period),
                             voxel =
                                 block.voxels.first + VoxelRange::addressOf(address - first, block.period);
            const glm::vec4 value =
                fill(level, result.origin + result.sizeOf(level) * (glm::vec3(voxel) + 0.5f),
                     static_cast<int>(face));
            const glm::ivec3 at = block.texel + glm::ivec3(x, y, z);
            const std::size_t texel =
                4 * static_cast<std::size_t>((at.z * volume.height + at.y) * volume.width + at.x);
            for (int c = 0; c < 4; ++c) texels[texel + static_cast<std::size_t>(c)] = value[c];
            if (value.w == 0.0f) continue;
            const auto bit =
                static_cast<std::uint32_t>((address.z * block.period + address.y) * block.period + address.x);
            bits[block.word + bit / 32] |= 1u << bit % 32;
          }
    }
    result.faces[face]->uploadFloats(0, texels);
  }
  result.occupied->uploadValues(std::span<const std::uint32_t>(bits));
  return filtered(result, settings);
}

/// The values of one face at a level, by voxel, counted from the level's first voxel.
inline std::map<Cell, glm::vec3> voxelsOf(const RadianceClipmap& clipmap, int level, int face) {
  std::map<Cell, glm::vec3> result;
  for (const auto& [voxel, value] : clipmap.voxels(level, face)) result[{voxel.x, voxel.y, voxel.z}] = value;
  return result;
}

}  // namespace lumivox::test::clipmap
