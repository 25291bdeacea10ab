// A glTF file in which everything moves: a bar that a skin bends, and a cube that turns and swells by a morph
// target. For tests and for a scene that needs no other model.
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "lumivox/base/file.h"
#include "models.h"

namespace lumivox::models {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Accessors of one buffer, as JSON and as bytes.
class Accessors {
 public:
  int floats(const std::vector<float>& values, const std::string& type, std::size_t components,
             const std::string& more = "") {
    return add(values.data(), values.size() * sizeof(float), 5126, values.size() / components, type, more);
  }
  int indices(const std::vector<std::uint16_t>& values) {
    return add(values.data(), values.size() * sizeof(std::uint16_t), 5123, values.size(), "SCALAR", "");
  }
  int joints(const std::vector<std::uint8_t>& values) {
    return add(values.data(), values.size(), 5121, values.size() / 4, "VEC4", "");
  }

  /// The members "buffers", "bufferViews" and "accessors" of a .glb file.
  std::string members() const {
    return fmt::format("\"buffers\":[{{\"byteLength\":{}}}],\n\"bufferViews\":[\n{}],\n\"accessors\":[\n{}]",
                       bytes_.size(), fmt::join(views_, ",\n"), fmt::join(accessors_, ",\n"));
  }
  const std::string& bytes() const { return bytes_; }

 private:
  int add(const void* data, std::size_t size, int componentType, std::size_t count, const std::string& type,
          const std::string& more) {
    while (bytes_.size() % 4 != 0) bytes_ += '\0';
    views_.push_back(
        fmt::format("{{\"buffer\":0,\"byteOffset\":{},\"byteLength\":{}}}", bytes_.size(), size));
    accessors_.push_back(
        fmt::format("{{\"bufferView\":{},\"componentType\":{},\"count\":{},\"type\":\"{}\"{}}}",
                    views_.size() - 1, componentType, count, type, more));
    bytes_.append(static_cast<const char*>(data), size);
    return static_cast<int>(accessors_.size()) - 1;
  }

  std::string bytes_;
  std::vector<std::string> views_, accessors_;
};

void push(std::vector<float>& values, const glm::dvec3& v) {
  for (int i = 0; i < 3; ++i) values.push_back(static_cast<float>(v[i]));
}

/// A rotation about an axis of the coordinates, as x y z w.
void pushTurn(std::vector<float>& values, int axis, double angle) {
  glm::dvec4 quaternion(0, 0, 0, std::cos(0.5 * angle));
  quaternion[axis] = std::sin(0.5 * angle);
  for (int i = 0; i < 4; ++i) values.push_back(static_cast<float>(quaternion[i]));
}

/// The four sides of a bar along y, 1.6 m high, of rings that a joint at half its height bends. The
/// attributes of its primitive.
std::string bar(Accessors& accessors) {
  constexpr int kRings = 17;
  constexpr double kHalf = 0.1, kHeight = 1.6;
  std::vector<float> positions, normals, weights;
  std::vector<std::uint8_t> joints;
  std::vector<std::uint16_t> indices;
  for (int side = 0; side < 4; ++side) {
    const glm::dvec3 outward[4] = {{0, 0, 1}, {1, 0, 0}, {0, 0, -1}, {-1, 0, 0}};
    const glm::dvec3 normal = outward[side], along = outward[(side + 1) % 4];
    for (int ring = 0; ring < kRings; ++ring) {
      const double height = kHeight * ring / (kRings - 1);
      const double t = std::fmin(std::fmax((height - 0.6) / 0.4, 0.0), 1.0);
      const double upper = t * t * (3 - 2 * t);
      for (const double end : {-1.0, 1.0}) {
        push(positions, kHalf * (normal + end * along) + glm::dvec3(0, height, 0));
        push(normals, normal);
        joints.insert(joints.end(), {0, 1, 0, 0});
        weights.insert(weights.end(), {static_cast<float>(1 - upper), static_cast<float>(upper), 0, 0});
      }
      if (ring + 1 == kRings) continue;
      const int first = 2 * (side * kRings + ring);
      for (const int corner : {0, 1, 3, 0, 3, 2})
        indices.push_back(static_cast<std::uint16_t>(first + corner));
    }
  }
  return fmt::format(
      "\"attributes\":{{\"POSITION\":{},\"NORMAL\":{},\"JOINTS_0\":{},\"WEIGHTS_0\":{}}},\"indices\":{}",
      accessors.floats(positions, "VEC3", 3), accessors.floats(normals, "VEC3", 3), accessors.joints(joints),
      accessors.floats(weights, "VEC4", 4), accessors.indices(indices));
}

/// A cube of 0.5 m whose faces are 4 x 4 quads; the morph target puts its points on a sphere.
std::string cube(Accessors& accessors) {
  constexpr int kQuads = 4;
  constexpr double kHalf = 0.25, kRadius = 0.4;
  std::vector<float> positions, deltas;
  std::vector<std::uint16_t> indices;
  for (int face = 0; face < 6; ++face) {
    glm::dvec3 normal(0), u(0);
    normal[face % 3] = face < 3 ? 1 : -1;
    u[(face + 1) % 3] = 1;
    const glm::dvec3 v = glm::cross(normal, u);
    const int first = face * (kQuads + 1) * (kQuads + 1);
    for (int j = 0; j <= kQuads; ++j)
      for (int i = 0; i <= kQuads; ++i) {
        const glm::dvec3 place = kHalf * (normal + (2.0 * i / kQuads - 1) * u + (2.0 * j / kQuads - 1) * v);
        push(positions, place);
        push(deltas, kRadius * glm::normalize(place) - place);
        if (i == kQuads || j == kQuads) continue;
        const int corner = first + j * (kQuads + 1) + i;
        for (const int next : {0, 1, kQuads + 2, 0, kQuads + 2, kQuads + 1})
          indices.push_back(static_cast<std::uint16_t>(corner + next));
      }
  }
  return fmt::format("\"attributes\":{{\"POSITION\":{}}},\"indices\":{},\"targets\":[{{\"POSITION\":{}}}]",
                     accessors.floats(positions, "VEC3", 3), accessors.indices(indices),
                     accessors.floats(deltas, "VEC3", 3));
}

/// A loop of two seconds: the bar bends to both sides, the cube turns once and swells twice.
std::string animation(Accessors& accessors) {
  const int quarters = accessors.floats({0, 0.5f, 1, 1.5f, 2}, "SCALAR", 1, ",\"min\":[0],\"max\":[2]");
  std::vector<float> bends, turns;
  for (const double degrees : {0, 40, 0, -40, 0}) pushTurn(bends, 2, degrees * kPi / 180);
  for (const double degrees : {0, 90, 180, 270, 360}) pushTurn(turns, 1, degrees * kPi / 180);
  return fmt::format(
      "\"animations\":[{{\"name\":\"play\",\"samplers\":[{{\"input\":{0},\"output\":{1}}},{{\"input\":{0},\"output\":"
      "{2}}},{{\"input\":{0},\"output\":{3}}}],\n\"channels\":[{{\"sampler\":0,\"target\":{{\"node\":2,\"path\":"
      "\"rotation\"}}}},{{\"sampler\":1,\"target\":{{\"node\":3,\"path\":\"rotation\"}}}},{{\"sampler\":2,\"target\":"
      "{{\"node\":3,\"path\":\"weights\"}}}}]}}]",
      quarters, accessors.floats(bends, "VEC4", 4), accessors.floats(turns, "VEC4", 4),
      accessors.floats({0, 1, 0, 1, 0}, "SCALAR", 1));
}

std::string number(std::size_t value) {
  const auto bits = static_cast<std::uint32_t>(value);
  std::string bytes(4, '\0');
  std::memcpy(bytes.data(), &bits, 4);
  return bytes;
}

}  // namespace

void writeMovingShapes(const std::filesystem::path& directory) {
  Accessors accessors;
  const std::string barText = bar(accessors), cubeText = cube(accessors);
  const int bind = accessors.floats(
      {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -0.8f, 0, 1},
      "MAT4", 16);
  const std::string play = animation(accessors);
  std::string json = fmt::format(
      "{{\"asset\":{{\"version\":\"2.0\",\"generator\":\"make_models\"}},\n\"extensionsUsed\":[\"KHR_lights_punctual\"],\n"
      "\"extensions\":{{\"KHR_lights_punctual\":{{\"lights\":[{{\"name\":\"lamp\",\"type\":\"point\",\"intensity\":6830}}]}}}},\n"
      "\"scene\":0,\"scenes\":[{{\"nodes\":[0,1,3,4,5]}}],\n\"nodes\":[\n"
      "{{\"name\":\"bar\",\"mesh\":0,\"skin\":0}},\n{{\"name\":\"lower\",\"translation\":[-0.6,0,0],\"children\":[2]}},\n"
      "{{\"name\":\"upper\",\"translation\":[0,0.8,0]}},\n{{\"name\":\"cube\",\"mesh\":1,\"translation\":[0.6,0.6,0]}},\n"
      "{{\"name\":\"view\",\"camera\":0,\"translation\":[0,0.8,4]}},\n"
      "{{\"name\":\"lamp\",\"translation\":[0.5,2.5,1.5],\"extensions\":{{\"KHR_lights_punctual\":{{\"light\":0}}}}}}],\n"
      "\"cameras\":[{{\"type\":\"perspective\",\"perspective\":{{\"yfov\":0.7,\"znear\":0.01}}}}],\n"
      "\"materials\":[{{\"name\":\"copper\",\"pbrMetallicRoughness\":{{\"baseColorFactor\":[0.95,0.64,0.54,1],"
      "\"metallicFactor\":0.5,\"roughnessFactor\":0.4}}}},\n{{\"name\":\"clay\",\"pbrMetallicRoughness\":{{"
      "\"baseColorFactor\":[0.3,0.5,0.7,1],\"metallicFactor\":0,\"roughnessFactor\":0.8}}}}],\n"
      "\"meshes\":[{{\"primitives\":[{{{},\"material\":0}}]}},\n{{\"primitives\":[{{{},\"material\":1}}]}}],\n"
      "\"skins\":[{{\"joints\":[1,2],\"inverseBindMatrices\":{}}}],\n{},\n{}}}\n",
      barText, cubeText, bind, play, accessors.members());
  while (json.size() % 4 != 0) json += ' ';
  std::string binary = accessors.bytes();
  while (binary.size() % 4 != 0) binary += '\0';
  writeFileAtomically(directory / "moving_shapes.glb",
                      "glTF" + number(2) + number(12 + 8 + json.size() + 8 + binary.size()) +
                          number(json.size()) + "JSON" + json + number(binary.size()) +
                          std::string("BIN\0", 4) + binary);
}

}  // namespace lumivox::models
