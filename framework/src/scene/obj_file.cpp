#include "scene/obj_file.h"

#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <istream>
#include <iterator>
#include <map>
#include <sstream>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "lumivox/base/memory_stream.h"

namespace lumivox {
namespace {

namespace fs = std::filesystem;

glm::vec3 vectorOf(const tinyobj::real_t* values) {
  return {values[0], values[1], values[2]};
}

std::string portable(std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  while (!name.empty() && (name.back() == ' ' || name.back() == '\t')) name.pop_back();
  return name;
}

bool isDefault(const tinyobj::texture_option_t& option) {
  return option.scale[0] == 1 && option.scale[1] == 1 && option.origin_offset[0] == 0 &&
         option.origin_offset[1] == 0 && option.turbulence[0] == 0 && option.turbulence[1] == 0 &&
         !option.clamp && option.brightness == 0 && option.contrast == 1;
}

/// The materials of one OBJ file, from all its MTL files.
class MaterialTable {
 public:
  MaterialTable(const fs::path& objFile, const ObjScan& scan, const ModelOptions& options, Hasher& hasher)
      : objFile_(objFile), options_(options), hasher_(hasher) {
    for (const std::string& line : scan.materialFiles) readLine(line);
    for (const std::string& name : scan.materialNames) {
      if (numbers_.count(name) == 0) addUnknown(name, scan.materialFiles);
    }
    // Faces before the first usemtl have a material too.
    fallback_ = static_cast<std::uint32_t>(table_.size());
    table_.push_back(grey("default"));
    if (!unsupported_.empty()) {
      complain(fmt::format("{}: not used: {}", objFile_.string(), fmt::join(unsupported_, ", ")));
    }
  }

  std::vector<ModelMaterial> table() && { return std::move(table_); }
  const std::map<std::string, int>& numbers() const { return numbers_; }
  std::uint32_t fallback() const { return fallback_; }

 private:
  void complain(const std::string& text) const {
    if (options_.strict) throw Error(text + "; refused under --strict");
    logWarning("{}", text);
  }

  static ModelMaterial grey(const std::string& name) {
    ModelMaterial material;
    material.values.name = name;
    material.values.diffuse = glm::vec3(kUnknownAlbedo);
    return material;
  }

  void addUnknown(const std::string& name, const std::vector<std::string>& files) {
    // A missing material file was reported before.
    if (options_.needsMaterials && !fileMissing_) {
      complain(fmt::format("{}: material '{}' is in none of its material files ({}); grey {} is used instead",
                           objFile_.string(), name,
                           files.empty() ? "it names none" : fmt::format("{}", fmt::join(files, ", ")),
                           kUnknownAlbedo));
    }
    numbers_[name] = static_cast<int>(table_.size());
    table_.push_back(grey(name));
  }

  /// A line names one file, possibly with blanks in its name, or several files.
  void readLine(const std::string& line) {
    const fs::path whole = objFile_.parent_path() / portable(line);
    std::error_code error;
    if (fs::exists(whole, error)) return readFile(whole);
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      const fs::path file = objFile_.parent_path() / portable(word);
      if (fs::exists(file, error)) {
        readFile(file);
      } else if (options_.needsMaterials) {
        fileMissing_ = true;
        complain(
            fmt::format("{}: material file '{}' does not exist; grey {} is used instead of its materials",
                        objFile_.string(), file.string(), kUnknownAlbedo));
      }
    }
  }

  void readFile(const fs::path& file) {
    if (!files_.insert(file.lexically_normal()).second) return;
    std::string text = lumivox::readFile(file);
    hasher_.add(text);
    const std::set<std::string> withDiffuse = scanMtl(text, file);
    MemoryBuffer buffer(text);
    std::istream stream(&buffer);
    std::map<std::string, int> ignored;
    std::vector<tinyobj::material_t> materials;
    std::string warnings, errors;
    tinyobj::LoadMtl(&ignored, &materials, &stream, &warnings, &errors);
    for (const tinyobj::material_t& material : materials) {
      const auto start = material.name.find_first_not_of(" \t");
      const std::string name = start == std::string::npos ? std::string() : material.name.substr(start);
      // The first definition of a name holds, as in tinyobjloader.
      if (name.empty() || numbers_.count(name) > 0) continue;
      numbers_[name] = static_cast<int>(table_.size());
      table_.push_back(convert(material, name, file, withDiffuse.count(name) > 0));
    }
  }

  ModelMaterial convert(const tinyobj::material_t& source, const std::string& name, const fs::path& file,
                        bool hasDiffuse) {
    ModelMaterial result;
    Material& values = result.values;
    values.name = name;
    values.diffuse = vectorOf(source.diffuse);
    // An image alone is the albedo.
    if (!hasDiffuse && !source.diffuse_texname.empty()) values.diffuse = glm::vec3(1.0f);
    values.specular = vectorOf(source.specular);
    values.exponent = source.shininess;
    values.emission = vectorOf(source.emission);
    result.dissolve = source.dissolve;
    result.diffuse = imageOf(source.diffuse_texname, file);
    result.mask = imageOf(source.alpha_texname, file);
    result.mtlFile = file;
    noteUnsupported(source);
    const glm::vec3 albedo = values.diffuse + values.specular;
    if (options_.needsMaterials && std::max({albedo.x, albedo.y, albedo.z}) > 1.0f + 1e-6f) {
      logInformation(
          "{}: material '{}' reflects up to {:.0f} % of the light (Kd + Ks); its values are used as given",
          file.string(), name, 100.0f * std::max({albedo.x, albedo.y, albedo.z}));
    }
    return result;
  }

  static ModelImage imageOf(const std::string& written, const fs::path& mtlFile) {
    ModelImage image;
    image.name = portable(written);
    image.file = mtlFile.parent_path() / image.name;
    return image;
  }

  void noteUnsupported(const tinyobj::material_t& source) {
    const auto note = [&](bool present, const char* what) {
      if (present) unsupported_.insert(what);
    };
    note(!source.specular_texname.empty(), "map_Ks");
    note(!source.specular_highlight_texname.empty(), "map_Ns");
    note(!source.emissive_texname.empty(), "map_Ke");
    note(!source.bump_texname.empty(), "map_bump");
    note(!source.displacement_texname.empty(), "disp");
    note(!source.normal_texname.empty(), "norm");
    note(!source.diffuse_texname.empty() && !isDefault(source.diffuse_texopt), "options of map_Kd");
    note(!source.alpha_texname.empty() && !isDefault(source.alpha_texopt), "options of map_d");
  }

  const fs::path& objFile_;
  const ModelOptions& options_;
  Hasher& hasher_;
  std::vector<ModelMaterial> table_;
  std::map<std::string, int> numbers_;
  std::set<fs::path> files_;
  std::set<std::string> unsupported_;
  bool fileMissing_ = false;
  std::uint32_t fallback_ = 0;
};

/// Cuts all polygons of more than four corners into triangles: three corners of the scan for each triangle,
/// in polygon order. tinyobjloader does it, on a text with these polygons alone.
std::vector<std::uint32_t> cutPolygons(const ObjScan& scan, const fs::path& path) {
  std::string text;
  std::vector<std::uint32_t> cornerOfVertex;
  for (const ObjPolygon& polygon : scan.polygons) {
    if (polygon.corners <= 4) continue;
    for (std::uint32_t k = 0; k < polygon.corners; ++k) {
      cornerOfVertex.push_back(polygon.firstCorner + k);
      const glm::dvec3 p(
          scan.positions[static_cast<std::size_t>(scan.corners[cornerOfVertex.back()].position)]);
      fmt::format_to(std::back_inserter(text), "v {} {} {}\n", p.x, p.y, p.z);
    }
    text += 'f';
    for (std::uint32_t k = polygon.corners; k > 0; --k) fmt::format_to(std::back_inserter(text), " -{}", k);
    text += '\n';
  }
  if (text.empty()) return {};
  MemoryBuffer buffer(text);
  std::istream stream(&buffer);
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<tinyobj::material_t> ignored;
  std::string errors;
  constexpr bool kTriangulate = true, kColours = false;
  if (!tinyobj::LoadObj(&attributes, &shapes, &ignored, nullptr, &errors, &stream, nullptr, kTriangulate,
                        kColours)) {
    throw Error(fmt::format("{}: its polygons cannot be triangulated: {}", path.string(), errors));
  }
  std::vector<std::uint32_t> triangles;
  for (const tinyobj::shape_t& shape : shapes) {
    for (const tinyobj::index_t& index : shape.mesh.indices)
      triangles.push_back(cornerOfVertex.at(static_cast<std::size_t>(index.vertex_index)));
  }
  return triangles;
}

/// Makes triangles with their objects and materials. `tableOfName` maps material names of the scan to the
/// material table.
void triangulate(const ObjScan& scan, const std::vector<std::uint32_t>& tableOfName,
                 std::uint32_t fallbackMaterial, ObjFile& file) {
  const std::vector<std::uint32_t> cut = cutPolygons(scan, file.path);
  std::size_t triangles = cut.size() / 3;
  for (const ObjPolygon& polygon : scan.polygons)
    if (polygon.corners <= 4) triangles += polygon.corners - 2;
  file.corners.reserve(3 * triangles);
  file.materials.reserve(triangles);
  file.objects.reserve(triangles);
  constexpr std::uint32_t kUnknown = ~std::uint32_t{0};
  std::vector<std::uint32_t> objectOfName(scan.objectNames.size(), kUnknown);
  std::map<std::string, std::uint32_t> objectNumbers;
  const auto objectOf = [&](std::uint32_t name) {
    if (objectOfName[name] == kUnknown) {
      const auto [entry, isNew] =
          objectNumbers.emplace(scan.objectNames[name], static_cast<std::uint32_t>(file.objectNames.size()));
      if (isNew) file.objectNames.push_back(scan.objectNames[name]);
      objectOfName[name] = entry->second;
    }
    return objectOfName[name];
  };
  const auto add = [&](const ObjPolygon& polygon, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    for (const std::uint32_t corner : {a, b, c}) file.corners.push_back(scan.corners[corner]);
    file.materials.push_back(polygon.material == ObjPolygon::kNoMaterial ? fallbackMaterial
                                                                         : tableOfName[polygon.material]);
    file.objects.push_back(objectOf(polygon.object));
  };
  const auto positionOf = [&](std::uint32_t corner) {
    return scan.positions[static_cast<std::size_t>(scan.corners[corner].position)];
  };
  std::size_t next = 0;  // next corner of the cut polygons
  for (const ObjPolygon& polygon : scan.polygons) {
    const std::uint32_t first = polygon.firstCorner;
    if (polygon.corners == 3) {
      add(polygon, first, first + 1, first + 2);
    } else if (polygon.corners == 4) {
      // Along the shorter diagonal, as tinyobjloader does it.
      const glm::vec3 even = positionOf(first + 2) - positionOf(first),
                      odd = positionOf(first + 3) - positionOf(first + 1);
      const bool alongEven =
          even.x * even.x + even.y * even.y + even.z * even.z < odd.x * odd.x + odd.y * odd.y + odd.z * odd.z;
      if (alongEven) {
        add(polygon, first, first + 1, first + 2);
        add(polygon, first, first + 2, first + 3);
      } else {
        add(polygon, first, first + 1, first + 3);
        add(polygon, first + 1, first + 2, first + 3);
      }
    } else {
      for (; next < cut.size() && cut[next] < first + polygon.corners; next += 3)
        add(polygon, cut[next], cut[next + 1], cut[next + 2]);
    }
  }
}

}  // namespace

int lineOfMap(const ModelMaterial& material, const std::string& statement) {
  std::istringstream text(readFile(material.mtlFile));
  bool inside = false;
  int number = 0;
  for (std::string line; std::getline(text, line);) {
    ++number;
    std::istringstream words(line);
    std::string word, rest;
    words >> word;
    std::getline(words >> std::ws, rest);
    if (!rest.empty() && rest.back() == '\r') rest.pop_back();
    if (word == "newmtl") inside = portable(rest) == material.values.name;
    if (inside && word == statement) return number;
  }
  return 0;
}

ObjFile readObjFile(const fs::path& path, const ModelOptions& options, Hasher& hasher) {
  // Measured on well-known models: the peak is 5 times the text with normals of the file, and 15 times with
  // generated ones.
  constexpr std::uint64_t kMemoryPerByte = 16;
  ObjFile file;
  file.path = path;
  file.text = readFileMaybeGzip(path, kLargestModelFile);
  requireMemory(kMemoryPerByte * file.text.size(), path.string());
  hasher.add(file.text);
  file.scan = scanObj(file.text, path);
  if (file.scan.faces == 0 && file.scan.brokenFaces.count == 0) {
    throw Error(fmt::format("{}: contains no faces; expected an OBJ text with 'v' and 'f' statements",
                            path.string()));
  }
  if (!file.scan.unusedStatements.empty()) {
    const std::string text = fmt::format("{}: statements without triangles are not used: {}", path.string(),
                                         fmt::join(file.scan.unusedStatements, ", "));
    if (options.strict) throw Error(text + "; refused under --strict");
    logWarning("{}", text);
  }
  MaterialTable materials(file.path, file.scan, options, hasher);
  std::vector<std::uint32_t> tableOfName;
  for (const std::string& name : file.scan.materialNames)
    tableOfName.push_back(static_cast<std::uint32_t>(materials.numbers().at(name)));
  triangulate(file.scan, tableOfName, materials.fallback(), file);
  file.positions = std::move(file.scan.positions);
  file.normals = std::move(file.scan.normals);
  file.texcoords = std::move(file.scan.texcoords);
  // Only the triangles are of use from here on.
  file.scan.corners = {};
  file.scan.polygons = {};
  file.materialTable = std::move(materials).table();
  return file;
}

}  // namespace lumivox
