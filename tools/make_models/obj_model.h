// A model in the making: named objects of triangles with normals and texture coordinates, written as OBJ and
// MTL.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <string>
#include <vector>

namespace lumivox::models {

struct Vertex {
  glm::dvec3 position{0};  ///< m
  glm::dvec3 normal{0, 1, 0};
  glm::dvec2 texcoord{0};
};

/// Values of the MTL keys Kd, Ks, Ns, Ke, map_Kd and map_d.
struct ObjMaterial {
  std::string name;
  glm::dvec3 diffuse{0};   ///< albedo
  glm::dvec3 specular{0};  ///< Phong albedo
  double exponent = 0.0;
  glm::dvec3 emission{0};  ///< radiance, W/(sr m^2)
  std::string diffuseMap = {}, maskMap = {};
};

class ObjModel {
 public:
  /// `name` is the stem of both files; `comment` their first line.
  ObjModel(std::string name, std::string comment);

  void material(ObjMaterial material) { materials_.push_back(std::move(material)); }
  /// Starts an object: all faces up to the next one belong to it and have this material, which is declared
  /// before.
  void object(const std::string& name, const std::string& material);

  void triangle(const Vertex& a, const Vertex& b, const Vertex& c);
  /// Corners counter-clockwise as seen from the front.
  void quad(const Vertex& a, const Vertex& b, const Vertex& c, const Vertex& d);
  /// Each triangle has its own geometric normal. Texture coordinates are metres along the two axes to which
  /// the normal is most perpendicular, divided by `textureSize`.
  void flatQuad(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d);
  void flatTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);
  enum class Facing { outward, inward };
  /// An axis-aligned box between two corners. `faces`: those to add, any of "xXyYzZ", where a capital letter
  /// is the face on the high side.
  void box(const glm::dvec3& low, const glm::dvec3& high, Facing facing = Facing::outward,
           const std::string& faces = "xXyYzZ");
  /// A rectangular ring around the Y axis between heights y0 and y1; extents are half sizes in X and Z.
  void ring(const glm::dvec2& inner, const glm::dvec2& outer, double y0, double y1);

  double textureSize = 1.0;  ///< metres of a surface that one repetition of its texture covers

  /// If false, no normals are written, and the scene smooths by its 'crease'. The frames of a sequence need
  /// this: their faces must be equal, but equal normals share one index.
  bool writesNormals = true;

  std::size_t triangleCount() const { return faces_.size(); }
  void write(const std::filesystem::path& directory) const;

 private:
  struct Face {
    int object, material;
    glm::ivec3 corners[3];  ///< indices of position, texture coordinate and normal
  };
  glm::ivec3 corner(const Vertex& vertex);
  Vertex flatVertex(const glm::dvec3& position, const glm::dvec3& normal) const;
  std::string objText() const;
  std::string mtlText() const;

  std::string name_, comment_;
  std::vector<ObjMaterial> materials_;
  std::vector<std::string> objects_, positions_, texcoords_, normals_;  // lines of the file, each kept once
  std::map<std::string, int> positionOf_, texcoordOf_, normalOf_;
  std::vector<Face> faces_;
  int object_ = -1, material_ = -1;
};

}  // namespace lumivox::models
