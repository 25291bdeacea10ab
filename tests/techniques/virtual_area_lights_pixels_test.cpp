// Points at pixels: for surfaces of which no triangles are known, such as captured ones; and points as discs.
#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "support/captures.h"
#include "support/facts.h"
#include "support/virtual_area_lights.h"

using namespace lumivox;
using namespace lumivox::test;

TEST_CASE("points at pixels stand for the whole of a slanted plane, and their light is interpolated on it") {
  const double slant = GENERATE(0.0, 0.7);
  const int stride = GENERATE(1, 4, 7);
  CAPTURE(slant, stride);
  const Scene scene = sceneWith(captureOf(smallCamera(), {plane(2.0, slant)}));
  const GBuffer surfaces = surfacesIn(scene);
  LonePass pass("virtual_area_lights.pixels", scene, {{"stride", stride}});
  const SurfacePoints points = pass.in("gbuffer", surfaces).out<SurfacePoints>("points");
  const int across = (60 + stride - 1) / stride, down = (40 + stride - 1) / stride;
  REQUIRE(points.count == across * down);
  const std::vector<float> position = points.position->downloadFloats(0);
  double area = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i)
    area += static_cast<double>(position[4 * i + 3]);
  // Squares of the stride cover the picture, and those at its end a little more.
  const double all = lightsIn(scene, {{"filter", 0}}).area() * (across * stride * down * stride) / 2400.0;
  CHECK(area == Approx(all).epsilon(stride == 1 ? 0.01 : stride == 4 ? 0.05 : 0.25));
  // Light proportional to the height: linear on the plane, so that interpolation
  // is exact.
  const glm::vec3 normal(static_cast<float>(std::sin(slant)), 0.0f, static_cast<float>(std::cos(slant)));
  std::vector<glm::vec4> lights, places;
  for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i) {
    const glm::vec3 place(position[4 * i], position[4 * i + 1], position[4 * i + 2]);
    lights.emplace_back(glm::vec3(2.0f + place.y), 1.0f);
    places.emplace_back(place + 1e4f * normal, 1.0f);
  }
  LonePass apply("virtual_area_lights.apply_pixels", scene);
  const ImageBuffer image = apply.in("gbuffer", surfaces)
                                .in("points", points)
                                .in("light", diffuseLight(lights, places))
                                .image("diffuse");
  const std::vector<float> seen = surfaces.position->downloadFloats(0);
  for (int y = 8; y < 32; y += 3)
    for (int x = 8; x < 52; x += 5)
      CHECK(image.at(x, y, 0) == Approx(2.0f + seen[4u * static_cast<unsigned>(60 * y + x) + 1u])
                                     .margin(slant == 0.0 ? 2e-3 : 0.03));
}

TEST_CASE("light of points at pixels does not cross an edge between two walls") {
  // To the left a wall at 2 m, to the right one at 3 m; only the left one is lit.
  const Scene scene = sceneWith(captureOf(smallCamera(), {[](const glm::dvec2& ray) {
                                            return SeenPixel{ray.x < 0.0 ? 2.0 : 3.0, glm::vec3(1.0f)};
                                          }}));
  const GBuffer surfaces = surfacesIn(scene);
  LonePass pass("virtual_area_lights.pixels", scene, {{"stride", 4}});
  const SurfacePoints points = pass.in("gbuffer", surfaces).out<SurfacePoints>("points");
  const std::vector<float> position = points.position->downloadFloats(0);
  std::vector<glm::vec4> lights, places;
  for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i) {
    const glm::vec3 place(position[4 * i], position[4 * i + 1], position[4 * i + 2]);
    lights.emplace_back(glm::vec3(place.z > -2.5f ? 1.0f : 0.0f), 1.0f);
    places.emplace_back(place + glm::vec3(0, 0, 1e4f), 1.0f);
  }
  LonePass apply("virtual_area_lights.apply_pixels", scene);
  const ImageBuffer image = apply.in("gbuffer", surfaces)
                                .in("points", points)
                                .in("light", diffuseLight(lights, places))
                                .image("diffuse");
  for (int x = 0; x < 60; ++x) {
    CAPTURE(x);
    CHECK(image.at(x, 20, 0) == Approx(x < 30 ? 1.0f : 0.0f).margin(0.01));
  }
}

TEST_CASE("points of one kind are refused where those of the other are expected") {
  const Scene scene = sceneWith(captureOf(smallCamera(), {plane(2.0)}));
  const GBuffer surfaces = surfacesIn(scene);
  LonePass pass("virtual_area_lights.pixels", scene);
  const SurfacePoints atPixels = pass.in("gbuffer", surfaces).out<SurfacePoints>("points"),
                      spread = pointsOf({SparsePoint{}});
  const SparseLight light = lightOverhead({glm::vec4(1.0f)});
  const auto refusal = [&](const char* name, const SurfacePoints& points) {
    return messageOf<Error>([&] {
      LonePass(name, scene).in("gbuffer", surfaces).in("points", points).in("light", light).image("diffuse");
    });
  };
  CHECK_THAT(refusal("virtual_area_lights.apply", atPixels), Tells("virtual_area_lights.points"));
  CHECK_THAT(refusal("virtual_area_lights.apply_pixels", spread), Tells("virtual_area_lights.pixels"));
}

TEST_CASE("discs of points have their places, normals and areas, and no flux") {
  const Scene scene = sceneWith(captureOf(smallCamera(), {plane(2.0)}));
  LonePass pass("virtual_area_lights.discs", scene);
  const SurfaceLights discs =
      pass.in("points",
              pointsOf({{.position = {1, 2, 3}, .normal = {0, 0, 1}, .radius = 0.5f}, {.radius = 2.0f}}))
          .out<SurfaceLights>("discs");
  REQUIRE(discs.count == 2);
  const auto values = discs.lights->downloadValues<float>();
  CHECK((values[0] == 1.0f && values[1] == 2.0f && values[2] == 3.0f && values[6] == 1.0f));
  CHECK(values[3] == Approx(kPi * 0.25));
  CHECK(values[15] == Approx(kPi * 4.0));
  for (const std::size_t i : {8u, 9u, 10u, 20u, 21u, 22u}) CHECK(values[i] == 0.0f);
}

TEST_CASE("a point at a pixel has the pixel's place, and the area that its square of pixels covers there") {
  // Seen from (1, 2, 3) along -z: patches at several depths and slants.
  SceneBuilder builder;
  builder.quad({-9, -9, -9}, {18, 0, 0}, {0, 18, 0}, builder.lambert(0.5f));
  builder.look({1, 2, 3}, {1, 2, 0}, {0, 1, 0}, 1.0, 8, 8);
  const CameraView view = snapshotOf(builder.scene, 0.0).camera;
  constexpr int kStride = 4;
  struct Patch {
    float depth, cosine;  ///< m along the view; of the normal with the path to the eye
    bool hit = true;
  };
  const auto check = [&](const Patch& patch, double expectedCosine) {
    CAPTURE(patch.depth, patch.cosine);
    // On the view's axis, so that the path is the depth.
    const glm::vec3 place = view.eye + patch.depth * view.forward;
    const glm::vec3 normal =
        patch.cosine * -view.forward + std::sqrt(1.0f - patch.cosine * patch.cosine) * view.right;
    const GBuffer gbuffer = gbufferAt({.position = place, .normal = normal, .hit = patch.hit});
    LonePass pass("virtual_area_lights.pixels", builder.scene, {{"stride", kStride}});
    const SurfacePoints points = pass.in("gbuffer", gbuffer).out<SurfacePoints>("points");
    REQUIRE(points.count == 4);
    const std::vector<float> position = points.position->downloadFloats(0),
                             side = points.normal->downloadFloats(0),
                             radius = points.radius->downloadFloats(0);
    const double width =
        kStride * 2.0 * static_cast<double>(view.tanHalfFov) / 8.0 * static_cast<double>(patch.depth);
    const double area = expectedCosine > 0.0 ? width * width / expectedCosine : 0.0;
    CHECK(glm::length(glm::vec3(position[0], position[1], position[2]) - place) < 1e-5f);
    CHECK(static_cast<double>(position[3]) == Approx(area).epsilon(1e-4));
    CHECK(glm::length(glm::vec3(side[0], side[1], side[2]) - (area > 0.0 ? normal : glm::vec3(0.0f))) <
          1e-5f);
    CHECK(side[3] == 0.0f);
    CHECK(static_cast<double>(radius[0]) == Approx(std::sqrt(area / kPi)).epsilon(1e-4));
    CHECK((radius[1] == 0.0f && radius[2] == 0.0f && radius[3] == 1.0f));
  };
  check({0.2f, 1.0f}, 1.0);
  check({2.0f, 1.0f}, 1.0);
  check({4.0f, 0.5f}, 0.5);
  check({4.0f, 0.06f}, 0.06);
  check({4.0f, 0.02f}, 0.05);       // as wide as at a cosine of 0.05
  check({-2.0f, 1.0f}, 0.0);        // behind the eye
  check({2.0f, 1.0f, false}, 0.0);  // nothing is seen
}

TEST_CASE("of the four points around a pixel, those in its plane that face as it does give its light") {
  // A pixel's weights by hand, for points of any place and normal, and at the edge of the image.
  const Scene scene = sceneWith(captureOf(smallCamera(8, 8, 8.0), {plane(2.0)}));
  constexpr int kStride = 4, kSize = 8, kAcross = 2;
  const glm::vec3 normal(0, 0, 1), place(0.1f, -0.2f, -2.0f);
  const GBuffer gbuffer = gbufferAt({.position = place, .normal = normal, .diffuse = glm::vec3(0.5f)});
  const auto tilted = [](float angle) { return glm::vec3(std::sin(angle), 0.0f, std::cos(angle)); };
  const std::vector<SparsePoint> all{
      {.position = {0.0f, 0.0f, -2.0f}, .normal = tilted(0.3f), .radius = 0.4f},
      {.position = {0.4f, 0.1f, -2.1f}, .normal = tilted(0.0f), .radius = 0.5f},
      {.position = {0.1f, 0.3f, -2.6f}, .normal = tilted(-0.2f), .radius = 0.3f},
      {.position = {0.2f, 0.1f, -2.0f}, .normal = tilted(2.5f), .radius = 0.6f}};
  SurfacePoints points = pointsOf(all);
  points.pixels = {kAcross, kAcross}, points.stride = kStride;
  const std::vector<glm::vec4> lights{{1, 0, 3, 1}, {2, 5, 0, 1}, {400, 1, 1, 1}, {800, 9, 2, 1}};
  const ImageBuffer image = LonePass("virtual_area_lights.apply_pixels", scene)
                                .in("gbuffer", gbuffer)
                                .in("points", points)
                                .in("light", lightOverhead(lights))
                                .image("diffuse");
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const double along[2] = {(x - 2.0) / kStride, (y - 2.0) / kStride};
      glm::dvec3 sum(0.0);
      double weights = 0.0;
      for (int corner = 0; corner < 4; ++corner) {
        double near = 1.0;
        int cell[2];
        for (int axis = 0; axis < 2; ++axis) {
          const int first = static_cast<int>(std::floor(along[axis])), step = corner >> axis & 1;
          const double share = along[axis] - first;
          near *= step == 1 ? share : 1.0 - share;
          cell[axis] = std::clamp(first + step, 0, kAcross - 1);
        }
        const auto i = static_cast<std::size_t>(cell[0] + kAcross * cell[1]);
        const double apart = std::abs(static_cast<double>(glm::dot(all[i].normal, place - all[i].position))) /
                             static_cast<double>(all[i].radius),
                     facing = std::max(0.0, static_cast<double>(glm::dot(all[i].normal, normal)));
        const double weight = std::max(near, 1e-3) * (1e-4 + facing * facing * std::max(0.0, 1.0 - apart));
        sum += weight * glm::dvec3(lights[i]);
        weights += weight;
      }
      CAPTURE(x, y);
      for (int c = 0; c < 3; ++c)
        CHECK(static_cast<double>(image.at(x, y, c)) == Approx(0.5 * sum[c] / weights).epsilon(1e-4));
    }
}

TEST_CASE("a pixel without a surface, and one among points without any, reflect nothing") {
  const Scene scene = sceneWith(captureOf(smallCamera(8, 8, 8.0), {plane(2.0)}));
  const auto reflected = [&](bool hit, const glm::vec3& normal) {
    std::vector<SparsePoint> all(4, {.position = {0, 0, -2}, .normal = normal, .radius = 1.0f});
    SurfacePoints points = pointsOf(all);
    points.pixels = {2, 2}, points.stride = 4;
    return LonePass("virtual_area_lights.apply_pixels", scene)
        .in("gbuffer", gbufferAt({.position = {0, 0, -2}, .normal = {0, 0, 1}, .hit = hit}))
        .in("points", points)
        .in("light", lightOverhead(std::vector<glm::vec4>(4, glm::vec4(3.0f))))
        .image("diffuse")
        .at(3, 3, 0);
  };
  CHECK(reflected(true, {0, 0, 1}) == Approx(3.0f));
  CHECK(reflected(false, {0, 0, 1}) == 0.0f);
  CHECK(reflected(true, glm::vec3(0)) == 0.0f);
}
