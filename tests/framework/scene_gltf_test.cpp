// glTF models that stand still: containers, accessors, hierarchy, materials; good and bad files.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "framework/one_mesh.h"
#include "framework/one_model.h"
#include "support/facts.h"
#include "support/gltf_files.h"

using namespace lumivox;
using lumivox::test::Tells;
using test::base64, test::cornersOf, test::GltfWriter, test::OneModel, test::triangleBody;

namespace {

/// A triangle whose material has these members; `primitive` as in triangleBody().
std::string withMaterial(const std::string& material, const std::string& more = "",
                         const std::string& primitive = "") {
  GltfWriter writer;
  const std::string body = triangleBody(writer, "", R"(,"material":0)" + primitive);
  return writer.gltf(body + R"(,"materials":[{"name":"paint",)" + material + "}]" + more);
}

/// A cube of side 2 as in test::kCube: 8 vertices and 12 triangles, with the indices `Index`.
template <class Index>
std::string cube() {
  GltfWriter writer;
  std::vector<float> positions;
  for (const auto& [x, y, z] : {std::array{-1, -1, -1},
                                {1, -1, -1},
                                {1, 1, -1},
                                {-1, 1, -1},
                                {-1, -1, 1},
                                {1, -1, 1},
                                {1, 1, 1},
                                {-1, 1, 1}})
    for (const int value : {x, y, z}) positions.push_back(static_cast<float>(value));
  std::vector<Index> indices;
  for (const auto& quad :
       {std::array{1, 4, 3, 2}, {5, 6, 7, 8}, {1, 2, 6, 5}, {3, 4, 8, 7}, {2, 3, 7, 6}, {1, 5, 8, 4}})
    for (const int corner : {0, 1, 3, 1, 2, 3})
      indices.push_back(static_cast<Index>(quad[static_cast<std::size_t>(corner)] - 1));
  const int p = writer.numbers(positions, "VEC3"), i = writer.numbers(indices, "SCALAR");
  return writer.gltf(fmt::format(
      R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{}}},"indices":{}}}]}}])",
      p, i));
}

std::string pngOf(int width, int height, int channels, const std::vector<unsigned char>& values) {
  return test::tga(width, height, channels, values);
}

}  // namespace

TEST_CASE("a glTF triangle is the triangle of the same OBJ file to the bit, in each container") {
  const Scene obj = test::OneMesh(test::kTriangle).load();
  GltfWriter writer;
  const std::string body = triangleBody(writer);
  const OneModel beside("m.gltf", writer.gltf(body, "m%20x.bin"));
  beside.directory.write("m x.bin", writer.binary());
  for (const Scene& scene : {OneModel("m.gltf", writer.gltf(body)).load(),
                             OneModel("m.glb", writer.glb(body)).load(), beside.load()}) {
    CHECK(cornersOf(scene) == cornersOf(obj));
    CHECK(scene.normals == obj.normals);
    CHECK(scene.materials.at(0).diffuse == obj.materials.at(0).diffuse);
    CHECK(scene.objects.at(0).name == "m/triangle");
  }
}

TEST_CASE("a cube with indices of every width is the cube of the same OBJ file to the bit") {
  const Scene obj = test::OneMesh(test::kCube).load();
  for (const std::string& file : {cube<std::uint8_t>(), cube<std::uint16_t>(), cube<std::uint32_t>()}) {
    const Scene scene = OneModel("m.gltf", file).load();
    CHECK(cornersOf(scene) == cornersOf(obj));
    REQUIRE(scene.indices.size() == obj.indices.size());
    for (std::size_t i = 0; i < scene.indices.size(); ++i)
      CHECK(scene.normals[scene.indices[i]] == obj.normals[obj.indices[i]]);
  }
}

TEST_CASE("every kind of accessor gives the same positions") {
  const std::vector<glm::vec3> expected{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const auto sceneOf = [](GltfWriter& writer, int positions) {
    return OneModel("m.gltf", writer.gltf(fmt::format(
                                  R"("extensionsUsed":["KHR_mesh_quantization"],"nodes":[{{"mesh":0}}],)"
                                  R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":{}}}}}]}}])",
                                  positions)))
        .load();
  };
  const auto check = [&](GltfWriter& writer, int positions) {
    CHECK(cornersOf(sceneOf(writer, positions)) == expected);
  };
  const auto integers = [&](auto one, const char* more, std::size_t stride) {
    using T = decltype(one);
    GltfWriter writer;
    // Elements begin at multiples of four bytes.
    std::vector<T> values;
    for (const auto& [x, y, z] : {std::array<T, 3>{0, 0, 0}, {one, 0, 0}, {0, one, 0}}) {
      values.insert(values.end(), {x, y, z});
      while (values.size() * sizeof(T) % stride != 0) values.push_back(0);
    }
    const int view = writer.view(values);
    std::string accessor = fmt::format(
        R"({{"bufferView":{},"componentType":{},"count":3,"type":"VEC3"{}}})", view,
        std::is_signed_v<T> ? (sizeof(T) == 1 ? 5120 : 5122) : (sizeof(T) == 1 ? 5121 : 5123), more);
    const int index = writer.accessor(accessor);
    // The stride belongs to the view.
    std::string file = writer.gltf(fmt::format(
        R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{}}}}}]}}])", index));
    file.insert(file.find("\"byteLength\"", file.find("bufferViews")),
                fmt::format("\"byteStride\":{},", stride));
    CHECK(cornersOf(OneModel("m.gltf", file).load()) == expected);
  };
  integers(std::uint8_t{255}, R"(,"normalized":true)", 4);
  integers(std::int8_t{127}, R"(,"normalized":true)", 4);
  integers(std::uint16_t{65535}, R"(,"normalized":true)", 8);
  integers(std::int16_t{32767}, R"(,"normalized":true)", 8);
  integers(std::uint8_t{1}, "", 4);
  integers(std::int16_t{1}, "", 8);
  {
    GltfWriter writer;  // floats, sparse over a base
    const int base = writer.view<float>({0, 0, 0, 9, 9, 9, 0, 1, 0}),
              indices = writer.view<std::uint8_t>({1}), values = writer.view<float>({1, 0, 0});
    check(writer,
          writer.accessor(fmt::format(
              R"({{"bufferView":{},"componentType":5126,"count":3,"type":"VEC3","sparse":{{"count":1,)"
              R"("indices":{{"bufferView":{},"componentType":5121}},"values":{{"bufferView":{}}}}}}})",
              base, indices, values)));
  }
  {
    GltfWriter writer;  // sparse over zeros
    const int indices = writer.view<std::uint16_t>({1, 2}), values = writer.view<float>({1, 0, 0, 0, 1, 0});
    check(writer,
          writer.accessor(fmt::format(
              R"({{"componentType":5126,"count":3,"type":"VEC3","sparse":{{"count":2,)"
              R"("indices":{{"bufferView":{},"componentType":5123}},"values":{{"bufferView":{}}}}}}})",
              indices, values)));
  }
}

TEST_CASE("strips and fans are cut into triangles of one winding, points and lines are named once") {
  const auto sceneOf = [](int mode) {
    GltfWriter writer;
    // Of a strip: 0 1 2, then 1 3 2; of a fan about its first vertex.
    const int positions = writer.numbers<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 2, 1, 0}, "VEC3");
    return OneModel("m.gltf", writer.gltf(fmt::format(R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[)"
                                                      R"({{"attributes":{{"POSITION":{0}}},"mode":{1}}},)"
                                                      R"({{"attributes":{{"POSITION":{0}}},"mode":1}}]}}])",
                                                      positions, mode)))
        .logged();
  };
  const auto [strip, log] = sceneOf(5);
  CHECK(cornersOf(strip) ==
        std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 0, 0}, {2, 1, 0}, {1, 1, 0}});
  CHECK_THAT(log, Tells("points and lines"));
  CHECK(cornersOf(sceneOf(6).first) ==
        std::vector<glm::vec3>{{1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {2, 1, 0}, {0, 0, 0}});
}

TEST_CASE(
    "nodes place their meshes through all their parents, and those that share a mesh are objects of their own") {
  GltfWriter writer;
  const int positions = writer.numbers<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  const std::string body = fmt::format(
      R"("scene":1,"scenes":[{{}},{{"nodes":[0]}}],"nodes":[)"
      R"({{"name":"root","translation":[1,2,3],"scale":[2,2,2],"children":[1,2]}},)"
      R"({{"name":"a b/c","mesh":0,"rotation":[0,0,0.70710678118654752,0.70710678118654752]}},)"
      R"({{"name":"a b/c","mesh":0,"matrix":[1,0,0,0, 0,1,0,0, 0,0,-1,0, 0,0,5,1]}},)"
      R"({{"name":"elsewhere","mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{}}}}}]}}])",
      positions);
  const Scene scene = OneModel("m.gltf", writer.gltf(body), "scale 10").load();
  REQUIRE(scene.objects.size() == 2);
  CHECK(scene.objects[0].name == "m/a_b_c");
  CHECK(scene.objects[1].name == "m/a_b_c_2");
  const auto placed = [&](std::size_t object, std::uint32_t vertex) {
    const Object& one = scene.objects[object];
    return glm::dvec3(one.placement * glm::dvec4(glm::dvec3(scene.positions[one.firstVertex + vertex]), 1.0));
  };
  // A quarter turn about z puts x on y: 10 ((1,2,3) + 2 (0,1,0)).
  CHECK(glm::length(placed(0, 1) - glm::dvec3(10, 40, 30)) < 1e-9);
  CHECK(glm::length(placed(1, 0) - glm::dvec3(10, 20, 130)) < 1e-9);
  // A mirrored node keeps its front side: normals go by the inverse transpose.
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  CHECK(glm::normalize(snapshot.objects[1].normalToWorld * scene.normals[scene.objects[1].firstVertex]).z ==
        Approx(-1.0f));
  // The winding of its triangles in the world, by which surfaces shine and are drawn, agrees.
  const std::uint32_t* triangle = &scene.indices[scene.objects[1].parts[0].firstIndex];
  const auto corner = [&](int k) { return placed(1, triangle[k] - scene.objects[1].firstVertex); };
  CHECK(glm::cross(corner(1) - corner(0), corner(2) - corner(0)).z < 0.0);
}

TEST_CASE("primitives of a mesh are parts of one object, which use and without select by material") {
  GltfWriter writer;
  const int a = writer.numbers<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3"),
            b = writer.numbers<float>({0, 0, 1, 1, 0, 1, 0, 1, 1}, "VEC3");
  const std::string file = writer.gltf(fmt::format(
      R"("nodes":[{{"mesh":0,"name":"lamp"}}],"meshes":[{{"primitives":[)"
      R"({{"attributes":{{"POSITION":{}}},"material":0}},{{"attributes":{{"POSITION":{}}},"material":1}}]}}],)"
      R"("materials":[{{"name":"shade"}},{{"name":"bulb"}}])",
      a, b));
  const Scene scene = OneModel("m.gltf", file, "use { mtl bulb  material white }",
                               "material white { diffuse 0.5 }\nlight glow area { mesh m/lamp  radiance 3 }")
                          .load();
  REQUIRE(scene.objects.size() == 1);
  REQUIRE(scene.objects[0].parts.size() == 2);
  CHECK(scene.materials.at(0).name == "m/shade@glow");
  CHECK(scene.materials.at(1).diffuse == glm::vec3(0.5f));
  CHECK(scene.materials.at(1).emission == glm::vec3(3.0f));
  CHECK(OneModel("m.gltf", file, "without { mtl bulb }").load().triangleCount() == 1);
}

TEST_CASE("metallic-roughness factors become lobes that reflect at most what they receive") {
  const auto materialOf = [](const std::string& factors) {
    return OneModel("m.gltf", withMaterial("\"pbrMetallicRoughness\":{" + factors + "}"))
        .load()
        .materials.at(0);
  };
  const Material matt =
      materialOf(R"("baseColorFactor":[0.5,0.25,0,1],"metallicFactor":0,"roughnessFactor":1)");
  CHECK(matt.diffuse.r == Approx(2.0f * matt.diffuse.g));
  CHECK(matt.diffuse.r == Approx(0.5f * 0.96f).epsilon(0.01));
  CHECK(matt.diffuse.b == 0.0f);
  CHECK(matt.specular.r < 0.04f);
  const Material metal =
      materialOf(R"("baseColorFactor":[0.5,0.25,0,1],"metallicFactor":1,"roughnessFactor":0.1)");
  CHECK(metal.diffuse == glm::vec3(0.0f));
  CHECK(metal.specular.r == Approx(0.5f).epsilon(0.01));
  CHECK(metal.exponent == Approx(std::numbers::ln2 / (2 * (std::numbers::sqrt2 - 1) * 1e-4)).epsilon(0.01));
  for (const double metallic : {0.0, 0.3, 1.0})
    for (const double roughness : {0.0, 0.3, 0.6, 1.0}) {
      const Material white =
          materialOf(fmt::format(R"("metallicFactor":{},"roughnessFactor":{})", metallic, roughness));
      CHECK(white.diffuse.r + white.specular.r <= 1.0f);
    }
}

TEST_CASE("a base colour texture keeps its file, its transform and its place") {
  const std::string image = pngOf(2, 1, 3, {255, 0, 0, 0, 0, 255});
  GltfWriter writer;
  const int uv = writer.numbers<float>({0, 0, 1, 0, 0, 1}, "VEC2");
  const int positions = writer.numbers<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  const auto fileOf = [&](const std::string& uri, const std::string& transform) {
    return writer.gltf(fmt::format(
        R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{},"TEXCOORD_0":{}}},)"
        R"("material":0}}]}}],"materials":[{{"pbrMetallicRoughness":{{"metallicFactor":0,"baseColorTexture":)"
        R"({{"index":0{}}}}}}}],"textures":[{{"source":0}}],"images":[{{"uri":"{}"}}])",
        positions, uv, transform, uri));
  };
  const OneModel beside("m.gltf", fileOf("i.tga", ""));
  beside.directory.write("i.tga", image);
  const Scene scene = beside.load();
  REQUIRE(scene.textures.size() == 1);
  CHECK(scene.textures[0].values == std::vector<float>{1, 0, 0, 0, 0, 1});
  // v runs down in the file and up in a scene.
  CHECK(scene.texcoords == std::vector<glm::vec2>{{0, 1}, {1, 1}, {0, 0}});
  const Scene embedded = OneModel("m.gltf", fileOf("data:image/png;base64," + base64(image), "")).load();
  CHECK(embedded.textures == [&] {
    auto expected = scene.textures;
    expected[0].name = "image_0";
    return expected;
  }());
  // A quarter turn, counter-clockwise on the image: (1, 0) goes to (0, -1), with v down.
  const Scene turned =
      OneModel("m.gltf",
               fileOf("data:image/png;base64," + base64(image),
                      R"(,"extensions":{"KHR_texture_transform":{"offset":[0.5,0.25],"scale":[2,3],)"
                      R"("rotation":1.5707963267948966}})"))
          .load();
  CHECK(glm::distance(turned.texcoords.at(0), glm::vec2(0.5f, 0.75f)) < 1e-6f);
  CHECK(glm::distance(turned.texcoords.at(1), glm::vec2(0.5f, 2.75f)) < 1e-6f);
  CHECK(glm::distance(turned.texcoords.at(2), glm::vec2(3.5f, 0.75f)) < 1e-6f);
}

TEST_CASE("an alpha mask is a hole below its cut-off, and blending is told and made a mask") {
  const std::string images = R"(,"textures":[{"source":0}],"images":[{"uri":"data:image/x;base64,)" +
                             base64(pngOf(2, 1, 4, {9, 9, 9, 60, 9, 9, 9, 70})) + "\"}]";
  const std::string texture = R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0}},)";
  const Scene scene =
      OneModel("m.gltf", withMaterial(texture + R"("alphaMode":"MASK","alphaCutoff":0.25)", images)).load();
  const Material& material = scene.materials.at(0);
  REQUIRE(material.maskTexture >= 0);
  const std::vector<float>& coverage =
      scene.textures.at(static_cast<std::size_t>(material.maskTexture)).values;
  CHECK(coverage.at(0) < 0.5f);  // 60/255 < 0.25 < 70/255
  CHECK(coverage.at(1) > 0.5f);
  const auto [blended, log] =
      OneModel("m.gltf", withMaterial(texture + R"("alphaMode":"BLEND")", images)).logged();
  CHECK(blended.materials.at(0).maskTexture >= 0);
  CHECK_THAT(log, Tells("blending", "hole"));
  CHECK(OneModel("m.gltf", withMaterial(texture + R"("alphaMode":"OPAQUE")", images))
            .load()
            .materials.at(0)
            .maskTexture == -1);
  // An image without alpha covers everything.
  const std::string opaque = R"(,"textures":[{"source":0}],"images":[{"uri":"data:image/x;base64,)" +
                             base64(pngOf(1, 1, 3, {0, 0, 0})) + "\"}]";
  const Scene covered = OneModel("m.gltf", withMaterial(texture + R"("alphaMode":"MASK")", opaque)).load();
  CHECK(covered.textures.back().values == std::vector<float>{1.0f});
}

TEST_CASE("textures of metalness, emission and vertex colours become their means, which is told") {
  const std::string image = base64(pngOf(2, 1, 3, {0, 255, 0, 0, 0, 255}));
  const std::string images =
      R"(,"textures":[{"source":0}],"images":[{"uri":"data:image/x;base64,)" + image + "\"}]";
  const auto [scene, log] =
      OneModel("m.gltf",
               withMaterial(R"("pbrMetallicRoughness":{"metallicRoughnessTexture":{"index":0}},)"
                            R"("emissiveFactor":[1,1,1],"emissiveTexture":{"index":0},)"
                            R"("extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":8},)"
                            R"("KHR_materials_clearcoat":{}})",
                            images))
          .logged();
  CHECK(scene.materials.at(0).emission == glm::vec3(0, 4, 4));
  CHECK_THAT(log, Tells("warning", "clearcoat"));
  const Scene half = OneModel("m.gltf", withMaterial(R"("pbrMetallicRoughness":{"metallicFactor":0.5,)"
                                                     R"("roughnessFactor":0.5})"))
                         .load();
  CHECK(scene.materials.at(0).exponent == half.materials.at(0).exponent);
  CHECK(scene.materials.at(0).specular == half.materials.at(0).specular);
  GltfWriter writer;
  const int colours = writer.numbers<std::uint8_t>({255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 0, 255}, "VEC4",
                                                   R"(,"normalized":true)");
  const int positions = writer.numbers<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  const Scene coloured =
      OneModel("m.gltf",
               writer.gltf(fmt::format(R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":)"
                                       R"({{"POSITION":{},"COLOR_0":{}}}}}]}}])",
                                       positions, colours)))
          .load();
  CHECK(glm::distance(coloured.materials.at(0).diffuse, 0.8f * glm::vec3(1 / 3.0f, 1 / 3.0f, 0)) < 1e-6f);
}

TEST_CASE("what a scene cannot show of lights and cameras is told") {
  GltfWriter writer;
  const std::string body =
      triangleBody(writer, R"(,"camera":0,"extensions":{"KHR_lights_punctual":{"light":0}})");
  const std::string file = writer.gltf(
      body + R"(,"extensionsUsed":["KHR_lights_punctual"],"extensions":{"KHR_lights_punctual":{"lights":[)"
             R"({"type":"point","range":2}]}},"cameras":[{"type":"orthographic","orthographic":)"
             R"({"xmag":1,"ymag":1,"zfar":2,"znear":1}}])");
  const std::string log = OneModel("m.gltf", file).logged().second;
  CHECK_THAT(log, Tells("beyond their range"));
  CHECK_THAT(log, Tells("warning", "orthographic cameras"));
}

TEST_CASE("each way in which a glTF file can be wrong gives one error with its JSON pointer or byte") {
  GltfWriter writer;
  const std::string good = writer.gltf(triangleBody(writer));
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = good;
    const std::size_t at = changed.find(from);
    REQUIRE(at != std::string::npos);
    changed.replace(at, from.size(), to);
    return changed;
  };
  const std::vector<std::pair<std::string, Tells>> files{
      {"", Tells("m.gltf", "JSON")},
      {"v 0 0 0\n", Tells("m.gltf", "JSON")},
      {"[]", Tells("m.gltf", "object")},
      {"{}", Tells("m.gltf", "asset")},
      {std::string(100000, '['), Tells("m.gltf", "JSON")},
      {with("2.0", "1.0"), Tells("/asset/version", "1.0", "2.0")},
      {with("\"mesh\":0", "\"mesh\":1"), Tells("/nodes/0/mesh", "1", "meshes")},
      {with("\"mesh\":0", "\"mesh\":-1"), Tells("/nodes/0/mesh", "-1")},
      {with("\"mesh\":0", "\"mesh\":\"a\""), Tells("/nodes/0/mesh", "number")},
      {with("\"mesh\":0", "\"mesh\":0,\"children\":[0]"), Tells("/nodes/0", "ancestor")},
      {with("\"mesh\":0", "\"mesh\":0,\"scale\":[1,1]"), Tells("/nodes/0/scale", 2, 3)},
      {with("\"mesh\":0", "\"mesh\":0,\"rotation\":[0,0,0,0]"), Tells("/nodes/0/rotation", "zero")},
      {with("\"POSITION\":0", "\"NORMAL\":0"), Tells("/meshes/0/primitives/0/attributes", "POSITION")},
      {with("\"POSITION\":0", "\"POSITION\":1"), Tells("/accessors/1", "vectors")},
      {with("\"indices\":1", "\"indices\":0"), Tells("/accessors/0", "indices")},
      {with("\"count\":3", "\"count\":4"), Tells("/accessors/0", 4, "view")},
      {with("\"count\":3", "\"count\":1e9"), Tells("/accessors/0", "view")},
      {with("\"componentType\":5126", "\"componentType\":5124"), Tells("/accessors/0/componentType", 5124)},
      {with("\"VEC3\"", "\"VEC9\""), Tells("/accessors/0/type")},
      {with("\"byteLength\":36", "\"byteLength\":360"), Tells("/bufferViews/0", 360)},
      {with("\"byteLength\":42", "\"byteLength\":43"), Tells("/buffers/0/byteLength", 43, 42)},
      {with("base64,", "base64,!"), Tells("/buffers/0/uri", "base64")},
      {with("data:", "http:"), Tells("/buffers/0/uri", "folder")},
      {with("\"scene\":0", "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"scene\":0"),
       Tells("/extensionsRequired/0", "KHR_draco_mesh_compression")},
  };
  for (const auto& [file, told] : files) {
    CAPTURE(file.substr(0, 200));
    CHECK_THAT(OneModel("m.gltf", file).error(), told);
  }
  GltfWriter large;
  const int positions = large.numbers<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3"),
            indices = large.numbers<std::uint8_t>({0, 1, 3}, "SCALAR");
  CHECK_THAT(OneModel("m.gltf", large.gltf(fmt::format(
                                    R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":)"
                                    R"({{"POSITION":{}}},"indices":{}}}]}}])",
                                    positions, indices)))
                 .error(),
             Tells("/accessors/1", "index 2 is 3", 3));
}

TEST_CASE("URIs that leave the folder are refused, whether the file is there or not") {
  for (const char* uri : {"../m.bin", "/etc/passwd", "a/../../m.bin", "%2e%2e/m.bin", "file:///etc/passwd",
                          "..\\\\m.bin", "C:/m.bin"}) {
    CAPTURE(uri);
    GltfWriter writer;
    CHECK_THAT(OneModel("m.gltf", writer.gltf(triangleBody(writer), uri)).error(),
               Tells("/buffers/0/uri", "folder"));
  }
  GltfWriter writer;
  CHECK_THAT(OneModel("m.gltf", writer.gltf(triangleBody(writer), "m.bin")).error(),
             Tells("/buffers/0/uri", "m.bin", "exist"));
}

TEST_CASE("a GLB file that is cut off or lies about its lengths is refused at a byte") {
  GltfWriter writer;
  const std::string good = writer.glb(triangleBody(writer));
  for (std::size_t size = 0; size < good.size(); size += 5) {
    CAPTURE(size);
    CHECK_THAT(OneModel("m.glb", good.substr(0, size)).error(), Tells("m.glb"));
  }
  std::string other = good;
  other[4] = 1;
  CHECK_THAT(OneModel("m.glb", other).error(), Tells("byte 4", "version 1"));
  other = good;
  other[15] = 0x7F;
  CHECK_THAT(OneModel("m.glb", other).error(), Tells("byte 20", "chunk"));
}

TEST_CASE("more triangles than a model may have are refused before they are read") {
  GltfWriter writer;
  const int positions = writer.accessor(R"({"componentType":5126,"count":16000000,"type":"VEC3"})");
  std::string nodes, children;
  for (int i = 0; i < 100; ++i) nodes += std::string(i > 0 ? "," : "") + "{\"mesh\":0}";
  CHECK_THAT(OneModel("m.gltf",
                      writer.gltf(fmt::format(
                          R"("nodes":[{}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{}}}}}]}}])",
                          nodes, positions)))
                 .error(),
             Tells("/nodes/", "triangles", 200000000));
}
