// Scene texts: what the grammar accepts, and one message for each way to get it wrong.
#include <cmath>
#include <functional>
#include <numbers>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/results/reproduction.h"
#include "lumivox/scene/scene.h"
#include "lumivox/scene/text.h"
#include "support/support.h"

using namespace lumivox;
using Catch::Matchers::Contains;

namespace {

const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// The findings of a whole text; `m.obj` lies beside it.
std::string findings(const std::string& text) {
  const test::TemporaryDirectory directory;
  directory.write("m.obj", kTriangle);
  const auto file = directory.write("a.scene", text);
  return test::messageOf<DiagnosticsError>([&] { checkScene(file); });
}

/// The findings of a scene with a good camera, a good mesh `room` and `inside`.
std::string sceneWith(const std::string& inside) {
  return findings("scene \"x\" {\ncamera main { eye 0 0 1  target 0 0 0 }\nmesh room { file \"m.obj\" }\n" +
                  inside + "\n}\n");
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t result = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++result;
  return result;
}

}  // namespace

TEST_CASE("the scene of the design is read with its units, names and kinds") {
  const test::TemporaryDirectory directory;
  directory.write("models/cornell.obj",
                  "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no tall_box\nf 1 2 3\no ceiling_lamp\nf 1 3 4\n");
  const auto file = directory.write("a.scene", R"(scene "Cornell box" {
  camera main   { eye 0.278 0.273 -0.8   target 0.278 0.273 0   fov 39.3 deg   resolution 256 128 }
  material red  { diffuse 0.63 0.06 0.05 }
  material gold { diffuse 0.4 0.3 0.1   specular 0.5 0.4 0.2   exponent 40 }
  mesh room     { file "models/cornell.obj"  material red }
  light lamp area        { mesh room/ceiling_lamp   radiance 17 12 4 }
  light sun directional  { direction -0.3 -1 0.2    irradiance 10 10 9 }
  environment            { radiance 0.2 0.25 0.3 }
  medium smoke  { particles 10000  source 0.28 0 0.28  radius 4 cm  rise 0.2 m/s   albedo 0.9   extinction 40 /m   anisotropy 0.6 }
  animate room/tall_box  { rotate 0 1 0  30 deg/s }
})");
  const Scene scene = loadScene(file);
  CHECK(scene.name == "Cornell box");
  REQUIRE(scene.cameras.size() == 1);
  CHECK(scene.cameras[0].eye == glm::dvec3(0.278, 0.273, -0.8));
  CHECK(scene.cameras[0].fov == Approx(39.3 * std::numbers::pi / 180));
  CHECK(scene.cameras[0].width == 256);
  CHECK(scene.cameras[0].height == 128);
  REQUIRE(scene.lights.size() == 1);
  CHECK(scene.lights[0].name == "sun");
  CHECK(glm::length(scene.lights[0].direction) == Approx(1.0));
  CHECK(scene.lights[0].power == glm::vec3(10, 10, 9));
  CHECK(scene.environment == glm::vec3(0.2f, 0.25f, 0.3f));
  REQUIRE(scene.media.size() == 1);
  CHECK(scene.media[0].extinction == glm::vec3(40));
  CHECK(scene.media[0].albedo == glm::vec3(0.9f));
  CHECK(scene.media[0].particles == 10000);
  CHECK(scene.media[0].radius == Approx(0.04));
  CHECK(scene.media[0].rise == Approx(0.2));
  REQUIRE(scene.objects.size() == 2);
  CHECK(scene.objects[0].name == "room/tall_box");
  REQUIRE(scene.objects[0].motion.has_value());
  CHECK(scene.objects[0].motion->angularSpeed == Approx(std::numbers::pi / 6));
  CHECK_FALSE(scene.objects[1].motion.has_value());
  const Material& areaLight =
      scene.materials.at(static_cast<std::size_t>(scene.objects[1].parts.at(0).material));
  CHECK(areaLight.emission == glm::vec3(17, 12, 4));
  CHECK(areaLight.diffuse == glm::vec3(0.63f, 0.06f, 0.05f));
  // The same material without an area light does not shine; gold, which nothing uses, is no material of the
  // scene.
  CHECK_FALSE(scene.materials.at(static_cast<std::size_t>(scene.objects[0].parts.at(0).material)).emissive());
  CHECK(scene.materials.size() == 2);
  CHECK_FALSE(SceneTraits::of(scene).glossy);
}

TEST_CASE("all errors of a scene text are reported at once") {
  const std::string text = sceneWith(
      "camera other { eye 0 0 1  target 0 0 0  fow 3 deg }\nmesh b { file \"m.obj\"  material goold }\n"
      "light l area { mesh rom  radiance 1 }\nenvironment { radiance -1 }\n");
  CHECK_THAT(text, Contains("a.scene:4:") && Contains("did you mean 'fov'?"));
  CHECK_THAT(text, Contains("a.scene:5:") && Contains("unknown material 'goold'"));
  CHECK_THAT(text, Contains("a.scene:6:") && Contains("unknown mesh 'rom'"));
  CHECK_THAT(text, Contains("a.scene:7:") && Contains("out of range"));
}

TEST_CASE("a scene without a camera is refused") {
  CHECK_THAT(findings("scene \"x\" { mesh room { file \"m.obj\" } }"), Contains("lacks a block 'camera'"));
}

TEST_CASE("a text that is no scene is refused") {
  CHECK_THAT(findings("pipeline \"x\" { }"),
             Contains("unknown block 'pipeline'") && Contains("lacks a block 'scene'"));
}

TEST_CASE("a camera without eye or target is refused unless it has keys") {
  CHECK_THAT(
      findings("scene \"x\" { camera main { fov 40 deg } }"),
      Contains("block 'camera main' lacks the property 'eye'") && Contains("lacks the property 'target'"));
  const test::TemporaryDirectory directory;
  checkScene(directory.write("a.scene",
                             "scene \"x\" { camera main {\n key { time 0  eye 0 0 1  target 0 0 0 }\n } }"));
}

TEST_CASE("a camera that looks nowhere or along its up direction is refused") {
  CHECK_THAT(sceneWith("camera b { eye 1 2 3  target 1 2 3 }"),
             Contains("eye and target are the same point"));
  CHECK_THAT(sceneWith("camera b { eye 0 1 0  target 0 0 0 }"), Contains("the camera looks along 'up'"));
  CHECK_THAT(sceneWith("camera b { eye 0 1 0  target 0 0 1  up 0 0 0 }"), Contains("'up' has length zero"));
}

TEST_CASE("a thin lens is read with its units, and one that cannot be is refused") {
  const test::TemporaryDirectory directory;
  const Scene scene = loadScene(
      directory.write("a.scene",
                      "scene \"x\" {\n  camera main { eye 0 0 1  target 0 0 0  aperture 5 cm  focus 3 m }\n"
                      "  camera plain { eye 0 0 1  target 0 0 0 }\n}\n"));
  CHECK(scene.camera("main").aperture == Approx(0.05));
  CHECK(scene.camera("main").focus == Approx(3.0));
  CHECK(scene.camera("plain").aperture == 0.0);
  const CameraView view = snapshotOf(scene, 0.0).camera;
  CHECK(view.aperture == 0.05f);
  CHECK(view.focus == 3.0f);

  const auto lens = [](const std::string& words) {
    return sceneWith("camera b { eye 0 0 1  target 0 0 0  " + words + " }");
  };
  const Scene pinhole = loadScene(directory.write(
      "b.scene", "scene \"x\" {\n  camera b { eye 0 0 1  target 0 0 0  aperture 0  focus 2 m }\n}\n"));
  CHECK(pinhole.camera("b").aperture == 0.0);
  CHECK_THAT(lens("aperture 5 cm"), Contains("a.scene:4:") &&
                                        Contains("'aperture' without a plane in focus") &&
                                        Contains("focus 3 m"));
  CHECK_THAT(lens("focus 3 m"), Contains("'focus' without an aperture") && Contains("aperture DIAMETER"));
  CHECK_THAT(lens("aperture -1 cm  focus 3 m"), Contains("of property 'aperture' is out of range"));
  CHECK_THAT(lens("aperture 5 cm  focus 0 m"), Contains("of property 'focus' is out of range"));
  CHECK_THAT(lens("aperture 5 cm  focus -2 m"), Contains("of property 'focus' is out of range"));
  CHECK_THAT(lens("aperture 5 deg  focus 3 m"), Contains("unit 'deg' measures angle"));
  CHECK_THAT(lens("aperture wide  focus 3 m"), Contains("'aperture'"));
  CHECK_THAT(lens("apperture 5 cm  focus 3 m"), Contains("did you mean 'aperture'?"));
}

TEST_CASE("camera keys must rise in time") {
  CHECK_THAT(sceneWith("camera b {\nkey { time 1 s  eye 0 0 1  target 0 0 0 }\nkey { time 1000 ms  eye 0 0 2 "
                       " target 0 0 0 }\n}"),
             Contains("keys run backwards in time"));
}

TEST_CASE("unknown materials, meshes and kinds of light are named with the nearest known one") {
  CHECK_THAT(sceneWith("material gold { }\nmesh b { file \"m.obj\"  material golt }"),
             Contains("unknown material 'golt'") && Contains("did you mean 'gold'?"));
  CHECK_THAT(sceneWith("material gold { }\nmesh b {\nfile \"m.obj\"\nuse { part x  material glod }\n}"),
             Contains("did you mean 'gold'?"));
  CHECK_THAT(sceneWith("light l area { mesh rooom/lamp  radiance 1 }"),
             Contains("unknown mesh 'rooom'") && Contains("did you mean 'room'?"));
  CHECK_THAT(sceneWith("animate roof/box { translate 1 0 0 }"),
             Contains("unknown mesh 'roof'") && Contains("did you mean 'room'?"));
  CHECK_THAT(sceneWith("light l aera { }"),
             Contains("unknown kind 'aera'") && Contains("did you mean 'area'?"));
}

TEST_CASE("two blocks of one name are refused") {
  CHECK_THAT(sceneWith("mesh room { file \"m.obj\" }"), Contains("block 'mesh' named 'room' is given twice"));
  CHECK_THAT(sceneWith("environment { radiance 1 }\nenvironment { radiance 1 }"),
             Contains("block 'environment' is given twice"));
}

TEST_CASE("a material that reflects more than it receives is refused") {
  CHECK_THAT(sceneWith("material b { diffuse 0.7 0.2 0.2  specular 0.4 }"),
             Contains("material 'b' reflects more light than it receives"));
}

TEST_CASE("directions and axes need a length, spots an opening") {
  CHECK_THAT(sceneWith("light l directional { direction 0 0 0  irradiance 1 }"),
             Contains("'direction' has length zero"));
  CHECK_THAT(sceneWith("animate room { rotate 0 0 0 30 deg/s }"), Contains("'rotate' has length zero"));
  CHECK_THAT(
      sceneWith("light l spot { position 0 0 0  direction 0 -1 0  intensity 1  inner 30 deg  outer 20 deg }"),
      Contains("the inner angle of the spot is not below the outer one"));
}

TEST_CASE("an animation that moves nothing and a selection of nothing are refused") {
  CHECK_THAT(sceneWith("animate room { }"), Contains("the animation moves nothing"));
  CHECK_THAT(sceneWith("material b { }\nmesh c {\nfile \"m.obj\"\nuse { material b }\n}"),
             Contains("selects nothing"));
}

TEST_CASE("sequences and frame numbers in file names belong together") {
  CHECK_THAT(sceneWith("mesh b { file \"m_##.obj\" }"),
             Contains("contains '#' but the mesh has no sequence"));
  CHECK_THAT(sceneWith("mesh b { file \"m.obj\"  sequence 0..3 }"),
             Contains("has no place for the frame number"));
  CHECK_THAT(sceneWith("mesh b { file \"m.obj\"  rate 24 }"), Contains("'rate' without a sequence"));
}

TEST_CASE("a mesh name with a slash is refused") {
  CHECK_THAT(sceneWith("mesh a/b { file \"m.obj\" }"), Contains("the mesh name 'a/b' contains a '/'"));
}

TEST_CASE("a parameter in a scene is refused: only pipelines have them") {
  CHECK_THAT(sceneWith("camera b { eye 0 0 1  target 0 0 0  resolution 640 $height }"),
             Contains("a.scene:4:52: parameter '$height' in a scene"));
  CHECK_THAT(sceneWith("mesh b { file \"m_#.obj\"  sequence 0..$last }"),
             Contains("parameter '$last' in a scene"));
}

TEST_CASE("particles need a radius") {
  CHECK_THAT(sceneWith("medium s { extinction 1 /m  particles 10 }"), Contains("particles without a radius"));
}

TEST_CASE("a missing model beside the text is a finding with the nearest file name") {
  const std::string text = sceneWith("mesh b { file \"n.obj\" }");
  CHECK_THAT(
      text, Contains("a.scene:4:15: model file 'n.obj' does not exist") && Contains("did you mean 'm.obj'?"));
  CHECK_THAT(sceneWith("material b { texture \"none.png\" }"),
             Contains("image file 'none.png' does not exist"));
}

TEST_CASE("a model in a folder that is nowhere is an error of a check, and absent to who renders") {
  const test::TemporaryDirectory directory;
  const auto file = directory.write(
      "a.scene",
      "scene \"x\" { camera main { eye 0 0 1  target 0 0 0 }\nmesh b { file \"no_such_model/b.obj\" } }");
  SceneLoadOptions options;
  options.assetPath = {directory.path() / "assets"};
  CHECK_THAT(
      test::messageOf<DiagnosticsError>([&] { checkScene(file, options); }),
      Contains("a.scene:2:15: model file 'no_such_model/b.obj' does not exist; expected it at one of") &&
          Contains((directory.path() / "assets/no_such_model/b.obj").string()));
  const std::string text = test::messageOf<AbsentError>([&] { loadScene(file, options); });
  CHECK_THAT(text, Contains("the model of mesh 'b' 'no_such_model/b.obj' was not found; searched"));
  CHECK_THAT(text, Contains((directory.path() / "assets/no_such_model/b.obj").string()));
  CHECK_THAT(text, Contains("shared/models/no_such_model/b.obj"));
}

TEST_CASE("models are found on the asset path and in LUMIVOX_ASSETS") {
  const test::TemporaryDirectory directory;
  directory.write("one/deep/a.obj", kTriangle);
  directory.write("two/deep/b.obj", kTriangle);
  const auto file = directory.write("texts/a.scene",
                                    "scene \"x\" { camera main { eye 0 0 1  target 0 0 0 }\n"
                                    "mesh a { file \"deep/a.obj\" }\nmesh b { file \"deep/b.obj\" }\n}");
  SceneLoadOptions options;
  options.assetPath = {directory.path() / "one"};
  CHECK_THROWS_AS(loadScene(file, options), AbsentError);
  setenv("LUMIVOX_ASSETS", ("/nowhere:" + (directory.path() / "two").string()).c_str(), 1);
  const Scene scene = loadScene(file, options);
  unsetenv("LUMIVOX_ASSETS");
  CHECK(scene.objects.size() == 2);
}

TEST_CASE("errors in an included file name that file") {
  const test::TemporaryDirectory directory;
  directory.write("materials.part", "material red { difuse 1 0 0 }\n");
  const auto file = directory.write(
      "a.scene", "scene \"x\" {\n camera main { eye 0 0 1  target 0 0 0 }\n include \"materials.part\"\n}\n");
  CHECK_THAT(test::messageOf<DiagnosticsError>([&] { checkScene(file); }),
             Contains("materials.part:1:16: unknown property 'difuse'") &&
                 Contains("did you mean 'diffuse'?") && Contains("material red { difuse 1 0 0 }"));
}

TEST_CASE("a truncated, an empty and a binary scene give one error each") {
  CHECK(count(findings("scene \"x\" {\n camera main { eye 0 0 1  target 0"), "a.scene:") == 1);
  CHECK(count(findings(""), "a.scene") == 1);
  CHECK(count(findings(std::string("\0\1\2\3", 4)), "a.scene") == 1);
}

TEST_CASE("every committed scene passes the check") {
  if (!std::filesystem::exists(test::sourceDirectory() / "../shared/models"))
    return test::skip("the models of some scenes are not on this machine");
  int checked = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(test::sourceDirectory() / "scenes")) {
    if (entry.path().extension() != ".scene") continue;
    INFO(entry.path());
    CHECK_NOTHROW(checkScene(entry.path()));
    ++checked;
  }
  CHECK(checked >= 10);
}

TEST_CASE("every property of the scene grammar is described with its meaning") {
  for (const std::string& word : dsl::words(sceneSpecifications())) {
    INFO(word);
    CHECK(dsl::describe(sceneSpecifications(), word).size() > word.size() + 10);
  }
  CHECK_THAT(dsl::describe(sceneSpecifications(), "fov"),
             Contains("full vertical angle") && Contains("default 40 deg"));
}

TEST_CASE("what a text leaves out has the default that its table names") {
  const test::TemporaryDirectory directory;
  const Scene scene =
      loadScene(directory.write("a.scene", "scene \"x\" { camera main { eye 0 0 1  target 0 0 0 } }"));
  CHECK(scene.camera().fov == Approx(40 * std::numbers::pi / 180));
  CHECK(scene.camera().width == 256);
  CHECK(scene.camera().height == 256);
  CHECK(scene.camera().up == glm::dvec3(0, 1, 0));
  CHECK_THAT(dsl::describe(sceneSpecifications(), "fov"), Contains("default 40 deg"));
  CHECK_THAT(dsl::describe(sceneSpecifications(), "resolution"), Contains("default 256 256"));
}

TEST_CASE("every default in the scene tables is a value that its own table accepts") {
  const std::function<void(const dsl::BlockSpecification&)> visit =
      [&](const dsl::BlockSpecification& block) {
        std::vector<dsl::PropertySpecification> all = block.properties;
        for (const auto& kind : block.kindProperties)
          all.insert(all.end(), kind.second.begin(), kind.second.end());
        for (const dsl::PropertySpecification& property : all) {
          if (property.defaultText.empty()) continue;
          const dsl::Document document =
              dsl::parse("b { " + property.word + " " + property.defaultText + " }", "defaults");
          std::vector<Diagnostic> found = document.findings;
          dsl::checkProperty(document, *document.items.at(0).block->items.at(0).property, property, found);
          for (const Diagnostic& finding : found) FAIL_CHECK(finding.text());
        }
        for (const dsl::BlockSpecification& inner : block.blocks) visit(inner);
      };
  visit(sceneSpecifications().front());
}

namespace {

/// Calls back for every property of the tables, with the words of the blocks around it.
void forEachProperty(
    const std::vector<dsl::BlockSpecification>& blocks, const std::string& around,
    const std::function<void(const dsl::PropertySpecification&, const std::string&)>& visit) {
  for (const dsl::BlockSpecification& block : blocks) {
    const std::string here = around + " " + block.word;
    for (const dsl::PropertySpecification& property : block.properties) visit(property, here);
    for (const auto& [kind, properties] : block.kindProperties)
      for (const dsl::PropertySpecification& property : properties) visit(property, here + " " + kind);
    forEachProperty(block.blocks, here, visit);
  }
}

bool takesNumbers(const dsl::PropertySpecification& property) {
  switch (property.type) {
    case dsl::PropertyType::number:
    case dsl::PropertyType::integer:
    case dsl::PropertyType::vector2:
    case dsl::PropertyType::vector3:
    case dsl::PropertyType::oneOrThree:
    case dsl::PropertyType::axisAndNumber:
    case dsl::PropertyType::resolution:
    case dsl::PropertyType::range:
      return true;
    default:
      return false;
  }
}

}  // namespace

TEST_CASE("every number of a scene and of a published table has a range") {
  int numbers = 0;
  for (const auto* tables : {&sceneSpecifications(), &reproductionSpecifications()})
    forEachProperty(*tables, "", [&](const dsl::PropertySpecification& property, const std::string& around) {
      if (!takesNumbers(property)) return;
      ++numbers;
      CAPTURE(around, property.word);
      CHECK(std::isfinite(property.low));
      CHECK(std::isfinite(property.high));
      CHECK(property.low < property.high);
    });
  CHECK(numbers > 40);
}

TEST_CASE("light, places, speeds and directions that no renderer could compute with are refused") {
  for (const char* block :
       {"light l directional { direction 1e200 -1e200 0  irradiance 1 }",
        "light l directional { direction 1e-20 0 0  irradiance 1 }",
        "light l directional { direction 0 -1 0  irradiance 1e39 }",
        "light l directional { direction 0 -1 0  irradiance 1 1e16 1 }",
        "light l directional { direction 0 -1 0  irradiance 1e-40 }",
        "light l point { position 0 0 0  intensity 1e39 }",
        "light l point { position 1e30 0 0  intensity 1 }",
        "light l point { position 2e6 0 0 km  intensity 1 }",
        "light l spot { position 0 0 0  direction 1e200 0 0  intensity 1  inner 1 deg  outer 2 deg }",
        "light l area { mesh room  radiance 1e39 }",
        "material b { emission 1e39 }",
        "environment { radiance 1e39 }",
        "camera b { eye 1e200 0 0  target 0 0 0 }",
        "camera b { eye 0 0 0  target 0 0 1e-20 }",
        "camera b { eye 0 0 1  target 0 0 0  up 1e200 0 0 }",
        "camera b { key { time 1e30  eye 0 0 1  target 0 0 0 } }",
        "animate room { rotate 1e200 0 0  30 deg/s }",
        "animate room { rotate 0 1 0  1e30 deg/s }",
        "animate room { translate 1e30 0 0 }",
        "animate room { translate 1 0 0  about 1e30 0 0 }",
        "mesh b { file \"m.obj\"  translate 1e30 0 0 }",
        "mesh b { file \"m.obj\"  rotate 0 1 0  1e30 deg }",
        "mesh b { file \"m.obj\"  rotate 1e200 0 0  30 deg }",
        "medium s { extinction 1e39 /m }",
        "medium s { extinction 1 /m  low 0 0 0  high 1e30 1 1 }",
        "medium s { extinction 1 /m  particles 9  radius 1e30 }",
        "medium s { extinction 1 /m  particles 9  radius 1e-9 }",
        "medium s { extinction 1 /m  particles 9  radius 1  rise 1e30 m/s }",
        "medium s { extinction 1 /m  particles 9  radius 1  drift 1e30 m/s }",
        "medium s { extinction 1 /m  particles 9  radius 1  spread 1e30 }",
        "medium s { extinction 1 /m  particles 9  radius 1  source 0 1e30 0 }"}) {
    CAPTURE(block);
    const std::string text = sceneWith(block);
    CHECK(count(text, "a.scene:4:") >= 1);
    CHECK_THAT(text, Contains("expected"));
  }
}

TEST_CASE("what is at the ends of the ranges is read") {
  const test::TemporaryDirectory directory;
  directory.write("m.obj", kTriangle);
  checkScene(directory.write(
      "a.scene",
      "scene \"x\" {\ncamera main { eye 0 0 1e9  target 0 0 0 }\nmesh room { file \"m.obj\"  scale 1e9 }\n"
      "light a point { position -1e6 1e6 1e6 km  intensity 1e15 }\n"
      "light b directional { direction 1e-6 -1e9 0  irradiance 1e15 }\n}\n"));
}

TEST_CASE("as many particles as a scene may have fit into the block that every device has") {
  constexpr double kPromisedBlock = 1
                                    << 27;  // bytes: MAX_SHADER_STORAGE_BLOCK_SIZE of OpenGL 4.5, table 23.64
  constexpr double kBytesOfParticle = 3 * sizeof(float);
  double most = 0.0;
  forEachProperty(sceneSpecifications(), "",
                  [&](const dsl::PropertySpecification& property, const std::string&) {
                    if (property.word == "particles") most = property.high;
                  });
  CHECK(most >= 1e7);
  CHECK(most * kBytesOfParticle <= kPromisedBlock);
}
