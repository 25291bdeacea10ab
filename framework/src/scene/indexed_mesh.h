// Triangles of a model file as indices into its vertices, and what is made of them: bad triangles are
// dropped, missing normals are generated.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "scene/model.h"

namespace lumivox {

struct IndexedMesh {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;      ///< as many as positions, of any length, or none
  std::vector<glm::vec2> texcoords;    ///< as many as positions, or none
  std::vector<std::uint32_t> indices;  ///< three per triangle, all below the number of positions
};

/// The same with unit normals and texture coordinates at every vertex.
struct FinishedMesh {
  IndexedMesh mesh;
  /// The vertex of the file that each vertex was; empty where they are the file's.
  std::vector<std::uint32_t> source;
  /// Corners that share a generated normal; empty where the file's normals were kept.
  NormalGroups groups;
};

/// Bad triangles of a whole file.
struct TriangleFindings {
  std::size_t triangles = 0, nonFinite = 0, flat = 0;
  std::string firstNonFinite, firstFlat;  ///< places, such as "triangle 7 of /meshes/0/primitives/1"

  /// Warns of them; Error if `strict` or if none is left.
  void report(const std::filesystem::path& file, bool strict) const;
};

/// `place` names the mesh in findings. Vertices that no triangle uses are left out where most are unused.
FinishedMesh finished(IndexedMesh mesh, const ModelOptions& options, const std::string& place,
                      TriangleFindings& findings);

/// Adds the triangles as a part of the model's last object. Moves the vertices where the model has none yet.
void append(Model& model, FinishedMesh finished, int material);

}  // namespace lumivox
