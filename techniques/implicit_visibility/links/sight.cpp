#include "sight.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace lumivox::implicit_visibility {
namespace {

constexpr Sight kNothing{std::numeric_limits<float>::infinity(), kNoElement};
constexpr int kCellsPerLine = 4;
/// Below this angle, rad, nothing counts as above a plane, since coplanar discs are rounded. For discs nearer
/// than their radius it is this share of the radius, since places are rounded however near they are.
constexpr float kFlat = 1e-4f;
/// A disc nearer than this many of its radii is at the same place.
constexpr float kSamePlace = 1e-5f;
/// Within so many of its radii a disc counts by its middle, not by its rim.
constexpr float kNearby = 3.0f;
/// Discs are enlarged by this factor so that rays through the corners of touching squares do not slip between
/// them.
constexpr float kRounding = 1.0f + 1e-5f;
/// Sides of polygons are moved out by this share of their radius. Places and corners are rounded, and rays
/// would slip between neighbours.
constexpr float kSeam = 1e-4f;

/// Extent of a disc seen through a face, as ratios of the components x to z: the planes through the eye that
/// touch it. The whole disc must lie in front of the face (z above 0).
std::pair<float, float> extent(float x, float z, float nx, float nz, float radius) {
  const float r2 = radius * radius;
  const float a = z * z - r2 * (1.0f - nz * nz), b = x * z + r2 * nx * nz, c = x * x - r2 * (1.0f - nx * nx);
  const float root = std::sqrt(std::max(b * b - a * c, 0.0f));
  return {(b - root) / a, (b + root) / a};
}

/// Distance at which a ray from the eye meets a disc around `direction`; infinity: it misses.
float meetDisc(const glm::vec3& direction, const glm::vec3& normal, float radius, const glm::vec3& ray) {
  const float distance = glm::dot(normal, direction) / glm::dot(normal, ray);
  const glm::vec3 away = distance * ray - direction;
  return distance > 0.0f && glm::dot(away, away) <= radius * radius ? distance : kNothing.distance;
}

}  // namespace

DiscTree::DiscTree(const ElementTree& tree, const ElementState& state)
    : tree_(tree), nodes_(tree.nodeCount), sides_(state.corners.size()) {
  constexpr float kFlatNode = 0.9999f;  // length of a mean normal
  constexpr float kSquare = 1.02f;      // twice the reach squared over the area, of a square 1
  for (std::uint32_t i = 0; i < tree.nodeCount; ++i) {
    Node& node = nodes_[i];
    node.position = state.position[i];
    const float length = glm::length(state.normal[i]);
    const bool flat = !tree.isGroup(i) && length > (tree.isLeaf(i) ? 0.0f : kFlatNode);
    if (flat) node.normal = state.normal[i] / length;
    node.radius = state.reach[i] * kRounding;
    if (tree.isLeaf(i))
      outline(i, state.outline(tree, i));
    else if (flat && 2.0f * state.reach[i] * state.reach[i] < kSquare * state.area[i])
      node.filledSquared = 0.24f * state.area[i];  // just within a square's inscribed circle
  }
}

void DiscTree::outline(std::uint32_t leaf, std::span<const glm::vec3> corners) {
  Node& node = nodes_[leaf];
  node.filledSquared = node.radius * node.radius;
  if (corners.empty()) return;
  glm::vec3 across(0.0f);  // the polygon's area, along the normal that it is counter-clockwise to
  for (std::size_t i = 0; i < corners.size(); ++i)
    across += glm::cross(corners[i], corners[(i + 1) % corners.size()]);
  const float doubled = glm::length(across);
  if (doubled > 0.0f) across /= doubled;
  float nearest = node.radius;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::vec3& from = corners[i];
    const glm::vec3 out = glm::cross(corners[(i + 1) % corners.size()] - from, across);
    const float length = glm::length(out);
    const glm::vec3 unit = length > 0.0f ? out / length : glm::vec3(0.0f);
    const float distance = glm::dot(unit, from) + kSeam * node.radius;
    sides_[tree_.firstCorner[leaf] + i] = glm::vec4(unit, distance);
    nearest = std::min(nearest, distance);
  }
  nearest = std::max(nearest, 0.0f);
  node.filledSquared = nearest * nearest;
}

bool DiscTree::covers(std::uint32_t leaf, const glm::vec3& away) const {
  if (tree_.firstCorner.empty()) return true;
  const auto first = sides_.begin() + tree_.firstCorner[leaf],
             last = sides_.begin() + tree_.firstCorner[leaf + 1];
  return std::all_of(first, last,
                     [&](const glm::vec4& side) { return glm::dot(glm::vec3(side), away) <= side.w; });
}

float DiscTree::distanceTo(std::uint32_t node, const glm::vec3& eye, const glm::vec3& ray) const {
  float nearest = kNothing.distance;
  for (const std::uint32_t child : tree_.childrenOf(node)) {
    if (child == kNoElement || !(nodes_[child].radius > 0.0f)) continue;
    const Node& disc = nodes_[child];
    const glm::vec3 direction = disc.position - eye;
    if (disc.isSphere()) {
      const float along = glm::dot(ray, direction);
      if (along < -disc.radius || glm::dot(direction, direction) - along * along > disc.radius * disc.radius)
        continue;
    } else {
      const float distance = meetDisc(direction, disc.normal, disc.radius, ray);
      if (distance >= nearest) continue;
      const glm::vec3 away = distance * ray - direction;
      if (glm::dot(away, away) <= disc.filledSquared) {
        nearest = distance;
        continue;
      }
      if (tree_.isLeaf(child)) {
        if (covers(child, away)) nearest = distance;
        continue;
      }
    }
    nearest = std::min(nearest, distanceTo(child, eye, ray));
  }
  return nearest;
}

BinFinder::BinFinder(const DirectionBins& bins) : bins_(bins), table_(bins) {
  for (int i = 0; i < bins.side(); ++i) middles_.push_back(static_cast<float>(bins.border(i + 0.5)));
  const int cells = kCellsPerLine * bins.side();
  for (int cell = 0; cell < cells; ++cell) {
    const float low = 2.0f * static_cast<float>(cell) / static_cast<float>(cells) - 1.0f;
    firstOfCell_.push_back(
        static_cast<int>(std::lower_bound(middles_.begin(), middles_.end(), low) - middles_.begin()));
  }
}

int BinFinder::firstMiddle(float ratio) const {
  if (!(ratio > -1.0f)) return 0;
  if (ratio >= 1.0f) return bins_.side();
  const auto cells = static_cast<int>(firstOfCell_.size());
  const int cell = static_cast<int>(0.5f * (ratio + 1.0f) * static_cast<float>(cells));
  int line = firstOfCell_[static_cast<std::size_t>(std::clamp(cell, 0, cells - 1))];
  // Rounding may have moved the cell's lower end past the line.
  while (line > 0 && middle(line - 1) >= ratio) --line;
  while (line < bins_.side() && middle(line) < ratio) ++line;
  return line;
}

Eye::Eye(const BinFinder& finder, const DiscTree& discs, bool cutsNearby)
    : finder_(finder), discs_(discs), cutsNearby_(cutsNearby), nearest_(finder.bins().count(), kNothing) {}

void Eye::open(const glm::vec3& position, const glm::vec3& normal) {
  position_ = position, normal_ = normal;
  hasPlane_ = normal != glm::vec3(0.0f);
  std::fill(nearest_.begin(), nearest_.end(), kNothing);
}

void Eye::offer(std::uint32_t bin, const Sight& sight) {
  if (sight.nearerThan(nearest_[bin])) nearest_[bin] = sight;
}

void Eye::see(std::uint32_t node, Fill fill) {
  Seen seen{discs_[node], node};
  const float radius = seen.disc.radius;
  seen.direction = seen.disc.position - position_;
  const float distanceSquared = glm::dot(seen.direction, seen.direction), least = kSamePlace * radius;
  if (!(distanceSquared > least * least) || !(radius > 0.0f)) return;
  seen.distance = std::sqrt(distanceSquared);
  seen.normal = seen.disc.normal;
  seen.radius = radius;
  if (hasPlane_) {
    const float height = glm::dot(normal_, seen.direction), flat = kFlat * std::max(seen.distance, radius);
    // Most lie on one side entirely, which takes no square root to find out.
    const float above = seen.disc.isSphere() || std::abs(height) > radius
                            ? radius
                            : radius * glm::length(glm::cross(normal_, seen.normal));
    seen.front = height + above > flat;
    seen.back = height - above < -flat;
    // Nearby, the part of a disc beyond its element's edge is not part of a surface that falls away behind a
    // convex edge.
    if (cutsNearby_ && !seen.disc.isSphere() && seen.distance < kNearby * radius) {
      seen.front = seen.front && height > flat;
      seen.back = seen.back && height < -flat;
    }
    if (!seen.front && !seen.back) return;
  }
  if (seen.disc.isSphere()) {
    seen.normal = seen.direction / seen.distance;
    // The disc through a sphere's middle that hides all of it; around the eye it hides everything.
    const float sine = std::min(radius / seen.distance, 1.0f);
    seen.radius = sine < 1.0f ? radius / std::sqrt(1.0f - sine * sine) : kNothing.distance;
  }
  if (fill == Fill::centre) {
    rasterise(seen);
    return;
  }
  const std::uint32_t bin = finder_.bins().binOf(seen.direction);
  if (hasPlane_ && !(glm::dot(normal_, finder_.centre(bin)) > 0.0f ? seen.front : seen.back)) return;
  offer(bin, {seen.distance, node});
}

void Eye::rasterise(const Seen& seen) {
  for (int axis = 0; axis < 3; ++axis) {
    // The bounding sphere lies beside the face or behind it.
    const float along = seen.direction[axis], beside = std::max(std::abs(seen.direction[(axis + 1) % 3]),
                                                                std::abs(seen.direction[(axis + 2) % 3]));
    if (beside - seen.radius > std::abs(along) + seen.radius) continue;
    rasteriseFace(seen, axis, along < 0.0f ? -1.0f : 1.0f);
    if (seen.radius > std::abs(along)) rasteriseFace(seen, axis, along < 0.0f ? 1.0f : -1.0f);
  }
}

float Eye::meet(const Seen& seen, const glm::vec3& ray, float nearest) const {
  if (seen.disc.isSphere()) {
    const float along = glm::dot(ray, seen.direction), radius = seen.disc.radius;
    if (along < -radius || along - radius > nearest) return kNothing.distance;
    if (seen.distance * seen.distance - along * along > radius * radius) return kNothing.distance;
  } else {
    const float distance = meetDisc(seen.direction, seen.normal, seen.radius, ray);
    if (distance > nearest || distance == kNothing.distance) return kNothing.distance;
    const glm::vec3 away = distance * ray - seen.direction;
    if (glm::dot(away, away) <= seen.disc.filledSquared) return distance;
    if (discs_.isLeaf(seen.node)) return discs_.covers(seen.node, away) ? distance : kNothing.distance;
  }
  return discs_.distanceTo(seen.node, position_, ray);
}

void Eye::rasteriseFace(const Seen& seen, int axis, float side) {
  const int first = (axis + 1) % 3, second = (axis + 2) % 3;
  const float x = side * seen.direction[first], y = side * seen.direction[second],
              z = side * seen.direction[axis], nx = side * seen.normal[first],
              ny = side * seen.normal[second], nz = side * seen.normal[axis];
  std::pair<float, float> columns(-1.0f, 1.0f), rows(-1.0f, 1.0f);
  constexpr float kSmall = 0.25f;  // of its depth: then bounds without square roots are nearly as close
  if (seen.radius < kSmall * z) {
    const float inverse = 1.0f / z, u = x * inverse, v = y * inverse, share = seen.radius / (z - seen.radius);
    const float reachU = share * (1.0f + std::abs(u)), reachV = share * (1.0f + std::abs(v));
    columns = {u - reachU, u + reachU};
    rows = {v - reachV, v + reachV};
  } else {
    const float depth = seen.radius * std::sqrt(std::max(1.0f - nz * nz, 0.0f));
    if (z + depth <= 0.0f) return;
    constexpr float kClear =
        1e-3f;  // of its radius, before the plane of the eye: nearer, all of the face is tried
    if (z - depth > kClear * seen.radius) {
      columns = extent(x, z, nx, nz, seen.radius);
      rows = extent(y, z, ny, nz, seen.radius);
    }
  }
  if (columns.first > 1.0f || columns.second < -1.0f || rows.first > 1.0f || rows.second < -1.0f) return;
  const int lines = finder_.bins().side(), face = 2 * axis + (side < 0.0f ? 1 : 0);
  const int column = finder_.firstMiddle(columns.first);
  if (column == lines || finder_.middle(column) > columns.second) return;
  const float nearest = seen.distance - seen.radius;  // that anything of it can be
  for (int j = finder_.firstMiddle(rows.first); j < lines && finder_.middle(j) <= rows.second; ++j)
    for (int i = column; i < lines && finder_.middle(i) <= columns.second; ++i) {
      const auto bin = static_cast<std::uint32_t>((face * lines + j) * lines + i);
      if (nearest_[bin].distance < nearest) continue;
      const glm::vec3 ray = finder_.centre(bin);
      if (hasPlane_ && !(glm::dot(normal_, ray) > 0.0f ? seen.front : seen.back)) continue;
      const float distance = meet(seen, ray, nearest_[bin].distance);
      if (distance < kNothing.distance) offer(bin, {distance, seen.node});
    }
}

void Eye::collect(std::vector<BinnedSight>& seen) const {
  for (std::uint32_t bin = 0; bin < nearest_.size(); ++bin)
    if (nearest_[bin].node != kNoElement) seen.push_back({bin, nearest_[bin]});
}

}  // namespace lumivox::implicit_visibility
