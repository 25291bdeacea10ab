// A cloth that deforms from frame to frame, for tests of deformation without any other model.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "models.h"
#include "obj_model.h"

namespace lumivox::models {

// A cloth of 1 m x 1 m that hangs from its upper edge, y = 0, and waves: its points move along z by a wave
// that runs down and grows towards the free edge. Eight frames are one period.
void writeWavingCloth(const std::filesystem::path& directory) {
  constexpr int kFrames = 8, kSide = 16;  // quads along both sides
  constexpr double kAmplitude = 0.15, kWaves = 1.5, kSlant = 0.3, kPi = std::numbers::pi;
  for (int frame = 0; frame < kFrames; ++frame) {
    const double phase = 2.0 * kPi * frame / kFrames;
    const auto at = [&](int i, int j) {
      const double across = static_cast<double>(i) / kSide, down = static_cast<double>(j) / kSide;
      const double angle = 2.0 * kPi * kWaves * (down + kSlant * across) - phase;
      return Vertex{.position = {across - 0.5, -down, kAmplitude * down * std::sin(angle)},
                    .texcoord = {across, 1.0 - down}};
    };
    ObjModel model(fmt::format("waving_cloth_{:02}", frame),
                   fmt::format("A waving cloth, frame {} of {}", frame + 1, kFrames));
    model.material({.name = "cloth", .diffuse = {0.65, 0.2, 0.1}});
    model.writesNormals = false;
    model.object("cloth", "cloth");
    for (int j = 0; j < kSide; ++j)
      for (int i = 0; i < kSide; ++i) model.quad(at(i, j + 1), at(i + 1, j + 1), at(i + 1, j), at(i, j));
    model.write(directory);
  }
}

}  // namespace lumivox::models
