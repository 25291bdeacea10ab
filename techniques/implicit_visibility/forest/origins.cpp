#include "origins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <span>

#include "../room.h"
#include "leaf_materials.h"
#include "lumivox/scene/atlas.h"
#include "lumivox/scene/topology.h"

namespace lumivox::implicit_visibility {
namespace {

/// A triangle of the scene at rest in the world.
struct RestTriangle {
  glm::dvec3 corner, edge1, edge2;
  RestTriangle(const Scene& scene, const Object& object, std::uint32_t triangle) {
    std::array<glm::dvec3, 3> places;
    for (std::size_t k = 0; k < 3; ++k)
      places[k] =
          object.placement * glm::dvec4(glm::dvec3(scene.positions[scene.indices[3 * triangle + k]]), 1.0);
    corner = places[0], edge1 = places[1] - places[0], edge2 = places[2] - places[0];
  }
  double area() const { return 0.5 * glm::length(glm::cross(edge1, edge2)); }
};

template <class Visit>
void forEachTriangle(const Object& object, Visit&& visit) {
  for (const Part& part : object.parts)
    for (std::uint32_t t = part.firstIndex / 3; t < (part.firstIndex + part.indexCount) / 3; ++t)
      visit(t, part);
}

struct Extent {
  double area = 0.0, diagonal = 0.0;  ///< m^2; m, of the bounds

  Extent(const Scene& scene, const Object& object) {
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    forEachTriangle(object, [&](std::uint32_t t, const Part&) {
      const RestTriangle triangle(scene, object, t);
      area += triangle.area();
      for (const glm::dvec3& edge : {glm::dvec3(0.0), triangle.edge1, triangle.edge2}) {
        low = glm::min(low, triangle.corner + edge);
        high = glm::max(high, triangle.corner + edge);
      }
    });
    if (area > 0.0) diagonal = glm::distance(low, high);
  }
  /// Size of a texel that holds a whole chart of any shape; smaller for needles, which cover hardly any of
  /// it.
  double wholeTexel() const { return std::min(2.0 * diagonal, 100.0 * std::sqrt(area)); }
};

/// Texel sizes that give each object its share of the elements. Objects with a share below one have one
/// element each beyond the number, so that thousands of them take nothing from larger objects.
struct TexelSizes {
  std::vector<double> ofObjects;  ///< m
  double elements;                ///< number of elements that they give

  TexelSizes(const Scene& scene, double wanted, double share) : ofObjects(scene.objects.size(), 1.0) {
    std::vector<Extent> extents;
    double largest = 0.0;
    for (const Object& object : scene.objects) {
      extents.emplace_back(scene, object);
      largest = std::max(largest, extents.back().area);
    }
    std::vector<double> weights;
    for (const Extent& extent : extents)
      weights.push_back(extent.area > 0.0 ? std::pow(extent.area / largest, share) : 0.0);
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    const auto isAlone = [&](double weight) { return wanted * weight < total; };
    double alone = 0.0, shared = 0.0;  // number of these objects; weight of the others
    for (const double weight : weights)
      if (!isAlone(weight))
        shared += weight;
      else if (weight > 0.0)
        alone += 1.0;
    for (std::size_t i = 0; i < extents.size(); ++i)
      if (weights[i] > 0.0)
        ofObjects[i] = isAlone(weights[i]) ? extents[i].wholeTexel()
                                           : std::sqrt(extents[i].area * shared / (wanted * weights[i]));
    elements = alone + (shared > 0.0 ? wanted : 0.0);
  }
};

/// Finds an atlas of about the wanted number of texels. Charts end in texels that are not full, so the first
/// try gives more.
SurfaceAtlas atlasOf(const Scene& scene, const OriginSettings& settings) {
  TexelSizes sizes(scene, settings.elements, settings.share);
  SurfaceAtlas best = makeSurfaceAtlas(scene, sizes.ofObjects, AtlasPlaces::middles);
  const auto farness = [&](const SurfaceAtlas& atlas) {
    return std::abs(std::log(std::max(static_cast<double>(atlas.texels.size()), 1.0) / sizes.elements));
  };
  constexpr int kTries = 4;
  constexpr double kNear = 0.05;
  for (int i = 0; i < kTries && !best.texels.empty() && farness(best) > kNear; ++i) {
    // No chart has less than one texel; only the texels beyond those can change in number.
    const auto charts = static_cast<double>(best.chartCount), found = static_cast<double>(best.texels.size());
    const double fixed = charts > 0.5 * sizes.elements ? charts : 0.0;
    if (!(found > fixed && sizes.elements > fixed)) break;
    const double factor = std::sqrt((found - fixed) / (sizes.elements - fixed));
    for (double& size : sizes.ofObjects) size *= factor;
    SurfaceAtlas next = makeSurfaceAtlas(scene, sizes.ofObjects, AtlasPlaces::middles);
    if (farness(next) >= farness(best)) break;
    best = std::move(next);
  }
  return best;
}

bool hasTexcoords(const Scene& scene, const Object& object) {
  const std::span all = std::span(scene.texcoords).subspan(object.firstVertex, object.vertexCount);
  return std::any_of(all.begin(), all.end(),
                     [&](const glm::vec2& texcoord) { return texcoord != all.front(); });
}

/// The UV island of each triangle of an object. Triangles are connected by edges whose ends coincide in space
/// and in the texture. Islands are numbered from `next` on, by Scene::indices.
void findIslands(const Scene& scene, const Object& object, std::vector<std::uint32_t>& islandOf,
                 std::uint32_t& next) {
  const WeldedObject welded = weld(scene, object);
  struct Corner {
    std::uint32_t place;
    float u, v;
    auto operator<=>(const Corner&) const = default;
  };
  const auto cornerOf = [&](std::size_t t, std::size_t k) {
    const glm::vec2& texcoord = scene.texcoords[scene.indices[welded.firstIndices[t] + k]];
    return Corner{welded.corners[3 * t + k], texcoord.x, texcoord.y};
  };
  std::vector<std::uint32_t> parent(welded.triangleCount());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto find = [&](std::uint32_t t) {
    while (parent[t] != t) t = parent[t] = parent[parent[t]];
    return t;
  };
  std::map<std::pair<Corner, Corner>, std::uint32_t> edges;
  for (std::uint32_t t = 0; t < welded.triangleCount(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(cornerOf(t, k), cornerOf(t, (k + 1) % 3));
      const auto [at, isNew] = edges.try_emplace({low, high}, t);
      if (!isNew) parent[std::max(find(t), find(at->second))] = std::min(find(t), find(at->second));
    }
  std::vector<std::uint32_t> numbers(welded.triangleCount(), kNoElement);
  for (std::uint32_t t = 0; t < welded.triangleCount(); ++t) {
    std::uint32_t& number = numbers[find(t)];
    if (number == kNoElement) number = next++;
    islandOf[welded.firstIndices[t] / 3] = number;
  }
}

/// The segment of each triangle of Scene::indices, and whether its plane is that of the texture.
struct SegmentMap {
  std::vector<std::uint32_t> segment;
  std::vector<bool> byTexcoords;  ///< of objects

  SegmentMap(const Scene& scene, const SurfaceAtlas& atlas, Segments segments, std::string& withoutTexcoords)
      : segment(atlas.chartOfTriangle), byTexcoords(scene.objects.size(), false) {
    if (segments == Segments::charts) return;
    auto next = static_cast<std::uint32_t>(atlas.chartCount);
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
      const Object& object = scene.objects[i];
      byTexcoords[i] = hasTexcoords(scene, object);
      if (byTexcoords[i]) {
        findIslands(scene, object, segment, next);
      } else {
        if (!withoutTexcoords.empty()) withoutTexcoords += ", ";
        withoutTexcoords += "'" + object.name + "'";
      }
    }
  }
};

glm::dvec2 texcoordAt(const Scene& scene, const Leaf& leaf) {
  const auto corner = [&](std::uint32_t k) {
    return glm::dvec2(scene.texcoords[scene.indices[3 * leaf.triangle + k]]);
  };
  const double b = static_cast<double>(leaf.second), c = static_cast<double>(leaf.third);
  return (1.0 - b - c) * corner(0) + b * corner(1) + c * corner(2);
}

void addTexels(const Scene& scene, const SurfaceAtlas& atlas, const SegmentMap& map, Origins& origins) {
  std::size_t part = 0;
  for (std::uint32_t o = 0; o < scene.objects.size(); ++o)
    for (std::size_t p = 0; p < scene.objects[o].parts.size(); ++p, ++part)
      for (std::uint32_t i = 0; i < atlas.parts[part].texelCount; ++i) {
        const AtlasTexel& texel = atlas.texels[atlas.parts[part].firstTexel + i];
        Leaf leaf{o, texel.triangle, texel.second, texel.third};
        leaf.segment = map.segment[texel.triangle];
        leaf.area = texel.area;
        leaf.outline = atlas.outlines[atlas.parts[part].firstTexel + i];
        leaf.place = map.byTexcoords[o] ? texcoordAt(scene, leaf) : glm::dvec2(texel.x, texel.y);
        const LeafMaterial material = materialOfPiece(scene, scene.objects[o].parts[p], leaf);
        if (material.covered > 0.0f) origins.leaves.push_back(material.on(leaf));
      }
}

/// Places of vertices in the planes of their charts, along the two axes closest to these planes.
glm::dvec2 placeInPlane(const Scene& scene, const Object& object, const Leaf& leaf,
                        const glm::dvec3& normal) {
  const glm::dvec3 place = object.placement * glm::dvec4(glm::dvec3(scene.positions[leaf.vertex]), 1.0);
  const glm::dvec3 size = glm::abs(normal);
  if (size.x >= size.y && size.x >= size.z) return {place.y, place.z};
  return size.y >= size.z ? glm::dvec2(place.z, place.x) : glm::dvec2(place.x, place.y);
}

void addVertices(const Scene& scene, const SegmentMap& map, Origins& origins) {
  std::map<std::uint32_t, glm::dvec3> normals;  // of segments, times their area
  for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
    const Object& object = scene.objects[o];
    std::vector<std::vector<std::pair<std::uint32_t, const Part*>>> around(object.vertexCount);
    forEachTriangle(object, [&](std::uint32_t t, const Part& part) {
      const RestTriangle triangle(scene, object, t);
      normals[map.segment[t]] += glm::cross(triangle.edge1, triangle.edge2);
      for (std::size_t k = 0; k < 3; ++k)
        around[scene.indices[3 * t + k] - object.firstVertex].emplace_back(t, &part);
    });
    for (std::uint32_t v = 0; v < object.vertexCount; ++v) {
      if (around[v].empty()) continue;
      Leaf leaf{o, around[v].front().first};
      leaf.vertex = object.firstVertex + v;
      leaf.segment = map.segment[leaf.triangle];
      double area = 0.0;
      std::vector<CornerPiece> pieces;
      for (const auto& [t, part] : around[v]) {
        const double third = RestTriangle(scene, object, t).area() / 3.0;
        area += third;
        pieces.push_back({t, part, third});
      }
      leaf.area = static_cast<float>(area);
      const LeafMaterial material = materialOfVertex(scene, pieces, leaf.vertex);
      if (!(material.covered > 0.0f)) continue;
      origins.leaves.push_back(material.on(leaf));
      origins.firstTriangle.push_back(static_cast<std::uint32_t>(origins.triangles.size()));
      for (const auto& [t, part] : around[v]) origins.triangles.push_back(t);
    }
  }
  origins.firstTriangle.push_back(static_cast<std::uint32_t>(origins.triangles.size()));
  for (Leaf& leaf : origins.leaves)
    leaf.place = map.byTexcoords[leaf.object]
                     ? glm::dvec2(scene.texcoords[leaf.vertex])
                     : placeInPlane(scene, scene.objects[leaf.object], leaf, normals[leaf.segment]);
}

}  // namespace

Origins findOrigins(const Scene& scene, const OriginSettings& settings) {
  Origins origins;
  if (scene.triangleCount() == 0) return origins;
  const bool atlasLeaves = settings.source == Source::atlas;
  const auto leaves = atlasLeaves ? static_cast<std::uint64_t>(settings.elements) : scene.positions.size();
  // The leaf itself, its texel and outline twice, and its nodes with their states and textures.
  constexpr std::uint64_t kBytesPerLeaf = 1024;
  requireRoom({"places and trees", leaves, leaves * kBytesPerLeaf}, ofHost());
  // For vertices the atlas only gives charts, so that texels as large as the objects suffice.
  const SurfaceAtlas atlas =
      atlasLeaves ? atlasOf(scene, settings)
                  : makeSurfaceAtlas(
                        scene, TexelSizes(scene, static_cast<double>(scene.objects.size()), 0.0).ofObjects,
                        AtlasPlaces::middles);
  const SegmentMap map(scene, atlas, settings.segments, origins.withoutTexcoords);
  if (atlasLeaves)
    addTexels(scene, atlas, map, origins);
  else
    addVertices(scene, map, origins);
  return origins;
}

}  // namespace lumivox::implicit_visibility
