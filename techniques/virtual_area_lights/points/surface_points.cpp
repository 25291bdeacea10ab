#include "surface_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "lumivox/scene/models.h"
#include "near_places.h"
#include "sample_elimination.h"
#include "surface_candidates.h"

namespace lumivox::virtual_area_lights {
namespace {

/// Normals face alike from this cosine on; below it they lie across an edge. kAlikeCosine of
/// shaders/virtual_area_lights/surface_points.glsl.
constexpr float kAlikeCosine = 0.05f;

/// The points among `candidates` of one model, and the candidates that belong to each of them.
class ModelPoints {
 public:
  ModelPoints(const std::vector<Facet>& facets, const SurfaceCandidates& candidates, std::uint32_t model,
              std::span<const std::uint32_t> chosen)
      : facets_(facets), candidates_(candidates) {
    for (const std::uint32_t number : chosen) {
      const Facet& facet = facets_[candidates_.facets[number]];
      for (int side = 0; side < facet.sides; ++side) {
        points_.push_back({.place = candidates_.places[number],
                           .object = facet.object,
                           .model = model,
                           .material = facet.material,
                           .back = side == 1});
        positions_.push_back(candidates_.positions[number]);
        normals_.push_back(side == 1 ? -candidates_.normals[number] : candidates_.normals[number]);
      }
    }
  }

  /// Each candidate belongs to the nearest point on its side and lies in the reach of its nearest ones.
  std::vector<SurfacePoint> measured(int neighbours, double spacing, double farthest) {
    const NearPlaces near(positions_, static_cast<float>(1.5 * spacing));
    // Nearly every place has a candidate within this distance.
    const auto beside = static_cast<float>(0.5 * spacing);
    for (std::uint32_t c = 0; c < candidates_.places.size(); ++c)
      for (int side = 0; side < facets_[candidates_.facets[c]].sides; ++side)
        measure(near, candidates_.positions[c], (side == 1 ? -1.0f : 1.0f) * candidates_.normals[c],
                static_cast<std::size_t>(neighbours), spacing, farthest, beside);
    for (SurfacePoint& point : points_) point.reach = std::max(point.reach, point.radius + beside);
    return std::move(points_);
  }

 private:
  using Neighbour = std::pair<float, std::uint32_t>;  // squared distance, point

  void measure(const NearPlaces& near, const glm::vec3& place, const glm::vec3& normal,
               std::size_t neighbours, double spacing, double farthest, float beside) {
    const auto most = static_cast<float>(farthest);
    // A little beyond the expected distance of the last of them on a plane.
    const double expected = spacing * std::sqrt(static_cast<double>(neighbours) * std::numbers::inv_pi);
    float radius = std::min(static_cast<float>(1.2 * expected) + 2.0f * beside, most);
    find(near, place, normal, radius);
    while (found_.size() < neighbours && radius < most)
      find(near, place, normal, radius = std::min(1.5f * radius, most));
    // Widens the search until one is found.
    while (found_.empty() && radius < std::numeric_limits<float>::max())
      find(near, place, normal, radius = std::min(2.0f * radius, std::numeric_limits<float>::max()));
    if (found_.empty()) return;
    const Neighbour nearest = *std::min_element(found_.begin(), found_.end());
    SurfacePoint& owner = points_[nearest.second];
    owner.area += static_cast<float>(candidates_.area);
    owner.radius = std::max(owner.radius, std::sqrt(nearest.first));
    // From a place up to `beside` away no distance differs by more, not even that of the last neighbour.
    float last = most;
    if (found_.size() >= neighbours) {
      std::nth_element(found_.begin(), found_.begin() + static_cast<std::ptrdiff_t>(neighbours) - 1,
                       found_.end());
      last = std::sqrt(found_[neighbours - 1].first);
    }
    if (const float limit = std::min(last + 2.0f * beside, most); limit > radius)
      find(near, place, normal, limit);
    bool anyAlike = false;
    for (const auto& [squared, number] : found_)
      if (const float distance = std::sqrt(squared); distance <= last + 2.0f * beside) {
        points_[number].reach = std::max(points_[number].reach, std::min(distance, last) + beside);
        anyAlike = anyAlike || (distance <= last && alike(number, normal));
      }
    if (!anyAlike) reachAlike(near, place, normal, most, beside);
  }

  bool alike(std::uint32_t number, const glm::vec3& normal) const {
    return glm::dot(normals_[number], normal) >= kAlikeCosine;
  }

  /// On a narrow face the nearest points may all lie across its edges. The nearest point that faces alike
  /// reaches there, too.
  void reachAlike(const NearPlaces& near, const glm::vec3& place, const glm::vec3& normal, float most,
                  float beside) {
    find(near, place, normal, most);
    std::erase_if(found_, [&](const Neighbour& one) { return !alike(one.second, normal); });
    if (found_.empty()) return;
    const auto& [squared, number] = *std::min_element(found_.begin(), found_.end());
    points_[number].reach = std::max(points_[number].reach, std::sqrt(squared) + beside);
  }

  void find(const NearPlaces& near, const glm::vec3& place, const glm::vec3& normal, float radius) {
    found_.clear();
    near.within(place, radius, [&](std::uint32_t number, float squared) {
      if (glm::dot(normals_[number], normal) >= kOtherSideCosine) found_.emplace_back(squared, number);
    });
  }

  const std::vector<Facet>& facets_;
  const SurfaceCandidates& candidates_;
  std::vector<SurfacePoint> points_;
  std::vector<glm::vec3> positions_, normals_;
  std::vector<Neighbour> found_;
};

double placeAreaOf(const std::vector<Facet>& facets) {
  double area = 0.0;
  for (const Facet& facet : facets) area += facet.area;
  return area;
}

double sideAreaOf(const std::vector<Facet>& facets) {
  double area = 0.0;
  for (const Facet& facet : facets) area += facet.sides * facet.area;
  return area;
}

bool hasMask(const Scene& scene, const std::vector<Facet>& facets) {
  return std::any_of(facets.begin(), facets.end(), [&](const Facet& facet) {
    return scene.materials[static_cast<std::size_t>(facet.material)].maskTexture >= 0;
  });
}

/// Candidates of equal density for each model, and the areas that they cover.
struct Drawn {
  std::vector<SurfaceCandidates> candidates;
  std::vector<double> covered;  ///< by sides with candidates, m^2
  double area = 0.0;            ///< sum of `covered`
};

/// `area` of sides, m^2, that gets kCandidatesPerPoint candidates per point.
Drawn draw(const Scene& scene, const std::vector<std::vector<Facet>>& models, int points, double area) {
  constexpr double kFewest = 16.0;  // so that places on a small model are not all on its first triangles
  Drawn drawn;
  for (const std::vector<Facet>& facets : models) {
    drawn.covered.push_back(0.0);
    drawn.candidates.emplace_back();
    if (facets.empty()) continue;
    const double share = placeAreaOf(facets) / area;
    const double count =
        std::max(std::ceil(static_cast<double>(kCandidatesPerPoint) * points * share), kFewest);
    const Facet& first = facets.front();
    const glm::dvec3 base(
        scene.objects[first.object].placement *
        glm::dvec4(glm::dvec3(scene.positions[scene.indices[3 * std::size_t{first.triangle}]]), 1.0));
    drawn.candidates.back() = candidatesOn(scene, facets, static_cast<std::size_t>(count), base);
    const SurfaceCandidates& candidates = drawn.candidates.back();
    for (const std::uint32_t facet : candidates.facets)
      drawn.covered.back() += facets[facet].sides * candidates.area;
    drawn.area += drawn.covered.back();
  }
  return drawn;
}

}  // namespace

double SurfacePointSet::spacing() const {
  return points.empty() ? 0.0 : std::sqrt(area / static_cast<double>(points.size()));
}

SurfacePointSet spreadSurfacePoints(const Scene& scene, const SurfacePointSettings& settings) {
  const std::vector<std::vector<Facet>> models = facetsOf(scene, modelsOf(scene));
  double area = 0.0;
  bool masked = false;
  for (const std::vector<Facet>& facets : models) {
    area += sideAreaOf(facets);
    masked = masked || hasMask(scene, facets);
  }
  SurfacePointSet set;
  if (!(area > 0.0)) return set;
  Drawn drawn = draw(scene, models, settings.points, area);
  // Where holes took many candidates, draws as many more; bounded, since next to nothing may be left.
  constexpr double kMostHoles = 0.9;
  if (masked && drawn.area > 0.0)
    drawn = draw(scene, models, settings.points, std::max(drawn.area, (1.0 - kMostHoles) * area));
  if (!(drawn.area > 0.0)) return set;
  set.area = drawn.area;
  const double spacing = std::sqrt(drawn.area / settings.points);
  // Two and a half times as far as the last neighbour on a plane; farther points say nothing about a place.
  set.farthest = spacing * (1.0 + 2.5 * std::sqrt(settings.neighbours * std::numbers::inv_pi));
  double before = 0.0;  // of the models so far
  for (std::uint32_t model = 0; model < models.size(); ++model) {
    const SurfaceCandidates& candidates = drawn.candidates[model];
    if (candidates.places.empty()) continue;
    const auto pointsUpTo = [&](double covered) {
      return std::floor(settings.points * std::min(covered / drawn.area, 1.0) + 1e-6);
    };
    const double first = pointsUpTo(before);
    before += drawn.covered[model];
    const auto most = static_cast<std::size_t>(std::max(pointsUpTo(before) - first, 1.0));
    std::vector<int> sides;
    for (const std::uint32_t facet : candidates.facets) sides.push_back(models[model][facet].sides);
    const std::vector<std::uint32_t> chosen = eliminateSamples(candidates, sides, most);
    const std::vector<SurfacePoint> points = ModelPoints(models[model], candidates, model, chosen)
                                                 .measured(settings.neighbours, spacing, set.farthest);
    set.points.insert(set.points.end(), points.begin(), points.end());
  }
  return set;
}

}  // namespace lumivox::virtual_area_lights
