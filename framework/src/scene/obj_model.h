// A processed model file: clean triangles with normals, grouped by object and material.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/base/hash.h"
#include "lumivox/scene/scene.h"

namespace lumivox {

/// A material of an MTL file, with its images not yet loaded.
struct ModelMaterial {
  Material values;                    ///< without textures
  std::string diffuseFile, maskFile;  ///< as written; empty for none
  float dissolve = 1.0f;              ///< coverage of the whole surface; below a half it is a hole
  std::filesystem::path mtlFile;      ///< images are relative to its folder
};

/// The line of an MTL file in which the material names its image by `statement` ("map_Kd"); 0 when it does
/// not.
int lineOfMap(const ModelMaterial& material, const std::string& statement);

struct ModelObject {
  std::string name;  ///< of the object or group; empty when the file names none
  std::uint32_t firstVertex = 0, vertexCount = 0;
  std::vector<Part> parts;  ///< Part::material counts in Model::materials
};

struct Model {
  std::vector<glm::vec3> positions, normals;
  std::vector<glm::vec2> texcoords;
  std::vector<std::uint32_t> indices;
  std::vector<ModelObject> objects;
  std::vector<ModelMaterial> materials;
  std::vector<std::vector<glm::vec3>> framePositions, frameNormals;  ///< of a sequence: [frame][vertex]
};

struct ModelOptions {
  std::optional<double> crease;  ///< rad; recomputes all normals
  bool strict = false;
  bool needsMaterials =
      true;  ///< false: the text replaces all materials, so a missing MTL file does not matter
};

/// Reads one OBJ file, or the frames of a sequence, which must have the same faces. Everything that is read
/// goes into `hasher`.
Model loadModel(const std::vector<std::filesystem::path>& frames, const ModelOptions& options,
                Hasher& hasher);

/// Where generated normals are smooth: faces that meet at no more than this angle.
inline constexpr double kDefaultCrease = 0.5235987755982988;  // 30 deg

/// Corner k of triangle t has number 3 t + k everywhere below.
struct NormalGroups {
  std::vector<std::uint32_t> start;    ///< one more than groups
  std::vector<std::uint32_t> corners;  ///< corners whose faces share a normal at one point
  std::vector<std::uint32_t> groupOfCorner;
};

/// Groups the corners at each position by the crease angle: those whose face normals are within it of a
/// corner's own.
NormalGroups groupNormals(const std::vector<glm::vec3>& positions,
                          const std::vector<std::uint32_t>& triangles, double crease);
/// One unit normal for each group: face normals weighted by the angle at the corner (Thuermer and Wuethrich
/// 1998).
std::vector<glm::vec3> groupNormalsOf(const std::vector<glm::vec3>& positions,
                                      const std::vector<std::uint32_t>& triangles,
                                      const NormalGroups& groups);

}  // namespace lumivox
