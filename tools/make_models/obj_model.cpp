#include "obj_model.h"

#include <fmt/format.h>

#include <cassert>
#include <cmath>

#include "lumivox/base/file.h"

namespace lumivox::models {
namespace {

/// A decimal without trailing zeros and without a negative zero, so that equal values have equal texts.
std::string decimal(double value, int places) {
  std::string text = fmt::format("{:.{}f}", value, places);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string vectorText(const glm::dvec3& v, int places) {
  return decimal(v.x, places) + ' ' + decimal(v.y, places) + ' ' + decimal(v.z, places);
}

int indexOf(const std::string& line, std::vector<std::string>& lines, std::map<std::string, int>& known) {
  const auto [entry, isNew] = known.try_emplace(line, static_cast<int>(lines.size()));
  if (isNew) lines.push_back(line);
  return entry->second;
}

}  // namespace

ObjModel::ObjModel(std::string name, std::string comment)
    : name_(std::move(name)), comment_(std::move(comment)) {}

void ObjModel::object(const std::string& name, const std::string& material) {
  if (objects_.empty() || objects_.back() != name) objects_.push_back(name);
  object_ = static_cast<int>(objects_.size()) - 1;
  material_ = -1;
  for (std::size_t i = 0; i < materials_.size(); ++i)
    if (materials_[i].name == material) material_ = static_cast<int>(i);
  assert(material_ >= 0 && "an object's material is declared before it");
}

glm::ivec3 ObjModel::corner(const Vertex& vertex) {
  // Rounded to 0.1 mm, and to 0.001 in normals and texture coordinates: finer than any test of these scenes
  // resolves.
  const std::string texcoord = decimal(vertex.texcoord.x, 3) + ' ' + decimal(vertex.texcoord.y, 3);
  return {indexOf(vectorText(vertex.position, 4), positions_, positionOf_),
          indexOf(texcoord, texcoords_, texcoordOf_),
          indexOf(vectorText(glm::normalize(vertex.normal), 3), normals_, normalOf_)};
}

void ObjModel::triangle(const Vertex& a, const Vertex& b, const Vertex& c) {
  assert(object_ >= 0);
  faces_.push_back({object_, material_, {corner(a), corner(b), corner(c)}});
}

void ObjModel::quad(const Vertex& a, const Vertex& b, const Vertex& c, const Vertex& d) {
  triangle(a, b, c);
  triangle(a, c, d);
}

Vertex ObjModel::flatVertex(const glm::dvec3& position, const glm::dvec3& normal) const {
  const glm::dvec3 size = glm::abs(normal);
  glm::dvec2 texcoord{position.x, position.y};
  if (size.x > size.y && size.x > size.z) texcoord = {position.z, position.y};
  if (size.y >= size.x && size.y > size.z) texcoord = {position.x, position.z};
  return {position, normal, texcoord / textureSize};
}

void ObjModel::flatTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 cross = glm::cross(b - a, c - a);
  // A triangle without area has no normal. The stress models contain such triangles on purpose.
  const glm::dvec3 normal = glm::length(cross) > 0 ? glm::normalize(cross) : glm::dvec3(0, 1, 0);
  triangle(flatVertex(a, normal), flatVertex(b, normal), flatVertex(c, normal));
}

void ObjModel::flatQuad(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
  flatTriangle(a, b, c);
  flatTriangle(a, c, d);
}

void ObjModel::box(const glm::dvec3& low, const glm::dvec3& high, Facing facing, const std::string& faces) {
  const auto face = [&](char name, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                        const glm::dvec3& d) {
    if (faces.find(name) == std::string::npos) return;
    facing == Facing::outward ? flatQuad(a, b, c, d) : flatQuad(d, c, b, a);
  };
  const glm::dvec3 l = low, h = high;
  face('x', {l.x, l.y, l.z}, {l.x, l.y, h.z}, {l.x, h.y, h.z}, {l.x, h.y, l.z});
  face('X', {h.x, l.y, h.z}, {h.x, l.y, l.z}, {h.x, h.y, l.z}, {h.x, h.y, h.z});
  face('y', {l.x, l.y, l.z}, {h.x, l.y, l.z}, {h.x, l.y, h.z}, {l.x, l.y, h.z});
  face('Y', {l.x, h.y, h.z}, {h.x, h.y, h.z}, {h.x, h.y, l.z}, {l.x, h.y, l.z});
  face('z', {h.x, l.y, l.z}, {l.x, l.y, l.z}, {l.x, h.y, l.z}, {h.x, h.y, l.z});
  face('Z', {l.x, l.y, h.z}, {h.x, l.y, h.z}, {h.x, h.y, h.z}, {l.x, h.y, h.z});
}

void ObjModel::ring(const glm::dvec2& inner, const glm::dvec2& outer, double y0, double y1) {
  // The four corners in counter-clockwise order as seen from above (Y towards the eye).
  const auto at = [](const glm::dvec2& extent, int i, double y) {
    static const glm::dvec2 kSigns[4] = {{-1, 1}, {1, 1}, {1, -1}, {-1, -1}};
    return glm::dvec3(extent.x * kSigns[i % 4].x, y, extent.y * kSigns[i % 4].y);
  };
  for (int i = 0; i < 4; ++i) {
    flatQuad(at(outer, i, y1), at(outer, i + 1, y1), at(inner, i + 1, y1), at(inner, i, y1));  // top
    flatQuad(at(inner, i, y0), at(inner, i + 1, y0), at(outer, i + 1, y0), at(outer, i, y0));  // bottom
    flatQuad(at(outer, i, y0), at(outer, i + 1, y0), at(outer, i + 1, y1), at(outer, i, y1));  // outside
    flatQuad(at(inner, i + 1, y0), at(inner, i, y0), at(inner, i, y1), at(inner, i + 1, y1));  // inside
  }
}

std::string ObjModel::objText() const {
  std::string text = fmt::format("# {}\nmtllib {}.mtl\n", comment_, name_);
  for (const std::string& line : positions_) text += "v " + line + '\n';
  for (const std::string& line : texcoords_) text += "vt " + line + '\n';
  if (writesNormals)
    for (const std::string& line : normals_) text += "vn " + line + '\n';
  int object = -1, material = -1;
  for (const Face& face : faces_) {
    if (face.object != object) {
      object = face.object;
      material = -1;
      text += "o " + objects_[static_cast<std::size_t>(object)] + '\n';
    }
    if (face.material != material) {
      material = face.material;
      text += "usemtl " + materials_[static_cast<std::size_t>(material)].name + '\n';
    }
    text += 'f';
    for (const glm::ivec3& c : face.corners)
      text += writesNormals ? fmt::format(" {}/{}/{}", c.x + 1, c.y + 1, c.z + 1)
                            : fmt::format(" {}/{}", c.x + 1, c.y + 1);
    text += '\n';
  }
  return text;
}

std::string ObjModel::mtlText() const {
  std::string text = "# " + comment_ + '\n';
  for (const ObjMaterial& material : materials_) {
    text += fmt::format("\nnewmtl {}\nKd {}\n", material.name, vectorText(material.diffuse, 4));
    if (material.specular != glm::dvec3(0))
      text += fmt::format("Ks {}\nNs {}\n", vectorText(material.specular, 4), decimal(material.exponent, 2));
    if (material.emission != glm::dvec3(0)) text += fmt::format("Ke {}\n", vectorText(material.emission, 4));
    if (!material.diffuseMap.empty()) text += "map_Kd " + material.diffuseMap + '\n';
    if (!material.maskMap.empty()) text += "map_d " + material.maskMap + '\n';
  }
  return text;
}

void ObjModel::write(const std::filesystem::path& directory) const {
  writeFileAtomically(directory / (name_ + ".obj"), objText());
  writeFileAtomically(directory / (name_ + ".mtl"), mtlText());
}

}  // namespace lumivox::models
