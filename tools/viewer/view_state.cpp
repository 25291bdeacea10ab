#include "viewer/view_state.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "lumivox/scene/free_camera.h"

namespace lumivox::viewer {
namespace {

/// Least angle to straight up or down, rad: at the pole the direction to the side is undefined.
constexpr double kNearestToPole = 0.01;

/// `direction` turned to the right about `up`, then upwards.
glm::dvec3 turnedDirection(const glm::dvec3& direction, const glm::dvec3& up, double right, double upwards) {
  const glm::dvec3 pole = glm::normalize(up);
  const double length = glm::length(direction);
  const glm::dvec3 forward(glm::rotate(glm::dmat4(1.0), -right, pole) * glm::dvec4(direction / length, 0.0));
  const double height = std::asin(std::clamp(glm::dot(forward, pole), -1.0, 1.0));
  const double limit = 0.5 * glm::pi<double>() - kNearestToPole;
  const double next = std::clamp(height + upwards, -limit, limit);
  const glm::dvec3 level = forward - glm::dot(forward, pole) * pole;
  if (glm::length(level) == 0.0) return length * forward;
  return length * (std::cos(next) * glm::normalize(level) + std::sin(next) * pole);
}

}  // namespace

const std::vector<std::string>& layoutWords() {
  static const std::vector<std::string> words{"picture",      "reference", "split",
                                              "side_by_side", "flicker",   "error"};
  return words;
}
const std::vector<std::string>& errorMapWords() {
  static const std::vector<std::string> words{"relative", "flip", "squared"};
  return words;
}
const std::vector<std::string>& curveWords() {
  static const std::vector<std::string> words{"srgb", "linear", "filmic", "false_colour"};
  return words;
}

Camera cameraOf(const ViewState& state, const Scene& scene) {
  if (state.free) return *state.free;
  return cameraAt(scene.camera(state.camera), state.time);
}

Camera moved(Camera camera, const glm::dvec3& by) {
  const glm::dvec3 forward = glm::normalize(camera.target - camera.eye);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up));
  const glm::dvec3 way = by.x * right + by.y * glm::cross(right, forward) + by.z * forward;
  camera.eye += way;
  camera.target += way;
  return camera;
}

Camera turned(Camera camera, double right, double up) {
  camera.target = camera.eye + turnedDirection(camera.target - camera.eye, camera.up, right, up);
  return camera;
}

Camera orbited(Camera camera, double right, double up) {
  // Moving the eye to the right around its target turns the view to the left.
  camera.eye = camera.target - turnedDirection(camera.target - camera.eye, camera.up, -right, -up);
  return camera;
}

Camera zoomed(Camera camera, double factor) {
  camera.eye = camera.target - (camera.target - camera.eye) * factor;
  return camera;
}

}  // namespace lumivox::viewer
