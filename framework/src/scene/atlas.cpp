#include "lumivox/scene/atlas.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>

#include "lumivox/base/error.h"
#include "lumivox/scene/topology.h"
#include "polygon.h"

namespace lumivox {
namespace {

constexpr double kLongestSide = 65535.0;  // the largest value of AtlasTexel::x and y
constexpr std::uint32_t kNobody = SurfaceAtlas::kNoChart;

[[noreturn]] void tooLarge(double texels) {
  throw Error(fmt::format("the atlas would have {:.3g} texels; at most {} are made: larger texels need fewer",
                          texels, kMostAtlasTexels));
}

/// The triangles of an object at rest in world space, with their neighbours.
struct Patch {
  WeldedObject welded;
  std::vector<glm::dvec3> places;                    ///< m
  std::vector<glm::dvec3> normals;                   ///< of triangles; zero without area
  std::vector<double> areas;                         ///< of triangles, m^2
  std::vector<std::array<std::uint32_t, 3>> beyond;  ///< neighbour across each side, kNobody: none

  Patch(const Scene& scene, const Object& object) : welded(weld(scene, object)) {
    for (const glm::vec3& place : welded.places)
      places.emplace_back(object.placement * glm::dvec4(glm::dvec3(place), 1.0));
    for (std::size_t t = 0; t < welded.triangleCount(); ++t) {
      const glm::dvec3 normal = glm::cross(at(t, 1) - at(t, 0), at(t, 2) - at(t, 0));
      const double size = glm::length(normal);
      normals.push_back(size > 0.0 ? normal / size : glm::dvec3(0.0));
      areas.push_back(0.5 * size);
    }
    connect();
  }

  const glm::dvec3& at(std::size_t triangle, std::size_t corner) const {
    return places[welded.corners[3 * triangle + corner]];
  }
  /// The point with these barycentric coordinates of the second and third corner.
  glm::dvec3 point(std::size_t triangle, const glm::dvec2& weights) const {
    return at(triangle, 0) + weights.x * (at(triangle, 1) - at(triangle, 0)) +
           weights.y * (at(triangle, 2) - at(triangle, 0));
  }

 private:
  /// Pairs sides with the same end points. A third triangle at an edge starts a chart of its own.
  void connect() {
    struct Side {
      std::uint32_t low, high, triangle, number;
      auto operator<=>(const Side&) const = default;
    };
    std::vector<Side> sides;
    for (std::uint32_t t = 0; t < welded.triangleCount(); ++t)
      for (std::uint32_t k = 0; k < 3; ++k) {
        const auto [low, high] = std::minmax(welded.corners[3 * t + k], welded.corners[3 * t + (k + 1) % 3]);
        sides.push_back({low, high, t, k});
      }
    std::sort(sides.begin(), sides.end());
    beyond.assign(welded.triangleCount(), {kNobody, kNobody, kNobody});
    for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
      const Side &a = sides[i], &b = sides[i + 1];
      if (a.low != b.low || a.high != b.high) continue;
      beyond[a.triangle][a.number] = b.triangle;
      beyond[b.triangle][b.number] = a.triangle;
      ++i;
    }
  }
};

using Triangle2d = std::array<glm::dvec2, 3>;

/// Two directions across the chart's axis.
struct Plane {
  glm::dvec3 right, up;
  glm::dvec2 operator()(const glm::dvec3& place) const {
    return {glm::dot(right, place), glm::dot(up, place)};
  }
  Plane turned(double angle) const {
    return {std::cos(angle) * right + std::sin(angle) * up, std::cos(angle) * up - std::sin(angle) * right};
  }
};

/// One axis runs along the first side of the chart's first triangle, so that rectangles stay axis-aligned.
Plane planeOf(const Patch& patch, std::uint32_t seed) {
  glm::dvec3 side = patch.at(seed, 1) - patch.at(seed, 0);
  if (glm::dot(side, side) == 0.0) side = patch.at(seed, 2) - patch.at(seed, 0);
  const glm::dvec3 right = glm::dot(side, side) > 0.0 ? glm::normalize(side) : glm::dvec3(1, 0, 0);
  glm::dvec3 axis = patch.normals[seed];
  if (axis == glm::dvec3(0.0))
    axis = glm::normalize(
        glm::cross(right, std::abs(right.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
  return {right, glm::cross(axis, right)};
}

/// A chart being made: its triangles in texels, from the lower left corner of its rectangle.
struct Chart {
  std::vector<std::uint32_t> triangles;
  std::vector<Triangle2d> corners;
  int width = 0, height = 0;
};

/// Whether the ray from `point` along +x crosses the edge, independent of the edge's direction.
bool crosses(glm::dvec2 a, glm::dvec2 b, const glm::dvec2& point) {
  if ((a.y <= point.y) == (b.y <= point.y)) return false;
  if (b.y < a.y) std::swap(a, b);
  return point.x < a.x + (b.x - a.x) * ((point.y - a.y) / (b.y - a.y));
}

/// Of triangles that tile the plane, exactly one contains each point.
bool inside(const Triangle2d& t, const glm::dvec2& point) {
  return crosses(t[0], t[1], point) != (crosses(t[1], t[2], point) != crosses(t[2], t[0], point));
}

/// Separating axis test of a triangle and the unit square around `centre`. Precondition: their bounds
/// overlap.
bool touches(const Triangle2d& t, const glm::dvec2& centre) {
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec2 side = t[(k + 1) % 3] - t[k], axis(-side.y, side.x);
    const double reach = 0.5 * (std::abs(axis.x) + std::abs(axis.y));
    const double onSide = glm::dot(axis, t[k] - centre), opposite = glm::dot(axis, t[(k + 2) % 3] - centre);
    if (std::min(onSide, opposite) > reach || std::max(onSide, opposite) < -reach) return false;
  }
  return true;
}

/// Barycentric coordinates of the second and third corner of the triangle's point nearest to `point`.
glm::dvec2 nearestIn(const Triangle2d& t, const glm::dvec2& point) {
  const glm::dvec2 e1 = t[1] - t[0], e2 = t[2] - t[0], p = point - t[0];
  const double doubleArea = e1.x * e2.y - e1.y * e2.x;
  if (doubleArea != 0.0) {
    const glm::dvec2 weights((p.x * e2.y - p.y * e2.x) / doubleArea, (e1.x * p.y - e1.y * p.x) / doubleArea);
    if (weights.x >= 0.0 && weights.y >= 0.0 && weights.x + weights.y <= 1.0) return weights;
  }
  // Otherwise the nearest point lies on a side.
  double nearest = std::numeric_limits<double>::infinity();
  glm::dvec2 result(0.0);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const glm::dvec2 side = t[next] - t[k];
    const double lengthSquared = glm::dot(side, side);
    const double along =
        lengthSquared > 0.0 ? std::clamp(glm::dot(point - t[k], side) / lengthSquared, 0.0, 1.0) : 0.0;
    const glm::dvec2 away = point - (t[k] + along * side);
    if (const double distance = glm::dot(away, away); distance < nearest) {
      nearest = distance;
      std::array<double, 3> weights{};
      weights[k] = 1.0 - along;
      weights[next] = along;
      result = {weights[1], weights[2]};
    }
  }
  return result;
}

/// The part of a triangle within a unit square.
struct Piece {
  double area = 0.0;
  glm::dvec2 middle{0.0};
  std::array<glm::dvec2, 8> corners;
  std::size_t cornerCount = 0;
};
Piece pieceOf(const Triangle2d& t, const glm::dvec2& centre) {
  std::array<glm::dvec2, 8> corners{t[0], t[1], t[2]}, kept;
  std::size_t count = 3;
  for (const int axis : {0, 1})
    for (const double side : {-1.0, 1.0}) {
      const double border = centre[axis] + 0.5 * side;
      std::size_t keptCount = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const glm::dvec2 &a = corners[i], &b = corners[(i + 1) % count];
        const double ha = side * (border - a[axis]), hb = side * (border - b[axis]);
        if (ha >= 0.0) kept[keptCount++] = a;
        if ((ha > 0.0 && hb < 0.0) || (ha < 0.0 && hb > 0.0))
          kept[keptCount++] = a + ha / (ha - hb) * (b - a);
      }
      corners = kept;
      count = keptCount;
      if (count < 3) return {};
    }
  Piece piece{.corners = corners, .cornerCount = count};
  glm::dvec2 moment(0.0);
  for (std::size_t i = 1; i + 1 < count; ++i) {
    const glm::dvec2 a = corners[i] - corners[0], b = corners[i + 1] - corners[0];
    const double area = 0.5 * (a.x * b.y - a.y * b.x);
    piece.area += area;
    moment += area / 3.0 * (a + b);
  }
  if (piece.area != 0.0) piece.middle = corners[0] + moment / piece.area;
  piece.area = std::abs(piece.area);
  return piece;
}

/// Calls `visit(texel, its centre)` for the texels in the bounds of a triangle.
template <class Visit>
void forEachTexel(const Triangle2d& t, int width, int height, Visit&& visit) {
  const glm::dvec2 low = glm::min(t[0], glm::min(t[1], t[2])), high = glm::max(t[0], glm::max(t[1], t[2]));
  const int lastX = std::min(static_cast<int>(high.x), width - 1),
            lastY = std::min(static_cast<int>(high.y), height - 1);
  for (int y = std::max(static_cast<int>(low.y), 0); y <= lastY; ++y)
    for (int x = std::max(static_cast<int>(low.x), 0); x <= lastX; ++x)
      visit(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x),
            glm::dvec2(x + 0.5, y + 0.5));
}

struct PackedChart {
  int width, height;
  std::size_t firstTexel, texelCount;  ///< range in AtlasMaker::texels, with places in the chart
};

class AtlasMaker {
 public:
  AtlasMaker(const Scene& scene, const std::vector<double>& texelSizes, AtlasPlaces places)
      : scene_(scene),
        texelSizes_(texelSizes),
        places_(places),
        chartOfTriangle_(scene.triangleCount(), kNobody) {}

  SurfaceAtlas make() {
    std::uint32_t firstPart = 0;
    for (std::size_t i = 0; i < scene_.objects.size(); ++i) {
      const Object& object = scene_.objects[i];
      texelSize_ = texelSizes_[i];
      addObject(object, firstPart);
      firstPart += static_cast<std::uint32_t>(object.parts.size());
    }
    SurfaceAtlas atlas;
    atlas.side = pack();
    atlas.chartCount = charts_.size();
    atlas.chartOfTriangle = std::move(chartOfTriangle_);
    sortByParts(atlas, firstPart);
    return atlas;
  }

 private:
  struct PlacedTexel {
    AtlasTexel texel;
    AtlasOutline outline;  ///< with AtlasPlaces::middles
    std::uint32_t part;
  };

  void addObject(const Object& object, std::uint32_t firstPart) {
    const Patch patch(scene_, object);
    checkArea(patch);
    std::vector<std::uint32_t> parts;  // of triangles
    for (std::uint32_t p = 0; p < object.parts.size(); ++p)
      parts.insert(parts.end(), object.parts[p].indexCount / 3, firstPart + p);
    std::vector<bool> taken(patch.welded.triangleCount(), false);
    std::deque<std::uint32_t> seeds;
    for (const bool withArea : {true, false})
      for (std::uint32_t t = 0; t < patch.welded.triangleCount(); ++t)
        if ((patch.normals[t] != glm::dvec3(0.0)) == withArea) seeds.push_back(t);
    while (!seeds.empty()) {
      const std::uint32_t seed = seeds.front();
      seeds.pop_front();
      if (taken[seed]) continue;
      const Chart chart = project(patch, grow(patch, seed, taken), seed);
      for (const std::uint32_t t : rasterise(patch, chart, parts)) {
        taken[t] = false;
        seeds.push_back(t);
      }
    }
  }

  /// Refuses too many texels before memory is allocated.
  void checkArea(const Patch& patch) {
    for (const double area : patch.areas) area_ += area / (texelSize_ * texelSize_);
    if (!(area_ <= static_cast<double>(kMostAtlasTexels))) tooLarge(area_);
  }

  /// Grows a chart from the seed, nearest triangles first; the seed comes first.
  static std::vector<std::uint32_t> grow(const Patch& patch, std::uint32_t seed, std::vector<bool>& taken) {
    const double cosine = std::cos(kLargestChartTilt);
    std::vector<std::uint32_t> triangles{seed};
    taken[seed] = true;
    for (std::size_t i = 0; i < triangles.size(); ++i)
      for (const std::uint32_t next : patch.beyond[triangles[i]]) {
        if (next == kNobody || taken[next]) continue;
        // Triangles without area lie on sides of their neighbours and join any chart.
        const glm::dvec3& normal = patch.normals[next];
        if (normal != glm::dvec3(0.0) && glm::dot(normal, patch.normals[seed]) < cosine) continue;
        taken[next] = true;
        triangles.push_back(next);
      }
    return triangles;
  }

  /// Projects the chart and turns it so that its rectangle is small.
  Chart project(const Patch& patch, std::vector<std::uint32_t> triangles, std::uint32_t seed) const {
    constexpr int kTurns = 8;
    const Plane upright = planeOf(patch, seed);
    Plane best = upright;
    glm::dvec2 bestLow(0.0), bestSize(0.0);
    double smallest = std::numeric_limits<double>::infinity();
    for (int turn = 0; turn < kTurns; ++turn) {
      const Plane plane = upright.turned(turn * 0.5 * std::numbers::pi / kTurns);
      glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
      for (const std::uint32_t t : triangles)
        for (std::size_t k = 0; k < 3; ++k) {
          const glm::dvec2 place = plane(patch.at(t, k)) / texelSize_;
          low = glm::min(low, place);
          high = glm::max(high, place);
        }
      const glm::dvec2 size = high - low;
      const double area = (size.x + 1.0) * (size.y + 1.0);
      // Only a real difference counts, not rounding.
      if (area < smallest * (1.0 - 1e-6)) smallest = area, best = plane, bestLow = low, bestSize = size;
    }
    if (!(smallest <= static_cast<double>(kMostAtlasTexels) &&
          std::max(bestSize.x, bestSize.y) < kLongestSide))
      tooLarge(smallest);
    Chart chart{std::move(triangles), {}, static_cast<int>(bestSize.x) + 1, static_cast<int>(bestSize.y) + 1};
    glm::dvec2 texels(1.0 / texelSize_);  // texels a metre, along both axes
    if (places_ == AtlasPlaces::middles) {
      chart.width = divide(bestSize.x, texels.x);
      chart.height = divide(bestSize.y, texels.y);
      bestLow *= texelSize_ * texels;
    }
    for (const std::uint32_t t : chart.triangles) {
      Triangle2d& corners = chart.corners.emplace_back();
      for (std::size_t k = 0; k < 3; ++k)
        corners[k] = glm::max(best(patch.at(t, k)) * texels - bestLow, glm::dvec2(0.0));
    }
    return chart;
  }

  /// Rounds the texels along a side to a whole number, or a multiple of four if there are many, so that
  /// squares of 2 and of 4 texels a side fill the chart. Returns that number.
  static int divide(double size, double& texels) {
    constexpr double kRounding = 1e-6;
    double whole = std::max(std::ceil(size - kRounding), 1.0);
    if (whole > 10.0)
      whole = 4.0 * std::round(0.25 * size);
    else if (whole > 3.0)
      whole = 2.0 * std::round(0.5 * size);
    if (size > kRounding) texels *= whole / size;
    return static_cast<int>(whole);
  }

  /// The owning triangles of a chart's texels, and what they cover.
  struct Ownership {
    std::vector<std::uint32_t> owners;  ///< numbers in the chart, kNobody: nobody
    std::vector<glm::dvec3> places;     ///< of the owner, m
    std::vector<double> gaps;           ///< distance from the texel's centre to its owner, texels; 0 inside
    std::vector<double> areas;          ///< of the surface within the texel, m^2
    std::vector<glm::dvec2> middles;    ///< centroid of that surface in the chart, times its area
    std::vector<glm::dvec3> normals;    ///< normal of that surface, times its area
    std::vector<double> flat;           ///< area of that surface's projection, square texels
    std::vector<std::vector<glm::dvec2>>
        corners;  ///< corners of that projection, at least those of its convex hull
    explicit Ownership(std::size_t size)
        : owners(size, kNobody),
          places(size),
          gaps(size, kUntouched),
          areas(size),
          middles(size),
          normals(size),
          flat(size),
          corners(size) {}
    void cover(std::size_t at, const Piece& piece) {
      constexpr std::size_t kMany = 64;
      flat[at] += piece.area;
      corners[at].insert(corners[at].end(), piece.corners.begin(),
                         piece.corners.begin() + static_cast<std::ptrdiff_t>(piece.cornerCount));
      if (corners[at].size() > kMany) corners[at] = convexHull(std::move(corners[at]));
    }
    /// Sine of the mean angle between the surface's normals and their mean: normals that differ sum to less
    /// than their areas. 0: flat.
    double bend(std::size_t at) const {
      constexpr double kFlat = 1.0 - 1e-6;
      const double cosine = areas[at] > 0.0 ? glm::length(normals[at]) / areas[at] : 1.0;
      return cosine >= kFlat ? 0.0 : std::sqrt(1.0 - cosine * cosine);
    }
    static constexpr double kUntouched = std::numeric_limits<double>::infinity();
  };

  /// Gives the triangle its texels; returns false, and changes nothing, if it overlaps others of its chart.
  bool take(const Patch& patch, const Chart& chart, std::uint32_t i, Ownership& ownership) const {
    struct Claim {
      std::size_t at;
      double gap;
      glm::dvec3 place;
      Piece piece;
    };
    const Triangle2d& t = chart.corners[i];
    const glm::dvec2 e1 = t[1] - t[0], e2 = t[2] - t[0];
    const double flat = 0.5 * std::abs(e1.x * e2.y - e1.y * e2.x), area = patch.areas[chart.triangles[i]];
    std::vector<Claim> claims;
    bool free = true;
    forEachTexel(t, chart.width, chart.height, [&](std::size_t at, const glm::dvec2& centre) {
      if (!free || !touches(t, centre)) return;
      const glm::dvec2 weights = nearestIn(t, centre);
      const glm::dvec2 nearest = t[0] + weights.x * (t[1] - t[0]) + weights.y * (t[2] - t[0]);
      // Exactly one triangle of a sheet contains the centre; all others have a distance above 0.
      constexpr double kBeside = 1e-30;
      const double gap = inside(t, centre) ? 0.0 : std::max(glm::length(nearest - centre), kBeside);
      const glm::dvec3 point = patch.point(chart.triangles[i], weights);
      // Two pieces of one sheet meet within a texel; farther apart than this they are two sheets.
      constexpr double kSheet = 1.5;  // texels
      free = !(gap == 0.0 && ownership.gaps[at] == 0.0) &&
             (ownership.owners[at] == kNobody ||
              glm::length(point - ownership.places[at]) <= kSheet * texelSize_);
      claims.push_back({at, gap, point, pieceOf(t, centre)});
    });
    if (!free) return false;
    for (const Claim& claim : claims) {
      const double share = flat > 0.0 ? claim.piece.area / flat * area : 0.0;
      ownership.areas[claim.at] += share;
      ownership.middles[claim.at] += share * claim.piece.middle;
      ownership.normals[claim.at] += share * patch.normals[chart.triangles[i]];
      if (places_ == AtlasPlaces::middles) ownership.cover(claim.at, claim.piece);
      if (claim.gap >= ownership.gaps[claim.at]) continue;
      ownership.owners[claim.at] = i;
      ownership.places[claim.at] = claim.place;
      ownership.gaps[claim.at] = claim.gap;
    }
    return true;
  }

  /// Assigns texels to triangles; returns overlapping ones, which need a chart of their own.
  std::vector<std::uint32_t> rasterise(const Patch& patch, const Chart& chart,
                                       const std::vector<std::uint32_t>& parts) {
    const std::size_t size = static_cast<std::size_t>(chart.width) * static_cast<std::size_t>(chart.height);
    Ownership ownership(size);
    std::vector<std::uint32_t> rejected;
    const auto number = static_cast<std::uint32_t>(charts_.size());
    for (std::uint32_t i = 0; i < chart.triangles.size(); ++i)
      if (take(patch, chart, i, ownership))
        chartOfTriangle_[patch.welded.firstIndices[chart.triangles[i]] / 3] = number;
      else
        rejected.push_back(chart.triangles[i]);
    if (places_ == AtlasPlaces::middles) findMiddles(chart, rejected, ownership);
    const std::size_t first = texels_.size();
    for (std::size_t at = 0; at < size; ++at) {
      const std::uint32_t owner = ownership.owners[at];
      if (owner == kNobody) continue;
      const auto x = static_cast<std::uint16_t>(at % static_cast<std::size_t>(chart.width)),
                 y = static_cast<std::uint16_t>(at / static_cast<std::size_t>(chart.width));
      const glm::dvec2 place =
          places_ == AtlasPlaces::middles ? ownership.middles[at] : glm::dvec2(x + 0.5, y + 0.5);
      const glm::dvec2 weights = nearestIn(chart.corners[owner], place);
      const std::uint32_t t = chart.triangles[owner];
      PlacedTexel& placed = texels_.emplace_back(
          PlacedTexel{{x, y, patch.welded.firstIndices[t] / 3, static_cast<float>(weights.x),
                       static_cast<float>(weights.y), static_cast<float>(ownership.areas[at]), number},
                      {},
                      parts[t]});
      if (places_ == AtlasPlaces::middles && ownership.bend(at) <= AtlasOutline::kMostBend)
        placed.outline = outlineOf(chart.corners[owner], weights, ownership, at);
    }
    if (texels_.size() > kMostAtlasTexels) tooLarge(static_cast<double>(texels_.size()));
    charts_.push_back({chart.width, chart.height, first, texels_.size() - first});
    return rejected;
  }

  /// `weights`: barycentric coordinates of the texel's place in the triangle `t`.
  static AtlasOutline outlineOf(const Triangle2d& t, const glm::dvec2& weights, Ownership& ownership,
                                std::size_t at) {
    const glm::dvec2 e1 = t[1] - t[0], e2 = t[2] - t[0];
    const double doubleArea = cross(e1, e2);
    std::vector<glm::dvec2> hull = convexHull(std::move(ownership.corners[at]));
    AtlasOutline outline;
    if (hull.size() < 3 || doubleArea == 0.0) return outline;
    keepCorners(hull, AtlasOutline::kMostCorners);
    const double scale = std::sqrt(ownership.flat[at] / polygonArea(hull)) *
                         (1.0 + AtlasOutline::kOverlap * ownership.bend(at));
    for (const glm::dvec2& corner : hull) {
      const glm::dvec2 p = corner - t[0];
      const glm::dvec2 there(cross(p, e2) / doubleArea, cross(e1, p) / doubleArea);
      outline.corners[outline.count++] = scale * (there - weights);
    }
    return outline;
  }

  /// Moves texels to the centroid of their surface and assigns each to the triangle there.
  void findMiddles(const Chart& chart, const std::vector<std::uint32_t>& rejected,
                   Ownership& ownership) const {
    constexpr double kLeast = 1e-6;  // of a texel
    for (std::size_t at = 0; at < ownership.owners.size(); ++at)
      if (ownership.areas[at] > kLeast * texelSize_ * texelSize_)
        ownership.middles[at] /= ownership.areas[at];
      else
        ownership.owners[at] = kNobody;
    std::size_t passed = 0;
    for (std::uint32_t i = 0; i < chart.triangles.size(); ++i) {
      if (passed < rejected.size() && rejected[passed] == chart.triangles[i]) {
        ++passed;
        continue;
      }
      forEachTexel(chart.corners[i], chart.width, chart.height, [&](std::size_t at, const glm::dvec2&) {
        if (ownership.owners[at] != kNobody && inside(chart.corners[i], ownership.middles[at]))
          ownership.owners[at] = i;
      });
    }
  }

  /// Packs rectangles on shelves, the highest first, into the smallest square that holds them. Returns its
  /// side, texels.
  int pack() {
    std::vector<std::size_t> order(charts_.size());
    double area = 0.0;
    int side = 1;
    for (std::size_t i = 0; i < order.size(); ++i) {
      order[i] = i;
      area += static_cast<double>(charts_[i].width) * charts_[i].height;
      side = std::max({side, charts_[i].width, charts_[i].height});
    }
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return std::pair(charts_[b].height, charts_[b].width) < std::pair(charts_[a].height, charts_[a].width);
    });
    side = std::max(side, static_cast<int>(std::ceil(std::sqrt(area))));
    std::vector<glm::ivec2> corners(charts_.size());
    for (;; side += std::max(side / 64, 1)) {
      glm::ivec2 pen(0);
      int shelf = 0;
      for (const std::size_t i : order) {
        if (pen.x + charts_[i].width > side) pen = {0, pen.y + shelf}, shelf = 0;
        if (shelf == 0) shelf = charts_[i].height;
        corners[i] = pen;
        pen.x += charts_[i].width;
      }
      if (pen.y + shelf <= side) break;
    }
    if (side > kLongestSide) tooLarge(static_cast<double>(side) * side);
    for (std::size_t i = 0; i < charts_.size(); ++i)
      for (std::size_t k = 0; k < charts_[i].texelCount; ++k) {
        AtlasTexel& texel = texels_[charts_[i].firstTexel + k].texel;
        texel.x = static_cast<std::uint16_t>(texel.x + corners[i].x);
        texel.y = static_cast<std::uint16_t>(texel.y + corners[i].y);
      }
    return side;
  }

  /// Counting sort by parts, which keeps the order of the charts within a part.
  void sortByParts(SurfaceAtlas& atlas, std::uint32_t partCount) const {
    atlas.parts.resize(partCount);
    for (const PlacedTexel& placed : texels_) ++atlas.parts[placed.part].texelCount;
    for (std::size_t p = 1; p < atlas.parts.size(); ++p)
      atlas.parts[p].firstTexel = atlas.parts[p - 1].firstTexel + atlas.parts[p - 1].texelCount;
    atlas.texels.resize(texels_.size());
    if (places_ == AtlasPlaces::middles) atlas.outlines.resize(texels_.size());
    std::vector<std::uint32_t> next;
    for (const AtlasPart& part : atlas.parts) next.push_back(part.firstTexel);
    for (const PlacedTexel& placed : texels_) {
      const std::uint32_t at = next[placed.part]++;
      atlas.texels[at] = placed.texel;
      if (!atlas.outlines.empty()) atlas.outlines[at] = placed.outline;
    }
  }

  const Scene& scene_;
  const std::vector<double>& texelSizes_;  ///< m, of each object
  AtlasPlaces places_;
  double texelSize_ = 0.0;                      ///< m, of the current object
  std::vector<std::uint32_t> chartOfTriangle_;  ///< of Scene::indices
  double area_ = 0.0;                           ///< texels that all triangles so far cover
  std::vector<PlacedTexel> texels_;
  std::vector<PackedChart> charts_;
};

}  // namespace

SurfaceAtlas makeSurfaceAtlas(const Scene& scene, double texelSize) {
  return makeSurfaceAtlas(scene, std::vector<double>(scene.objects.size(), texelSize));
}

SurfaceAtlas makeSurfaceAtlas(const Scene& scene, const std::vector<double>& texelSizes, AtlasPlaces places) {
  assert(texelSizes.size() == scene.objects.size());
  for (const double size : texelSizes)
    if (!(size > 0.0)) throw Error(fmt::format("a texel of {} m; its size must be above 0", size));
  return AtlasMaker(scene, texelSizes, places).make();
}

}  // namespace lumivox
