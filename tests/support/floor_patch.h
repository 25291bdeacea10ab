// The mean over a patch of a floor from any camera, and cameras that turn.
#pragma once

#include <algorithm>
#include <cmath>

#include "lumivox/base/image.h"
#include "lumivox/pipeline/ports.h"
#include "lumivox/scene/scene.h"

namespace lumivox::test {

/// A square on the floor in world space, m: its centre and half of its side.
struct FloorSquare {
  glm::dvec3 centre;
  float half;
};

struct Patch {
  double mean = 0.0;
  int pixels = 0;
};

/// The mean of one channel over a square of a floor. A pixel's weight is the floor area that it sees times a
/// tent that falls to 0 at the square's border, so that the mean does not depend on the view.
inline Patch patchOf(const GBuffer& gbuffer, const SceneSnapshot& snapshot, const ImageBuffer& image,
                     const FloorSquare& square, int channel = 0) {
  const std::vector<float> places = gbuffer.position->downloadFloats(0),
                           normals = gbuffer.normal->downloadFloats(0);
  const glm::vec3 centre = glm::vec3(square.centre - snapshot.origin);
  const CameraView& camera = snapshot.camera;
  Patch patch;
  double weights = 0.0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const auto i = static_cast<std::size_t>(4 * (y * image.width() + x));
      const glm::vec3 place(places[i], places[i + 1], places[i + 2]), off = glm::abs(place - centre);
      if (places[i + 3] == 0.0f || normals[i + 1] < 0.9f || off.y > 0.01f ||
          std::max(off.x, off.z) >= square.half)
        continue;
      // The floor area that a pixel sees is its solid angle (proportional to the cubed cosine to the view
      // axis) times the squared distance, divided by the cosine to the floor. It is multiplied by the tent.
      const glm::vec3 way = place - camera.eye;
      const double depth = glm::dot(way, camera.forward), weight = depth * depth * depth / -way.y *
                                                                   (1.0 - off.x / square.half) *
                                                                   (1.0 - off.z / square.half);
      patch.mean += weight * image.at(x, y, channel);
      weights += weight;
      ++patch.pixels;
    }
  patch.mean /= weights;
  return patch;
}

/// Turns the first camera about the vertical.
inline void turnCamera(Scene& scene, double degrees) {
  Camera& camera = scene.cameras.front();
  const glm::dvec3 way = camera.target - camera.eye;
  const double turn = glm::radians(degrees);
  camera.target = camera.eye + glm::dvec3(std::cos(turn) * way.x + std::sin(turn) * way.z, way.y,
                                          std::cos(turn) * way.z - std::sin(turn) * way.x);
}

}  // namespace lumivox::test
