// Finds the nearest disc in each direction of every point, in place of one share for all lights of a point
// (Lensing and Broll 2013, Sec. 3.3; Sec. 7 hopes for micro-rendering).
#include "../passes.h"
#include "lumivox/base/error.h"
#include "lumivox/toolkit/loop_limit.h"
#include "point_sight.h"
#include "virtual_area_lights_shaders.h"

namespace lumivox::virtual_area_lights {
namespace {

using namespace shaders::virtual_area_lights;

constexpr int kMostPoints = 65536;  ///< that the lower half of an entry numbers; all bits mean none

constexpr int kTurns = PointSight::kDirections + 8;  ///< of the loops over a disc's directions, at most

class LookPass : public Pass {
  In<SurfacePoints> points{this, "points", "which look, and the discs that they see"};
  Param<bool> occlusion{this, "occlusion", true, "off: nothing occludes"};
  Out<PointSight> sight{this, "sight", Contributes::nothing, Needs::anyLight,
                        "the nearest disc in each direction of every point"};

  bool uses(const InBase& input) const override { return occlusion || &input != &points; }

  void run(PassContext& frame) override {
    if (!occlusion) {
      sight = PointSight{};
      return;
    }
    if (points->count > kMostPoints)
      throw Error("virtual_area_lights.look: 'points' are more than 65536; expected fewer points");
    sight = PointSight{frame.kept("sight of points", points->position, [&] { return nearest(frame); })};
  }

  gpu::BufferRef nearest(PassContext& frame) const {
    const gpu::BufferRef result = frame.elements(
        look::sight,
        static_cast<std::uint64_t>(PointSight::kDirections) * static_cast<std::uint64_t>(points->count),
        "sight of points");
    if (points->count == 0) return result;
    forEachPortion(points->count, kTurns, [&](int first, int count) {
      frame.dispatchList(
          frame.program(look::kProgram),
          {look::parameters({first, count, first == 0}), SurfacePointsBinding(*points), look::sight(result)},
          static_cast<std::uint64_t>(points->count));
    });
    return result;
  }
};

}  // namespace

void addLook(TechniqueRegistry& registry) {
  registry.add<LookPass>(
      "look", "The nearest disc in each direction of every point, for lights one by one and the sky");
}

}  // namespace lumivox::virtual_area_lights
