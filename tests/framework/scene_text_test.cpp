// Scene texts: what the grammar accepts, and one message for each way to get it wrong.
#include <cmath>
#include <functional>
#include <numbers>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/results/reproduction.h"
#include "lumivox/scene/scene.h"
#include "lumivox/scene/text.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using Catch::Matchers::Contains;
using lumivox::test::Tells;

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

/// The scene of a text of these blocks.
Scene sceneOf(const std::string& inside) {
  const test::TemporaryDirectory directory;
  return loadScene(directory.write("a.scene", "scene \"x\" {\n" + inside + "\n}\n"));
}

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

TEST_CASE("all errors of a scene text are reported at once, in their order") {
  CHECK_THAT(
      sceneWith(
          "camera other { eye 0 0 1  target 0 0 0  fow 3 deg }\nmesh b { file \"m.obj\"  material goold }\n"
          "light l area { mesh rom  radiance 1 }\nenvironment { radiance -1 }\n"),
      Tells("a.scene:4", "fov", "a.scene:5", "goold", "a.scene:6", "rom", "a.scene:7", "range"));
}

TEST_CASE("each mistake in a scene is told with its names and the nearest known one") {
  const auto [inside, told] = GENERATE(table<const char*, Tells>({
      {"camera b { eye 1 2 3  target 1 2 3 }", Tells("eye", "target", "same")},
      {"camera b { eye 0 1 0  target 0 0 0 }", Tells("along", "up")},
      {"camera b { eye 0 1 0  target 0 0 1  up 0 0 0 }", Tells("up", "zero")},
      {"camera b { eye 0 0 1  target 0 0 0  resolution 640 $height }", Tells("a.scene:4:52", "$height")},
      {"camera b { key { time 1 s  eye 0 0 1  target 0 0 0 }  key { time 1000 ms  eye 0 0 2  target 0 0 0 } }",
       Tells("backwards", "time")},
      {"camera b { eye 0 0 1  target 0 0 0  aperture 5 cm }", Tells("aperture", "focus", 3)},
      {"camera b { eye 0 0 1  target 0 0 0  focus 3 m }", Tells("focus", "aperture", "DIAMETER")},
      {"camera b { eye 0 0 1  target 0 0 0  aperture -1 cm  focus 3 m }", Tells("aperture", "range")},
      {"camera b { eye 0 0 1  target 0 0 0  aperture 5 cm  focus 0 m }", Tells("focus", "range")},
      {"camera b { eye 0 0 1  target 0 0 0  aperture 5 cm  focus -2 m }", Tells("focus", "range")},
      {"camera b { eye 0 0 1  target 0 0 0  aperture 5 deg  focus 3 m }", Tells("deg", "angle")},
      {"camera b { eye 0 0 1  target 0 0 0  aperture wide  focus 3 m }", Tells("aperture")},
      {"camera b { eye 0 0 1  target 0 0 0  apperture 5 cm  focus 3 m }",
       Tells("apperture", "mean", "aperture")},
      {"mesh b { file \"m.obj\"  material golt }\nmaterial gold { }",
       Tells("material", "golt", "mean", "gold")},
      {"mesh b { file \"m.obj\"\n use { part x  material glod }\n }\nmaterial gold { }",
       Tells("mean", "gold")},
      {"mesh c { file \"m.obj\"\n use { material b }\n }\nmaterial b { }", Tells("selects", "nothing")},
      {"mesh room { file \"m.obj\" }", Tells("mesh", "room", "twice")},
      {"mesh a/b { file \"m.obj\" }", Tells("a/b", "/")},
      {"mesh b { file \"n.obj\" }", Tells("a.scene:4:15", "n.obj", "exist", "mean", "m.obj")},
      {"mesh b { file \"m_##.obj\" }", Tells("#", "no", "sequence")},
      {"mesh b { file \"m.obj\"  sequence 0..3 }", Tells("frame", "number")},
      {"mesh b { file \"m.obj\"  rate 24 }", Tells("rate", "without", "sequence")},
      {"mesh b { file \"m_#.obj\"  sequence 0..$last }", Tells("$last")},
      {"material b { texture \"none.png\" }", Tells("none.png", "exist")},
      {"material b { diffuse 0.7 0.2 0.2  specular 0.4 }", Tells("b", "more", "light")},
      {"light l area { mesh rooom/lamp  radiance 1 }", Tells("mesh", "rooom", "mean", "room")},
      {"light l aera { }", Tells("kind", "aera", "mean", "area")},
      {"light l directional { direction 0 0 0  irradiance 1 }", Tells("direction", "zero")},
      {"light l spot { position 0 0 0  direction 0 -1 0  intensity 1  inner 30 deg  outer 20 deg }",
       Tells("inner", "outer")},
      {"environment { radiance 1 } environment { radiance 1 }", Tells("environment", "twice")},
      {"medium s { extinction 1 /m  particles 10 }", Tells("particles", "radius")},
      {"animate roof/box { translate 1 0 0 }", Tells("mesh", "roof", "mean", "room")},
      {"animate room { rotate 0 0 0 30 deg/s }", Tells("rotate", "zero")},
      {"animate room { }", Tells("animation", "nothing")},
  }));
  CAPTURE(inside);
  CHECK_THAT(sceneWith(inside), told && Catch::Contains("a.scene:"));
}

TEST_CASE("a text that lacks a scene, a camera, or the camera's eye and target is refused for that") {
  const auto [text, told] = GENERATE(table<const char*, Tells>({
      {"pipeline \"x\" { }", Tells("lacks", "scene", "unknown", "pipeline")},
      {"scene \"x\" { mesh room { file \"m.obj\" } }", Tells("lacks", "camera")},
      {"scene \"x\" { camera main { fov 40 deg } }", Tells("camera main", "lacks", "eye", "lacks", "target")},
  }));
  CHECK_THAT(findings(text), told);
  CHECK_NOTHROW(sceneOf("camera main {\n key { time 0  eye 0 0 1  target 0 0 0 }\n }"));  // keys have both
}

TEST_CASE("a thin lens is read with its units; without one, or with aperture 0, a camera is a pinhole") {
  const Scene scene = sceneOf(
      "camera main { eye 0 0 1  target 0 0 0  aperture 5 cm  focus 3 m }\n"
      "camera plain { eye 0 0 1  target 0 0 0 }\ncamera zero { eye 0 0 1  target 0 0 0  aperture 0  focus 2 m }");
  CHECK(scene.camera("main").aperture == Approx(0.05));
  CHECK(scene.camera("main").focus == Approx(3.0));
  for (const char* pinhole : {"plain", "zero"}) CHECK(scene.camera(pinhole).aperture == 0.0);
  const CameraView view = snapshotOf(scene, 0.0).camera;
  CHECK(view.aperture == 0.05f);
  CHECK(view.focus == 3.0f);
}

TEST_CASE("a model in a folder that is nowhere is an error of a check, and absent to who renders") {
  const test::TemporaryDirectory directory;
  const auto file = directory.write(
      "a.scene",
      "scene \"x\" { camera main { eye 0 0 1  target 0 0 0 }\nmesh b { file \"no_such_model/b.obj\" } }");
  const SceneLoadOptions options{.assetPath = {directory.path() / "assets"}};
  const std::string name = "no_such_model/b.obj";
  const auto sought = directory.path() / "assets" / name;
  CHECK_THROWS_MATCHES(checkScene(file, options), DiagnosticsError, Tells("a.scene:2:15", name, sought));
  CHECK_THROWS_MATCHES(loadScene(file, options), AbsentError, Tells("b", name, sought));
  CHECK_THROWS_MATCHES(loadScene(file, options), AbsentError, Tells("shared/models/" + name));
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

TEST_CASE("every property of the scene grammar is described with its meaning, and with its default") {
  for (const std::string& word : dsl::words(sceneSpecifications())) {
    INFO(word);
    CHECK(dsl::describe(sceneSpecifications(), word).size() > word.size() + 10);
  }
  CHECK_THAT(dsl::describe(sceneSpecifications(), "fov"), Contains("vertical") && Contains("default 40 deg"));
  CHECK_THAT(dsl::describe(sceneSpecifications(), "resolution"), Contains("default 256 256"));
}

TEST_CASE("what a text leaves out has the default that its table names") {
  const Camera camera = sceneOf("camera main { eye 0 0 1  target 0 0 0 }").camera();
  CHECK(camera.fov == Approx(40 * std::numbers::pi / 180));
  CHECK((camera.width == 256 && camera.height == 256));
  CHECK(camera.up == glm::dvec3(0, 1, 0));
}

TEST_CASE("every default in the scene tables is a value that its own table accepts") {
  forEachProperty(
      sceneSpecifications(), "", [](const dsl::PropertySpecification& property, const std::string&) {
        if (property.defaultText.empty()) return;
        const dsl::Document document =
            dsl::parse("b { " + property.word + " " + property.defaultText + " }", "defaults");
        std::vector<Diagnostic> found = document.findings;
        dsl::checkProperty(document, *document.items.at(0).block->items.at(0).property, property, found);
        for (const Diagnostic& finding : found) FAIL_CHECK(finding.text());
      });
}

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
    CHECK_THAT(sceneWith(block), Tells("a.scene:4", "expected"));
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
