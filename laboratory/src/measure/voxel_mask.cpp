#include "measure/voxel_mask.h"

#include <algorithm>
#include <cmath>

namespace lumivox::measure {
namespace {

constexpr float kSolid = 0.5f;  // Material::maskTexture: below it is a hole

/// Least signed distance of a point from the edges of a convex polygon, positive inside. A polygon without
/// area consists of its edge.
double depthInside(const std::vector<glm::dvec2>& polygon, double doubleArea, const glm::dvec2& point) {
  const double turn = doubleArea >= 0.0 ? 1.0 : -1.0;
  double least = 1e300;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 a = polygon[i], edge = polygon[(i + 1) % polygon.size()] - a;
    const double length = glm::length(edge);
    if (length == 0.0) continue;
    const glm::dvec2 towards = point - a;
    least = std::min(least, turn * (edge.x * towards.y - edge.y * towards.x) / length);
  }
  return least;
}

}  // namespace

MaskedTriangle::MaskedTriangle(const ExactTriangle& triangle, const std::array<glm::vec2, 3>& texcoords,
                               const SurfaceTexture& mask)
    : mask_(mask) {
  // Row 0 is the top of the image; the centre of texel (x, y) lies at (x + 0.5, y + 0.5).
  for (std::size_t k = 0; k < 3; ++k)
    corners_[k] = {triangle[k],
                   {static_cast<double>(texcoords[k].x) * mask.width,
                    (1.0 - static_cast<double>(texcoords[k].y)) * mask.height}};
}

/// Sutherland & Hodgman 1974: one plane of the box after the other.
std::vector<MaskedTriangle::Point> MaskedTriangle::clipped(const glm::dvec3& low,
                                                           const glm::dvec3& high) const {
  std::vector<Point> polygon(corners_.begin(), corners_.end()), next;
  for (int plane = 0; plane < 6 && !polygon.empty(); ++plane) {
    const int axis = plane / 2;
    const auto inside = [&](const Point& point) {
      return plane % 2 == 0 ? point.position[axis] - low[axis] : high[axis] - point.position[axis];
    };
    next.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double depthA = inside(a), depthB = inside(b);
      if (depthA >= 0.0) next.push_back(a);
      if ((depthA > 0.0 && depthB < 0.0) || (depthA < 0.0 && depthB > 0.0)) {
        const double share = depthA / (depthA - depthB);
        next.push_back({glm::mix(a.position, b.position, share), glm::mix(a.texel, b.texel, share)});
      }
    }
    polygon.swap(next);
  }
  return polygon;
}

float MaskedTriangle::texel(int x, int y) const {
  const int column = ((x % mask_.width) + mask_.width) % mask_.width,
            row = ((y % mask_.height) + mask_.height) % mask_.height;
  return mask_.values[static_cast<std::size_t>(row) * static_cast<std::size_t>(mask_.width) +
                      static_cast<std::size_t>(column)];
}

float MaskedTriangle::filtered(const glm::dvec2& at) const {
  const glm::dvec2 corner = glm::floor(at - 0.5);
  const glm::vec2 share(at - 0.5 - corner);
  const auto x = static_cast<int>(corner.x), y = static_cast<int>(corner.y);
  return glm::mix(glm::mix(texel(x, y), texel(x + 1, y), share.x),
                  glm::mix(texel(x, y + 1), texel(x + 1, y + 1), share.x), share.y);
}

bool MaskedTriangle::anySolid() const {
  return std::any_of(mask_.values.begin(), mask_.values.end(), [](float value) { return value >= kSolid; });
}

MaskedTriangle::Within MaskedTriangle::within(const glm::ivec3& voxel, double tolerance) const {
  const glm::dvec3 low(voxel);
  const std::vector<Point> points = clipped(low - tolerance, low + 1.0 + tolerance);
  if (points.empty()) return {};
  std::vector<glm::dvec2> polygon;
  glm::dvec2 least(1e300), most(-1e300);
  for (const Point& point : points) {
    polygon.push_back(point.texel);
    least = glm::min(least, point.texel);
    most = glm::max(most, point.texel);
  }
  const glm::dvec2 image(mask_.width, mask_.height), size = most - least;
  // If a voxel covers more than the whole image, or coordinates are not finite, the result is undecided
  // unless the mask has only holes.
  if (!(size.x < image.x && size.y < image.y)) return {false, anySolid()};
  const glm::dvec2 repeats = glm::floor(least / image) * image;
  Within result;
  for (glm::dvec2& corner : polygon) {
    corner -= repeats;
    result.solid |= filtered(corner) >= kSolid;
  }
  double doubleArea = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 a = polygon[i] - polygon[0], b = polygon[(i + 1) % polygon.size()] - polygon[0];
    doubleArea += a.x * b.y - a.y * b.x;
  }
  // Bilinear filtering reads texels whose centres are closer than one texel in x and y.
  constexpr double kReach = 1.4142135623730951;
  const glm::ivec2 first(glm::floor(least - repeats - 1.5)), last(glm::ceil(most - repeats + 0.5));
  for (int y = first.y; y <= last.y && !result.solid; ++y)
    for (int x = first.x; x <= last.x && !result.solid; ++x) {
      if (texel(x, y) < kSolid) continue;
      const double depth = depthInside(polygon, doubleArea, glm::dvec2(x, y) + 0.5);
      result.solid |= depth >= 0.0 && doubleArea != 0.0;
      result.reachesSolid |= depth >= -kReach;
    }
  result.reachesSolid |= result.solid;
  return result;
}

}  // namespace lumivox::measure
