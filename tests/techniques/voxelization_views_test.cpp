// Voxelizers that look at the scene along the axes: slices, peeled layers, multisampled coverage. Closed
// forms of planes, spheres and boxes, and the failures that the papers tell of.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "support/meshes.h"
#include "support/passes.h"
#include "support/voxel_fragments.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

LonePass voxelizer(const Scene& scene, const std::string& pass, const Settings& settings) {
  return LonePass("voxelization." + pass, scene, settings);
}

Voxels voxelize(const Scene& scene, const std::string& pass, int resolution, const Settings& settings = {}) {
  return voxelsOf(
      voxelizer(scene, pass, settings).with({{"resolution", resolution}}).out<VoxelFragments>("fragments"));
}
const Settings kThreeAxes{{"axes", 3}};

Scene sphere(int rings) {
  SceneBuilder builder;
  builder.mesh(sphereCorners(rings), builder.lambert(0.5f));
  return builder.scene;
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

}  // namespace

TEST_CASE("voxelizers that look along axes invent no voxel and find the share of a sphere that theory says") {
  // Of a plane with the normal n, as many voxels are touched per area as its shadow on the three sides of a
  // voxel is large: |x| + |y| + |z|; over all directions 3/2. A line through the voxels' centres along z
  // meets |z| of them: 1/2, a third. Lines along all axes meet max(|x|, |y|, |z|): over all directions 3
  // sqrt(2) / pi atan(1 / sqrt(2)).
  const double oneAxis = 1.0 / 3.0,
               threeAxes = 3.0 * std::sqrt(2.0) / kPi * std::atan(1.0 / std::sqrt(2.0)) / 1.5;
  const Scene ball = sphere(24);
  const Voxels reference = voxelize(ball, "conservative", 32);
  const auto share = [&](const Voxels& voxels) {
    return static_cast<double>(voxels.occupied.size()) / static_cast<double>(reference.occupied.size());
  };
  const auto invented = [&](const Voxels& voxels) {
    return std::count_if(voxels.occupied.begin(), voxels.occupied.end(),
                         [&](const Cell& cell) { return reference.occupied.count(cell) == 0; });
  };
  const Voxels one = voxelize(ball, "slicing", 32), three = voxelize(ball, "slicing", 32, kThreeAxes),
               peeled = voxelize(ball, "depth_peeling", 32), msaa = voxelize(ball, "msaa_opacity", 32);
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
  const Scene ball = sphere(24);
  const Voxels peeled = voxelize(ball, "depth_peeling", 33),
               sliced = voxelize(ball, "slicing", 33, kThreeAxes);
  // Both see every surface at every pixel's centre. Clipping makes new corners, which the rasteriser rounds
  // again, so that a few pixels on the silhouettes differ.
  std::vector<Cell> different;
  std::set_symmetric_difference(peeled.occupied.begin(), peeled.occupied.end(), sliced.occupied.begin(),
                                sliced.occupied.end(), std::back_inserter(different));
  CHECK(different.size() <= peeled.occupied.size() / 100);
}

TEST_CASE(
    "a surface parallel to the view is lost to slices along one axis, as published, and found along three") {
  for (const int axis : {0, 1}) CHECK(voxelize(wall(axis), "slicing", 16).fragments.empty());
  // A wall of 14 by 14 voxels; the pixels on its border have their centres inside.
  CHECK(voxelize(wall(2), "slicing", 16).occupied.size() == 14u * 14u);
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(voxelize(wall(axis), "slicing", 16, kThreeAxes).occupied.size() == 14u * 14u);
    CHECK(voxelize(wall(axis), "depth_peeling", 16).occupied.size() == 14u * 14u);
    CHECK(voxelize(wall(axis), "msaa_opacity", 16).occupied.size() == 14u * 14u);
  }
}

TEST_CASE("every surface behind others is peeled, until the layers end") {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  // Ten plates one above the other, two of them within one voxel.
  for (int i = 0; i < 10; ++i)
    builder.quad({-1, -1, -0.9f + 0.2f * static_cast<float>(i)}, {2, 0, 0}, {0, 2, 0}, grey);
  builder.quad({-1, -1, 0.12f}, {2, 0, 0}, {0, 2, 0}, grey);
  const Voxels all = voxelize(builder.scene, "depth_peeling", 18),
               reference = voxelize(builder.scene, "conservative", 18);
  CHECK(all.occupied == reference.occupied);
  CHECK(all.fragments.size() == 11u * 16u * 16u);
  const Voxels few = voxelize(builder.scene, "depth_peeling", 18, {{"layers", 3.0}});
  CHECK(few.fragments.size() == 3u * 16u * 16u);
}

TEST_CASE("the coverages of a wall made of many triangles add up to one in every voxel that it fills") {
  // A fan of slivers about a corner: their samples share out every pixel.
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  constexpr int kSlivers = 40;
  const auto at = [](int i) {
    const float t = static_cast<float>(i) / kSlivers;
    return t < 0.5f ? glm::vec3(1, 4 * t - 1, 0) : glm::vec3(3 - 4 * t, 1, 0);
  };
  std::vector<glm::vec3> corners;
  for (int i = 0; i < kSlivers; ++i)
    for (const glm::vec3& corner : {glm::vec3(-1, -1, 0), at(i), at(i + 1)}) corners.push_back(corner);
  builder.mesh(corners, grey);
  const VoxelFragments list =
      voxelizer(builder.scene, "msaa_opacity", {{"resolution", 16}}).out<VoxelFragments>("fragments");
  CHECK(list.coverage == VoxelFragments::Coverage::sum);
  std::map<std::uint32_t, double> sums;
  for (const FragmentData& fragment : fragmentsOf(list)) sums[fragment.voxel] += fragment.coverage();
  CHECK(sums.size() == 14u * 14u);
  for (const auto& [voxel, sum] : sums) {
    CHECK(sum == Approx(1.0).epsilon(1e-3));
  }
}

TEST_CASE("a strip is as opaque in the voxel where it begins as the samples that it covers there") {
  // 14 voxels over 2 m; the strip begins within voxel 4, at `start` of its width, and ends with voxel 7. A
  // sample is covered when its x is beyond the start; the grid holds opacities in steps of 1/255.
  const int count = std::min(8, device().info().maxSamples);
  const std::vector<glm::vec2> samples = device().samplePositions(count);
  std::set<float> told;
  for (const float start : {0.06f, 0.3f, 0.5f, 0.69f, 0.94f}) {
    INFO("from " << start << " with " << count << " samples");
    SceneBuilder builder;
    const int grey = builder.lambert(0.5f);
    builder.box({-1, -1, -1}, {1, 1, 1}, grey, false);
    builder.quad({-1.0f + (3.0f + start) / 7.0f, -0.5f, 0.02f}, {(4.0f - start) / 7.0f, 0, 0}, {0, 1, 0},
                 grey);
    const auto opacities = voxelizer(builder.scene, "msaa_opacity", {{"resolution", 16}})
                               .out<OccupancyGrid>("opacity_z")
                               .opacity->downloadFloats();
    const auto at = [&](int x) { return opacities[static_cast<std::size_t>((8 * 16 + 8) * 16 + x)]; };
    const auto covered = std::count_if(samples.begin(), samples.end(),
                                       [&](const glm::vec2& sample) { return sample.x > start; });
    const float share = static_cast<float>(covered) / static_cast<float>(count);
    CHECK(at(4) ==
          Approx(share).margin(0.5 / 255.0 + 1e-6));  // a byte, in which drivers round halves up or down
    told.insert(at(4));
    for (int x = 2; x < 14; ++x)
      if (x != 4) CHECK(at(x) == (x >= 5 && x <= 7 ? 1.0f : 0.0f));
  }
  CHECK(told.size() >= 3);
}

namespace {

/// The coverages of a rectangle of `size` voxels across z, added up, in a grid of voxels of 1 m around the
/// camera.
double coverageOf(const glm::dvec2& low, const glm::dvec2& size, int supersampling) {
  SceneBuilder builder;
  const glm::vec2 corner(low), edges(size);
  builder.quad({corner, 0.5f}, {edges.x, 0, 0}, {0, edges.y, 0}, builder.lambert(0.5f, 1.0f));
  // Far outside of the grid: they keep the origin of positions at zero, wherever the rectangle is.
  for (const float end : {-100.0f, 100.0f})
    builder.quad(glm::vec3(end), {-0.005f * end, 0, 0}, {0, -0.005f * end, 0}, 0);
  builder.look({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.7, 8, 8);
  LonePass pass =
      voxelizer(builder.scene, "msaa_opacity",
                {{"resolution", 8}, {"around", "camera"}, {"extent", 8}, {"supersampling", supersampling}});
  double sum = 0.0;
  for (const FragmentData& fragment : fragmentsOf(pass.out<VoxelFragments>("fragments"))) {
    sum += fragment.coverage();
    CHECK(fragment.emittedRadiance() == glm::vec3(1.0f));
  }
  return sum;
}

}  // namespace

TEST_CASE("adaptive supersampling counts the samples of smaller pixels, as many as a small triangle needs") {
  // Each half of a square of 0.4 voxels has 0.08 of a voxel's side, and so has that of a strip. 8 x 8 pixels
  // of 4 or 8 samples put at least 16 of them there (20, 41), 4 x 4 do not (5, 10). What it covers are the
  // samples within it, each a share of 1 / (64 n); of those within a hundredth of a pixel of its border,
  // corners are rounded to 1/256 of a pixel.
  const int count = std::min(8, device().info().maxSamples);
  const std::vector<glm::vec2> samples = device().samplePositions(count);
  constexpr int kScale = 8;
  for (int step = 0; step < 18; ++step) {
    const glm::dvec2 size = step % 3 == 0   ? glm::dvec2(0.4, 0.4)
                            : step % 3 == 1 ? glm::dvec2(1.6, 0.1)
                                            : glm::dvec2(0.1, 1.6);
    const glm::dvec2 low(0.05 + 0.0753 * step, -0.3 + 0.0473 * step);
    int inside = 0, open = 0;
    for (int y = -2 * kScale; y < 3 * kScale; ++y)
      for (int x = -2 * kScale; x < 3 * kScale; ++x)
        for (const glm::vec2& sample : samples) {
          const glm::dvec2 at = (glm::dvec2(x, y) + glm::dvec2(sample)) / double{kScale} - low;
          const double depth =
              std::min(std::min(at.x, size.x - at.x), std::min(at.y, size.y - at.y)) * kScale;
          inside += depth > 0.0;
          open += std::abs(depth) < 0.01;
        }
    const double share = 1.0 / (kScale * kScale * count);
    INFO("step " << step << ": " << inside << " samples, " << open << " at the border");
    CHECK(coverageOf(low, size, 8) == Approx(inside * share).margin(open * share + 1e-6));
    // More pixels than are needed are not taken.
    CHECK(coverageOf(low, size, 16) == coverageOf(low, size, 8));
  }
}

TEST_CASE(
    "the light of a small square that moves through a voxel pops without supersampling and stays with it") {
  // Thesis Gomes 2015, Fig. 56. The square has 0.16 of a voxel's side: four samples a pixel tell quarters of
  // it.
  constexpr double kSide = 0.4;
  double least[2] = {1e9, 1e9}, most[2] = {0, 0}, sum[2] = {0, 0};
  constexpr int kSteps = 40;
  for (int step = 0; step < kSteps; ++step)
    for (const int with : {0, 1}) {
      const double coverage =
          coverageOf({0.021 * step, 0.3 + 0.013 * step}, glm::dvec2(kSide), with == 1 ? 16 : 1);
      least[with] = std::min(least[with], coverage);
      most[with] = std::max(most[with], coverage);
      sum[with] += coverage / kSteps;
    }
  // One of four samples, or none: 0 to 0.25. With 8 x 8 pixels of four there are 41 on the average, each
  // 1/256; which ones is told exactly above, and here 7 of them come and go. A quarter of its light is 10.
  CHECK(most[0] - least[0] >= 0.5 * kSide * kSide);
  CHECK(most[1] - least[1] < 0.25 * kSide * kSide);
  CHECK(sum[1] == Approx(kSide * kSide).epsilon(0.02));
}

TEST_CASE(
    "supersampling leaves what is large alone, to the bit, and the coverages of small triangles add up") {
  const Scene large = wall(2);
  CHECK(voxelize(large, "msaa_opacity", 16).fragments ==
        voxelize(large, "msaa_opacity", 16, {{"supersampling", 8.0}}).fragments);
  // A sphere of triangles much smaller than a voxel. Each adds its area as seen along the axis that it faces
  // most: area * max(|n.x|, |n.y|, |n.z|), over the sphere 4 pi r^2 times the mean of that factor.
  const Scene fine = sphere(60);
  double mean = 0.0;
  constexpr int kPoints = 200000;
  for (int i = 0; i < kPoints; ++i) {
    const double z = -1.0 + 2.0 * (i + 0.5) / kPoints, phi = 2.399963229728653 * i,
                 r = std::sqrt(1.0 - z * z);
    mean += std::max({std::abs(r * std::cos(phi)), std::abs(r * std::sin(phi)), std::abs(z)}) / kPoints;
  }
  // 14 voxels over 2 m.
  const double expected = 4.0 * kPi * 49.0 * mean;
  double sum = 0.0;
  for (const FragmentData& fragment : voxelize(fine, "msaa_opacity", 16, {{"supersampling", 16.0}}).fragments)
    sum += fragment.coverage();
  CHECK(sum == Approx(expected).epsilon(0.005));
}

TEST_CASE("a thin wall is opaque across, and from the side as thick as asked for") {
  for (int axis = 0; axis < 3; ++axis) {
    const char* names[3] = {"opacity_x", "opacity_y", "opacity_z"};
    double side[2] = {0, 0};
    for (const int thick : {0, 1}) {
      LonePass pass =
          voxelizer(wall(axis), "msaa_opacity", {{"resolution", 16}, {"thickness", thick * 0.75}});
      for (int other = 0; other < 3; ++other) {
        const auto values = pass.out<OccupancyGrid>(names[other]).opacity->downloadFloats();
        const double sum = std::accumulate(values.begin(), values.end(), 0.0);
        INFO("wall across " << axis << " seen along " << other << ", thick " << thick);
        if (other == axis) {
          CHECK(sum == 14.0 * 14.0);
        } else {
          CHECK(sum > 0.0);
          side[thick] += sum;
        }
      }
      const auto most = pass.out<OccupancyGrid>("opacity").opacity->downloadFloats();
      CHECK(std::accumulate(most.begin(), most.end(), 0.0) == 14.0 * 14.0);
    }
    // Half of either side, in steps of 1/255.
    CHECK(side[0] == Approx(14.0 * 14.0).epsilon(1.5 / 255));
    CHECK(side[1] > side[0]);
    CHECK(side[1] <= 2.0 * 14.0 * 14.0);
  }
}
