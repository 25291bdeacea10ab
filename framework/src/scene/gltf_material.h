// Materials of glTF 2.0 as ours.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "scene/gltf_document.h"
#include "scene/gltf_nodes.h"
#include "scene/metallic_roughness.h"
#include "scene/model.h"

namespace lumivox {

/// Where the texture coordinates of a primitive come from and what is done to them (KHR_texture_transform).
struct TexcoordUse {
  std::size_t set = 0;
  glm::dvec2 offset{0}, scale{1};
  double rotation = 0.0;  ///< rad
  /// From glTF's coordinates, whose v runs down, to ours, whose v runs up.
  glm::vec2 operator()(const glm::vec2& texcoord) const;
};

class GltfMaterials {
 public:
  GltfMaterials(GltfDocument& document, Hasher& hasher, GltfLosses& losses)
      : document_(document), hasher_(hasher), losses_(losses) {}

  /// The number in table() of a material of the file, or of the grey one, with a factor of its diffuse
  /// colour.
  int numberOf(std::optional<std::size_t> material, const glm::vec3& colour);
  TexcoordUse texcoordsOf(std::optional<std::size_t> material) const;
  std::vector<ModelMaterial> table() && { return std::move(table_); }

 private:
  ModelMaterial converted(std::size_t index, const glm::vec3& colour);
  void readAlpha(const GltfValue& source, const std::optional<GltfValue>& texture, float alpha,
                 ModelMaterial& result);
  void readEmission(const GltfValue& source, ModelMaterial& result);
  void noteLosses(const GltfValue& source);
  ModelImage imageOf(const GltfValue& textureInfo);
  std::string nameOf(std::size_t material) const;
  /// Mean of an image's channels; red, green and blue made linear if it holds colours. White where it cannot
  /// be read.
  glm::vec3 meanOf(const GltfValue& textureInfo, bool isColour);

  GltfDocument& document_;
  Hasher& hasher_;
  GltfLosses& losses_;
  std::map<std::pair<std::size_t, std::array<float, 3>>, int> numbers_;
  std::map<std::size_t, std::shared_ptr<const std::string>> embedded_;  // by image
  std::map<std::pair<std::string, bool>, glm::vec3> means_;
  std::vector<ModelMaterial> table_;
  NextNumbers names_;  // of the table: each once, since scene texts choose materials by name
};

}  // namespace lumivox
