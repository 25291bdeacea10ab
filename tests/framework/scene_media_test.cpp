// Media in scene texts: particles as a pure function of time, volume files, and what is refused.
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <numbers>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/scene/medium.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

Medium smoke() {
  Medium medium;
  medium.particles = 2000;
  medium.source = {0.3, -0.2, 5};
  medium.spread = 0.2;
  medium.radius = 0.1;
  medium.rise = 0.5;
  medium.drift = 0.1;
  medium.life = 4.0;
  return medium;
}

double massOf(const DensityVolume& volume) {
  double sum = 0.0;
  for (const float value : volume.values) sum += value;
  return sum * std::pow(volume.voxelSize, 3.0);
}

/// A scene text with one medium, written to a directory of its own.
struct Text {
  TemporaryDirectory directory;
  Scene load(const std::string& medium) const {
    return loadScene(directory.write(
        "a.scene", "scene \"A\" {\n  camera main { eye 0 0 3  target 0 0 0 }\n  " + medium + "\n}\n"));
  }
  std::string refusal(const std::string& medium) const {
    return messageOf<Error>([&] { load(medium); });
  }
  void write(const char* name, const openvdb::GridPtrVec& grids) const {
    openvdb::io::File file((directory.path() / name).string());
    file.write(grids);
  }
};

/// A small density with a different value everywhere.
openvdb::FloatGrid::Ptr ramp(const openvdb::math::Transform::Ptr& transform) {
  openvdb::initialize();
  auto grid = openvdb::FloatGrid::create(0.0f);
  grid->setName("density");
  grid->setTransform(transform);
  for (int z = 0; z < 3; ++z)
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 5; ++x)
        grid->tree().setValue({x - 2, y + 10, z}, 1.0f + static_cast<float>(x + 10 * y + 100 * z));
  return grid;
}

}  // namespace

TEST_CASE("particles stay inside their bounds, and each life of each particle is another one") {
  const Medium medium = smoke();
  const auto [low, high] = particleBounds(medium);
  for (const double time : {0.0, 0.7, 3.9999999, 4.0, 1e6, -3.0}) {
    const ParticleClock clock = particleClock(medium, time);
    double age = 0.0, height = 0.0;
    for (std::uint32_t i = 0; i < 2000; ++i) {
      const glm::vec4 particle = particleAt(medium, clock, i);
      const glm::dvec3 position = medium.source + glm::dvec3(particle);
      CHECK(glm::all(glm::greaterThanEqual(position - medium.radius, low - 1e-6)));
      CHECK(glm::all(glm::lessThanEqual(position + medium.radius, high + 1e-6)));
      CHECK((particle.w >= 0.0f && particle.w < 4.0f));
      age += particle.w / 2000.0;
      height += (particle.y) / 2000.0;
    }
    // Births are spread evenly over a life of 4 s: the mean age is 2 s with a deviation of 4 / sqrt(12 N) =
    // 0.026.
    CHECK(age == Approx(2.0).margin(0.1));
    CHECK(height == Approx(1.0).margin(0.06));
  }
  const glm::vec4 now = particleAt(medium, particleClock(medium, 1.0), 7),
                  later = particleAt(medium, particleClock(medium, 5.0), 7);
  CHECK(now.w == Approx(later.w).margin(1e-5));
  CHECK(now.x != later.x);
}

TEST_CASE("the density of a cloud integrates to its mass, 64 pi R^3 / 315") {
  const Medium medium = smoke();
  const double expected = 2000 * 64.0 * std::numbers::pi / 315.0 * 1e-3;
  CHECK(2000 * particleMass(medium) == Approx(expected).epsilon(1e-12));
  CHECK(massOf(particleDensity(medium, 2.5, medium.radius / 8.0)) == Approx(expected).epsilon(1e-4));
  CHECK(massOf(particleDensity(medium, 2.5, medium.radius / 4.0)) == Approx(expected).epsilon(1e-3));
}

TEST_CASE("a volume file stands where its transform says, its voxels' centres at whole indices") {
  const Text text;
  auto transform = openvdb::math::Transform::createLinearTransform(0.25);
  transform->postTranslate({10.0, 0.0, -3.0});
  text.write("a.vdb", {ramp(transform)});
  const Scene scene = text.load("medium a { file \"a.vdb\"  extinction 2 /m }");
  const DensityVolume& volume = *scene.media.front().volume;
  CHECK(volume.resolution == glm::ivec3(5, 4, 3));
  CHECK(volume.voxelSize == 0.25);
  // Index (-2, 10, 0) is the centre of the first voxel: half a voxel above its corner.
  CHECK(volume.low.x == Approx(10.0 - 0.5 - 0.125));
  CHECK(volume.low.y == Approx(2.5 - 0.125));
  CHECK(volume.low.z == Approx(-3.0 - 0.125));
  for (std::size_t i = 0; i < volume.values.size(); ++i) {
    const auto x = i % 5, y = i / 5 % 4, z = i / 20;
    CHECK(volume.values[i] == 1.0f + static_cast<float>(x + 10 * y + 100 * z));
  }
  const Bounds bounds = mediumBounds(scene.media.front(), snapshotOf(scene, 0.0));
  CHECK(bounds.high.x - bounds.low.x == Approx(6 * 0.25));
  // The file's content is part of the scene's identity.
  const ContentHash before = scene.hash;
  auto other = ramp(transform);
  other->tree().setValue({0, 11, 1}, 0.5f);
  text.write("a.vdb", {other});
  CHECK(text.load("medium a { file \"a.vdb\"  extinction 2 /m }").hash != before);
}

TEST_CASE("a turned or stretched volume is resampled, and keeps its mass and its middle") {
  const Text text;
  openvdb::math::Mat4d matrix = openvdb::math::Mat4d::identity();
  matrix.postRotate(openvdb::math::Y_AXIS, 0.6);
  matrix.postScale(openvdb::Vec3d(0.1, 0.2, 0.1));
  auto grid = openvdb::FloatGrid::create(0.0f);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(matrix));
  double sum = 0.0, weightedY = 0.0;
  for (int z = -8; z <= 8; ++z)
    for (int y = -8; y <= 8; ++y)
      for (int x = -8; x <= 8; ++x) {
        const float value = std::exp(-0.05f * static_cast<float>(x * x + (y - 2) * (y - 2) + z * z));
        grid->tree().setValue({x, y, z}, value);
        sum += value * 0.1 * 0.2 * 0.1;
        weightedY += value * 0.1 * 0.2 * 0.1 * (0.2 * y);
      }
  text.write("turned.vdb", {grid});
  const Scene scene = text.load("medium a { file \"turned.vdb\"  extinction 2 /m }");
  const DensityVolume& volume = *scene.media.front().volume;
  CHECK(volume.voxelSize == Approx(0.1));
  CHECK(massOf(volume) == Approx(sum).epsilon(0.005));
  double y = 0.0;
  for (std::size_t i = 0; i < volume.values.size(); ++i) {
    const auto row =
        i / static_cast<std::size_t>(volume.resolution.x) % static_cast<std::size_t>(volume.resolution.y);
    y += volume.values[i] * std::pow(volume.voxelSize, 3.0) *
         (volume.low.y + volume.voxelSize * (static_cast<double>(row) + 0.5));
  }
  CHECK(y == Approx(weightedY).epsilon(0.01));
}

TEST_CASE("what is no density is refused with the file, the grid and what was expected") {
  const auto unit = openvdb::math::Transform::createLinearTransform(1.0);
  const auto changed = [&](const auto& change) {
    auto grid = ramp(unit);
    change(*grid);
    return grid;
  };
  auto vectors = openvdb::Vec3SGrid::create();
  vectors->setName("flow");
  auto wide = openvdb::FloatGrid::create(0.0f);
  for (const int x : {0, 5000}) wide->tree().setValue({x, 0, 0}, 1.0f);
  const auto frustum =
      openvdb::math::Transform::createFrustumTransform(openvdb::BBoxd({0, 0, 0}, {10, 10, 10}), 0.5, 10.0);
  const std::vector<std::tuple<openvdb::GridPtrVec, const char*, Tells>> refusals{
      {{ramp(unit), openvdb::Vec3SGrid::create()}, "", Tells("several grids", "density")},
      {{ramp(unit)}, "grid densty ", Tells("grid", "densty", "mean", "density")},
      {{vectors}, "", Tells("flow", "vec3s", "float")},
      {{changed([](auto& grid) { grid.setGridClass(openvdb::GRID_LEVEL_SET); })}, "", Tells("level set")},
      {{openvdb::FloatGrid::create(0.0f)}, "", Tells("empty")},
      {{openvdb::FloatGrid::create(0.5f)}, "", Tells("background 0.5")},
      {{changed([](auto& grid) {
         grid.tree().setValue({0, 11, 1}, -2.0f);
       })},
       "",
       Tells(-2, 0, 11, 1)},
      {{ramp(frustum)}, "", Tells("linear")},
      {{wide}, "", Tells("5001 x 1 x 1", 1024)}};
  const Text text;
  for (const auto& [grids, word, told] : refusals) {
    text.write("a.vdb", grids);
    CHECK_THAT(text.refusal(std::string("medium a { file \"a.vdb\" ") + word + " extinction 1 /m }"),
               told && Tells("a.vdb"));
  }
}

TEST_CASE("an absent, foreign or truncated volume file is refused wherever it ends") {
  const Text text;
  text.write("whole.vdb", {ramp(openvdb::math::Transform::createLinearTransform(0.5))});
  const std::string whole = readFile(text.directory.path() / "whole.vdb"),
                    medium = "medium a { file \"a.vdb\"  extinction 1 /m }";
  CHECK_THAT(text.refusal(medium), Tells("a.vdb", "exist"));
  for (const char* foreign : {"this is no volume", ""}) {
    text.directory.write("a.vdb", foreign);
    CHECK_THAT(text.refusal(medium), Tells("a.vdb", "whole .vdb"));
  }
  for (int part = 1; part < 40; ++part) {
    const std::size_t length = whole.size() * static_cast<std::size_t>(part) / 40;
    CAPTURE(length, whole.size());
    text.directory.write("a.vdb", whole.substr(0, length));
    CHECK_THAT(text.refusal(medium), Tells("a.vdb"));
  }
}

TEST_CASE("words of a medium that contradict each other are refused at their place") {
  const auto [medium, told] = GENERATE(table<std::string, Tells>({
      {"low 0 0 0", Tells("both corners")},
      {"low 0 0 0  high 1 0 1", Tells("below", "high")},
      {"rise 1 m/s", Tells("rise", "particles")},
      {"particles 5  radius 1  low 0 0 0  high 1 1 1", Tells("not even")},
      {"grid density", Tells("grid", "file")},
      {"", Tells("no triangles")},
  }));
  const Text text;
  CHECK_THAT(text.refusal("medium a { extinction 1 /m  " + medium + " }"), told && Tells("a.scene:3"));
  std::string many;
  for (int i = 0; i < 5; ++i)
    many += "medium a" + std::to_string(i) + " { extinction 1 /m  particles 5  radius 1 }\n";
  CHECK_THAT(text.refusal(many), Tells("media", 4));
}

TEST_CASE("a medium between two corners is homogeneous") {
  const Scene scene = Text().load("medium a { extinction 1 2 3 /m  low 0 0 0  high 1 2 3  albedo 0.5 }");
  CHECK(scene.media.front().homogeneous());
  CHECK(scene.media.front().box->second == glm::dvec3(1, 2, 3));
}
