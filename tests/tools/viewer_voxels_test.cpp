// Voxels in the view of a camera, and depths in the view of a light: each pixel against a ray in closed form.
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "lumivox/base/error.h"
#include "lumivox/pipeline/ports.h"
#include "support/techniques.h"
#include "viewer/port_view.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::viewer;

namespace {

constexpr int kSide = 4;  // voxels along a side of the grids here

GridPlacement smallGrid() {
  return {glm::vec3(-1.0f, -0.5f, 0.25f), 0.5f, glm::ivec3(kSide)};
}

/// Looks at the middle of the grid from the side, so that no ray is parallel to an axis.
CameraView sideView() {
  CameraView camera;
  camera.eye = {1.5f, 2.0f, 4.0f};
  camera.forward = glm::normalize(glm::vec3(0.0f, 0.5f, 1.25f) - camera.eye);
  camera.right = glm::normalize(glm::cross(camera.forward, glm::vec3(0, 1, 0)));
  camera.up = glm::cross(camera.right, camera.forward);
  camera.tanHalfFov = 0.5f;
  camera.width = 80;
  camera.height = 64;
  return camera;
}

gpu::TextureRef volume(gpu::Format format, const std::vector<float>& values) {
  gpu::TextureDescription description;
  description.kind = gpu::TextureKind::d3;
  description.format = format;
  description.width = description.height = description.depth = kSide;
  auto texture = std::make_shared<gpu::Texture>(device(), description, "test");
  texture->uploadFloats(0, values);
  return texture;
}

std::size_t indexOf(const glm::ivec3& voxel) {
  return static_cast<std::size_t>(voxel.x + kSide * (voxel.y + kSide * voxel.z));
}

template <class Port>
VoxelPicture drawn(const Port& port, const std::string& field, int level = 0, float above = 0.0f) {
  PortContents contents(portKind<Port>());
  PortTraits<Port>::contents(port, contents);
  return VoxelView(device()).draw(contents, field, level, above, sideView());
}

/// How deep a pixel's ray passes in a box, m; below 0: how far it stays outside, about.
double depthInBox(const glm::dvec3& low, const glm::dvec3& high, int x, int y) {
  const CameraView camera = sideView();
  const glm::dvec3 direction = glm::normalize(
      glm::dvec3(camera.direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f)));
  const glm::dvec3 a = (low - glm::dvec3(camera.eye)) / direction,
                   b = (high - glm::dvec3(camera.eye)) / direction;
  const glm::dvec3 near = glm::min(a, b), far = glm::max(a, b);
  return std::min({far.x, far.y, far.z}) - std::max({near.x, near.y, near.z});
}
double depthInVoxel(const glm::ivec3& voxel, int x, int y) {
  const GridPlacement grid = smallGrid();
  const glm::dvec3 low = glm::dvec3(grid.low) + glm::dvec3(voxel) * 0.5;
  return depthInBox(low, low + 0.5, x, y);
}

/// How much nearer than its radius a pixel's ray passes the centre of a sphere, m.
double depthInSphere(const glm::dvec3& centre, double radius, int x, int y) {
  const CameraView camera = sideView();
  const glm::dvec3 direction = glm::normalize(
      glm::dvec3(camera.direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f)));
  const glm::dvec3 way = centre - glm::dvec3(camera.eye);
  return radius - glm::length(way - glm::dot(way, direction) * direction);
}

/// The pixels that are drawn are those whose `depth` is above 0; nearer than `margin` either is right.
template <class Depth>
void checkSilhouette(const VoxelPicture& picture, double margin, const Depth& depth) {
  int drawnPixels = 0;
  for (int y = 0; y < picture.brightness.height(); ++y)
    for (int x = 0; x < picture.brightness.width(); ++x) {
      const double inside = depth(x, y);
      const bool isDrawn = picture.brightness.at(x, y, 0) > 0.0f;
      drawnPixels += isDrawn ? 1 : 0;
      if (std::abs(inside) < margin) continue;
      INFO("pixel " << x << " " << y);
      CHECK(isDrawn == (inside > 0.0));
    }
  CHECK(drawnPixels > 10);
}

}  // namespace

TEST_CASE("a voxel is drawn as the cube that it is, whatever holds it, with its value in each pixel") {
  const glm::ivec3 voxel(1, 2, 3);
  const auto checkCube = [&](const VoxelPicture& picture, float value) {
    checkSilhouette(picture, 1e-4, [&](int x, int y) { return depthInVoxel(voxel, x, y); });
    for (std::size_t i = 0; i < picture.brightness.values().size(); ++i)
      if (picture.brightness.values()[i] > 0.0f)
        CHECK(picture.values.values()[i * static_cast<std::size_t>(picture.values.channels())] ==
              Approx(value));
  };
  SECTION("an opacity") {
    std::vector<float> opacity(kSide * kSide * kSide, 0.0f);
    opacity[indexOf(voxel)] = 0.4f;
    const VoxelPicture picture =
        drawn(OccupancyGrid{smallGrid(), volume(gpu::Format::r8, opacity)}, "opacity");
    CHECK(picture.values.channels() == 1);
    checkCube(picture, 0.4f);
  }
  SECTION("a radiance in its unit") {
    std::vector<float> radiance(4 * kSide * kSide * kSide, 0.0f);
    radiance[4 * indexOf(voxel)] = 0.25f;
    RadianceGrid grid;
    grid.grid = smallGrid();
    grid.radiance = volume(gpu::Format::rgba16f, radiance);
    grid.unit = 8.0f;
    const VoxelPicture picture = drawn(grid, "radiance");
    CHECK(picture.values.channels() == 3);
    CHECK(picture.unit == "W/(sr m^2)");
    checkCube(picture, 2.0f);
  }
  SECTION("a bit of a stack") {
    gpu::TextureDescription description;
    description.kind = gpu::TextureKind::d2Array;
    description.format = gpu::Format::rgba32ui;
    description.width = description.height = kSide;
    BinaryGrid grid{smallGrid(), std::make_shared<gpu::Texture>(device(), description, "test")};
    std::vector<std::uint32_t> words(4 * kSide * kSide, 0u);
    words[4 * static_cast<std::size_t>(voxel.x + kSide * voxel.y)] = 1u << voxel.z;
    grid.stacks->upload(0, std::as_bytes(std::span(words)));
    checkCube(drawn(grid, "occupancy"), 1.0f);
  }
  SECTION("fragments of a list, counted") {
    VoxelFragments list;
    list.grid = smallGrid();
    list.capacity = 3;
    std::vector<std::uint32_t> words(3 * 6, 0u);
    for (std::size_t i = 0; i < 2; ++i)
      words[6 * i] = static_cast<std::uint32_t>(voxel.x | voxel.y << 10 | voxel.z << 20);
    list.fragments = std::make_shared<gpu::Buffer>(device(), words.size() * 4, "test");
    list.fragments->uploadValues(std::span<const std::uint32_t>(words));
    const std::vector<std::uint32_t> count{2, 1, 1, 1};
    list.count = std::make_shared<gpu::Buffer>(device(), count.size() * 4, "test");
    list.count->uploadValues(std::span<const std::uint32_t>(count));
    checkCube(drawn(list, "fragments"), 2.0f);
    checkCube(drawn(list, "occupancy"), 1.0f);
  }
}

TEST_CASE("of voxels behind each other the nearer is seen, and those that are not above the bound are not") {
  // The eye is above, to the right and in front: (3,3,3) hides what is behind it.
  const glm::ivec3 nearer(3, 3, 3), farther(1, 1, 0);
  std::vector<float> opacity(kSide * kSide * kSide, 0.0f);
  opacity[indexOf(nearer)] = 0.2f;
  opacity[indexOf(farther)] = 0.8f;
  const OccupancyGrid grid{smallGrid(), volume(gpu::Format::r8, opacity)};
  const VoxelPicture both = drawn(grid, "opacity");
  int hidden = 0;
  for (int y = 0; y < both.values.height(); ++y)
    for (int x = 0; x < both.values.width(); ++x) {
      const double front = depthInVoxel(nearer, x, y), back = depthInVoxel(farther, x, y);
      if (std::abs(front) < 1e-4 || std::abs(back) < 1e-4) continue;
      hidden += front > 0.0 && back > 0.0 ? 1 : 0;
      INFO("pixel " << x << " " << y);
      CHECK(both.values.at(x, y, 0) == Approx(front > 0.0 ? 0.2 : back > 0.0 ? 0.8 : 0.0).margin(1e-6));
    }
  CHECK(hidden > 10);
  checkSilhouette(drawn(grid, "opacity", 0, 0.5f), 1e-4,
                  [&](int x, int y) { return depthInVoxel(farther, x, y); });
}

TEST_CASE("a coarser level is drawn with its larger voxels") {
  std::vector<float> finest(4 * kSide * kSide * kSide, 0.0f), coarser(4 * 8, 0.0f);
  coarser[4 * 7] = 1.0f;  // voxel (1,1,1) of two along each side
  gpu::TextureDescription description;
  description.kind = gpu::TextureKind::d3;
  description.format = gpu::Format::rgba32f;
  description.width = description.height = description.depth = kSide;
  description.levels = 2;
  RadianceGrid grid;
  grid.grid = smallGrid();
  grid.radiance = std::make_shared<gpu::Texture>(device(), description, "test");
  grid.radiance->uploadFloats(0, finest);
  grid.radiance->uploadFloats(1, coarser);
  const glm::dvec3 low = glm::dvec3(smallGrid().low) + 1.0;
  checkSilhouette(drawn(grid, "radiance", 1), 1e-4,
                  [&](int x, int y) { return depthInBox(low, low + 1.0, x, y); });
  CHECK_THROWS_WITH(drawn(grid, "radiance", 2), Catch::Contains("no level 2") && Catch::Contains("0..1"));
  CHECK_THROWS_WITH(drawn(grid, "albedo"), Catch::Contains("no such field") && Catch::Contains("radiance"));
}

TEST_CASE(
    "spherical harmonics are drawn as lobes: band 0 as a sphere, band 1 as one that touches the centre") {
  const glm::ivec3 voxel(2, 1, 2);
  const glm::dvec3 centre = glm::dvec3(smallGrid().low) + (glm::dvec3(voxel) + 0.5) * 0.5;
  const auto harmonic = [&](std::size_t which, float value) {
    std::vector<float> coefficients(4 * kSide * kSide * kSide, 0.0f);
    coefficients[4 * indexOf(voxel) + which] = value;
    ShGrid grid;
    grid.levels.push_back({smallGrid(), {volume(gpu::Format::rgba32f, coefficients), nullptr, nullptr}});
    return drawn(grid, kLobes);
  };
  // Y00 alone is alike in all directions, and reaches the sides of the voxel.
  const VoxelPicture mean = harmonic(0, 3.0f);
  checkSilhouette(mean, 1e-3, [&](int x, int y) { return depthInSphere(centre, 0.25, x, y); });
  for (std::size_t i = 0; i < mean.brightness.values().size(); ++i)
    if (mean.brightness.values()[i] > 0.0f) CHECK(mean.values.values()[3 * i] == Approx(3.0 * 0.2820948));
  // r = s cos(angle to x): a sphere of the diameter s through the centre. Y11 is along x, Y1-1 along y, Y10
  // along z.
  const glm::dvec3 axes[]{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
  for (std::size_t k = 1; k < 4; ++k) {
    INFO("harmonic " << k);
    const glm::dvec3 way = 0.125 * axes[k - 1];
    checkSilhouette(harmonic(k, 2.0f), 2e-3,
                    [&](int x, int y) { return depthInSphere(centre + way, 0.125, x, y); });
    checkSilhouette(harmonic(k, -2.0f), 2e-3,
                    [&](int x, int y) { return depthInSphere(centre - way, 0.125, x, y); });
  }
}

TEST_CASE("depths that a light sees are shown as metres behind the near plane") {
  gpu::TextureDescription description;
  description.kind = gpu::TextureKind::d2Array;
  description.format = gpu::Format::depth32f;
  description.width = description.height = 4;
  description.depth = 2;
  ShadowMap map;
  map.depth = std::make_shared<gpu::Texture>(device(), description, "test");
  map.depth->clear(glm::vec4(0.5f));
  const std::vector<glm::mat4> views{glm::mat4(1.0f), glm::orthoRH_ZO(-1.0f, 1.0f, -1.0f, 1.0f, 2.0f, 8.0f)};
  map.views = std::make_shared<gpu::Buffer>(device(), views.size() * sizeof(glm::mat4), "test");
  map.views->uploadValues(std::span<const glm::mat4>(views));
  PortContents contents(portKind<ShadowMap>());
  PortTraits<ShadowMap>::contents(map, contents);
  PortChoice choice;
  choice.slice = 1;
  const PortPicture picture = pictureOfPort(contents, choice, sideView(),
                                            []() -> VoxelView& { throw Error("no voxels are asked for"); });
  CHECK(picture.unit == "m");
  CHECK(picture.slices == 2);
  for (const float value : picture.image.values()) CHECK(value == Approx(3.0));  // half of 2..8
  choice.channel = Channel::w;
  CHECK_THROWS_WITH(pictureOfPort(contents, choice, sideView(), []() -> VoxelView& { throw Error("none"); }),
                    Catch::Contains("no component w"));
}
