// A vase whose wall is thinner than a voxel, to be lit from one side: such a voxel contains both sides of the
// wall.
#include <cmath>
#include <numbers>

#include "models.h"
#include "obj_model.h"

namespace lumivox::models {

// 45 cm high about the Y axis, on y = 0, with a wall 6 mm thick: an outer and an inner surface of revolution
// that meet at the rim, each with a bottom.
void writeVase(const std::filesystem::path& directory) {
  constexpr int kAround = 32, kUp = 14;
  constexpr double kHeight = 0.45, kWall = 0.006, kPi = std::numbers::pi;
  ObjModel model("vase", "A vase whose wall is 6 mm thick, 45 cm high, about the Y axis");
  model.material({.name = "clay", .diffuse = {0.68, 0.6, 0.5}});
  // Wide at the rim, so that a camera above sees the inside.
  const auto radius = [](double up) { return 0.09 + 0.06 * up + 0.02 * std::sin(2.0 * kPi * up); };
  const auto slope = [](double up) {
    return (0.06 + 0.04 * kPi * std::cos(2.0 * kPi * up)) / kHeight;  // derivative of the radius by height
  };
  const auto at = [&](bool inside, int around, int up) {
    const double angle = 2.0 * kPi * around / kAround, height = static_cast<double>(up) / kUp,
                 r = radius(height) - (inside ? kWall : 0.0),
                 y = inside ? kWall + (kHeight - kWall) * height : kHeight * height,
                 side = inside ? -1.0 : 1.0;
    return Vertex{.position = {r * std::cos(angle), y, r * std::sin(angle)},
                  .normal = side * glm::dvec3(std::cos(angle), -slope(height), std::sin(angle)),
                  .texcoord = {static_cast<double>(around) / kAround, height}};
  };
  for (const bool inside : {false, true}) {
    model.object(inside ? "inside" : "outside", "clay");
    for (int up = 0; up < kUp; ++up)
      for (int around = 0; around < kAround; ++around) {
        const Vertex a = at(inside, around, up), b = at(inside, around + 1, up),
                     c = at(inside, around + 1, up + 1), d = at(inside, around, up + 1);
        inside ? model.quad(a, b, c, d) : model.quad(a, d, c, b);
      }
    // The bottoms: the outer faces down, the inner faces up.
    for (int around = 0; around < kAround; ++around) {
      const glm::dvec3 a = at(inside, around, 0).position, b = at(inside, around + 1, 0).position,
                       middle(0.0, a.y, 0.0);
      inside ? model.flatTriangle(middle, b, a) : model.flatTriangle(middle, a, b);
    }
  }
  model.object("rim", "clay");
  for (int around = 0; around < kAround; ++around)
    model.flatQuad(at(false, around, kUp).position, at(true, around, kUp).position,
                   at(true, around + 1, kUp).position, at(false, around + 1, kUp).position);
  model.write(directory);
}

}  // namespace lumivox::models
