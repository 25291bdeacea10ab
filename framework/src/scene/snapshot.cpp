// A scene at one time.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <span>

#include "lumivox/base/error.h"
#include "lumivox/scene/free_camera.h"
#include "lumivox/scene/model_animation.h"
#include "lumivox/scene/scene.h"
#include "scene/motion.h"

namespace lumivox {
namespace {

/// Bounds in double precision, in world space.
struct WideBounds {
  glm::dvec3 low{std::numeric_limits<double>::max()}, high{std::numeric_limits<double>::lowest()};
  bool empty() const { return low.x > high.x; }
  void grow(const glm::dvec3& point) {
    low = glm::min(low, point);
    high = glm::max(high, point);
  }
};

/// A SIMD vector of four floats (an extension of GCC and Clang).
using Four = float __attribute__((vector_size(16)));

/// Smallest and largest coordinates of points, in four lanes: four points are processed at once.
struct BlockBounds {
  std::array<float, 12> low, high;

  explicit BlockBounds(std::span<const glm::vec3> points) {
    static_assert(sizeof(glm::vec3) == 3 * sizeof(float) && sizeof(Four) == 4 * sizeof(float));
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    constexpr Four kMost{kInfinity, kInfinity, kInfinity, kInfinity};
    Four low0 = kMost, low1 = kMost, low2 = kMost, high0 = -kMost, high1 = -kMost, high2 = -kMost;
    const float* value = &points.front().x;
    const std::size_t whole = points.size() / 4 * 4;
    for (std::size_t i = 0; i < whole; i += 4, value += 12) {
      Four a, b, c;  // four points: x y z x, y z x y, z x y z
      std::memcpy(&a, value, sizeof(Four));
      std::memcpy(&b, value + 4, sizeof(Four));
      std::memcpy(&c, value + 8, sizeof(Four));
      low0 = a < low0 ? a : low0;
      low1 = b < low1 ? b : low1;
      low2 = c < low2 ? c : low2;
      high0 = a > high0 ? a : high0;
      high1 = b > high1 ? b : high1;
      high2 = c > high2 ? c : high2;
    }
    const std::array<Four, 3> lows{low0, low1, low2}, highs{high0, high1, high2};
    std::memcpy(low.data(), lows.data(), sizeof(low));
    std::memcpy(high.data(), highs.data(), sizeof(high));
    for (std::size_t i = 3 * whole; i < 3 * points.size(); ++i, ++value) {
      low[i % 3] = std::min(low[i % 3], *value);
      high[i % 3] = std::max(high[i % 3], *value);
    }
  }
  double lowest(std::size_t axis) const {
    return std::min({low[axis], low[axis + 3], low[axis + 6], low[axis + 9]});
  }
  double highest(std::size_t axis) const {
    return std::max({high[axis], high[axis + 3], high[axis + 6], high[axis + 9]});
  }

  /// Whether all transformed points of the block lie within `bounds` for certain, rounding included.
  bool within(const WideBounds& bounds, const glm::dmat4& toWorld) const {
    if (bounds.empty()) return false;
    // A point's coordinate is a sum of four products: less than eight roundings of their absolute values.
    constexpr double kRounding = 8.0 * std::numeric_limits<double>::epsilon();
    for (int row = 0; row < 3; ++row) {
      double least = toWorld[3][row], most = toWorld[3][row], size = std::abs(toWorld[3][row]);
      for (int column = 0; column < 3; ++column) {
        const auto axis = static_cast<std::size_t>(column);
        const double a = toWorld[column][row] * lowest(axis), b = toWorld[column][row] * highest(axis);
        least += std::min(a, b);
        most += std::max(a, b);
        size += std::max(std::abs(a), std::abs(b));
      }
      if (!(least - kRounding * size >= bounds.low[row] && most + kRounding * size <= bounds.high[row]))
        return false;
    }
    return true;
  }
};

/// Grows the bounds by the transformed points; it runs every frame for moving objects. Blocks whose box lies
/// inside the present bounds are skipped, which does not change a bit of the result.
void grow(WideBounds& bounds, const glm::dmat4& toWorld, std::span<const glm::vec3> points) {
  constexpr std::size_t kBlock = 256;
  const auto growByBlock = [&](std::size_t first) {
    const std::span<const glm::vec3> block = points.subspan(first, std::min(kBlock, points.size() - first));
    if (BlockBounds(block).within(bounds, toWorld)) return;
    for (const glm::vec3& point : block)
      bounds.grow(glm::dvec3(toWorld * glm::dvec4(glm::dvec3(point), 1.0)));
  };
  // Starts with blocks from all over the object: if vertices are sorted, each block would otherwise lie
  // beyond the last.
  for (std::size_t first = 0; first < points.size(); first += 16 * kBlock) growByBlock(first);
  for (std::size_t first = 0; first < points.size(); first += kBlock) growByBlock(first);
}

std::span<const glm::vec3> verticesOf(const Scene& scene, const Object& object) {
  return std::span(scene.positions).subspan(object.firstVertex, object.vertexCount);
}

/// The bounds of an object that neither moves nor deforms, or of one before its motion.
WideBounds placedBounds(const Scene& scene, const Object& object) {
  WideBounds bounds;
  if (object.parts.empty()) return bounds;
  if (object.placedBounds) {
    bounds.low = object.placedBounds->first;
    bounds.high = object.placedBounds->second;
  } else {
    grow(bounds, object.placement, verticesOf(scene, object));
  }
  return bounds;
}

/// Grows the bounds by the circle of a vertex in a whole turn about a line.
void growByTurn(WideBounds& bounds, const RigidMotion& motion, const glm::dvec3& point) {
  const glm::dvec3 axis = glm::normalize(motion.axis);
  const glm::dvec3 arm = point - motion.pivot;
  const glm::dvec3 centre = motion.pivot + axis * glm::dot(axis, arm);
  const double radius = glm::length(point - centre);
  const glm::dvec3 reach = radius * glm::sqrt(glm::max(1.0 - axis * axis, glm::dvec3(0.0)));
  bounds.grow(centre - reach);
  bounds.grow(centre + reach);
}

/// The corners of the box around points in object space: their transforms bound those of the points.
std::array<glm::vec3, 8> boxCornersOf(std::span<const glm::vec3> points) {
  const BlockBounds box(points);
  std::array<glm::vec3, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      corners[i][static_cast<int>(axis)] =
          static_cast<float>((i >> axis & 1) != 0 ? box.highest(axis) : box.lowest(axis));
  }
  return corners;
}

/// Grid bounds follow travelling objects in steps of 1/8 of the scene's longest side at rest, so that grids
/// move rarely.
constexpr double kTravelStep = 1.0 / 8.0;

Bounds gridBounds(const Scene& scene, double time, const glm::dvec3& origin) {
  WideBounds rest, now;
  for (const Object& object : scene.objects) {
    if (object.parts.empty()) continue;
    const auto [low, high] = object.sweptBounds ? *object.sweptBounds : sweptBoundsOf(scene, object);
    rest.grow(low);
    rest.grow(high);
    const glm::dvec3 travelled = object.motion ? object.motion->velocity * time : glm::dvec3(0.0);
    now.grow(low + travelled);
    now.grow(high + travelled);
  }
  Bounds bounds;
  if (rest.empty()) return bounds;
  const glm::dvec3 extent = rest.high - rest.low;
  const double step = kTravelStep * std::max({extent.x, extent.y, extent.z});
  glm::dvec3 low = rest.low, high = rest.high;
  for (int axis = 0; axis < 3 && step > 0.0; ++axis) {
    low[axis] -= step * std::ceil(std::max(rest.low[axis] - now.low[axis], 0.0) / step);
    high[axis] += step * std::ceil(std::max(now.high[axis] - rest.high[axis], 0.0) / step);
  }
  bounds.grow(glm::vec3(low - origin));
  bounds.grow(glm::vec3(high - origin));
  return bounds;
}

/// The inverse transpose. Of what is flattened, as by an animated scale of 0, it is the cofactor matrix,
/// which turns normals the same way and stays finite.
glm::dmat3 normalMatrixOf(const glm::dmat3& toWorld) {
  if (glm::determinant(toWorld) != 0.0) return glm::transpose(glm::inverse(toWorld));
  return {glm::cross(toWorld[1], toWorld[2]), glm::cross(toWorld[2], toWorld[0]),
          glm::cross(toWorld[0], toWorld[1])};
}

/// The motion of a model file, or the placement; then that of `animate`.
glm::dmat4 motionAt(const Object& object, double time) {
  const glm::dmat4 placement = object.animation ? object.animation->placementAt(time) : object.placement;
  return object.motion ? rigidMotionAt(*object.motion, time) * placement : placement;
}

/// The vertices of a deforming object: linear between the two frames around the time.
void deform(const VertexSequence& sequence, double time, ObjectState& state) {
  const auto count = static_cast<double>(sequence.positions.size());
  assert(count > 0);
  double frame = time * sequence.framesPerSecond;
  if (sequence.loop) {
    frame = std::fmod(frame, count);
    if (frame < 0) frame += count;
  } else {
    frame = std::clamp(frame, 0.0, count - 1.0);
  }
  const auto before = std::min(static_cast<std::size_t>(frame), sequence.positions.size() - 1);
  const std::size_t after = sequence.loop ? (before + 1) % sequence.positions.size()
                                          : std::min(before + 1, sequence.positions.size() - 1);
  const auto weight = static_cast<float>(frame - static_cast<double>(before));
  const std::vector<glm::vec3>&positions0 = sequence.positions[before],
        &positions1 = sequence.positions[after];
  const std::vector<glm::vec3>&normals0 = sequence.normals[before], &normals1 = sequence.normals[after];
  state.positions.resize(positions0.size());
  state.normals.resize(positions0.size());
  for (std::size_t v = 0; v < positions0.size(); ++v) {
    state.positions[v] = glm::mix(positions0[v], positions1[v], weight);
    const glm::vec3 normal = glm::mix(normals0[v], normals1[v], weight);
    const float length = glm::length(normal);
    state.normals[v] = length > 1e-6f ? normal / length : normals0[v];  // opposite normals have no mean
  }
}

/// What the capture's camera sees about its optical axis, with the height of its rows.
CameraView viewOf(const Capture& capture, const CaptureState& state, int width, int height) {
  CameraView view;
  view.eye = state.eye;
  view.right = state.toWorld[0];
  view.up = -state.toWorld[1];
  view.forward = state.toWorld[2];
  view.tanHalfFov = static_cast<float>(0.5 * capture.camera.height / capture.camera.focal.y);
  view.width = width;
  view.height = height;
  return view;
}

CameraView viewOf(const Camera& moving, double time, const glm::dvec3& origin, int width, int height) {
  const Camera camera = cameraAt(moving, time);
  const glm::dvec3 &eye = camera.eye, &target = camera.target;
  // The text's check covers the keys only, not the views between them.
  if (eye == target)
    throw Error(fmt::format("camera '{}': eye and target are the same point at {} s; expected two points",
                            camera.name, time));
  const glm::dvec3 forward = glm::normalize(target - eye);
  const glm::dvec3 sideways = glm::cross(forward, camera.up);
  if (glm::length(sideways) == 0.0)
    throw Error(fmt::format("camera '{}' looks along 'up' at {} s; expected another up direction",
                            camera.name, time));
  const glm::dvec3 right = glm::normalize(sideways);
  CameraView view;
  view.eye = glm::vec3(eye - origin);
  view.forward = glm::vec3(forward);
  view.right = glm::vec3(right);
  view.up = glm::vec3(glm::cross(right, forward));
  view.tanHalfFov = static_cast<float>(std::tan(0.5 * camera.fov));
  view.aperture = static_cast<float>(camera.aperture);
  view.focus = static_cast<float>(camera.focus);
  view.width = width;
  view.height = height;
  return view;
}

}  // namespace

double ambientOcclusionDistance(const Bounds& bounds) {
  return bounds.empty ? 0.0 : 0.1 * glm::length(bounds.high - bounds.low);
}

std::pair<glm::dvec3, glm::dvec3> sweptBoundsOf(const Scene& scene, const Object& object) {
  if (!object.animated()) {
    const WideBounds placed = placedBounds(scene, object);
    return {placed.low, placed.high};
  }
  WideBounds bounds;
  glm::dmat4 placement = object.placement;
  const auto add = [&](const glm::vec3& position) {
    const glm::dvec3 placed(placement * glm::dvec4(glm::dvec3(position), 1.0));
    if (object.motion && object.motion->angularSpeed != 0.0) {
      growByTurn(bounds, *object.motion, placed);
    } else {
      bounds.grow(placed);
    }
  };
  const std::span<const glm::vec3> vertices = verticesOf(scene, object);
  if (object.animation) {
    std::vector<glm::vec3> positions(vertices.begin(), vertices.end()), normals;
    for (const double time : object.animation->sampleTimes()) {
      placement = object.animation->placementAt(time);
      if (object.animation->deforms()) object.animation->deform(time, positions, normals);
      for (const glm::vec3& corner : boxCornersOf(positions)) add(corner);
    }
  } else if (object.sequence) {
    for (const std::vector<glm::vec3>& frame : object.sequence->positions) {
      for (const glm::vec3& position : frame) add(position);
    }
  } else {
    for (const glm::vec3& position : vertices) add(position);
  }
  assert(!bounds.empty());
  // Between two samples an arc of at most 22.5 degrees leaves the box by 2 % of its radius.
  constexpr double kBetweenSamples = 0.02;
  const glm::dvec3 margin(object.animation ? kBetweenSamples * glm::length(bounds.high - bounds.low) : 0.0);
  return {bounds.low - margin, bounds.high + margin};
}

const Camera& Scene::camera(const std::string& wanted) const {
  if (cameras.empty()) throw Error(fmt::format("scene '{}' has no camera; expected one", name));
  if (wanted.empty()) return cameras.front();
  std::vector<std::string> names;
  for (const Camera& one : cameras) {
    if (one.name == wanted) return one;
    names.push_back(one.name);
  }
  const std::string nearest = nearestWord(wanted, names);
  throw Error(fmt::format("scene '{}' has no camera '{}'; expected one of {}{}", name, wanted,
                          fmt::join(names, ", "),
                          nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
}

SceneTraits SceneTraits::of(const Scene& scene) {
  SceneTraits traits;
  for (const Object& object : scene.objects) {
    bool emissive = false;
    for (const Part& part : object.parts) {
      if (part.indexCount == 0) continue;
      const Material& material = scene.materials.at(static_cast<std::size_t>(part.material));
      traits.triangles = true;
      traits.textures = traits.textures || material.diffuseTexture >= 0;
      traits.masks = traits.masks || material.maskTexture >= 0;
      traits.glossy = traits.glossy || material.glossy();
      emissive = emissive || material.emissive();
    }
    traits.movingGeometry = traits.movingGeometry || (object.animated() && !object.parts.empty());
    traits.areaLights += emissive ? 1 : 0;
  }
  traits.emission = traits.areaLights > 0;
  traits.environment = scene.environment != glm::vec3(0.0f);
  traits.environmentMap = traits.environment && scene.environmentMap != nullptr;
  traits.medium = !scene.media.empty();
  traits.particles = std::any_of(scene.media.begin(), scene.media.end(),
                                 [](const Medium& made) { return made.particles > 0; });
  const auto moves = [](const std::shared_ptr<const Capture>& capture) { return capture->frames.size() > 1; };
  traits.captures = !scene.captures.empty();
  traits.movingCaptures = std::any_of(scene.captures.begin(), scene.captures.end(), moves);
  traits.movingCamera = std::any_of(scene.cameras.begin(), scene.cameras.end(), [&](const Camera& camera) {
    return camera.capture >= 0 ? moves(scene.captures.at(static_cast<std::size_t>(camera.capture)))
                               : camera.keys.size() > 1 || camera.motion;
  });
  for (const Light& light : scene.lights) {
    if (light.power == glm::vec3(0.0f) && !light.motion) continue;
    traits.movingLights = traits.movingLights || light.motion;
    traits.directionalLights += light.kind == LightKind::directional ? 1 : 0;
    traits.pointLights += light.kind == LightKind::point ? 1 : 0;
    traits.spotLights += light.kind == LightKind::spot ? 1 : 0;
  }
  return traits;
}

SceneTraits SceneTraits::everything() {
  SceneTraits traits;
  traits.triangles = traits.textures = traits.masks = traits.glossy = traits.emission = traits.environment =
      traits.environmentMap = traits.medium = traits.particles = traits.captures = true;
  traits.movingGeometry = traits.movingCamera = traits.movingCaptures = traits.movingLights = true;
  traits.directionalLights = traits.pointLights = traits.spotLights = traits.areaLights = 1;
  return traits;
}

glm::vec3 CameraView::direction(float x, float y) const {
  const auto w = static_cast<float>(width), h = static_cast<float>(height);
  const float horizontal = (2.0f * (x + shift.x) / w - 1.0f) * tanHalfFov * w / h;
  const float vertical = (1.0f - 2.0f * (y + shift.y) / h) * tanHalfFov;
  return forward + horizontal * right + vertical * up;
}

void Bounds::grow(const glm::vec3& point) {
  low = empty ? point : glm::min(low, point);
  high = empty ? point : glm::max(high, point);
  empty = false;
}

SceneSnapshot snapshotOf(const Scene& scene, double time, const std::string& camera, int width, int height) {
  return snapshotFrom(scene, time, scene.camera(camera), width, height);
}

SceneSnapshot snapshotFrom(const Scene& scene, double time, const Camera& camera, int width, int height) {
  SceneSnapshot snapshot;
  snapshot.time = time;
  // A scene may have only moving objects: then their positions at rest give the origin.
  WideBounds still, all;
  for (const Object& object : scene.objects) {
    const WideBounds placed = placedBounds(scene, object);
    if (placed.empty()) continue;
    WideBounds& kind = object.animated() ? all : still;
    kind.grow(placed.low);
    kind.grow(placed.high);
  }
  const WideBounds& centred = still.empty() ? all : still;
  if (!centred.empty()) {
    snapshot.origin = 0.5 * (centred.low + centred.high);
  } else if (!scene.captures.empty()) {
    snapshot.origin = scene.captures.front()->frames.front().eye;
  }
  for (const auto& capture : scene.captures)
    snapshot.captures.push_back(captureStateOf(*capture, capture->frameAt(time), snapshot.origin));

  WideBounds bounds;
  snapshot.objects.reserve(scene.objects.size());
  for (const Object& object : scene.objects) {
    ObjectState& state = snapshot.objects.emplace_back();
    const glm::dmat4 toWorld = motionAt(object, time);
    const glm::dmat4 toLocal = glm::translate(glm::dmat4(1.0), -snapshot.origin) * toWorld;
    state.toWorld = glm::mat4(toLocal);
    state.normalToWorld = glm::mat3(normalMatrixOf(glm::dmat3(toLocal)));
    if (object.sequence) deform(*object.sequence, time, state);
    if (object.animation && object.animation->deforms())
      object.animation->deform(time, state.positions, state.normals);
    if (object.parts.empty()) continue;
    if (!state.positions.empty()) {
      grow(bounds, toWorld, state.positions);
    } else if (object.motion || object.animation) {
      grow(bounds, toWorld, verticesOf(scene, object));
    } else {
      const WideBounds placed = placedBounds(scene, object);
      bounds.grow(placed.low);
      bounds.grow(placed.high);
    }
  }
  if (!bounds.empty()) {
    snapshot.bounds.grow(glm::vec3(bounds.low - snapshot.origin));
    snapshot.bounds.grow(glm::vec3(bounds.high - snapshot.origin));
  }
  snapshot.gridBounds = gridBounds(scene, time, snapshot.origin);
  const int wide = width > 0 ? width : camera.width, high = height > 0 ? height : camera.height;
  if (camera.capture >= 0) {
    const auto captured = static_cast<std::size_t>(camera.capture);
    snapshot.camera = viewOf(*scene.captures.at(captured), snapshot.captures.at(captured), wide, high);
  } else {
    snapshot.camera = viewOf(camera, time, snapshot.origin, wide, high);
  }
  for (const Light& moving : scene.lights) {
    const Light light = lightAt(moving, time);
    snapshot.lights.push_back({light.kind, glm::vec3(light.position - snapshot.origin),
                               glm::vec3(glm::normalize(light.direction)), light.power, light.innerAngle,
                               light.outerAngle});
  }
  return snapshot;
}

}  // namespace lumivox
