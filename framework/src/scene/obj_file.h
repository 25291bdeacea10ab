// An unprocessed OBJ file with its MTL files: triangles as corners with three indices each.
#pragma once

#include "scene/obj_model.h"
#include "scene/obj_scan.h"

namespace lumivox {

struct ObjFile {
  std::filesystem::path path;
  std::string text;  ///< as scanned; for naming lines
  ObjScan scan;
  std::vector<glm::vec3> positions, normals;
  std::vector<glm::vec2> texcoords;
  std::vector<ObjCorner> corners;        ///< three per triangle
  std::vector<std::uint32_t> materials;  ///< per triangle, into `materialTable`
  std::vector<std::uint32_t> objects;    ///< per triangle, into `objectNames`
  std::vector<std::string> objectNames;  ///< each once, in the order of the file
  std::vector<ModelMaterial> materialTable;
};

ObjFile readObjFile(const std::filesystem::path& path, const ModelOptions& options, Hasher& hasher);

}  // namespace lumivox
