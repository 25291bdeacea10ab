// Reads OBJ texts, and checks MTL texts before tinyobjloader parses them. That library reads malformed
// numbers as zero; here every number and index is checked, so that no error is silent.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <set>
#include <string>
#include <vector>

namespace lumivox {

/// A count of findings and the line of the first.
struct LineCount {
  std::size_t count = 0;
  int firstLine = 0;
  void add(int line) {
    if (count++ == 0 || line < firstLine) firstLine = line;
  }
};

/// A corner of a face: indices from 0, -1 for none.
struct ObjCorner {
  int position = -1, texcoord = -1, normal = -1;
  bool operator==(const ObjCorner&) const = default;
};

/// A whole face: a run of at least three corners.
struct ObjPolygon {
  static constexpr std::uint32_t kNoMaterial = ~std::uint32_t{0};
  std::uint32_t firstCorner, corners;
  std::uint32_t object;    ///< into ObjScan::objectNames
  std::uint32_t material;  ///< into ObjScan::materialNames; kNoMaterial before the first usemtl
};

struct ObjScan {
  std::vector<glm::vec3> positions, normals;  ///< coordinates that are not finite are 0
  std::vector<glm::vec2> texcoords;
  std::vector<ObjCorner> corners;
  std::vector<ObjPolygon> polygons;        ///< in the order of the file
  std::vector<std::string> objectNames;    ///< of every g and o, each time; the first is that of no statement
  std::vector<std::string> materialFiles;  ///< what follows each mtllib
  std::vector<std::string> materialNames;  ///< of usemtl, each once, blanks inside replaced by '_'
  std::vector<std::uint32_t> nonFinitePositions;  ///< indices from 0, rising
  LineCount nonFinite;                            ///< positions, normals and texture coordinates
  LineCount brokenFaces;                          ///< faces with an index that no vertex has
  std::set<std::string>
      unusedStatements;   ///< known or unknown ones that carry no triangles (curves, surfaces)
  std::size_t faces = 0;  ///< whole ones
};

/// Reads an OBJ text once. Broken faces become comments in it, continued lines are joined. Throws Error
/// (file, line, what was expected) for anything that is no OBJ.
ObjScan scanObj(std::string& text, const std::filesystem::path& file);

/// The line of the first face that holds these three positions (indices from 0); 0 when there is none.
int lineOfFace(const std::string& text, int a, int b, int c);

/// Checks an MTL text: numbers where numbers belong. Names with blanks get '_' as in scanObj. Returns the
/// materials that state Kd.
std::set<std::string> scanMtl(std::string& text, const std::filesystem::path& file);

}  // namespace lumivox
