// Cells of light propagation with given contents, and the pass that propagates them.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "../../techniques/light_propagation_volumes/occluded_faces.h"
#include "support/passes.h"

namespace lumivox::test {

inline const double kY0 = 0.5 / std::sqrt(kPi), kY1 = std::sqrt(0.75 / kPi);
inline const double kFarFace =
    4.0 * std::atan(1.0 / (3.0 * std::sqrt(11.0)));                  // of a cube at distance 3/2, sr
inline const double kSideFace = (2.0 * kPi / 3.0 - kFarFace) / 4.0;  // five faces are a sixth of the sphere
/// The flux of a cell's light across a face is kAcross0 c0 + kAcross1 c1.
inline const double kAcross0 = 2.0 * kPi / 3.0 * kY0,
                    kAcross1 = (kFarFace + 8.0 / std::sqrt(5.0) * kSideFace) * kY1;

using Cells = std::vector<float>;  ///< four coefficients a cell: Y00, Y1-1, Y10, Y11

inline std::size_t at(int n, int x, int y, int z) {
  return static_cast<std::size_t>(4 * ((z * n + y) * n + x));
}

inline gpu::TextureRef volume(int n, gpu::Format format) {
  return filled(volumeOf(glm::ivec3(n), format), glm::vec4(0.0f));
}

using light_propagation_volumes::OccludedFaces;

/// A grid of light with its occluded faces.
struct LitCells : ShGrid {
  OccludedFaces faces;
};

/// A grid over [-1,1]^3 with the same light in all channels. `occluded`: for (n+1)^3 cells, the occluded
/// shares of their x, y and z faces.
inline LitCells gridOf(int n, const Cells& cells, const std::vector<float>& occluded = {}) {
  ShGrid::Level level;
  level.grid = {glm::vec3(-1.0f), 2.0f / static_cast<float>(n), glm::ivec3(n)};
  for (gpu::TextureRef& texture : level.coefficients) {
    texture = volume(n, gpu::Format::rgba32f);
    texture->uploadFloats(0, cells);
  }
  const OccludedFaces::Level faces{level.grid, volume(n + 1, gpu::Format::rgba8),
                                   volume(n + 1, gpu::Format::rgba8), nullptr};
  if (!occluded.empty()) {
    std::vector<std::byte> bytes;
    for (const float share : occluded)
      bytes.push_back(static_cast<std::byte>(static_cast<int>(share * 255.0f + 0.5f)));
    faces.occluded->upload(0, bytes);
  }
  LitCells result;
  result.levels.push_back(level);
  result.faces.levels.push_back(faces);
  return result;
}

/// A virtual light of flux 1: c0 = Y0, c1 = m Y1 along the direction.
inline void addLight(Cells& cells, int n, const glm::ivec3& cell, const glm::vec3& direction,
                     double meanCosine) {
  const std::size_t first = at(n, cell.x, cell.y, cell.z);
  cells[first] += static_cast<float>(kY0);
  cells[first + 1] += static_cast<float>(meanCosine * kY1) * direction.y;
  cells[first + 2] += static_cast<float>(meanCosine * kY1) * direction.z;
  cells[first + 3] += static_cast<float>(meanCosine * kY1) * direction.x;
}

/// The mean cosine at which no flux leaves backwards.
inline double forwardCosine() {
  return kAcross0 * kY0 / (kAcross1 * kY1);
}

inline Cells empty(int n) {
  return Cells(at(n, 0, 0, n), 0.0f);
}

inline double energy(const Cells& cells) {
  double sum = 0.0;
  for (std::size_t i = 0; i < cells.size(); i += 4) sum += cells[i] / kY0;  // integral over the sphere
  return sum;
}
inline double norm(const Cells& cells) {
  double sum = 0.0;
  for (const float value : cells) sum += static_cast<double>(value) * value;
  return std::sqrt(sum);
}

inline SceneBuilder emptyScene(float environment = 0.0f) {
  SceneBuilder builder;
  builder.look({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 0.7, 8, 8);
  builder.scene.environment = glm::vec3(environment);
  return builder;
}

/// The pass `propagate`.
class Propagation : public LonePass {
 public:
  explicit Propagation(const Scene& scene) : LonePass("light_propagation_volumes.propagate", scene) {}
  template <class Value>
  Propagation& set(const char* name, const Value& value) {
    with({{name, value}});
    return *this;
  }
  Propagation& run(const LitCells& light) { return run(light, light.faces); }
  Propagation& run(const ShGrid& light, const OccludedFaces& faces) {
    in("light", light).in("faces", faces).LonePass::run();
    return *this;
  }
  ShGrid grid(const char* port) { return out<ShGrid>(port); }
  Cells cells(const char* port) { return grid(port).levels[0].coefficients[0]->downloadFloats(0); }
};

}  // namespace lumivox::test
