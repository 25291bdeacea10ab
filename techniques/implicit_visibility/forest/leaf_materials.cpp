#include "leaf_materials.h"

#include <algorithm>
#include <cmath>

#include "lumivox/base/low_discrepancy.h"
#include "lumivox/scene/bilinear.h"

namespace lumivox::implicit_visibility {
namespace {

/// Weighted sums of samples.
class Means {
 public:
  void add(const Scene& scene, const Part& part, std::uint32_t triangle, const glm::dvec2& weights,
           double weight) {
    const Material& material = scene.materials[static_cast<std::size_t>(part.material)];
    all_ += weight;
    const glm::vec2 texcoord = texcoordAt(scene, triangle, weights);
    if (material.maskTexture >= 0 &&
        cutOut(scene.textures[static_cast<std::size_t>(material.maskTexture)], texcoord))
      return;
    covered_ += weight;
    glm::dvec3 albedo(material.diffuse);
    if (material.diffuseTexture >= 0) {
      const SurfaceTexture& texture = scene.textures[static_cast<std::size_t>(material.diffuseTexture)];
      albedo *= glm::dvec3(bilinearPlace(texcoord, texture.width, texture.height).blend([&](std::size_t at) {
        return glm::vec3(texture.values[3 * at], texture.values[3 * at + 1], texture.values[3 * at + 2]);
      }));
    }
    albedo_ += weight * albedo;
    emission_ += weight * glm::dvec3(material.emission);
    const glm::dvec3 specular(material.specular);
    specular_ += weight * specular;
    const double gloss = weight * (specular.x + specular.y + specular.z);
    gloss_ += gloss;
    exponent_ += gloss * static_cast<double>(material.exponent);
  }

  LeafMaterial result() const {
    LeafMaterial material;
    material.covered = all_ > 0.0 ? static_cast<float>(covered_ / all_) : 0.0f;
    if (!(covered_ > 0.0)) return material;
    material.albedo = glm::vec3(albedo_ / covered_);
    material.emission = glm::vec3(emission_ / covered_);
    material.specular = glm::vec4(glm::vec3(specular_ / covered_),
                                  gloss_ > 0.0 ? static_cast<float>(exponent_ / gloss_) : 0.0f);
    return material;
  }

 private:
  static glm::vec2 texcoordAt(const Scene& scene, std::uint32_t triangle, const glm::dvec2& weights) {
    const auto corner = [&](std::uint32_t k) {
      return glm::dvec2(scene.texcoords[scene.indices[3 * triangle + k]]);
    };
    return glm::vec2((1.0 - weights.x - weights.y) * corner(0) + weights.x * corner(1) +
                     weights.y * corner(2));
  }

  double all_ = 0.0, covered_ = 0.0, gloss_ = 0.0, exponent_ = 0.0;
  glm::dvec3 albedo_{0.0}, emission_{0.0}, specular_{0.0};
};

bool varies(const Scene& scene, const Part& part) {
  const Material& material = scene.materials[static_cast<std::size_t>(part.material)];
  return material.diffuseTexture >= 0 || material.maskTexture >= 0;
}

/// Moves a point beside the triangle onto it.
glm::dvec2 clamped(glm::dvec2 weights) {
  weights = glm::max(weights, glm::dvec2(0.0));
  const double sum = weights.x + weights.y;
  return sum > 1.0 ? weights / sum : weights;
}

}  // namespace

Leaf LeafMaterial::on(Leaf leaf) const {
  leaf.area *= covered;
  for (glm::vec2& corner : leaf.outline.corners) corner *= std::sqrt(covered);
  leaf.albedo = albedo, leaf.specular = specular, leaf.emission = emission;
  return leaf;
}

LeafMaterial materialOfPiece(const Scene& scene, const Part& part, const Leaf& leaf) {
  const glm::dvec2 middle(leaf.second, leaf.third);
  Means means;
  if (!varies(scene, part)) {
    means.add(scene, part, leaf.triangle, middle, 1.0);
    return means.result();
  }
  std::array<glm::dvec3, 3> places;
  const glm::dmat4& placement = scene.objects[leaf.object].placement;
  for (std::size_t k = 0; k < 3; ++k)
    places[k] =
        placement * glm::dvec4(glm::dvec3(scene.positions[scene.indices[3 * leaf.triangle + k]]), 1.0);
  // Steps along the first edge and across it, in barycentric coordinates.
  const glm::dvec3 e1 = places[1] - places[0], e2 = places[2] - places[0];
  const double length = glm::length(e1),
               height = length > 0.0 ? glm::length(glm::cross(e1, e2)) / length : 0.0;
  if (!(height > 0.0)) {
    means.add(scene, part, leaf.triangle, middle, 1.0);
    return means.result();
  }
  const double side = std::sqrt(static_cast<double>(leaf.area)), along = glm::dot(e1, e2) / length;
  for (int i = 0; i < kMaterialSamples; ++i) {
    const auto [x, y] = r2Point(i);
    const double third = (y - 0.5) * side / height, second = ((x - 0.5) * side - third * along) / length;
    means.add(scene, part, leaf.triangle, clamped(middle + glm::dvec2(second, third)), 1.0);
  }
  return means.result();
}

LeafMaterial materialOfVertex(const Scene& scene, std::span<const CornerPiece> pieces, std::uint32_t vertex) {
  Means means;
  for (const CornerPiece& piece : pieces) {
    const bool many = varies(scene, *piece.part);
    const int count = many ? std::max(kMaterialSamples / static_cast<int>(pieces.size()), 1) : 1;
    int corner = 0;
    while (corner < 2 && scene.indices[3 * piece.triangle + static_cast<std::uint32_t>(corner)] != vertex)
      ++corner;
    for (int i = 0; i < count; ++i) {
      // The vertex's part reaches half the way to the other corners.
      auto [x, y] = r2Point(i);
      if (x + y > 1.0) x = 1.0 - x, y = 1.0 - y;
      std::array<double, 3> weights{};
      weights[static_cast<std::size_t>(corner)] = 1.0 - 0.5 * (x + y);
      weights[static_cast<std::size_t>((corner + 1) % 3)] = 0.5 * x;
      weights[static_cast<std::size_t>((corner + 2) % 3)] = 0.5 * y;
      means.add(scene, *piece.part, piece.triangle, {weights[1], weights[2]}, piece.area / count);
    }
  }
  return means.result();
}

}  // namespace lumivox::implicit_visibility
