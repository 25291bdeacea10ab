#include "stress/scene_pieces.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "lumivox/base/error.h"

namespace lumivox::stress {
namespace {

/// Boxes remain boxes under rotations that map axes to axes.
bool mapsAxesToAxes(const glm::dmat3& rotation) {
  constexpr double kRounding = 1e-9;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) {
      const double size = std::abs(rotation[column][row]);
      if (size > kRounding && std::abs(size - 1.0) > kRounding) return false;
    }
  return true;
}

bool keepsUp(const glm::dmat3& rotation) {
  return glm::length(rotation * glm::dvec3(0, 1, 0) - glm::dvec3(0, 1, 0)) < 1e-9;
}

class Mover {
 public:
  explicit Mover(const Similarity& by) : by_(by) {}

  glm::dvec3 point(const glm::dvec3& p) const { return by_.scale * (by_.rotation * p) + by_.translation; }
  glm::dvec3 direction(const glm::dvec3& d) const { return by_.rotation * d; }
  glm::dvec3 path(const glm::dvec3& p) const { return by_.scale * (by_.rotation * p); }

  void move(Object& object) const {
    glm::dmat4 matrix(by_.scale * by_.rotation);
    matrix[3] = glm::dvec4(by_.translation, 1.0);
    object.placement = matrix * object.placement;
    object.placedBounds.reset();
    object.sweptBounds.reset();
    if (object.motion) move(*object.motion);
  }

  void move(RigidMotion& motion) const {
    motion.axis = direction(motion.axis);
    motion.pivot = point(motion.pivot);
    motion.velocity = path(motion.velocity);
  }

  void move(Light& light) const {
    light.position = point(light.position);
    light.direction = direction(light.direction);
    // Radiance is intensity over squared distance; irradiance of a parallel light knows no distance.
    const float power =
        light.kind == LightKind::directional ? 1.0f : static_cast<float>(by_.scale * by_.scale);
    light.power *= power;
    if (!light.motion) return;
    if (light.motion->rigid) move(*light.motion->rigid);
    for (LightKey& key : light.motion->keys) {
      if (key.position) key.position = point(*key.position);
      if (key.direction) key.direction = direction(*key.direction);
      if (key.power) *key.power *= power;
    }
  }

  void move(Camera& camera) const {
    camera.eye = point(camera.eye);
    camera.target = point(camera.target);
    camera.up = direction(camera.up);
    for (CameraKey& key : camera.keys) {
      key.eye = point(key.eye);
      key.target = point(key.target);
    }
    if (camera.motion) move(*camera.motion);
  }

  void move(Medium& medium) const {
    if ((medium.box || medium.volume) && !mapsAxesToAxes(by_.rotation))
      throw Error("a medium in a box or volume cannot be turned by other than quarter turns");
    if (medium.volume && by_.rotation != glm::dmat3(1.0))
      throw Error("a volume of densities cannot be turned");
    if (medium.particles > 0 && !keepsUp(by_.rotation))
      throw Error("particles rise along Y: their medium can only be turned about Y");
    medium.extinction /= static_cast<float>(by_.scale);
    if (medium.box) {
      const glm::dvec3 a = point(medium.box->first), b = point(medium.box->second);
      medium.box = {glm::min(a, b), glm::max(a, b)};
    }
    medium.source = point(medium.source);
    for (double* length : {&medium.spread, &medium.radius, &medium.rise, &medium.drift}) *length *= by_.scale;
    if (!medium.volume) return;
    auto volume = std::make_shared<DensityVolume>(*medium.volume);
    volume->low = point(volume->low);
    volume->voxelSize *= by_.scale;
    medium.volume = std::move(volume);
  }

 private:
  Similarity by_;
};

}  // namespace

glm::dmat3 turnAboutY(double angle) {
  return glm::dmat3(glm::rotate(glm::dmat4(1.0), angle, glm::dvec3(0, 1, 0)));
}

Scene moved(const Scene& scene, const Similarity& by) {
  const Mover mover(by);
  Scene result = scene;
  result.hash = {};  // no longer the hash of a text
  for (Object& object : result.objects) mover.move(object);
  for (Light& light : result.lights) mover.move(light);
  for (Camera& camera : result.cameras) mover.move(camera);
  for (Medium& medium : result.media) mover.move(medium);
  if (scene.environmentMap) {
    auto map = std::make_shared<EnvironmentMap>(*scene.environmentMap);
    map->toMap = map->toMap * glm::mat3(glm::transpose(by.rotation));
    map->finish();
    result.environmentMap = std::move(map);
  }
  return result;
}

Scene brighter(const Scene& scene, float factor) {
  Scene result = scene;
  result.hash = {};
  for (Light& light : result.lights) {
    light.power *= factor;
    if (!light.motion) continue;
    for (LightKey& key : light.motion->keys)
      if (key.power) *key.power *= factor;
  }
  for (Material& material : result.materials) material.emission *= factor;
  result.environment *= factor;
  if (scene.environmentMap) {
    auto map = std::make_shared<EnvironmentMap>(*scene.environmentMap);
    for (glm::vec3& radiance : map->radiance) radiance *= factor;
    map->finish();
    result.environmentMap = std::move(map);
  }
  return result;
}

Scene doubled(const Scene& scene) {
  Scene result = scene;
  result.hash = {};
  for (const Object& object : scene.objects) {
    const bool shines = std::any_of(object.parts.begin(), object.parts.end(), [&](const Part& part) {
      return scene.materials[static_cast<std::size_t>(part.material)].emissive();
    });
    if (!shines) result.objects.push_back(object);
  }
  return result;
}

std::vector<glm::vec3> gridOfTriangles(const glm::vec3& corner, const glm::vec3& edge1,
                                       const glm::vec3& edge2, int columns, int rows) {
  std::vector<glm::vec3> corners;
  corners.reserve(6 * static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  const auto at = [&](int column, int row) {
    return corner + edge1 * (static_cast<float>(column) / static_cast<float>(columns)) +
           edge2 * (static_cast<float>(row) / static_cast<float>(rows));
  };
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}})
        corners.push_back(at(column + x, row + y));
  return corners;
}

SceneBuilder closedRoom(float albedo) {
  SceneBuilder builder;
  builder.box({0, 0, 0}, {1, 1, 1}, builder.lambert(albedo), true);
  builder.light(LightKind::point, glm::vec3(1.0f), {0.45, 0.6, 0.55});
  builder.look({0.85, 0.8, 0.9}, {0.2, 0.2, 0.15}, {0, 1, 0}, 1.0, 64, 64);
  return builder;
}

Scene roomInBounds(const WallRoom& room) {
  constexpr float kHalf = 0.75f, kSpeck = 1e-3f;
  Similarity by;
  by.scale = room.size;
  by.translation = room.low;
  SceneBuilder builder;
  builder.scene = moved(closedRoom(0.7f).scene, by);
  for (const float end : {-1.0f, 1.0f}) {
    const float corner = end * kHalf, beside = end * (kHalf - kSpeck);
    builder.mesh({{corner, corner, corner}, {corner, corner, beside}, {corner, beside, corner}}, 0);
  }
  return builder.scene;
}

Scene tunnel() {
  SceneBuilder builder;
  builder.box({0, 0, 0}, {1, 1, 15}, builder.lambert(0.7f), true);
  for (const double z : {2.5, 7.5, 12.5}) builder.light(LightKind::point, glm::vec3(1.0f), {0.4, 0.8, z});
  builder.look({0.6, 0.5, 0.4}, {0.5, 0.45, 15.0}, {0, 1, 0}, 1.0, 64, 64);
  return builder.scene;
}

Scene twoRooms(float wall) {
  SceneBuilder builder;
  const int white = builder.lambert(0.7f);
  const float half = 0.5f * wall;
  // One sheet belongs to both rooms and faces the lit one.
  builder.box({-1.0f - half, 0, 0}, {-half, 1, 1}, white, true);
  if (wall > 0.0f) {
    builder.box({half, 0, 0}, {1.0f + half, 1, 1}, white, true);
  } else {
    for (const auto& [corner, edge1, edge2] :
         {std::tuple{glm::vec3(0, 0, 0), glm::vec3(0, 0, 1), glm::vec3(1, 0, 0)},
          {glm::vec3(0, 1, 0), glm::vec3(1, 0, 0), glm::vec3(0, 0, 1)},
          {glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)},
          {glm::vec3(0, 0, 1), glm::vec3(0, 1, 0), glm::vec3(1, 0, 0)},
          {glm::vec3(1, 0, 0), glm::vec3(0, 0, 1), glm::vec3(0, 1, 0)}})
      builder.quad(corner, edge1, edge2, white);
  }
  builder.light(LightKind::point, glm::vec3(1.0f), {-0.5 - half, 0.6, 0.5});
  // Each looks at the wall between the rooms and the floor before it.
  Camera dark = builder.look({0.9 + half, 0.7, 0.85}, {half, 0.3, 0.35}, {0, 1, 0}, 1.0, 64, 64), lit = dark;
  dark.name = "dark";
  lit.name = "lit";
  lit.eye.x = -lit.eye.x;
  lit.target.x = -lit.target.x;
  builder.scene.cameras = {lit, dark};
  return builder.scene;
}

SceneBuilder openFloor() {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f), white = builder.lambert(0.8f);
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, grey);
  builder.box({-0.25f, 0.0f, -0.25f}, {0.25f, 0.5f, 0.25f}, white, false);
  builder.look({0.9, 1.4, 1.9}, {0.0, 0.15, 0.0}, {0, 1, 0}, 0.8, 64, 64);
  return builder;
}

Scene glowingSpeck(int cells) {
  SceneBuilder builder;
  const int black = builder.lambert(0.0f), grey = builder.lambert(0.5f);
  builder.box({0, 0, 0}, {1, 1, 1}, grey, true);
  for (Part& part : builder.scene.objects[2].parts) part.material = black;  // the floor
  // Smaller than a voxel, and off the middle, where grids of even resolutions have a face.
  const glm::vec3 corner(0.505f, 0.505f, 0.505f);
  builder.mesh(gridOfTriangles(corner, {0, 0, 0.004f}, {0.004f, 0, 0}, cells, cells), grey);
  Light& spot = builder.light(LightKind::spot, glm::vec3(1000.0f), {0.507, 0.8, 0.507});
  spot.innerAngle = glm::radians(4.0f);
  spot.outerAngle = glm::radians(5.0f);
  builder.look({0.2, 0.15, 0.2}, {0.8, 0.85, 0.8}, {0, 1, 0}, 1.2, 64, 64);
  return builder.scene;
}

}  // namespace lumivox::stress
