// A processed model file: clean triangles with normals, grouped by object and material. Each format has a
// reader of its own behind loadModel().
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/base/hash.h"
#include "lumivox/scene/scene.h"

namespace lumivox {

/// Albedo of surfaces to which no material is given: the neutral grey that is common for scans.
inline constexpr float kUnknownAlbedo = 0.8f;
/// The most triangles of one model, and as many vertices: counted before memory is taken for them.
inline constexpr std::uint64_t kMostModelTriangles = 200'000'000;

/// An image of a model, not yet decoded.
struct ModelImage {
  std::string name;                          ///< as written; empty for none
  std::filesystem::path file;                ///< where it is, unless embedded
  std::shared_ptr<const std::string> bytes;  ///< of an embedded image; else null
  bool present() const { return !name.empty(); }
};

/// A material of a model file, with its images not yet loaded.
struct ModelMaterial {
  Material values;           ///< without textures
  ModelImage diffuse, mask;  ///< of `mask` alpha is the coverage; an image without alpha covers everything
                             ///< in glTF, by its first channel in MTL
  bool masksByAlphaOnly = false;
  float dissolve = 1.0f;          ///< coverage of the whole surface; below a half it is a hole
  std::filesystem::path mtlFile;  ///< of MTL materials: named in findings
};

struct ModelObject {
  std::string name;  ///< of the object or group; empty when the file names none
  std::uint32_t firstVertex = 0, vertexCount = 0;
  std::vector<Part> parts;    ///< Part::material counts in Model::materials
  glm::dmat4 placement{1.0};  ///< of its vertices in the space of the file
  /// Null for what stands still. It places the object in the space of the file.
  std::shared_ptr<const ModelAnimation> animation;
};

/// A camera of a model file: where it stands in the space of the file, at times that matter.
struct ModelCamera {
  struct View {
    double time = 0.0;  ///< s
    glm::dvec3 eye{0}, forward{0, 0, -1}, up{0, 1, 0};
  };
  std::string name;
  double fov = 0.7;         ///< full vertical angle, rad
  std::vector<View> views;  ///< one of a camera that stands still
};

/// An animation of a model file.
struct ModelMotionName {
  std::string name;
  double duration = 0.0;  ///< s
};

struct Model {
  std::vector<glm::vec3> positions, normals;
  std::vector<glm::vec2> texcoords;
  std::vector<std::uint32_t> indices;
  std::vector<ModelObject> objects;
  std::vector<ModelMaterial> materials;
  std::vector<std::vector<glm::vec3>> framePositions, frameNormals;  ///< of a sequence: [frame][vertex]
  std::vector<ModelCamera> cameras;
  std::vector<Light> lights;  ///< in the space of the file
  std::vector<ModelMotionName> motions;
};

struct ModelOptions {
  std::optional<double> crease;  ///< rad; recomputes all normals
  bool strict = false;
  bool needsMaterials =
      true;  ///< false: the text replaces all materials, so a missing MTL file does not matter
  std::optional<std::string> animation;  ///< name of the animation that plays; without it the file's first
  bool loop = true;                      ///< whether the animation starts again after its end
};

/// Reads one model, or the frames of a sequence of OBJ files, which must have the same faces. The ending
/// chooses the format. Everything that is read goes into `hasher`.
Model loadModel(const std::vector<std::filesystem::path>& frames, const ModelOptions& options,
                Hasher& hasher);

/// A triangle flatter than 2^-23, as height over longest edge, has no normal in single precision: it is
/// treated as of zero area.
bool hasArea(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);
/// Normalises in double precision, where squares of floats do not overflow.
glm::vec3 unitNormal(const glm::vec3& v);

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
