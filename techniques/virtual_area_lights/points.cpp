// Spreads sparse points over surfaces in advance and moves them along (Lensing and Broll 2013, Sec. 3.2).
#include <fmt/format.h>

#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/toolkit/room.h"
#include "passes.h"

namespace lumivox::virtual_area_lights {
namespace {

class PointsPass : public Pass {
  Param<int> points{this, "points", 2048, within(1, 262144),
                    "largest number of points, on both sides of open surfaces"};
  Param<int> neighbours{
      this, "neighbours", 8, within(1, 32),
      "number of nearest points that the look-up grid lists for every place on the surface"};
  Out<SurfacePoints> result{this, "points", Contributes::nothing, Needs::triangles,
                            "points spread evenly over the surfaces"};

  Reads readsFrom() const override { return Reads::geometry | Reads::materials; }
  bool worksOnHost() const override { return true; }

  void run(PassContext& frame) override {
    const auto set = frame.kept("surface points", 0, [&] {
      requireRoom(frame, points, bytesOf, "surface points");
      return std::make_shared<const SurfacePointSet>(
          spreadSurfacePoints(frame.sceneDescription(), {.points = points, .neighbours = neighbours}));
    });
    const auto state =
        std::make_shared<const SurfacePointState>(stateOf(*set, frame.sceneDescription(), frame.snapshot()));
    const SurfacePointGrid grid = gridOf(*set, *state);
    std::vector<glm::vec4> positions, normals, radii;
    for (std::size_t i = 0; i < set->points.size(); ++i) {
      const SurfacePoint& point = set->points[i];
      const Material& material = frame.sceneDescription().materials[static_cast<std::size_t>(point.material)];
      positions.emplace_back(state->position[i], state->area[i]);
      normals.emplace_back(state->normal[i], static_cast<float>(point.model));
      radii.emplace_back(state->radius[i], material.exponent, material.glossy() ? 1.0f : 0.0f,
                         point.back ? 0.0f : 1.0f);
    }
    result = SurfacePoints{.position = texture(frame, positions, "positions of surface points"),
                           .normal = texture(frame, normals, "normals of surface points"),
                           .radius = texture(frame, radii, "radii of surface points"),
                           .grid = grid.placement,
                           .cells = frame.uploaded(grid.first, "cells of surface points"),
                           .candidates = frame.uploaded(grid.points, "surface points by cells"),
                           .count = static_cast<int>(set->points.size()),
                           .neighbours = neighbours,
                           .spacing = static_cast<float>(set->spacing()),
                           .farthest = static_cast<float>(set->farthest),
                           .set = set,
                           .state = state};
  }

  /// Bytes of three textures and of the grid's two buffers at their longest.
  static std::vector<std::uint64_t> bytesOf(int points) {
    const glm::ivec2 size = SurfacePoints::sizeFor(points);
    const std::uint64_t texture = sizeof(glm::vec4) * static_cast<std::uint64_t>(size.x * size.y);
    const auto count = static_cast<std::uint64_t>(points);
    return {texture, texture, texture, 4 * SurfacePointGrid::mostCells(count),
            4 * SurfacePointGrid::mostEntries(count)};
  }

  static gpu::TextureRef texture(PassContext& frame, std::vector<glm::vec4> values,
                                 const std::string& label) {
    const glm::ivec2 size = SurfacePoints::sizeFor(static_cast<int>(values.size()));
    values.resize(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y), glm::vec4(0.0f));
    gpu::TextureRef made =
        frame.texture({.format = gpu::Format::rgba32f, .width = size.x, .height = size.y}, label);
    made->upload(0, std::as_bytes(std::span(values)));
    return made;
  }
};

}  // namespace

void addPoints(TechniqueRegistry& registry) {
  registry.add<PointsPass>("points",
                           "Points spread evenly over the surfaces (Lensing & Broll 2013, Sec. 3.2)");
}

}  // namespace lumivox::virtual_area_lights
