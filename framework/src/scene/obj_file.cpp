#include "scene/obj_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <istream>
#include <map>
#include <sstream>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"

namespace lumivox {
namespace {

namespace fs = std::filesystem;

// What a surface is where no material file says: the neutral grey of the usual scans.
constexpr float kUnknownAlbedo = 0.8f;

/// A stream over text in memory, without a copy.
class MemoryBuffer : public std::streambuf {
 public:
  explicit MemoryBuffer(std::string& text) { setg(text.data(), text.data(), text.data() + text.size()); }
};

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
    // What stands before the first usemtl has a material too.
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
    if (options_.needsMaterials) {
      complain(fmt::format(
          "{}: material '{}' is in none of its material files ({}); grey {} stands in", objFile_.string(),
          name, files.empty() ? "it names none" : fmt::format("{}", fmt::join(files, ", ")), kUnknownAlbedo));
    }
    numbers_[name] = static_cast<int>(table_.size());
    table_.push_back(grey(name));
  }

  /// A line names one file, perhaps with blanks inside, or several with blanks between.
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
        complain(fmt::format("{}: material file '{}' does not exist", objFile_.string(), file.string()));
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
    // A picture alone is the albedo.
    if (!hasDiffuse && !source.diffuse_texname.empty()) values.diffuse = glm::vec3(1.0f);
    values.specular = vectorOf(source.specular);
    values.exponent = source.shininess;
    values.emission = vectorOf(source.emission);
    result.dissolve = source.dissolve;
    result.diffuseFile = portable(source.diffuse_texname);
    result.maskFile = portable(source.alpha_texname);
    result.directory = file.parent_path();
    noteUnsupported(source);
    const glm::vec3 albedo = values.diffuse + values.specular;
    if (options_.needsMaterials && std::max({albedo.x, albedo.y, albedo.z}) > 1.0f + 1e-6f) {
      logInformation(
          "{}: material '{}' reflects up to {:.0f} % of the light (Kd + Ks); its values are used as given",
          file.string(), name, 100.0f * std::max({albedo.x, albedo.y, albedo.z}));
    }
    return result;
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
  std::uint32_t fallback_ = 0;
};

/// Gives tinyobjloader the materials that were read before.
class KnownMaterials : public tinyobj::MaterialReader {
 public:
  explicit KnownMaterials(const std::map<std::string, int>& numbers) : numbers_(numbers) {}
  bool operator()(const std::string&, std::vector<tinyobj::material_t>*, std::map<std::string, int>* numbers,
                  std::string*, std::string*) override {
    *numbers = numbers_;
    return true;
  }

 private:
  const std::map<std::string, int>& numbers_;
};

std::string trimmedName(const std::string& name) {
  const auto first = name.find_first_not_of(" \t"), last = name.find_last_not_of(" \t");
  return first == std::string::npos ? std::string() : name.substr(first, last - first + 1);
}

/// The scan has refused every index that is out of range; were the parser to read one differently, nothing
/// may follow it.
void requireIndices(const ObjFile& file) {
  const auto within = [](int index, std::size_t count) { return index < static_cast<int>(count); };
  for (const tinyobj::index_t& corner : file.corners) {
    if (corner.vertex_index >= 0 && within(corner.vertex_index, file.positions.size()) &&
        within(corner.normal_index, file.normals.size()) &&
        within(corner.texcoord_index, file.texcoords.size())) {
      continue;
    }
    throw Error(
        fmt::format("{}: a face index cannot be read; expected plain whole numbers", file.path.string()));
  }
}

void copyShapes(const std::vector<tinyobj::shape_t>& shapes, std::uint32_t fallbackMaterial, ObjFile& file) {
  std::map<std::string, std::uint32_t> objectNumbers;
  std::size_t triangles = 0;
  for (const tinyobj::shape_t& shape : shapes) triangles += shape.mesh.material_ids.size();
  file.corners.reserve(3 * triangles);
  file.materials.reserve(triangles);
  file.objects.reserve(triangles);
  for (const tinyobj::shape_t& shape : shapes) {
    if (shape.mesh.indices.empty()) continue;
    const std::string name = trimmedName(shape.name);
    const auto [entry, isNew] =
        objectNumbers.emplace(name, static_cast<std::uint32_t>(file.objectNames.size()));
    if (isNew) file.objectNames.push_back(name);
    file.corners.insert(file.corners.end(), shape.mesh.indices.begin(), shape.mesh.indices.end());
    for (const int material : shape.mesh.material_ids) {
      file.materials.push_back(material < 0 ? fallbackMaterial : static_cast<std::uint32_t>(material));
    }
    file.objects.resize(file.materials.size(), entry->second);
  }
}

}  // namespace

ObjFile readObjFile(const fs::path& path, const ModelOptions& options, Hasher& hasher) {
  // Measured on the well-known models: five times the text at its peak with the file's normals, fifteen where
  // they are made.
  constexpr std::uint64_t kMemoryPerByte = 16;
  ObjFile file;
  file.path = path;
  file.text = readFileMaybeGzip(path);
  requireMemory(kMemoryPerByte * file.text.size(), path.string());
  hasher.add(file.text);
  file.scan = scanObj(file.text, path);
  if (file.scan.faces == 0 && file.scan.brokenFaces.count == 0) {
    throw Error(
        fmt::format("{}: holds no faces; expected an OBJ text with 'v' and 'f' statements", path.string()));
  }
  if (!file.scan.unusedStatements.empty()) {
    const std::string text = fmt::format("{}: statements without triangles are not used: {}", path.string(),
                                         fmt::join(file.scan.unusedStatements, ", "));
    if (options.strict) throw Error(text + "; refused under --strict");
    logWarning("{}", text);
  }
  MaterialTable materials(file.path, file.scan, options, hasher);
  KnownMaterials reader(materials.numbers());

  // The scan has turned the file's own mtllib lines into comments; this one makes the parser ask for the
  // table.
  std::string header = "mtllib materials\n";
  file.text.insert(0, header);
  MemoryBuffer buffer(file.text);
  std::istream stream(&buffer);
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<tinyobj::material_t> ignored;
  std::string errors;
  // No text for warnings: whatever it could warn of, the scan has found before.
  const bool good =
      tinyobj::LoadObj(&attributes, &shapes, &ignored, nullptr, &errors, &stream, &reader, true, false);
  if (!good) throw Error(fmt::format("{}: cannot be parsed: {}", path.string(), errors));
  file.text.erase(0, header.size());

  const auto copy = [](const std::vector<tinyobj::real_t>& values, auto& result, int components) {
    using Vector = typename std::decay_t<decltype(result)>::value_type;
    result.resize(values.size() / static_cast<std::size_t>(components));
    for (std::size_t i = 0; i < result.size(); ++i) {
      Vector v;
      for (int k = 0; k < components; ++k) {
        const float value = values[i * static_cast<std::size_t>(components) + static_cast<std::size_t>(k)];
        v[k] = std::isfinite(value) ? value : 0.0f;  // the scan has counted it
      }
      result[i] = v;
    }
  };
  copy(attributes.vertices, file.positions, 3);
  copy(attributes.normals, file.normals, 3);
  copy(attributes.texcoords, file.texcoords, 2);
  copyShapes(shapes, materials.fallback(), file);
  requireIndices(file);
  file.materialTable = std::move(materials).table();
  return file;
}

}  // namespace lumivox
