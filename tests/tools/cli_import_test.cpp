// lumivox import and lumivox list parts.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "framework/one_mesh.h"
#include "lumivox/base/file.h"
#include "lumivox/scene/scene.h"
#include "support/facts.h"
#include "support/gltf_files.h"
#include "support/support.h"

using namespace lumivox;
using lumivox::test::Tells;
using test::runCommand, test::TemporaryDirectory;

namespace {

/// A red triangle, a camera, and one light of each kind that KHR_lights_punctual has.
std::string litTriangle() {
  test::GltfWriter writer;
  const int positions = writer.numbers<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  return writer.gltf(fmt::format(
      R"("extensionsUsed":["KHR_lights_punctual"],"extensions":{{"KHR_lights_punctual":{{"lights":[)"
      R"({{"type":"point","intensity":683,"color":[1,0.5,0]}},{{"type":"directional","intensity":1366}},)"
      R"({{"type":"spot","intensity":68.3,"spot":{{"innerConeAngle":0.1,"outerConeAngle":0.5}}}}]}}}},"nodes":[)"
      R"({{"name":"red one","mesh":0}},{{"name":"eye","camera":0,"translation":[0,0,5]}},)"
      R"({{"name":"bulb","translation":[1,2,3],"extensions":{{"KHR_lights_punctual":{{"light":0}}}}}},)"
      R"({{"name":"sun","rotation":[-0.70710678,0,0,0.70710678],"extensions":{{"KHR_lights_punctual":{{"light":1}}}}}},)"
      R"({{"name":"torch","extensions":{{"KHR_lights_punctual":{{"light":2}}}}}}],)"
      R"("cameras":[{{"type":"perspective","perspective":{{"yfov":0.5,"znear":0.1}}}}],)"
      R"("materials":[{{"name":"red paint","pbrMetallicRoughness":{{"baseColorFactor":[1,0,0,1],"metallicFactor":0}}}}],)"
      R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":{}}},"material":0}}]}}])",
      positions));
}

}  // namespace

TEST_CASE("import writes a canonical scene whose camera, lights and materials are those of the model") {
  const TemporaryDirectory folder;
  const auto model = folder.write("my room.gltf", litTriangle());
  const auto text = folder.path() / "scenes" / "room.scene";
  const auto result = runCommand("lumivox import '" + model.string() + "' -o '" + text.string() + "'");
  INFO(result.errors);
  REQUIRE(result.exitCode == 0);
  CHECK(runCommand("lumivox fmt --check '" + text.string() + "'").exitCode == 0);
  CHECK(runCommand("lumivox check '" + text.string() + "'").exitCode == 0);
  const Scene scene = loadScene(text);
  CHECK(scene.objects.at(0).name == "my room/red_one");
  CHECK(scene.materials.at(0).name == "red_paint");
  CHECK(scene.materials.at(0).diffuse.r == Approx(0.957f).epsilon(0.01));
  const Camera& camera = scene.camera("eye");
  CHECK((camera.eye == glm::dvec3(0, 0, 5) && camera.fov == Approx(0.5)));
  REQUIRE(scene.lights.size() == 3);
  // 683 cd are 1 W/sr, 1366 lx are 2 W/m^2.
  CHECK(scene.lights[0].kind == LightKind::point);
  CHECK(scene.lights[0].power == glm::vec3(1.0f, 0.5f, 0.0f));
  CHECK(scene.lights[0].position == glm::dvec3(1, 2, 3));
  CHECK(scene.lights[1].kind == LightKind::directional);
  CHECK(scene.lights[1].power.g == Approx(2.0f));
  CHECK(glm::distance(scene.lights[1].direction, glm::dvec3(0, -1, 0)) < 1e-6);
  CHECK(scene.lights[2].power.g == Approx(0.1f));
  CHECK(scene.lights[2].outerAngle == Approx(0.5f).epsilon(1e-5));
}

TEST_CASE("import writes a colour image as a mask only where its alpha cuts holes") {
  const TemporaryDirectory folder;
  test::GltfWriter writer;
  const std::string positions = std::to_string(writer.numbers<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3"));
  const auto model = folder.write(
      "m.gltf",
      writer.gltf(R"("nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":)" + positions +
                  R"(},"material":0}]}],"materials":[{"name":"leaf","alphaMode":"MASK",)"
                  R"("pbrMetallicRoughness":{"metallicFactor":0,"baseColorTexture":{"index":0}}}],)"
                  R"("textures":[{"source":0}],"images":[{"uri":"leaf.tga"}])"));
  const auto text = folder.path() / "m.scene";
  for (const int channels : {3, 4}) {
    folder.write("leaf.tga", test::tga(1, 1, channels, {9, 9, 9, 9}));
    REQUIRE(runCommand("lumivox import '" + model.string() + "' -o '" + text.string() + "'").exitCode == 0);
    CHECK((readFile(text).find("mask") != std::string::npos) == (channels == 4));
  }
}

TEST_CASE("import adds a camera and a sky to a model without them, and refuses what is no model") {
  const TemporaryDirectory folder;
  const auto model = folder.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const auto text = folder.path() / "m.scene";
  REQUIRE(runCommand("lumivox import '" + model.string() + "' -o '" + text.string() + "'").exitCode == 0);
  const Scene scene = loadScene(text);
  CHECK(scene.cameras.size() == 1);
  CHECK(scene.environment == glm::vec3(1.0f));
  const auto picture = folder.write("m.png", "");
  const auto refused = runCommand("lumivox import '" + picture.string() + "' -o '" + text.string() + "'");
  CHECK(refused.exitCode == 2);
  CHECK_THAT(refused.errors, Tells("m.png", ".glb"));
  CHECK(runCommand("lumivox import '" + model.string() + "' -o '" + (folder.path() / "m.txt").string() + "'")
            .exitCode == 2);
}

TEST_CASE("list parts shows what is in a model, as a table and as JSON") {
  const TemporaryDirectory folder;
  const auto model = folder.write("m.gltf", litTriangle());
  const auto table = runCommand("lumivox list parts '" + model.string() + "'");
  CHECK(table.exitCode == 0);
  CHECK_THAT(table.output, Tells("red_one", "1 triangles", "red_paint", "eye", "bulb", "point", "sun"));
  const auto json =
      nlohmann::json::parse(runCommand("lumivox list parts '" + model.string() + "' --json").output);
  CHECK(json.size() == 6);
  CHECK(json.at(0).at("kind") == "part");
  CHECK(runCommand("lumivox list parts").exitCode == 2);
  CHECK(runCommand("lumivox list scenes '" + model.string() + "'").exitCode == 2);
}
