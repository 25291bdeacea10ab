// PLY models: both forms, all scalar types, good and bad files.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "framework/one_mesh.h"
#include "framework/one_model.h"
#include "support/facts.h"
#include "support/gzip.h"

using namespace lumivox;
using lumivox::test::Tells;
using test::cornersOf, test::OneModel;

namespace {

const char* const kTriangleHeader =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

std::string asciiTriangle() {
  return std::string("ply\nformat ascii 1.0\ncomment made by a test\n") + kTriangleHeader +
         "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
}

template <class T>
std::string bytesOf(T value, bool isBig) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
  if (isBig) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

/// Two triangles that share an edge, as one quad, in doubles and 16-bit indices.
std::string binaryQuad(bool isBig) {
  std::string file = fmt::format(
      "ply\nformat binary_{}_endian 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement edge 1\nproperty int a\n"
      "element face 1\nproperty list int ushort vertex_index\nproperty float quality\nend_header\n",
      isBig ? "big" : "little");
  for (const auto& [x, y] : {std::pair(0.0, 0.0), {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
    for (const double value : {x, y, 0.25}) file += bytesOf(value, isBig);
    file += std::string("\xFF\xBC\x00", 3);
  }
  file += bytesOf(std::int32_t{7}, isBig) + bytesOf(std::int32_t{4}, isBig);
  for (const std::uint16_t index : {0, 1, 2, 3}) file += bytesOf(index, isBig);
  return file + bytesOf(1.0f, isBig);
}

}  // namespace

TEST_CASE("a PLY triangle is the triangle of the same OBJ file to the bit") {
  const Scene ply = OneModel("m.ply", asciiTriangle()).load(), obj = test::OneMesh(test::kTriangle).load();
  CHECK(cornersOf(ply) == cornersOf(obj));
  CHECK(ply.normals == obj.normals);
  CHECK(ply.materials == obj.materials);
  CHECK(ply.objects.at(0).name == "m");
}

TEST_CASE("binary PLY files of both byte orders are read alike, and polygons are cut as fans") {
  for (const bool isBig : {false, true}) {
    CAPTURE(isBig);
    const Scene scene = OneModel("m.ply", binaryQuad(isBig)).load();
    CHECK(cornersOf(scene) ==
          std::vector<glm::vec3>{
              {0, 0, 0.25f}, {1, 0, 0.25f}, {1, 1, 0.25f}, {0, 0, 0.25f}, {1, 1, 0.25f}, {0, 1, 0.25f}});
    // The mean of the colours, from sRGB: 255, 188 and 0.
    CHECK(scene.materials.at(0).diffuse.r == Approx(1.0f));
    CHECK(scene.materials.at(0).diffuse.g == Approx(0.502886f).epsilon(1e-5));
    CHECK(scene.materials.at(0).diffuse.b == 0.0f);
  }
}

TEST_CASE("floats of a binary PLY file are kept to the bit with normals and texture coordinates") {
  std::string file =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float nx\nproperty float ny\n"
      "property float nz\nproperty float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\n"
      "element face 1\nproperty list uchar uint vertex_indices\nend_header\n";
  const std::vector<std::array<float, 8>> vertices{{0, 0, 2, 0.1f, 0.2f, 0.3f, 0, 0},
                                                   {0, 0, 1, 1.1f, 0.2f, 0.3f, 1, 0},
                                                   {0, 0, 1, 0.1f, 1.7f, 0.3f, 0, 0.75f}};
  for (const auto& vertex : vertices)
    for (const float value : vertex) file += bytesOf(value, false);
  file += '\3';
  for (const std::uint32_t index : {0u, 1u, 2u}) file += bytesOf(index, false);
  const Scene scene = OneModel("m.ply", file).load();
  CHECK(scene.positions ==
        std::vector<glm::vec3>{{0.1f, 0.2f, 0.3f}, {1.1f, 0.2f, 0.3f}, {0.1f, 1.7f, 0.3f}});
  for (const glm::vec3& normal : scene.normals) CHECK(normal == glm::vec3(0, 0, 1));
  CHECK(scene.texcoords.at(2) == glm::vec2(0, 0.75f));
}

TEST_CASE("a gzip-compressed PLY file is the file") {
  CHECK(OneModel("m.ply.gz", test::gzip(asciiTriangle())).load().triangleCount() == 1);
}

TEST_CASE("each way in which a PLY file can be none gives one error with its line or byte") {
  const std::string good = asciiTriangle();
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = good;
    changed.replace(changed.find(from), from.size(), to);
    return changed;
  };
  const std::vector<std::pair<std::string, Tells>> files{
      {"", Tells("m.ply:1", "header")},
      {"solid x\n", Tells("m.ply:1", "'ply'")},
      {with("ascii", "text"), Tells("m.ply:2", "format", "ascii")},
      {with("vertex 3", "vertex many"), Tells("m.ply:4", "element")},
      {with("float x", "real x"), Tells("m.ply:5", "property")},
      {with("uchar int", "float int"), Tells("m.ply:9", "list")},
      {with("end_header", "the_end"), Tells("m.ply:10", "the_end", "end_header")},
      {with("vertex 3", "vertex 3000000000"), Tells("m.ply", "bytes", "truncated")},
      {with("float z", "float w"), Tells("m.ply", 2, "x, y and z")},
      {with("vertex_indices", "corners"), Tells("m.ply", "vertex_indices")},
      {with("3 0 1 2", "3 0 1 3"), Tells("m.ply", "byte", "face 0", "vertex 3", 3)},
      {with("3 0 1 2", "3 0 1 -1"), Tells("m.ply", "byte", "vertex -1")},
      {with("3 0 1 2", "2 0 1"), Tells("m.ply", "byte", 2, "corners")},
      {with("1 0 0", "1 x 0"), Tells("m.ply", "byte", "'x'", "number")},
      {good.substr(0, good.size() - 3), Tells("m.ply", "truncated")},
      {with("element face 1", "element line 1"), Tells("m.ply", "faces")},
      {with("0 1 0\n3", "1 0 0\n3"), Tells("no triangle")},
      {with("end_header", "element vertex 0\nproperty float q\nend_header"),
       Tells("m.ply", "'vertex' twice")},
  };
  for (const auto& [file, told] : files) {
    CAPTURE(file.substr(0, 300));
    CHECK_THAT(OneModel("m.ply", file).error(), told);
  }
  const std::string quad = binaryQuad(false);
  for (std::size_t size = quad.size() - 40; size < quad.size(); ++size)
    CHECK_THAT(OneModel("m.ply", quad.substr(0, size)).error(), Tells("m.ply", "byte", "truncated"));
}

TEST_CASE(
    "a triangle of a PLY file that is not finite or flat is dropped with a warning, and strict refuses it") {
  const std::string file = std::string(
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
      "property float z\nelement face 3\nproperty list uchar int vertex_indices\n"
      "end_header\n0 0 0\n1 0 0\n0 1 0\nnan 0 0\n2 0 0\n3 0 1 2\n3 0 1 3\n3 0 1 4\n");
  const OneModel model("m.ply", file);
  const auto [scene, log] = model.logged();
  CHECK(scene.triangleCount() == 1);
  CHECK_THAT(log, Tells("m.ply", "2 of 3", "finite", "triangle 1", "area", "triangle 2"));
  CHECK_THROWS_MATCHES(model.load(true), Error, Tells("--strict"));
}
