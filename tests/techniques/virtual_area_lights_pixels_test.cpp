// Points at pixels: for surfaces of which no triangles are known, such as captured ones; and points as discs.
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
