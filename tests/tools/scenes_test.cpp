// The committed scenes: they are right by their own grammar, hold what their descriptions say, and their
// models are what make_models writes.
#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "lumivox/base/file.h"
#include "lumivox/base/image.h"
#include "lumivox/base/log.h"
#include "lumivox/dsl/document.h"
#include "lumivox/scene/scene.h"
#include "support/support.h"

using namespace lumivox;
namespace fs = std::filesystem;

namespace {

fs::path scenesDirectory() {
  return test::sourceDirectory() / "scenes";
}

std::vector<fs::path> filesBelow(const fs::path& directory, const std::string& extension) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(directory))
    if (entry.is_regular_file() && (extension.empty() || entry.path().extension() == extension))
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// Scenes, and the examples of the guides, which promise as much.
std::vector<fs::path> committedScenes() {
  std::vector<fs::path> files = filesBelow(scenesDirectory(), ".scene");
  for (const fs::path& example : filesBelow(test::sourceDirectory() / "docs/examples", ".scene"))
    files.push_back(example);
  return files;
}

/// Scenes whose models are committed; all others need the asset path.
const std::set<std::string> kOwnScenes = {"cornell", "cornell_glossy", "arcade",        "corridor",
                                          "furnace", "spinning_box",   "hidden_sender", "waving_cloth",
                                          "vase",    "urn_fine",       "urn_coarse",    "glossy_sphere",
                                          "chess",   "exponents"};
bool isOwn(const fs::path& scene) {
  return kOwnScenes.count(scene.stem().string()) != 0 || scene.parent_path().filename() == "stress" ||
         scene.parent_path().filename() == "untuned" || scene.parent_path().filename() == "examples";
}

Scene load(const std::string& name) {
  return loadScene(scenesDirectory() / (name + ".scene"));
}

const Object& objectNamed(const Scene& scene, const std::string& name) {
  for (const Object& object : scene.objects)
    if (object.name == name) return object;
  FAIL("there is no object " + name);
  return scene.objects.front();
}

/// All vertices of a scene at a time, in metres relative to the camera's eye.
std::vector<glm::vec3> verticesSeenFromEye(const Scene& scene, double time) {
  const SceneSnapshot snapshot = snapshotOf(scene, time);
  std::vector<glm::vec3> vertices;
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    for (std::uint32_t v = 0; v < scene.objects[i].vertexCount; ++v)
      vertices.push_back(glm::vec3(snapshot.objects[i].toWorld *
                                   glm::vec4(scene.positions[scene.objects[i].firstVertex + v], 1.0f)) -
                         snapshot.camera.eye);
  return vertices;
}

glm::vec3 extent(const Scene& scene) {
  const Bounds bounds = snapshotOf(scene, 0).bounds;
  return bounds.high - bounds.low;
}

}  // namespace

TEST_CASE("make_models writes the committed models anew") {
  const test::TemporaryDirectory directory;
  const auto result = test::runCommand("'" + (test::binaryDirectory() / "bin/make_models").string() + "' '" +
                                       directory.path().string() + "'");
  INFO(result.errors);
  REQUIRE(result.exitCode == 0);
  const fs::path committed = scenesDirectory() / "models";
  std::uintmax_t total = 0;
  for (const fs::path& made : filesBelow(directory.path(), "")) {
    const fs::path other = committed / fs::relative(made, directory.path());
    INFO(other);
    REQUIRE(fs::exists(other));
    total += fs::file_size(other);
    if (made.extension() == ".png")  // zlib chooses the bytes, the pixels are ours
      CHECK(readByteImage(made).values == readByteImage(other).values);
    else
      CHECK(readFile(made) == readFile(other));
  }
  CHECK(filesBelow(directory.path(), "").size() == filesBelow(committed, "").size());
  CHECK(total < 2u << 20);
}

TEST_CASE("every committed scene passes its check and stands in the canonical layout") {
  const auto scenes = committedScenes();
  REQUIRE(scenes.size() >= kOwnScenes.size());
  for (const fs::path& file : scenes) {
    INFO(file);
    if (isOwn(file)) CHECK_NOTHROW(checkScene(file));
    const std::string text = readFile(file);
    const dsl::Document document = dsl::parse(text, file);
    REQUIRE(document.findings.empty());
    CHECK(dsl::format(document) == text);
  }
}

TEST_CASE("every scene with a committed model loads, and only the degenerate one warns") {
  for (const std::string& name : kOwnScenes) REQUIRE(fs::exists(scenesDirectory() / (name + ".scene")));
  for (const fs::path& file : committedScenes()) {
    if (!isOwn(file)) continue;
    INFO(file);
    const LogCapture log;
    const std::uint64_t before = warningCount();
    const Scene scene = loadScene(file);
    CHECK((scene.triangleCount() > 0) == (file.stem() != "no_triangles"));
    CHECK((warningCount() > before) == (file.stem() == "degenerate"));
    SceneLoadOptions strict;
    strict.strict = true;
    if (file.stem() == "degenerate") CHECK_THROWS_AS(loadScene(file, strict), Error);
  }
}

TEST_CASE("the scenes of well-known models load where the models are") {
  std::string absent;
  for (const fs::path& file : committedScenes()) {
    if (isOwn(file)) continue;
    INFO(file);
    try {
      const Scene scene = loadScene(file);
      CHECK(scene.triangleCount() > 0);
    } catch (const AbsentError&) {
      absent += ' ' + file.stem().string();
    }
  }
  if (!absent.empty()) test::skip("models that are not on the asset path:" + absent);
}

TEST_CASE(
    "the Cornell box is the measured one: 38 triangles, one area light, and nothing that a pipeline could need "
    "besides") {
  const Scene scene = load("cornell");
  CHECK(scene.triangleCount() == 38);
  std::set<std::string> names;
  for (const Object& object : scene.objects) names.insert(object.name);
  CHECK(names == std::set<std::string>{"room/floor", "room/ceiling", "room/back_wall", "room/left_wall",
                                       "room/right_wall", "room/short_box", "room/tall_box",
                                       "room/ceiling_lamp"});
  const SceneTraits traits = SceneTraits::of(scene);
  CHECK(traits.areaLights == 1);
  CHECK(traits.emission);
  CHECK_FALSE((traits.textures || traits.masks || traits.glossy || traits.environment || traits.medium ||
               traits.movingGeometry));
  CHECK(traits.directionalLights + traits.pointLights + traits.spotLights == 0);
  // The published widths: 556 mm at the ceiling, 548.8 mm high, 559.2 mm deep.
  CHECK(extent(scene).x == Approx(0.556).epsilon(1e-5));
  CHECK(extent(scene).y == Approx(0.5488).epsilon(1e-5));
  CHECK(extent(scene).z == Approx(0.5592).epsilon(1e-5));
}

TEST_CASE(
    "in the image of the Cornell box the red wall is on the left, and the area light shines downwards") {
  const Scene scene = load("cornell");
  const SceneSnapshot snapshot = snapshotOf(scene, 0);
  const auto mean = [&](const std::string& name) {
    const Object& object = objectNamed(scene, name);
    glm::vec3 sum(0.0f);
    for (std::uint32_t v = 0; v < object.vertexCount; ++v) sum += scene.positions[object.firstVertex + v];
    return sum / static_cast<float>(object.vertexCount);
  };
  CHECK(glm::dot(mean("room/left_wall") - mean("room/right_wall"), snapshot.camera.right) < 0);
  const Material& red =
      scene.materials[static_cast<std::size_t>(objectNamed(scene, "room/left_wall").parts.at(0).material)];
  CHECK(red.diffuse.r > 5 * red.diffuse.g);
  const Part& areaLight = objectNamed(scene, "room/ceiling_lamp").parts.at(0);
  CHECK(scene.materials[static_cast<std::size_t>(areaLight.material)].emission == glm::vec3(17, 12, 4));
  for (std::uint32_t i = areaLight.firstIndex; i < areaLight.firstIndex + areaLight.indexCount; i += 3) {
    const glm::vec3 a = scene.positions[scene.indices[i]], b = scene.positions[scene.indices[i + 1]],
                    c = scene.positions[scene.indices[i + 2]];
    CHECK(glm::normalize(glm::cross(b - a, c - a)).y == Approx(-1.0));
  }
}

TEST_CASE("each scene has what it is there for") {
  const SceneTraits glossy = SceneTraits::of(load("cornell_glossy"));
  CHECK(glossy.glossy);
  CHECK_FALSE(glossy.textures);

  const Scene arcade = load("arcade");
  const SceneTraits traits = SceneTraits::of(arcade);
  CHECK((traits.textures && traits.masks && traits.glossy && traits.environment && !traits.emission));
  CHECK(traits.directionalLights == 1);
  CHECK(arcade.triangleCount() >= 3000);
  CHECK(arcade.triangleCount() <= 10000);
  CHECK(extent(arcade).x == Approx(12.0).margin(1.0));

  const SceneTraits corridor = SceneTraits::of(load("corridor"));
  CHECK(corridor.spotLights == 1);
  CHECK(corridor.areaLights + corridor.directionalLights + corridor.pointLights == 0);
  CHECK_FALSE((corridor.environment || corridor.emission));

  const Scene furnace = load("furnace");
  for (const Material& material : furnace.materials) {
    CHECK(material.diffuse == glm::vec3(0.5f));
    CHECK(material.emission == glm::vec3(1.0f));
  }
  const SceneTraits spinning = SceneTraits::of(load("spinning_box"));
  CHECK((spinning.movingGeometry && !spinning.movingCamera));
}

TEST_CASE("the switched lamp goes out between the third and the fourth frame, and a dim sun stays") {
  const Scene scene = load("switched_lamp");
  const SceneTraits traits = SceneTraits::of(scene);
  CHECK((traits.movingLights && !traits.movingGeometry && !traits.movingCamera));
  constexpr double kFrame = 1.0 / 24.0;
  for (int frame = 0; frame < 5; ++frame) {
    const SceneSnapshot snapshot = snapshotOf(scene, frame * kFrame);
    CAPTURE(frame);
    CHECK(snapshot.lights.at(0).power.r == 2.0f);
    CHECK(snapshot.lights.at(1).power.r == (frame < 3 ? 3.0f : 0.0f));
  }
}

TEST_CASE("the moving sun turns by 15 degrees a second, and its patch stays on the floor over five frames") {
  const Scene scene = load("moving_sun");
  CHECK((SceneTraits::of(scene).movingLights && !SceneTraits::of(scene).movingGeometry));
  const auto directionAt = [&](double time) { return snapshotOf(scene, time).lights.at(0).direction; };
  const glm::vec3 start = directionAt(0.0), later = directionAt(1.0);
  CHECK(std::atan2(later.x, -later.y) - std::atan2(start.x, -start.y) == Approx(glm::radians(15.0f)));
  for (int frame = 0; frame < 5; ++frame) {
    const glm::vec3 direction = directionAt(frame / 24.0);
    for (const float corner : {-0.4f, 0.4f})  // of the hole in the ceiling, 2 m above the floor of 2 m x 2 m
      for (const float along : {direction.x, direction.z})
        CHECK(std::abs(corner - 2.0f * along / direction.y) <= 1.0001f);
  }
}

TEST_CASE("the spinning box turns by 45 degrees a second about its own centre and everything else rests") {
  const Scene scene = load("spinning_box");
  const auto start = verticesSeenFromEye(scene, 0), eighth = verticesSeenFromEye(scene, 1),
             whole = verticesSeenFromEye(scene, 8);
  std::size_t vertex = 0, moved = 0;
  for (const Object& object : scene.objects) {
    for (std::uint32_t v = 0; v < object.vertexCount; ++v, ++vertex) {
      INFO(object.name);
      CHECK(glm::distance(start[vertex], whole[vertex]) < 1e-5f);  // 8 s * 45 deg/s = 360 deg
      // A corner of the box is 0.3 sqrt 2 m from the axis and moves by the chord 2 r sin(45 deg / 2).
      const float chord =
          object.name == "room/box" ? 2.0f * 0.3f * std::sqrt(2.0f) * std::sin(0.3926991f) : 0.0f;
      CHECK(glm::distance(start[vertex], eighth[vertex]) == Approx(chord).margin(1e-5));
      if (chord > 0) ++moved;
    }
  }
  CHECK(moved >= 8);
}

TEST_CASE("the cloth deforms in a loop of one second of eight frames, and all else stands") {
  const Scene scene = load("waving_cloth");
  std::size_t deforming = 0;
  const SceneSnapshot start = snapshotOf(scene, 0.0), third = snapshotOf(scene, 1.0 / 3.0),
                      whole = snapshotOf(scene, 1.0);
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    INFO(scene.objects[i].name);
    CHECK(start.objects[i].positions == whole.objects[i].positions);
    CHECK((start.objects[i].positions == third.objects[i].positions) == !scene.objects[i].sequence);
    CHECK(start.objects[i].toWorld == third.objects[i].toWorld);
    if (!scene.objects[i].sequence) continue;
    CHECK(scene.objects[i].sequence->positions.size() == 8);
    ++deforming;
  }
  CHECK(deforming == 1);
}

TEST_CASE("scenes after Dong et al. have as many vertices as theirs") {
  const auto vertices = [](const Scene& scene, const std::string& mesh) {
    std::size_t count = 0;
    for (const Object& object : scene.objects)
      if (object.name == mesh || object.name.starts_with(mesh + "/")) count += object.vertexCount;
    return count;
  };
  const Scene fine = load("urn_fine"), coarse = load("urn_coarse"), sphere = load("glossy_sphere"),
              chess = load("chess");
  CHECK(vertices(fine, "urn") == 2582);  // Fig. 10
  CHECK(vertices(coarse, "urn") == 792);
  CHECK(vertices(sphere, "sphere") == 2278);  // Fig. 11
  CHECK(fine.positions.size() == 3378);       // Table 1
  CHECK(chess.positions.size() == 4782);      // Fig. 6b
  for (const Scene* scene : {&fine, &coarse, &sphere, &chess}) {
    REQUIRE(scene->texcoords.size() == scene->positions.size());
    // Every urn, sphere and piece is a body of one skin, whose texture coordinates fill the unit square.
    glm::vec2 low(1e9f), high(-1e9f);
    for (const glm::vec2& place : scene->texcoords) low = glm::min(low, place), high = glm::max(high, place);
    CHECK(low == glm::vec2(0.0f));
    CHECK(high == glm::vec2(1.0f));
  }
}

TEST_CASE("the teapot and its table have as many vertices as in the paper's picture of them") {
  try {
    for (const char* name : {"teapot_sky", "teapot_lamp"}) {
      std::size_t count = 0;
      const Scene scene = load(name);
      for (const Object& object : scene.objects)
        if (!object.name.starts_with("lamp")) count += object.vertexCount;
      CHECK(count == 3878);  // Dong et al. 2007, Fig. 1
    }
  } catch (const AbsentError&) {
    test::skip("the teapot is not on the asset path");
  }
}

TEST_CASE("the urns are the same body, fine and coarse, and stand on their table with normals outwards") {
  for (const char* name : {"urn_fine", "urn_coarse"}) {
    const Scene scene = load(name);
    INFO(name);
    float lowest = 1.0f, widest = 0.0f, highest = 0.0f;
    for (const Object& object : scene.objects) {
      if (object.name != "urn/body") continue;
      for (std::uint32_t v = object.firstVertex; v < object.firstVertex + object.vertexCount; ++v) {
        const glm::vec3 p = scene.positions[v], n = scene.normals[v];
        lowest = std::min(lowest, p.y);
        highest = std::max(highest, p.y);
        const float radius = std::hypot(p.x, p.z);
        if (radius > widest && p.y > 0.2f && p.y < 0.26f) {
          widest = radius;
          CHECK(glm::dot(glm::vec2(n.x, n.z), glm::vec2(p.x, p.z)) > 0.9f * radius);
        }
      }
    }
    CHECK(lowest == 0.0f);
    CHECK(highest == Approx(0.44).margin(1e-4));
    CHECK(widest == Approx(0.15).margin(2e-3));
  }
}

TEST_CASE("six panels of one width have exponents from 1 to 100 000, and the sun lights the floor alone") {
  const Scene scene = load("exponents");
  std::vector<float> exponents;
  for (const Object& object : scene.objects) {
    const Material& material = scene.materials[static_cast<std::size_t>(object.parts.front().material)];
    if (material.glossy()) exponents.push_back(material.exponent);
  }
  CHECK(exponents == std::vector<float>{1, 10, 100, 1000, 10000, 100000});
  CHECK(scene.lights.front().direction == glm::dvec3(0, -1, 0));
}

TEST_CASE("stacked plates lie in one line below the lit ceiling, and the spot shines away from them") {
  const Scene scene = load("stress/stacked_plates");
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  std::vector<glm::vec3> middles;
  for (const char* name : {"lower", "middle", "upper"})
    for (std::size_t i = 0; i < scene.objects.size(); ++i)
      if (scene.objects[i].name.starts_with(name))
        middles.push_back(glm::vec3(snapshot.objects[i].toWorld * glm::vec4(0.5f, 0.5f, 0.5f, 1.0f)));
  REQUIRE(middles.size() == 3);
  for (const glm::vec3& middle : middles) {
    CHECK(middle.x == Approx(middles[0].x));
    CHECK(middle.z == Approx(middles[0].z));
    CHECK(static_cast<double>(middle.y) + snapshot.origin.y < scene.lights.front().position.y);
  }
  CHECK(middles[2].y - middles[1].y == Approx(middles[1].y - middles[0].y));
  CHECK(scene.lights.front().direction == glm::dvec3(0, 1, 0));
}

TEST_CASE("one chess piece glides along the board, and the other stands") {
  const Scene scene = load("chess");
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneSnapshot start = snapshotOf(scene, 0.0), later = snapshotOf(scene, 1.0);
    const glm::vec3 moved = glm::vec3(later.objects[i].toWorld[3] - start.objects[i].toWorld[3]);
    const bool glides = scene.objects[i].name.starts_with("gliding");
    CHECK(glm::length(moved) == Approx(glides ? 0.04 : 0.0).margin(1e-6));
  }
}

TEST_CASE("no light of its lamp reaches the inside of the vase, whose walls are two surfaces 6 mm apart") {
  const Scene scene = load("vase");
  CHECK(scene.triangleCount() == 12 + 2 * (2 * 14 * 32 + 32) + 2 * 32);
  const Light& lamp = scene.lights.at(0);
  const auto radii = [&](const std::string& name, float height) {
    const Object& object = objectNamed(scene, name);
    float least = 1.0f, most = 0.0f;
    for (std::uint32_t v = 0; v < object.vertexCount; ++v) {
      const glm::vec3 place = scene.positions[object.firstVertex + v];
      if (std::abs(place.y - height) > 0.004f) continue;
      least = std::min(least, std::hypot(place.x, place.z));
      most = std::max(most, std::hypot(place.x, place.z));
    }
    return std::pair(least, most);
  };
  // The lamp is below the rim: what comes in over it goes up, and nothing inside is higher than the rim.
  CHECK(lamp.position.y < 0.44);
  CHECK(radii("vase/outside", 0.45f).first - radii("vase/inside", 0.45f).second ==
        Approx(0.006).margin(2e-4));
}

TEST_CASE(
    "the Cornell box looks the same a thousand kilometres away, half a millimetre wide and five kilometres "
    "wide") {
  const auto reference = verticesSeenFromEye(load("cornell"), 0);
  for (const auto& [name, scale] :
       std::map<std::string, float>{{"far_away", 1.0f}, {"tiny", 1e-3f}, {"huge", 1e4f}}) {
    INFO(name);
    const auto vertices = verticesSeenFromEye(load("stress/" + name), 0);
    REQUIRE(vertices.size() == reference.size());
    float largest = 0.0f;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      largest = std::max(largest, glm::distance(vertices[i] / scale, reference[i]));
    CHECK(largest < 1e-6f);  // m; a few steps of a float at 1 m
  }
}
