// Voxelizes random points on the triangles (Mavridis & Papaioannou 2011, Sec. 3.1).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "aside.h"
#include "voxelizer.h"

namespace lumivox::voxelization {

using namespace shaders::voxelization;

namespace {

class PointsPass : public Voxelizer {
  enum class Spread { random, regular };
  // The paper's figures are made with 19 points; it finds 12 to 19 nearly perfect in most scenes.
  Param<int> points{this, "points", 19, within(1, 65536), "random points on each triangle"};
  Param<bool> adaptive{this, "adaptive", false,
                       "number of points in proportion to the triangle's area; `points` is ignored"};
  // A voxel that a plane crosses squarely is missed with probability e^-8 = 3 in 10000.
  Param<float> density{this, "density", 8.0f, within(0.001f, 1000.0f),
                       "with 'adaptive': points per squared voxel size of area"};

  Param<Spread> spread{
      this, "spread", Spread::random,
      "random: random points; regular: centres of equal parts of the triangle, their number rounded up to a square"};

  // Most points of one triangle; a grid around a camera may see a small part of a huge one.
  static constexpr int kMostPoints = 1 << 24;

  std::uint64_t expectedFragments(const Scene& scene, const GridPlacement& grid) const override {
    if (adaptive) return expectedOfArea(scene, static_cast<double>(grid.voxelSize));
    const auto each = static_cast<std::uint64_t>(points);
    std::uint64_t side = 1;
    while (side * side < each) ++side;
    return scene.triangleCount() * (spread == Spread::regular ? side * side : each);
  }

  /// The points that the scene's triangles ask for, or those that a grid over a small part of it may hold.
  std::uint64_t expectedOfArea(const Scene& scene, double voxelSize) const {
    double all = 0.0;
    forEachArea(scene, [&](double area) {
      const double asked = std::ceil(static_cast<double>(density) * area / (voxelSize * voxelSize));
      all += std::clamp(asked, 1.0, double{kMostPoints});
    });
    // An extra 1/64 for squares and for areas that the device rounds differently.
    all *= spread == Spread::regular ? 1.5 : 1.0 + 1.0 / 64.0;
    // Surfaces fill about twice as many voxels as the grid's six sides.
    const double held = 12.0 * resolution * resolution * static_cast<double>(density) +
                        static_cast<double>(scene.triangleCount());
    return static_cast<std::uint64_t>(around == Around::scene ? all : std::min(all, held));
  }

  /// Calls `work` with the area of every triangle of the scene at rest, m^2.
  template <class Work>
  static void forEachArea(const Scene& scene, const Work& work) {
    for (const Object& object : scene.objects) {
      const glm::dmat3 linear(object.placement);
      for (const lumivox::Part& part : object.parts)
        for (std::uint32_t i = part.firstIndex; i < part.firstIndex + part.indexCount; i += 3) {
          const auto corner = [&](std::uint32_t k) {
            return glm::dvec3(scene.positions[scene.indices[i + k]]);
          };
          work(0.5 *
               glm::length(glm::cross(linear * (corner(1) - corner(0)), linear * (corner(2) - corner(0)))));
        }
    }
  }

  void warnOfHoles(PassContext& frame, float voxelSize) {
    if (!adaptive) return;
    if (!largestTriangle_) {
      double& largest = largestTriangle_.emplace(0.0);
      forEachArea(frame.sceneDescription(), [&](double area) { largest = std::max(largest, area); });
    }
    const double asked =
        static_cast<double>(density) * *largestTriangle_ / (double{voxelSize} * double{voxelSize});
    if (asked > kMostPoints)
      frame.warn(
          fmt::format("a triangle of {:.3g} m^2 asks for {:.3g} points and gets {}: its voxels have holes",
                      *largestTriangle_, asked, kMostPoints));
  }

  void append(PassContext& frame, const VoxelFragments& list, const Draws& draws) override {
    warnOfHoles(frame, list.grid.voxelSize);
    std::uint32_t mostTriangles = 0;
    for (const SceneDraw* draw : draws) mostTriangles = std::max(mostTriangles, draw->indexCount / 3);
    const Aside aside(frame, mostTriangles);
    for (const SceneDraw* draw : draws) {
      const SceneBinding scene(frame, *draw);
      const std::uint32_t triangles = draw->indexCount / 3;
      aside.dispatch(
          frame, scene.in(points::Variant{}), points::Constants{.regular = spread == Spread::regular},
          {scene, appending(list),
           points::points({static_cast<int>(draw->firstIndex / 3), static_cast<int>(triangles), points,
                           adaptive ? density + 0.0f : 0.0f, seedWords(frame), kMostPoints})},
          triangles);
    }
  }

  std::optional<double> largestTriangle_;  ///< m^2, once it was needed
};

}  // namespace

void addPoints(TechniqueRegistry& registry) {
  registry.add<PointsPass>("points", "Random points on each triangle (Mavridis & Papaioannou 2011)");
}

}  // namespace lumivox::voxelization
