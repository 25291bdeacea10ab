// A look over the text of an OBJ or MTL file before tinyobjloader parses it. The library takes whatever it
// cannot read as zero; here every number and index is checked, so that nothing is wrong in silence.
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace lumivox {

/// How often something was found, and in which line first.
struct LineCount {
  std::size_t count = 0;
  int firstLine = 0;
  void add(int line) {
    if (count++ == 0 || line < firstLine) firstLine = line;
  }
};

struct ObjScan {
  std::vector<std::string> materialFiles;         ///< what follows each mtllib
  std::vector<std::string> materialNames;         ///< of usemtl, each once, blanks inside replaced by '_'
  std::vector<std::uint32_t> nonFinitePositions;  ///< indices from 0, rising
  LineCount nonFinite;                            ///< positions, normals and texture coordinates
  LineCount brokenFaces;                          ///< faces with an index that no vertex has
  std::set<std::string>
      unusedStatements;   ///< known or unknown ones that carry no triangles (curves, surfaces)
  std::size_t faces = 0;  ///< whole ones
};

/// Checks an OBJ text and edits it for the parser: broken faces and statements that are not used become
/// comments, continued lines are joined. Throws Error (file, line, what was expected) for anything that is no
/// OBJ.
ObjScan scanObj(std::string& text, const std::filesystem::path& file);

/// The line of the first face that holds these three positions (indices from 0); 0 when there is none.
int lineOfFace(const std::string& text, int a, int b, int c);

/// Checks an MTL text: numbers where numbers belong. Names with blanks get '_' as in scanObj. Returns the
/// materials that state Kd.
std::set<std::string> scanMtl(std::string& text, const std::filesystem::path& file);

}  // namespace lumivox
