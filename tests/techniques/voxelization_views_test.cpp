// Voxelisers that look at the scene along the axes: slices, peeled layers, multisampled coverage. Closed
// forms of planes, spheres and boxes, and the failures that the papers tell of.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "support/scene_builder.h"
#include "support/techniques.h"
#include "support/voxel_fragments.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

using Numbers = std::vector<std::pair<std::string, double>>;

/// A pass alone.
std::unique_ptr<PassHarness> harnessOf(const Scene& scene, const std::string& pass, int resolution,
                                       const Numbers& parameters = {}) {
  auto harness = std::make_unique<PassHarness>(device(), techniques(), "voxelization", pass, scene,
                                               snapshotOf(scene, 0.0));
  harness->setParameter("resolution", resolution);
  for (const auto& [name, value] : parameters) harness->setParameter(name, value);
  harness->run();
  return harness;
}

Voxels voxelise(const Scene& scene, const std::string& pass, int resolution, const Numbers& parameters = {}) {
  const auto harness = harnessOf(scene, pass, resolution, parameters);
  return voxelsOf(harness->output<VoxelFragments>("fragments"));
}

/// A sphere of triangles with its normals.
Scene sphere(float radius, int rings) {
  SceneBuilder builder;
  Scene& scene = builder.scene;
  const int grey = builder.lambert(0.5f);
  for (int i = 0; i <= rings; ++i) {
    for (int j = 0; j <= 2 * rings; ++j) {
      const double theta = kPi * i / rings, phi = kPi * j / rings;
      const glm::vec3 direction(std::sin(theta) * std::cos(phi), std::cos(theta),
                                std::sin(theta) * std::sin(phi));
      scene.positions.push_back(radius * direction);
      scene.normals.push_back(direction);
      scene.texcoords.emplace_back(0.0f);
    }
  }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * (2 * rings + 1) + j); };
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < 2 * rings; ++j) {
      for (const std::uint32_t index : {at(i, j), at(i, j + 1), at(i + 1, j + 1)})
        scene.indices.push_back(index);
      for (const std::uint32_t index : {at(i, j), at(i + 1, j + 1), at(i + 1, j)})
        scene.indices.push_back(index);
    }
  }
  Object object;
  object.name = "sphere";
  object.vertexCount = static_cast<std::uint32_t>(scene.positions.size());
  object.parts.push_back({grey, 0, static_cast<std::uint32_t>(scene.indices.size())});
  scene.objects.push_back(object);
  return scene;
}

/// A square of 2 m across an axis, at zero.
Scene wall(int axis, float albedo = 0.5f) {
  SceneBuilder builder;
  glm::vec3 corner(-1.0f), edge1(0.0f), edge2(0.0f);
  corner[axis] = 0.0f;
  edge1[(axis + 1) % 3] = 2.0f;
  edge2[(axis + 2) % 3] = 2.0f;
  builder.quad(corner, edge1, edge2, builder.lambert(albedo));
  return builder.scene;
}

const std::vector<std::string> kVoxelisers{"slicing", "depth_peeling", "msaa_opacity"};

}  // namespace

TEST_CASE("voxelisers that look along axes invent no voxel and find the share of a sphere that theory says") {
  // Of a plane with the normal n, as many voxels are touched per area as its shadow on the three sides of a
  // voxel is large: |x| + |y| + |z|; over all directions 3/2. A line through the voxels' centres along z
  // meets |z| of them: 1/2, a third. Lines along all axes meet max(|x|, |y|, |z|): over all directions 3
  // sqrt(2) / pi atan(1 / sqrt(2)).
  const double oneAxis = 1.0 / 3.0,
               threeAxes = 3.0 * std::sqrt(2.0) / kPi * std::atan(1.0 / std::sqrt(2.0)) / 1.5;
  const Scene ball = sphere(1.0f, 24);
  const Voxels truth = voxelise(ball, "conservative", 32);
  const auto share = [&](const Voxels& voxels) {
    return static_cast<double>(voxels.occupied.size()) / static_cast<double>(truth.occupied.size());
  };
  const auto invented = [&](const Voxels& voxels) {
    return std::count_if(voxels.occupied.begin(), voxels.occupied.end(),
                         [&](const Cell& cell) { return truth.occupied.count(cell) == 0; });
  };
  const Voxels one = voxelise(ball, "slicing", 32),
               three = voxelise(ball, "slicing", 32, Numbers{{"axes", 3.0}}),
               peeled = voxelise(ball, "depth_peeling", 32), msaa = voxelise(ball, "msaa_opacity", 32);
  INFO("slices " << share(one) << ", along three axes " << share(three) << ", peeled " << share(peeled)
                 << ", multisampled " << share(msaa));
  for (const Voxels* voxels : {&one, &three, &peeled, &msaa}) CHECK(invented(*voxels) == 0);
  CHECK(share(one) == Approx(oneAxis).margin(0.015));
  CHECK(share(three) == Approx(threeAxes).margin(0.015));
  CHECK(share(peeled) == Approx(threeAxes).margin(0.015));
  CHECK(share(msaa) > share(three));
  CHECK(share(msaa) < 1.0);
}

TEST_CASE("peeled layers hold what slices along three axes hold") {
  const Scene ball = sphere(1.0f, 24);
  const Voxels peeled = voxelise(ball, "depth_peeling", 33),
               sliced = voxelise(ball, "slicing", 33, Numbers{{"axes", 3.0}});
  // Both see every surface at every pixel's centre. Clipping makes new corners, which the rasteriser rounds
  // again, so that a few pixels on the silhouettes differ.
  std::vector<Cell> different;
  std::set_symmetric_difference(peeled.occupied.begin(), peeled.occupied.end(), sliced.occupied.begin(),
                                sliced.occupied.end(), std::back_inserter(different));
  CHECK(different.size() <= peeled.occupied.size() / 100);
}

TEST_CASE(
    "a surface parallel to the view is lost to slices along one axis, as published, and found along three") {
  for (const int axis : {0, 1}) CHECK(voxelise(wall(axis), "slicing", 16).fragments.empty());
  // A wall of 14 by 14 voxels; the pixels on its border have their centres inside.
  CHECK(voxelise(wall(2), "slicing", 16).occupied.size() == 14u * 14u);
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(voxelise(wall(axis), "slicing", 16, Numbers{{"axes", 3.0}}).occupied.size() == 14u * 14u);
    CHECK(voxelise(wall(axis), "depth_peeling", 16).occupied.size() == 14u * 14u);
    CHECK(voxelise(wall(axis), "msaa_opacity", 16).occupied.size() == 14u * 14u);
  }
}

TEST_CASE("every surface behind others is peeled, until the layers end") {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  // Ten plates one above the other, two of them within one voxel.
  for (int i = 0; i < 10; ++i)
    builder.quad({-1, -1, -0.9f + 0.2f * static_cast<float>(i)}, {2, 0, 0}, {0, 2, 0}, grey);
  builder.quad({-1, -1, 0.12f}, {2, 0, 0}, {0, 2, 0}, grey);
  const Voxels all = voxelise(builder.scene, "depth_peeling", 18),
               truth = voxelise(builder.scene, "conservative", 18);
  CHECK(all.occupied == truth.occupied);
  CHECK(all.fragments.size() == 11u * 16u * 16u);
  const Voxels few = voxelise(builder.scene, "depth_peeling", 18, Numbers{{"layers", 3.0}});
  CHECK(few.fragments.size() == 3u * 16u * 16u);
}

TEST_CASE("the coverages of a wall made of many triangles add up to one in every voxel that it fills") {
  // A fan of slivers about a corner: their samples share out every pixel.
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  Scene& scene = builder.scene;
  constexpr int kSlivers = 40;
  for (int i = 0; i <= kSlivers; ++i) {
    const float t = static_cast<float>(i) / kSlivers;
    scene.positions.emplace_back(t < 0.5f ? glm::vec3(1, 4 * t - 1, 0) : glm::vec3(3 - 4 * t, 1, 0));
  }
  scene.positions.emplace_back(-1, -1, 0);
  scene.normals.assign(scene.positions.size(), {0, 0, 1});
  scene.texcoords.assign(scene.positions.size(), {0, 0});
  for (std::uint32_t i = 0; i < kSlivers; ++i) {
    for (const std::uint32_t index : {kSlivers + 1u, i, i + 1}) scene.indices.push_back(index);
  }
  Object object;
  object.name = "fan";
  object.vertexCount = static_cast<std::uint32_t>(scene.positions.size());
  object.parts.push_back({grey, 0, static_cast<std::uint32_t>(scene.indices.size())});
  scene.objects.push_back(object);

  const auto harness = harnessOf(scene, "msaa_opacity", 16);
  const auto& list = harness->output<VoxelFragments>("fragments");
  CHECK(list.coverage == VoxelFragments::Coverage::sum);
  std::map<std::uint32_t, double> sums;
  for (const FragmentData& fragment : fragmentsOf(list)) sums[fragment.voxel] += fragment.coverage();
  CHECK(sums.size() == 14u * 14u);
  for (const auto& [voxel, sum] : sums) {
    CHECK(sum == Approx(1.0).epsilon(1e-3));
  }
}

TEST_CASE("a wall that half fills its voxels is half opaque, as fine as the samples tell") {
  // 2 m over 14 voxels; a strip of three and a half of them.
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  builder.box({-1, -1, -1}, {1, 1, 1}, grey, false);
  builder.quad({-0.5f, -0.5f, 0.02f}, {3.5f / 7.0f, 0, 0}, {0, 1, 0}, grey);
  const auto harness = harnessOf(builder.scene, "msaa_opacity", 16);
  const auto opacities = harness->output<OccupancyGrid>("opacity_z").opacity->downloadFloats();
  double sum = 0.0;
  for (int x = 2; x < 14; ++x) sum += opacities[static_cast<std::size_t>((8 * 16 + 8) * 16 + x)];
  // Rows of samples share out the width: the mean over the strip's end is its fraction, to one column of
  // samples.
  CHECK(sum == Approx(3.5).margin(0.5));
}

TEST_CASE("a thin wall is opaque across, and from the side as thick as asked for") {
  for (int axis = 0; axis < 3; ++axis) {
    const char* names[3] = {"opacity_x", "opacity_y", "opacity_z"};
    double side[2] = {0, 0};
    for (const int thick : {0, 1}) {
      const auto harness = harnessOf(wall(axis), "msaa_opacity", 16, {{"thickness", thick * 0.75}});
      for (int other = 0; other < 3; ++other) {
        const auto values = harness->output<OccupancyGrid>(names[other]).opacity->downloadFloats();
        const double sum = std::accumulate(values.begin(), values.end(), 0.0);
        INFO("wall across " << axis << " seen along " << other << ", thick " << thick);
        if (other == axis) {
          CHECK(sum == 14.0 * 14.0);
        } else {
          CHECK(sum > 0.0);
          side[thick] += sum;
        }
      }
      const auto most = harness->output<OccupancyGrid>("opacity").opacity->downloadFloats();
      CHECK(std::accumulate(most.begin(), most.end(), 0.0) == 14.0 * 14.0);
    }
    // Half of either side, in steps of 1/255.
    CHECK(side[0] == Approx(14.0 * 14.0).epsilon(1.5 / 255));
    CHECK(side[1] > side[0]);
    CHECK(side[1] <= 2.0 * 14.0 * 14.0);
  }
}

TEST_CASE("attributes of all views are those of the material") {
  SceneBuilder builder;
  Material material;
  material.diffuse = {0.25f, 0.5f, 0.75f};
  material.emission = glm::vec3(2.0f);
  builder.box({-1, -1, -1}, {1, 1, 1}, builder.material(material), false);
  for (const std::string& pass : kVoxelisers) {
    INFO(pass);
    const Voxels voxels = voxelise(builder.scene, pass, 12);
    REQUIRE(voxels.fragments.size() > 100);
    for (const FragmentData& fragment : voxels.fragments) {
      CHECK(fragment.albedo() == glm::vec3(0.25f, 0.5f, 0.75f));
      CHECK(fragment.emittedRadiance() == glm::vec3(2.0f));
      const glm::vec3 normal = glm::abs(fragment.unitNormal());
      CHECK(std::max({normal.x, normal.y, normal.z}) == Approx(1.0f));
    }
  }
}

TEST_CASE("a mask's holes leave no fragments and a texture gives its colour to all views") {
  SceneBuilder builder;
  Material material;
  material.diffuse = glm::vec3(1.0f);
  material.diffuseTexture = 0;
  material.maskTexture = 1;
  builder.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, builder.material(material));
  // The left half is a hole, the right half is there; green everywhere.
  SurfaceTexture green{"green", 2, 1, false, {0, 0.5f, 0, 0, 0.5f, 0}};
  SurfaceTexture mask{"mask", 64, 1, true, std::vector<float>(64, 0.0f)};
  std::fill(mask.values.begin() + 32, mask.values.end(), 1.0f);
  builder.scene.textures = {green, mask};
  for (const std::string& pass : {std::string("slicing"), std::string("depth_peeling"),
                                  std::string("msaa_opacity"), std::string("conservative")}) {
    INFO(pass);
    const Voxels voxels = voxelise(builder.scene, pass, 18);
    std::size_t left = 0, right = 0;
    for (const Cell& cell : voxels.occupied) {
      // Away from the border: a mip of four texels reaches a voxel far.
      left += cell[0] >= 4 && cell[0] < 7;
      right += cell[0] >= 10 && cell[0] < 16;
    }
    CHECK(left == 0);
    CHECK(right == 6u * 16u);
    for (const FragmentData& fragment : voxels.fragments) CHECK(fragment.albedo() == glm::vec3(0, 0.5f, 0));
  }
}

TEST_CASE("voxelisers that look along axes give the same fragments every time and with everything kept") {
  Scene scene = litRoom(8, 8);
  SceneBuilder builder;
  builder.scene = scene;
  builder.quad({0.1f, 0.3f, 0.7f}, {0.2f, 0, 0}, {0, 0.2f, 0.1f}, builder.lambert(0.5f)).motion =
      RigidMotion{{0, 1, 0}, 1.0, {0.2, 0.3, 0.7}, {0, 0, 0}};
  for (const std::string& pass : kVoxelisers) {
    INFO(pass);
    const Pipeline text = Pipeline::parse(
        "pipeline \"views\" {\n  pass voxels voxelization." + pass + " { resolution 16 }\n}\n",
        "made_by_a_test.pipeline");
    std::vector<Voxels> runs;
    for (const int kind : {0, 1, 2}) {
      RenderOptions options;
      options.keepEverything = kind == 2;
      PipelineExecutor executor(device(), techniques(), builder.scene, text, options);
      executor.keepOutput("voxels", "fragments");
      // Kind 1 comes from another time: what stands still is kept.
      if (kind == 1) executor.render(0.7);
      executor.render(0.2, 1);
      runs.push_back(
          voxelsOf(static_cast<const Out<VoxelFragments>*>(executor.output("voxels", "fragments"))->value()));
    }
    CHECK(runs[0].fragments == runs[1].fragments);
    CHECK(runs[0].fragments == runs[2].fragments);
    CHECK(runs[0].fragments.size() > 100);
  }
}

TEST_CASE("empty scenes, points and one voxel are no special cases for views") {
  SceneBuilder empty, degenerate;
  degenerate.quad({0, 0, 0}, {1, 0, 0}, {1, 0, 0}, degenerate.lambert(0.5f));
  for (glm::vec3& normal : degenerate.scene.normals) normal = {0, 1, 0};
  for (const std::string& pass : kVoxelisers) {
    INFO(pass);
    CHECK(voxelise(empty.scene, pass, 16).fragments.empty());
    CHECK(voxelise(degenerate.scene, pass, 16).fragments.empty());
    CHECK(voxelise(wall(2), pass, 1).occupied.size() == 1);
  }
}
