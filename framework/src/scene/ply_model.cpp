#include "scene/ply_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/image.h"
#include "lumivox/base/log.h"
#include "scene/indexed_mesh.h"
#include "scene/parallel.h"
#include "scene/ply_header.h"

namespace lumivox {
namespace {

template <class T>
T numberAt(const char* at, bool isSwapped) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), at, sizeof(T));
  if (isSwapped) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

double loadScalar(const char* at, PlyScalar type, bool isSwapped) {
  switch (type) {
    case PlyScalar::int8:
      return numberAt<std::int8_t>(at, false);
    case PlyScalar::uint8:
      return numberAt<std::uint8_t>(at, false);
    case PlyScalar::int16:
      return numberAt<std::int16_t>(at, isSwapped);
    case PlyScalar::uint16:
      return numberAt<std::uint16_t>(at, isSwapped);
    case PlyScalar::int32:
      return numberAt<std::int32_t>(at, isSwapped);
    case PlyScalar::uint32:
      return numberAt<std::uint32_t>(at, isSwapped);
    case PlyScalar::float32:
      return numberAt<float>(at, isSwapped);
    case PlyScalar::float64:
      return numberAt<double>(at, isSwapped);
  }
  return 0.0;
}

/// Numbers one behind another in the data, of either form.
class PlyData {
 public:
  PlyData(std::string_view bytes, const PlyHeader& header, const std::filesystem::path& file)
      : bytes_(bytes),
        file_(file),
        isAscii_(header.format == PlyFormat::ascii),
        isSwapped_((header.format == PlyFormat::bigEndian) == (std::endian::native == std::endian::little)),
        at_(header.dataAt) {}

  bool isAscii() const { return isAscii_; }
  bool isSwapped() const { return isSwapped_; }

  double next(PlyScalar type) {
    if (isAscii_) return nextWord();
    const char* here = take(sizeOf(type));
    return loadScalar(here, type, isSwapped_);
  }
  /// So many bytes; Error where the file ends before.
  const char* take(std::size_t count) {
    if (bytes_.size() - at_ < count)
      refuse(fmt::format("the data end at byte {}", bytes_.size()), "more (is the file truncated?)");
    at_ += count;
    return bytes_.data() + at_ - count;
  }
  std::size_t left() const { return bytes_.size() - at_; }
  const char* here() const { return bytes_.data() + at_; }

  [[noreturn]] void refuse(const std::string& what, const std::string& expected) const {
    throw Error(fmt::format("{}: byte {}: {}; expected {}", file_.string(), at_, what, expected));
  }

 private:
  double nextWord() {
    while (at_ < bytes_.size() && isPlySeparator(bytes_[at_])) ++at_;
    const char *begin = bytes_.data() + at_, *end = bytes_.data() + bytes_.size();
    if (begin == end) refuse("the data end", "more numbers (is the file truncated?)");
    double value = 0;
    const auto result = std::from_chars(*begin == '+' ? begin + 1 : begin, end, value);
    if (result.ptr == begin || (result.ptr < end && !isPlySeparator(*result.ptr)) ||
        result.ec == std::errc::invalid_argument)
      refuse(fmt::format(
                 "'{}' is not a number",
                 legible(plyWordsOf(std::string_view(begin, std::min<std::size_t>(
                                                                64, static_cast<std::size_t>(end - begin))))
                             .front())),
             "numbers");
    if (result.ec == std::errc::result_out_of_range) value = std::numeric_limits<double>::infinity();
    at_ += static_cast<std::size_t>(result.ptr - begin);
    return value;
  }

  std::string_view bytes_;
  const std::filesystem::path& file_;
  bool isAscii_, isSwapped_;
  std::size_t at_;
};

/// What a vertex property is for us.
enum class Meaning { position, normal, texcoord, colour };
struct Target {
  Meaning meaning;
  int axis;
};

std::optional<Target> targetOf(const std::string& name) {
  constexpr std::array<std::string_view, 3> kPositions{"x", "y", "z"}, kNormals{"nx", "ny", "nz"},
      kColours{"red", "green", "blue"}, kDiffuse{"diffuse_red", "diffuse_green", "diffuse_blue"};
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    if (name == kPositions[i]) return Target{Meaning::position, axis};
    if (name == kNormals[i]) return Target{Meaning::normal, axis};
    if (name == kColours[i] || name == kDiffuse[i]) return Target{Meaning::colour, axis};
  }
  if (name == "s" || name == "u" || name == "texture_u") return Target{Meaning::texcoord, 0};
  if (name == "t" || name == "v" || name == "texture_v") return Target{Meaning::texcoord, 1};
  return std::nullopt;
}

class PlyReader {
 public:
  PlyReader(const std::string& bytes, const std::filesystem::path& file)
      : file_(file), header_(readPlyHeader(bytes, file)), data_(bytes, header_, file) {}

  IndexedMesh run() {
    requireRoom();
    bool hasVertices = false, hasFaces = false;
    for (const PlyElement& element : header_.elements) {
      if ((element.name == "vertex" && hasVertices) || (element.name == "face" && hasFaces))
        throw Error(
            fmt::format("{}: has the element '{}' twice; expected one", file_.string(), element.name));
      if (element.name == "vertex") {
        readVertices(element);
        hasVertices = true;
      } else if (element.name == "face") {
        readFaces(element);
        hasFaces = true;
      } else {
        skip(element);
      }
    }
    if (!hasVertices || !hasFaces)
      throw Error(
          fmt::format("{}: has no {}; expected the elements vertex and face (points, strips and range "
                      "grids are not read)",
                      file_.string(), hasVertices ? "faces" : "vertices"));
    for (std::size_t i = 0; i < mesh_.indices.size(); ++i) {
      if (mesh_.indices[i] >= mesh_.positions.size())
        throw Error(fmt::format("{}: triangle {} has vertex {}; expected one of {} vertices", file_.string(),
                                i / 3, mesh_.indices[i], mesh_.positions.size()));
    }
    return std::move(mesh_);
  }

  /// Linear; nothing without colours.
  std::optional<glm::vec3> meanColour() const {
    if (colours_ == 0) return std::nullopt;
    return glm::vec3(colourSum_ / static_cast<double>(colours_));
  }
  const std::vector<std::string>& unused() const { return unused_; }

 private:
  /// Refuses counts that the bytes cannot hold, before memory is taken.
  void requireRoom() const {
    std::uint64_t least = 0;
    for (const PlyElement& element : header_.elements) {
      std::uint64_t size = 0;
      for (const PlyProperty& property : element.properties)
        size += data_.isAscii() ? 2 : sizeOf(property.listCount.value_or(property.type));
      if (size == 0 && element.count > 0)
        throw Error(
            fmt::format("{}: element '{}' has no properties; expected some", file_.string(), element.name));
      least += size * element.count;
    }
    // The last number of a text needs no blank behind it.
    if (least > data_.left() + 1)
      throw Error(
          fmt::format("{}: byte {}: its elements need at least {} bytes and {} follow; expected more "
                      "(is the file truncated?)",
                      file_.string(), header_.dataAt, least, data_.left()));
    std::uint64_t vertices = 0, faces = 0;
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex") vertices = std::max(vertices, element.count);
      if (element.name == "face") faces = std::max(faces, element.count);
    }
    if (vertices > kMostModelTriangles || faces > kMostModelTriangles)
      throw Error(fmt::format("{}: {} vertices and {} faces; expected at most {} of each", file_.string(),
                              vertices, faces, kMostModelTriangles));
    requireMemory(vertices * 2 * (2 * sizeof(glm::vec3) + sizeof(glm::vec2)) + faces * 12, file_.string());
  }

  void skip(const PlyElement& element) {
    for (std::uint64_t i = 0; i < element.count; ++i)
      for (const PlyProperty& property : element.properties) skipProperty(property);
  }
  void skipProperty(const PlyProperty& property) {
    const std::uint64_t count = property.listCount ? lengthOf(property) : 1;
    if (!data_.isAscii()) {
      if (count > data_.left())
        data_.refuse(fmt::format("a list of {} numbers", count),
                     "as many as follow (is the file truncated?)");
      data_.take(count * sizeOf(property.type));
    } else {
      for (std::uint64_t i = 0; i < count; ++i) data_.next(property.type);
    }
  }
  std::uint64_t lengthOf(const PlyProperty& property) {
    const double count = data_.next(*property.listCount);
    if (!(count >= 0.0) || count != std::floor(count) || count > 1e9)
      data_.refuse(fmt::format("a list of {} numbers", count), "a whole number that is not negative");
    return static_cast<std::uint64_t>(count);
  }

  void readVertices(const PlyElement& element) {
    const std::size_t count = element.count;
    std::array<int, 4> found{};
    std::vector<std::optional<Target>> targets;
    bool hasList = false;
    for (const PlyProperty& property : element.properties) {
      hasList = hasList || property.listCount.has_value();
      targets.push_back(property.listCount ? std::nullopt : targetOf(property.name));
      if (targets.back())
        ++found[static_cast<std::size_t>(targets.back()->meaning)];
      else
        unused_.push_back(property.name);
      if (targets.back() && targets.back()->meaning == Meaning::colour)
        colourScale_ = property.type == PlyScalar::uint8    ? 1.0 / 255.0
                       : property.type == PlyScalar::uint16 ? 1.0 / 65535.0
                                                            : 1.0;
    }
    isByteColour_ = colourScale_ < 1.0;
    if (found[0] != 3)
      throw Error(
          fmt::format("{}: its vertices have {} of x, y and z; expected three", file_.string(), found[0]));
    mesh_.positions.resize(count);
    if (found[1] == 3) mesh_.normals.resize(count);
    if (found[2] == 2) mesh_.texcoords.resize(count);
    colours_ = found[3] == 3 ? count : 0;
    if (!data_.isAscii() && !hasList)
      readRecords(element, targets);
    else
      readVerticesSlowly(element, targets);
  }

  void store(const Target& target, std::size_t vertex, double value) {
    switch (target.meaning) {
      case Meaning::position:
        mesh_.positions[vertex][target.axis] = static_cast<float>(value);
        break;
      case Meaning::normal:
        if (!mesh_.normals.empty()) mesh_.normals[vertex][target.axis] = static_cast<float>(value);
        break;
      case Meaning::texcoord:
        if (!mesh_.texcoords.empty()) mesh_.texcoords[vertex][target.axis] = static_cast<float>(value);
        break;
      case Meaning::colour:
        addColour(target.axis, value);
        break;
    }
  }

  void addColour(int axis, double value) {
    const float colour = static_cast<float>(std::clamp(value * colourScale_, 0.0, 1.0));
    if (colour == colour) colourSum_[axis] += isByteColour_ ? srgbToLinear(colour) : colour;
  }

  void readVerticesSlowly(const PlyElement& element, const std::vector<std::optional<Target>>& targets) {
    for (std::size_t v = 0; v < element.count; ++v) {
      for (std::size_t p = 0; p < targets.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (!targets[p])
          skipProperty(property);
        else
          store(*targets[p], v, data_.next(property.type));
      }
    }
  }

  /// Binary vertices of one size. Runs of floats in the machine's byte order are copied as they are.
  void readRecords(const PlyElement& element, const std::vector<std::optional<Target>>& targets) {
    struct Field {
      Target target;
      std::size_t offset;
      PlyScalar type;
    };
    std::vector<Field> fields;
    std::size_t size = 0;
    bool isPlain = !data_.isSwapped();
    std::array<std::array<std::size_t, 3>, 3> offsets{};
    for (std::size_t p = 0; p < targets.size(); ++p) {
      const PlyScalar type = element.properties[p].type;
      if (targets[p]) {
        const bool isColour = targets[p]->meaning == Meaning::colour;
        if (isColour || type != PlyScalar::float32) fields.push_back({*targets[p], size, type});
        isPlain = isPlain && (isColour || type == PlyScalar::float32);
        if (!isColour)
          offsets[static_cast<std::size_t>(targets[p]->meaning)][static_cast<std::size_t>(targets[p]->axis)] =
              size;
      }
      size += sizeOf(type);
    }
    const char* records = data_.take(size * element.count);
    if (isPlain) {
      inParallel(element.count, [&](std::size_t begin, std::size_t end) {
        const auto copy = [&](auto& values, std::size_t meaning, std::size_t axes) {
          for (std::size_t v = begin; v < end && !values.empty(); ++v)
            for (std::size_t axis = 0; axis < axes; ++axis)
              std::memcpy(&values[v][static_cast<int>(axis)], records + v * size + offsets[meaning][axis], 4);
        };
        copy(mesh_.positions, 0, 3);
        copy(mesh_.normals, 1, 3);
        copy(mesh_.texcoords, 2, 2);
      });
    } else {
      fields.clear();
      std::size_t offset = 0;
      for (std::size_t p = 0; p < targets.size(); ++p) {
        if (targets[p]) fields.push_back({*targets[p], offset, element.properties[p].type});
        offset += sizeOf(element.properties[p].type);
      }
    }
    for (std::size_t v = 0; v < element.count && !fields.empty(); ++v)
      for (const Field& field : fields)
        store(field.target, v, loadScalar(records + v * size + field.offset, field.type, data_.isSwapped()));
  }

  void readFaces(const PlyElement& element) {
    std::size_t list = element.properties.size();
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      const bool isIndices =
          property.listCount && (property.name == "vertex_indices" || property.name == "vertex_index");
      if (isIndices)
        list = p;
      else
        unused_.push_back("face " + property.name);
    }
    if (list == element.properties.size())
      throw Error(fmt::format("{}: its faces have no list vertex_indices; expected one", file_.string()));
    mesh_.indices.reserve(3 * element.count);
    std::size_t done = 0;
    if (element.properties.size() == 1 && !data_.isAscii() && !data_.isSwapped())
      done = readTriangles(element);
    for (std::size_t face = done; face < element.count; ++face) {
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        if (p == list)
          readPolygon(element.properties[p], face);
        else
          skipProperty(element.properties[p]);
      }
    }
  }

  /// The triangles with 32-bit indices before the first other polygon; their number.
  std::size_t readTriangles(const PlyElement& element) {
    const PlyProperty& property = element.properties.front();
    if (sizeOf(*property.listCount) != 1 || sizeOf(property.type) != 4 || property.type == PlyScalar::float32)
      return 0;
    constexpr std::size_t kSize = 13;
    const char* at = data_.here();
    const std::size_t most = std::min<std::size_t>(element.count, data_.left() / kSize);
    mesh_.indices.resize(3 * most);
    std::size_t count = 0;
    for (; count < most && at[count * kSize] == 3; ++count)
      std::memcpy(&mesh_.indices[3 * count], at + count * kSize + 1, 12);
    mesh_.indices.resize(3 * count);
    data_.take(count * kSize);
    return count;
  }

  void readPolygon(const PlyProperty& property, std::size_t face) {
    constexpr std::uint64_t kMostPolygonCorners = 1024;
    const std::uint64_t corners = lengthOf(property);
    if (corners < 3 || corners > kMostPolygonCorners)
      data_.refuse(fmt::format("face {} has {} corners", face, corners),
                   fmt::format("3 to {}", kMostPolygonCorners));
    std::uint32_t first = 0, before = 0;
    for (std::uint64_t i = 0; i < corners; ++i) {
      const double value = data_.next(property.type);
      if (!(value >= 0.0 && value < static_cast<double>(mesh_.positions.size())) ||
          value != std::floor(value))
        data_.refuse(fmt::format("face {} has vertex {}", face, value),
                     fmt::format("one of {} vertices, which come before the faces", mesh_.positions.size()));
      const auto index = static_cast<std::uint32_t>(value);
      if (i == 0) first = index;
      if (i >= 2) mesh_.indices.insert(mesh_.indices.end(), {first, before, index});
      before = index;
    }
    if (mesh_.indices.size() / 3 > kMostModelTriangles)
      data_.refuse("too many triangles", fmt::format("at most {}", kMostModelTriangles));
  }

  const std::filesystem::path& file_;
  PlyHeader header_;
  PlyData data_;
  IndexedMesh mesh_;
  double colourScale_ = 1.0;
  bool isByteColour_ = false;
  std::size_t colours_ = 0;
  glm::dvec3 colourSum_{0.0};
  std::vector<std::string> unused_;
};

}  // namespace

Model loadPlyModel(const std::filesystem::path& file, const ModelOptions& options, Hasher& hasher) {
  const std::string bytes = readFileMaybeGzip(file, kLargestModelFile);
  hasher.add(bytes);
  PlyReader reader(bytes, file);
  IndexedMesh mesh = reader.run();
  if (!reader.unused().empty())
    logDetails("{}: properties that are not used: {}", file.string(), fmt::join(reader.unused(), ", "));
  Model model;
  ModelMaterial material;
  material.values.name = "default";
  material.values.diffuse = glm::vec3(kUnknownAlbedo);
  if (const auto colour = reader.meanColour()) {
    material.values.diffuse = *colour;
    if (options.needsMaterials)
      logInformation("{}: the colours of its vertices become one albedo, their mean ({:.3f} {:.3f} {:.3f})",
                     file.string(), colour->r, colour->g, colour->b);
  }
  model.materials.push_back(std::move(material));
  model.objects.emplace_back();
  TriangleFindings findings;
  FinishedMesh finishedMesh = finished(std::move(mesh), options, "the file", findings);
  findings.report(file, options.strict);
  append(model, std::move(finishedMesh), 0);
  return model;
}

}  // namespace lumivox
