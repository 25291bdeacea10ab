// The well-known models. They are not part of this project: where they are absent, these tests say that they
// did not run.
#include <algorithm>

#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/scene/scene.h"
#include "support/support.h"

using namespace lumivox;

namespace {

std::optional<Scene> load(const std::string& name) {
  const LogCapture quiet;
  try {
    return loadScene(test::sourceDirectory() / "scenes" / (name + ".scene"));
  } catch (const AbsentError& absent) {
    test::skip(absent.what());
    return std::nullopt;
  }
}

/// Nothing that a renderer could stumble over.
void requireSound(const Scene& scene) {
  REQUIRE(scene.normals.size() == scene.positions.size());
  REQUIRE(scene.texcoords.size() == scene.positions.size());
  const auto count = [](const auto& all, const auto& isBad) {
    return std::count_if(all.begin(), all.end(), isBad);
  };
  CHECK(count(scene.normals, [](const glm::vec3& n) { return std::abs(glm::dot(n, n) - 1.0f) > 1e-4f; }) ==
        0);
  CHECK(count(scene.positions, [](const glm::vec3& p) { return !std::isfinite(p.x + p.y + p.z); }) == 0);
  CHECK(count(scene.indices, [&](std::uint32_t index) { return index >= scene.positions.size(); }) == 0);
  CHECK_FALSE((scene.lights.empty() && !SceneTraits::of(scene).emission));
}

/// The part of the image that the bounds of what is there cover, in each direction, is not small.
void requireSeen(const Scene& scene) {
  for (const Camera& camera : scene.cameras) {
    const SceneSnapshot snapshot = snapshotOf(scene, 0.0, camera.name);
    std::size_t inside = 0, vertices = 0;
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
      const Object& object = scene.objects[o];
      for (std::uint32_t v = 0; v < object.vertexCount; ++v) {
        const glm::vec3 p =
            glm::vec3(snapshot.objects[o].toWorld * glm::vec4(scene.positions[object.firstVertex + v], 1)) -
            snapshot.camera.eye;
        const float depth = glm::dot(p, snapshot.camera.forward);
        ++vertices;
        if (depth <= 0) continue;
        const float aspect =
            static_cast<float>(snapshot.camera.width) / static_cast<float>(snapshot.camera.height);
        const float x = glm::dot(p, snapshot.camera.right) / (depth * snapshot.camera.tanHalfFov * aspect);
        const float y = glm::dot(p, snapshot.camera.up) / (depth * snapshot.camera.tanHalfFov);
        inside += std::abs(x) < 1 && std::abs(y) < 1 ? 1u : 0u;
      }
    }
    INFO(camera.name);
    CHECK(inside > vertices / 10);
  }
}

/// Triangles of objects that are sequences of so many frames.
std::size_t trianglesThatDeform(const Scene& scene, std::size_t frames) {
  std::size_t triangles = 0;
  for (const Object& object : scene.objects) {
    if (!object.sequence) continue;
    CHECK(object.sequence->positions.size() == frames);
    for (const Part& part : object.parts) triangles += part.indexCount / 3;
  }
  return triangles;
}

/// How far above what stands below it the lowest vertex of any frame of what deforms is, m.
double leastHeight(const Scene& scene, int frames) {
  double least = 1e30;
  for (int frame = 0; frame < frames; ++frame) {
    const SceneSnapshot snapshot = snapshotOf(scene, frame / 24.0);
    glm::vec3 lowest(1e30f);
    for (const ObjectState& object : snapshot.objects)
      for (const glm::vec3& position : object.positions) {
        const glm::vec3 place(object.toWorld * glm::vec4(position, 1.0f));
        if (place.y < lowest.y) lowest = place;
      }
    double floor = -1e30;
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
      if (scene.objects[o].sequence) continue;
      const auto vertex = [&](std::uint32_t index) {
        return glm::dvec3(snapshot.objects[o].toWorld *
                          glm::vec4(scene.positions[scene.indices[index]], 1.0f));
      };
      for (const Part& part : scene.objects[o].parts)
        for (std::uint32_t i = part.firstIndex; i < part.firstIndex + part.indexCount; i += 3) {
          const glm::dvec3 a = vertex(i), b = vertex(i + 1) - a, c = vertex(i + 2) - a,
                           p = glm::dvec3(lowest) - a;
          const double area = b.x * c.z - c.x * b.z, u = (p.x * c.z - c.x * p.z) / area,
                       v = (b.x * p.z - p.x * b.z) / area, height = u * b.y + v * c.y;
          if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && height < p.y + 0.5)
            floor = std::max(floor, a.y + height);
        }
    }
    least = std::min(least, lowest.y - floor);
  }
  return least;
}

}  // namespace

TEST_CASE("the models of the archive have their triangles with area, and stand in the image") {
  // Files hold triangles of zero area too; Sibenik lets light in through its panes of coverage 0.1.
  const auto [name, triangles] = GENERATE(table<const char*, std::size_t>({
      {"sponza_crytek", 262266},
      {"sponza_dabrovic", 66453},
      {"sibenik", 75284 - 2760 - 10},
      {"cornell_original", 36},
      {"cornell_sphere", 2188},
      {"cornell_glossy_mcguire", 1112},
      {"bunny", 69451 + 4},
      {"dragon", 100000 + 4},
      {"teapot", 6320 + 2},
  }));
  const auto scene = load(name);
  if (!scene) return;
  CAPTURE(name);
  CHECK(scene->triangleCount() == triangles);
  requireSound(*scene);
  requireSeen(*scene);
  const std::string model = name;
  const SceneTraits traits = SceneTraits::of(*scene);
  if (model == "sponza_crytek") {
    CHECK(scene->materials.size() == 25);
    CHECK(scene->textures.size() == 27);  // 24 diffuse images in use and 3 masks
    CHECK((traits.textures && traits.masks && traits.environment && traits.movingCamera));
    CHECK_FALSE((traits.glossy || traits.emission || traits.movingGeometry));
  } else if (model == "sponza_dabrovic") {
    CHECK(scene->textures.size() == 12);
  } else if (model == "sibenik") {
    CHECK(std::none_of(scene->materials.begin(), scene->materials.end(),
                       [](const Material& m) { return m.name == "sibenik/staklo"; }));
  } else if (model.rfind("cornell", 0) == 0) {
    CHECK(traits.areaLights == 1);
  } else {
    // Smooth surfaces share their vertices: fewer than one for each triangle.
    CHECK(scene->positions.size() < scene->triangleCount());
  }
}

TEST_CASE("the horse gallops in a loop of one second") {
  const auto scene = load("horse_gallop");
  if (!scene) return;
  REQUIRE(scene->objects.at(0).sequence.has_value());
  CHECK(scene->objects[0].sequence->positions.size() == 24);
  CHECK(SceneTraits::of(*scene).movingGeometry);
  requireSound(*scene);
  requireSeen(*scene);
  const SceneSnapshot start = snapshotOf(*scene, 0.0), half = snapshotOf(*scene, 0.5),
                      again = snapshotOf(*scene, 1.0);
  CHECK_FALSE(start.objects[0].positions == half.objects[0].positions);
  CHECK(start.objects[0].positions == again.objects[0].positions);
}

TEST_CASE("in an arena the horse gallops between walls of other colours under two spots, on its floor") {
  const auto scene = load("horse_arena");
  if (!scene) return;
  requireSound(*scene);
  const SceneTraits traits = SceneTraits::of(*scene);
  CHECK(traits.spotLights == 2);
  CHECK(traits.areaLights + traits.directionalLights + traits.pointLights == 0);
  CHECK(trianglesThatDeform(*scene, 24) > 16000);
  CHECK(leastHeight(*scene, 24) == Approx(0.005).margin(0.01));
  CHECK(scene->cameras.front().width == 1024);
  CHECK(scene->cameras.front().height == 768);
}

TEST_CASE("in Sponza a fifth of the triangles is the horse's, which gallops on the floor") {
  const auto scene = load("horse_sponza");
  if (!scene) return;
  requireSound(*scene);
  const auto moving = static_cast<double>(trianglesThatDeform(*scene, 24)),
             all = static_cast<double>(scene->triangleCount());
  CAPTURE(moving, all);
  CHECK(moving / all == Approx(0.2).margin(0.01));
  CHECK(leastHeight(*scene, 24) == Approx(0.005).margin(0.01));
}
