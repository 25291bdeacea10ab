// Fields of voxels along the axes of their grid: the largest value of each column, whatever holds the voxels.
#include <cmath>
#include <limits>

#include "lumivox/base/error.h"
#include "lumivox/pipeline/ports.h"
#include "lumivox/toolkit/voxel_view.h"
#include "support/techniques.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

PortContents::Field fieldOf(const glm::ivec3& resolution, VoxelSource source) {
  static const PortField what{"test", "a quantity", "1"};
  return {"test", "1", &what, 0, {glm::dvec3(0.0), glm::dvec3(1.0), resolution}, std::move(source), {}};
}

std::vector<ImageBuffer> largest(const glm::ivec3& resolution, VoxelSource source) {
  shader::ShaderLibrary shaders(device());
  const VoxelCanvas canvas(shaders);
  return largestAlongAxes(canvas, VoxelField(canvas, fieldOf(resolution, std::move(source))));
}

VoxelsRead voxelsOf(std::vector<VoxelsRead::Voxel> voxels, int components) {
  return {components, 0, [voxels = std::move(voxels)] { return voxels; }};
}

VoxelList listOf(const std::vector<glm::ivec3>& voxels, bool counts) {
  std::vector<std::uint32_t> words;
  for (const glm::ivec3& voxel : voxels) {
    words.push_back(static_cast<std::uint32_t>(voxel.x | voxel.y << 10 | voxel.z << 20));
    words.push_back(~0u);
  }
  VoxelList list;
  list.itemBytes = 2 * sizeof(std::uint32_t);
  list.capacity = voxels.size();
  list.counts = counts;
  list.items = std::make_shared<gpu::Buffer>(device(), words.size() * sizeof(words[0]), "test");
  list.items->uploadValues(std::span<const std::uint32_t>(words));
  const std::vector<std::uint32_t> count{static_cast<std::uint32_t>(voxels.size()) + 5u};  // more than it has
  list.count = std::make_shared<gpu::Buffer>(device(), sizeof(count[0]), "test");
  list.count->uploadValues(std::span<const std::uint32_t>(count));
  return list;
}

}  // namespace

TEST_CASE("the largest value of each column is seen along each axis, component by component") {
  const std::vector<ImageBuffer> views = largest({4, 2, 2}, voxelsOf({{{0, 0, 0}, glm::vec3(1, -4, 0)},
                                                                      {{0, 0, 1}, glm::vec3(3, 2, 0)},
                                                                      {{3, 1, 0}, glm::vec3(0, 0, 9)}},
                                                                     3));
  REQUIRE(views.size() == 3);
  // Along z, x to the right and y up: both voxels of the column.
  REQUIRE((views[2].width() == 4 && views[2].height() == 2));
  CHECK(views[2].at(0, 1, 0) == 3.0f);
  CHECK(views[2].at(0, 1, 1) == 4.0f);
  CHECK(views[2].at(3, 0, 2) == 9.0f);
  CHECK(views[2].at(1, 1, 0) == 0.0f);
  // Along x, z to the left; along y, z downwards.
  REQUIRE((views[0].width() == 2 && views[0].height() == 2));
  CHECK(views[0].at(1, 1, 1) == 4.0f);
  CHECK(views[0].at(0, 1, 0) == 3.0f);
  CHECK(views[0].at(1, 0, 2) == 9.0f);
  REQUIRE((views[1].width() == 4 && views[1].height() == 2));
  CHECK(views[1].at(0, 0, 1) == 4.0f);
  CHECK(views[1].at(0, 1, 0) == 3.0f);
  CHECK(views[1].at(3, 0, 2) == 9.0f);
}

TEST_CASE("a field has the same values whatever holds it: texels, stacks of bits, lists, a filled box") {
  const glm::ivec3 size(5, 3, 200);
  const std::vector<glm::ivec3> voxels{{4, 0, 0},  {4, 0, 0},   {1, 2, 31},
                                       {0, 1, 32}, {2, 0, 150}, {3, 1, 199}};
  const auto indexOf = [&](const glm::ivec3& voxel) {
    return static_cast<std::size_t>(voxel.x + size.x * (voxel.y + size.y * voxel.z));
  };
  std::vector<float> numbers(static_cast<std::size_t>(size.x * size.y * size.z));
  std::vector<std::uint32_t> bits(static_cast<std::size_t>(4 * size.x * size.y * 2));
  for (const glm::ivec3& voxel : voxels) {
    numbers[indexOf(voxel)] += 0.5f;
    bits[static_cast<std::size_t>(4 * (voxel.x + size.x * (voxel.y + size.y * (voxel.z / 128))) +
                                  voxel.z % 128 / 32)] |= 1u << voxel.z % 32;
  }
  const auto texture = std::make_shared<gpu::Texture>(
      device(), gpu::TextureDescription{gpu::TextureKind::d3, gpu::Format::r32f, size.x, size.y, size.z},
      "test");
  texture->uploadFloats(0, numbers);
  const auto stacks = std::make_shared<gpu::Texture>(
      device(), gpu::TextureDescription{gpu::TextureKind::d2Array, gpu::Format::rgba32ui, size.x, size.y, 2},
      "test");
  stacks->upload(0, std::as_bytes(std::span(bits)));

  const auto counted = largest(size, VoxelTexels{{texture}, {{0, 0}}, 0, 2.0f});
  CHECK(counted[2].at(4, 2, 0) == 2.0f);
  CHECK(counted[2].at(4, 2, 2) == 2.0f);
  CHECK(counted[2].at(1, 0, 0) == 1.0f);
  const auto occupied = largest(size, listOf(voxels, false));
  const auto filled = largest({4, 3, 2}, VoxelsFilled{});
  for (std::size_t axis = 0; axis < 3; ++axis) {
    CAPTURE(axis);
    CHECK(largest(size, listOf(voxels, true))[axis].values() == counted[axis].values());
    CHECK(largest(size, VoxelBits{stacks})[axis].values() == occupied[axis].values());
    for (std::size_t i = 0; i < occupied[axis].values().size(); ++i)
      CHECK(occupied[axis].values()[i] == std::min(counted[axis].values()[i], 1.0f));
    for (const float value : filled[axis].values()) CHECK(value == 1.0f);
  }
}

TEST_CASE(
    "what is no number is seen, and voxels outside of their grid and textures of another size are refused") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto views =
      largest({1, 1, 3}, voxelsOf({{{0, 0, 0}, glm::vec3(7)}, {{0, 0, 1}, glm::vec3(nan)}}, 1));
  CHECK(std::isnan(views[2].at(0, 0, 0)));
  CHECK(views[0].at(2, 0, 0) == 7.0f);
  CHECK_THROWS_WITH(largest({2, 2, 2}, voxelsOf({{{0, 2, 0}, glm::vec3(1)}}, 1)),
                    Catch::Contains("(0, 2, 0)") && Catch::Contains("2 x 2 x 2"));
  const auto texture = std::make_shared<gpu::Texture>(
      device(), gpu::TextureDescription{gpu::TextureKind::d3, gpu::Format::r8, 2, 2, 2}, "test");
  CHECK_THROWS_WITH(largest({2, 2, 3}, VoxelTexels{{texture}, {{0, 0}}}),
                    Catch::Contains("2 x 2 x 3") && Catch::Contains("2 x 2 x 2"));
  CHECK_THROWS_WITH(largest({2, 2, 2}, VoxelTexels{{texture}, {{0, 0}, {0, 0}}}),
                    Catch::Contains("2 channels"));
}
