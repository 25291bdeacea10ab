// Pixels of captured frames as lights, against closed forms; the picture behind virtual content.
#include <cmath>
#include <limits>
#include <numbers>

#include "lumivox/base/error.h"
#include "support/captures.h"
#include "support/facts.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

const Settings kRaw{{"filter", 0}};

/// Freiburg 1 of the TUM RGB-D benchmark, for images a quarter as wide.
CaptureCamera distortedCamera() {
  CaptureCamera camera = smallCamera(160, 120, 129.3);
  camera.distortion = {0.262383, -0.953104, -0.005358, 0.002628, 1.163314};
  return camera;
}

/// Area of the plane of plane(distance, slant) behind pixels from `margin` within the image, by fine rays.
double areaSeen(const CaptureCamera& camera, double distance, double slant, int x0, int y0, int x1, int y1) {
  // The polygon of the image's border, of which each point is carried to the plane.
  std::vector<glm::dvec3> border;
  const auto add = [&](double x, double y) {
    const glm::dvec2 ray = camera.ray({x, y});
    const double z = plane(distance, slant)(ray).depth;
    border.emplace_back(ray.x * z, ray.y * z, z);
  };
  constexpr int kSteps = 400;
  const double left = x0 - 0.5, right = x1 - 0.5, top = y0 - 0.5, bottom = y1 - 0.5;
  for (int i = 0; i < kSteps; ++i) add(std::lerp(left, right, i / double{kSteps}), top);
  for (int i = 0; i < kSteps; ++i) add(right, std::lerp(top, bottom, i / double{kSteps}));
  for (int i = 0; i < kSteps; ++i) add(std::lerp(right, left, i / double{kSteps}), bottom);
  for (int i = 0; i < kSteps; ++i) add(left, std::lerp(bottom, top, i / double{kSteps}));
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < border.size(); ++i)
    sum += glm::cross(border[i], border[(i + 1) % border.size()]);
  return 0.5 * glm::length(sum);
}

}  // namespace

TEST_CASE(
    "areas of a seen plane sum to it within 1 %, face on and at a slant, through a distorting lens too") {
  const double degrees = GENERATE(0.0, 45.0, 75.0);
  const bool isDistorted = GENERATE(false, true);
  CAPTURE(degrees, isDistorted);
  const double slant = degrees * kPi / 180.0;
  // At 75 degrees only a narrow view meets the plane everywhere.
  CaptureCamera camera = isDistorted ? distortedCamera() : smallCamera(160, 120, 200.0);
  if (degrees > 60.0) camera.focal = glm::dvec2(900.0);
  const CapturedMap map = lightsIn(sceneWith(captureOf(camera, {plane(2.0, slant)})), kRaw);
  for (const PixelLight& light : map.pixels) REQUIRE(light.isSurface);
  CHECK(map.area() == Approx(areaSeen(camera, 2.0, slant, 0, 0, 160, 120)).epsilon(0.01));
  // Each pixel lies on the plane, in the scene's axes (y up, -z forward), and its normal is the plane's.
  const glm::vec3 normal(static_cast<float>(std::sin(slant)), 0.0f, static_cast<float>(std::cos(slant)));
  for (const PixelLight& light : map.pixels) {
    REQUIRE(std::abs(glm::dot(light.position - glm::vec3(0, 0, -2), normal)) < 1e-5f);
    REQUIRE(glm::dot(light.normal, normal) > 1.0f - 1e-5f);
  }
}

TEST_CASE(
    "a pixel's flux is that of a Lambert emitter of its colour, and twice the focal length sees a quarter") {
  const glm::vec3 radiance(2.0f, 1.0f, 0.5f);
  const CapturedMap wide = lightsIn(sceneWith(captureOf(smallCamera(), {plane(1.5, 0.0, radiance)})), kRaw),
                    narrow = lightsIn(
                        sceneWith(captureOf(smallCamera(60, 40, 100.0), {plane(1.5, 0.0, radiance)})), kRaw);
  for (const PixelLight& light : wide.pixels)
    for (int c = 0; c < 3; ++c)
      REQUIRE(light.flux[c] == Approx(kPi * radiance[c] * light.area).epsilon(1e-5));
  CHECK(wide.flux() == Approx(4.0 * narrow.flux()).epsilon(1e-4));
}

TEST_CASE("in a white furnace the eye receives pi L times the form factor of the frustum's rectangle") {
  // Walls of radiance L at any depth: here a plane with a step.
  const auto seen = [](const glm::dvec2& ray) { return SeenPixel{ray.x < 0.1 ? 1.0 : 2.0, glm::vec3(3.0f)}; };
  const CaptureCamera camera = smallCamera(160, 120, 120.0);
  const CapturedMap map = lightsIn(sceneWith(captureOf(camera, {seen})), kRaw);
  double irradiance = 0.0;
  for (const PixelLight& light : map.pixels) {
    if (!light.isSurface) continue;
    const glm::dvec3 path(light.position);
    const double distance = glm::length(path);
    irradiance += static_cast<double>(light.flux.x) / kPi * (-path.z / distance) *
                  (glm::dot(glm::dvec3(light.normal), -path) / distance) / (distance * distance);
  }
  // Of a rectangle before a point with the same normal (Howell, configuration B-3), four quarters.
  const double a = 0.5 * camera.width / camera.focal.x, b = 0.5 * camera.height / camera.focal.y;
  const double factor = 4.0 / (2.0 * kPi) *
                        (a / std::sqrt(1 + a * a) * std::atan(b / std::sqrt(1 + a * a)) +
                         b / std::sqrt(1 + b * b) * std::atan(a / std::sqrt(1 + b * b)));
  CHECK(irradiance == Approx(kPi * 3.0 * factor).epsilon(0.02));
}

TEST_CASE("elsewhere in a white furnace pi L times the form factors of what is seen of each wall arrives") {
  // Two walls that meet 2 m before the eye, each seen to the middle of the picture.
  constexpr double kSlant = 0.6, kRadiance = 3.0;
  const auto left = plane(2.0, kSlant, glm::vec3(kRadiance)),
             right = plane(2.0, -kSlant, glm::vec3(kRadiance));
  const CaptureCamera camera = smallCamera(160, 120, 120.0);
  const CapturedMap map =
      lightsIn(sceneWith(captureOf(
                   camera, {[&](const glm::dvec2& ray) { return ray.x < 0.0 ? left(ray) : right(ray); }})),
               kRaw);
  // Corners of what is seen of a wall, in the scene's axes, so that it is to the left of its border from the
  // eye.
  const auto cornersOf = [&](const SeenAlong& wall, double from, double to) {
    const double down = 0.5 * camera.height / camera.focal.y;
    std::vector<glm::dvec3> corners;
    for (const glm::dvec2& ray : {glm::dvec2(from, down), {to, down}, {to, -down}, {from, -down}}) {
      const double depth = wall(ray).depth;
      corners.emplace_back(ray.x * depth, -ray.y * depth, -depth);
    }
    return corners;
  };
  const double across = 0.5 * camera.width / camera.focal.x;
  const std::vector<std::vector<glm::dvec3>> walls{cornersOf(left, -across, 0.0),
                                                   cornersOf(right, 0.0, across)};
  struct Receiver {
    glm::dvec3 place, normal;
  };
  for (const Receiver& at : {Receiver{{0.0, 0.0, -1.0}, {0, 0, -1}},
                             Receiver{{0.3, 0.2, -0.6}, glm::normalize(glm::dvec3(0.2, -0.1, -1))},
                             Receiver{{-0.5, 0.1, 0.5}, {0, 0, -1}}}) {
    CAPTURE(at.place.x, at.place.y, at.place.z);
    // Lambert's formula for a polygon above the receiver's horizon.
    double factor = 0.0;
    for (const auto& corners : walls) {
      double sum = 0.0;
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 a = glm::normalize(corners[i] - at.place),
                         b = glm::normalize(corners[(i + 1) % corners.size()] - at.place);
        sum += std::acos(glm::dot(a, b)) * glm::dot(glm::normalize(glm::cross(a, b)), at.normal);
      }
      factor += std::abs(sum) / (2.0 * kPi);
    }
    double irradiance = 0.0;
    for (const PixelLight& light : map.pixels) {
      if (!light.isSurface) continue;
      const glm::dvec3 path = glm::dvec3(light.position) - at.place;
      const double distance = glm::length(path);
      irradiance +=
          static_cast<double>(light.flux.x) / kPi * std::max(0.0, glm::dot(at.normal, path) / distance) *
          std::max(0.0, glm::dot(glm::dvec3(light.normal), -path) / distance) / (distance * distance);
    }
    CHECK(irradiance == Approx(kPi * kRadiance * factor).epsilon(0.05));
  }
}

TEST_CASE("holes, flying pixels and colours that are no radiance give no light") {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const CaptureCamera camera = smallCamera();
  const auto pixelOf = [&](const glm::dvec2& ray) { return glm::ivec2(glm::round(camera.project(ray))); };
  const auto seen = [&](const glm::dvec2& ray) {
    SeenPixel pixel = plane(2.0)(ray);
    const glm::ivec2 at = pixelOf(ray);
    if (at == glm::ivec2(10, 10)) pixel.depth = 0.0;
    if (at == glm::ivec2(20, 10)) pixel.radiance.y = static_cast<float>(kNaN);
    if (at == glm::ivec2(30, 10)) pixel.radiance.z = -1.0f;
    if (at == glm::ivec2(40, 10)) pixel.radiance.x = std::numeric_limits<float>::infinity();
    // A single pixel between two depths, as sensors smear edges.
    if (at.x == 50) pixel.depth = 2.5;
    if (at.x > 50) pixel.depth = 3.0;
    return pixel;
  };
  const CapturedMap map = lightsIn(sceneWith(captureOf(camera, {seen})), kRaw);
  for (const int x : {10, 20, 30, 40}) {
    CAPTURE(x);
    CHECK_FALSE(map.at(x, 10).isSurface);
    CHECK(map.at(x, 10).flux == glm::vec3(0.0f));
    CHECK(map.at(x, 12).isSurface);
  }
  CHECK_FALSE(map.at(50, 20).isSurface);
  CHECK(map.at(48, 20).isSurface);
  CHECK(map.at(52, 20).isSurface);
  for (const PixelLight& light : map.pixels)
    REQUIRE((std::isfinite(light.area) && std::isfinite(light.flux.x) && light.area >= 0.0f));
}

TEST_CASE("a capture of one pixel, and one without any depth, are dark") {
  CHECK(lightsIn(sceneWith(captureOf(smallCamera(1, 1), {plane(1.0)}))).flux() == 0.0);
  CHECK(lightsIn(sceneWith(captureOf(smallCamera(), {plane(0.0)}))).flux() == 0.0);
}

TEST_CASE("colours at the end of the file's range are kept, dropped or scaled") {
  const auto seen = [](const glm::dvec2& ray) {
    return SeenPixel{2.0, glm::vec3(ray.x < 0.0 ? 1.0f : 0.25f)};
  };
  const Scene scene = sceneWith(captureOf(smallCamera(), {seen}, {frameAt()}, 1.0f));
  const auto fluxWith = [&](const char* how) {
    return lightsIn(scene, {{"filter", 0}, {"saturated", how}, {"saturated_scale", 8}}).flux();
  };
  const double kept = fluxWith("kept"), dim = kept / 5.0;
  CHECK(fluxWith("dropped") == Approx(dim).epsilon(1e-4));
  CHECK(fluxWith("scaled") == Approx(dim + 8.0 * (kept - dim)).epsilon(1e-4));
}

TEST_CASE("two frames of the same view light like one") {
  const CaptureFrame first = frameAt(), second = frameAt(glm::dvec3(0), 1.0);
  const Scene scene =
      sceneWith(captureOf(smallCamera(), {plane(2.0, 0.3), plane(2.0, 0.3)}, {first, second}));
  const double one = lightsIn(scene, {}, {{"frames", 1}}, 1.0).flux();
  const CapturedMap both = lightsIn(scene, {}, {{"frames", 2}}, 1.0);
  CHECK(both.value.layerCount == 2);
  CHECK(both.flux() == Approx(one).epsilon(0.01));
}

TEST_CASE("a frame from the side adds what the newer one does not see, and nothing twice") {
  // A plane from two places: together they see the union of both views.
  const CaptureCamera camera = smallCamera();
  const double aside = 0.8;  // of a view 2.4 m wide at 2 m
  const Scene scene = sceneWith(
      captureOf(camera, {plane(2.0), plane(2.0)}, {frameAt({aside, 0, 0}), frameAt(glm::dvec3(0), 1.0)}));
  const double one = lightsIn(scene, kRaw, {{"frames", 1}}, 1.0).area(),
               both = lightsIn(scene, kRaw, {{"frames", 2}}, 1.0).area();
  CHECK(both == Approx(one * (1.0 + aside / 2.4)).epsilon(0.02));
}

TEST_CASE("a frame alone has the lights that it has in a sequence") {
  const Scene scene = sceneWith(captureOf(smallCamera(), {plane(2.0), plane(3.0), plane(4.0)},
                                          {frameAt(), frameAt({1, 0, 0}, 1.0), frameAt({2, 0, 0}, 2.0)}));
  const Pipeline text = Pipeline::parse(
      "pipeline \"p\" { pass read captured_frames.read { frames 2 }\n pass lights captured_frames.lights { frames "
      "read.frames }\n pass gbuffer direct_lighting.gbuffer { }\n pass choose reflective_shadow_maps.choose { map lights.map "
      "}\n pass gather reflective_shadow_maps.gather { gbuffer gbuffer lights choose.lights }\n output indirect_diffuse "
      "gather.diffuse }",
      "p.pipeline");
  PipelineExecutor sequence(device(), techniques(), scene, text, {}),
      alone(device(), techniques(), scene, text, {});
  for (PipelineExecutor* one : {&sequence, &alone}) one->keepOutput("lights", "map");
  for (const double time : {0.0, 1.0, 2.0}) sequence.render(time);
  alone.render(2.0);
  const auto fluxOf = [](const PipelineExecutor& executor) {
    return kept<ReflectiveShadowMap>(executor, "lights", "map").flux->downloadFloats(0);
  };
  CHECK(fluxOf(sequence) == fluxOf(alone));
  // Within one frame nothing is decoded again.
  const FrameResult later = alone.render(2.5);
  CHECK_FALSE(ran(later, "read"));
}

TEST_CASE("the filter takes noise from depths, and keeps an edge of 10 cm at 2 m where it is") {
  std::mt19937 random(3);
  std::normal_distribution<double> noise;
  const CaptureCamera camera = smallCamera(160, 120, 130.0);
  std::vector<double> table(160 * 120);
  for (double& one : table) one = noise(random);
  const auto seen = [&](const glm::dvec2& ray) {
    const glm::ivec2 at(glm::round(camera.project(ray)));
    const double z = at.x < 80 ? 2.0 : 2.1;
    const double deviation = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
    return SeenPixel{z + deviation * table[static_cast<std::size_t>(at.y * 160 + at.x)], glm::vec3(1.0f)};
  };
  const Scene scene = sceneWith(captureOf(camera, {seen}));
  const auto judged = [&](double filter) {
    const CapturedMap map = lightsIn(scene, {{"filter", filter}});
    double squares = 0.0, edge = 0.0;
    int count = 0;
    for (int y = 5; y < 115; ++y)
      for (int x = 5; x < 155; ++x) {
        const PixelLight& light = map.at(x, y);
        if (!light.isSurface) continue;
        const double z = -static_cast<double>(light.position.z), wanted = x < 80 ? 2.0 : 2.1;
        if (std::abs(x - 80) <= 2) continue;
        edge = std::max(edge, std::abs(z - wanted));
        squares += std::pow(std::acos(std::min(1.0, static_cast<double>(light.normal.z))), 2.0);
        ++count;
      }
    return std::pair(std::sqrt(squares / count), edge);
  };
  const auto [rawNormals, rawDepth] = judged(0.0);
  const auto [normals, depth] = judged(2.0);
  INFO("normals off by " << rawNormals << " rad without, " << normals << " with the filter; depths by "
                         << rawDepth << " m and " << depth << " m");
  CHECK(normals < 0.5 * rawNormals);
  CHECK(depth < 0.6 * rawDepth);
  CHECK(depth < 0.02);  // beyond two pixels of the edge no depth is of the other side
}

TEST_CASE(
    "a filtered depth is the mean of its neighbours by their distance and by the deviation of the sensor") {
  const CaptureCamera camera = smallCamera(9, 9, 40.0);
  const double z = GENERATE(0.8, 2.0, 4.0);
  const bool isKinect = GENERATE(true, false);
  CAPTURE(z, isKinect);
  const double sigma = isKinect ? 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4) : 0.004 * z;
  const auto off = [](const glm::ivec2& at) {
    return at == glm::ivec2(4) ? 0.0 : 3.0 * std::sin(1.7 * at.x + 2.9 * at.y);
  };
  const auto seen = [&](const glm::dvec2& ray) {
    return SeenPixel{z + sigma * off(glm::ivec2(glm::round(camera.project(ray)))), glm::vec3(1.0f)};
  };
  constexpr double kFilter = 1.5, kRange = 2.0;
  const CapturedMap map =
      lightsIn(sceneWith(captureOf(camera, {seen})), {{"filter", kFilter},
                                                      {"range", kRange},
                                                      {"noise", isKinect ? "kinect" : "share"},
                                                      {"noise_share", 0.004}});
  // Within two deviations of the filter in the image; sigma cancels in the weights over depth.
  double sum = 0.0, weights = 0.0;
  for (int y = 1; y <= 7; ++y)
    for (int x = 1; x <= 7; ++x) {
      const double squared = (x - 4) * (x - 4) + (y - 4) * (y - 4), difference = off({x, y});
      const double weight =
          std::exp(-0.5 * squared / (kFilter * kFilter) - 0.5 * difference * difference / (kRange * kRange));
      sum += weight * difference;
      weights += weight;
    }
  REQUIRE(map.at(4, 4).isSurface);
  const double moved = -static_cast<double>(map.at(4, 4).position.z) - z;
  CHECK(moved / sigma == Approx(sum / weights).margin(2e-3));
}

TEST_CASE("a colour is saturated from 'brightest' on in any of its channels") {
  for (int channel = 0; channel < 3; ++channel) {
    CAPTURE(channel);
    const auto seen = [&](const glm::dvec2& ray) {
      SeenPixel pixel{2.0, glm::vec3(0.25f)};
      if (ray.x < 0.0) pixel.radiance[channel] = 0.9f;
      return pixel;
    };
    const CapturedMap map = lightsIn(sceneWith(captureOf(smallCamera(), {seen})),
                                     {{"filter", 0}, {"saturated", "dropped"}, {"brightest", 0.5}});
    CHECK(map.at(10, 20).flux == glm::vec3(0.0f));
    CHECK(map.at(50, 20).flux.x > 0.0f);
  }
}

TEST_CASE("noise of the sensor biases the light that arrives by less than 3 %") {
  std::mt19937 random(11);
  std::normal_distribution<double> noise;
  const CaptureCamera camera = smallCamera(160, 120, 130.0);
  const auto clean = plane(2.0, 0.5);
  const auto noisy = [&](const glm::dvec2& ray) {
    SeenPixel pixel = clean(ray);
    pixel.depth += (0.0012 + 0.0019 * (pixel.depth - 0.4) * (pixel.depth - 0.4)) * noise(random);
    return pixel;
  };
  const auto arriving = [](const CapturedMap& map) {
    const glm::dvec3 place(0.0, 0.0, -0.6);
    double sum = 0.0;
    for (const PixelLight& light : map.pixels) {
      if (!light.isSurface) continue;
      const glm::dvec3 path = glm::dvec3(light.position) - place;
      const double distance = glm::length(path);
      sum += static_cast<double>(light.flux.x) / kPi * std::max(0.0, -path.z / distance) *
             std::max(0.0, glm::dot(glm::dvec3(light.normal), -path) / distance) / (distance * distance);
    }
    return sum;
  };
  const double expected = arriving(lightsIn(sceneWith(captureOf(camera, {clean})), kRaw)),
               found = arriving(lightsIn(sceneWith(captureOf(camera, {noisy})), {{"filter", 2}}));
  CHECK(found == Approx(expected).epsilon(0.03));
}

TEST_CASE("a map that is no square gives the same lights as the square with black rows") {
  const Scene scene = sceneWith(captureOf(smallCamera(48, 32, 40.0), {plane(2.0, 0.4, glm::vec3(1, 2, 3))}));
  const CapturedMap map = lightsIn(scene, kRaw);
  ReflectiveShadowMap square = map.value;
  const auto padded = [&](const gpu::TextureRef& texture) {
    std::vector<float> values = texture->downloadFloats(0);
    values.resize(48 * 48 * 4, 0.0f);
    gpu::TextureDescription description = texture->description();
    description.height = 48;
    return textureOf(description, values);
  };
  square.position = padded(map.value.position);
  square.normal = padded(map.value.normal);
  square.flux = padded(map.value.flux);
  const Settings settings = GENERATE(Settings{{"method", "flux"}, {"lights", 64}},
                                     Settings{{"method", "flux"}, {"lights", 64}, {"order", "patches"}},
                                     Settings{{"method", "stride"}, {"stride", 4}});
  const auto chosen = [&](const ReflectiveShadowMap& given) {
    const SurfaceLights lights = LonePass("reflective_shadow_maps.choose", scene, settings)
                                     .in("map", given)
                                     .out<SurfaceLights>("lights");
    std::vector<float> values = lights.lights->downloadValues<float>();
    values.resize(static_cast<std::size_t>(lights.count) * 12);
    std::vector<std::array<float, 12>> bright;
    for (std::size_t i = 0; i < values.size(); i += 12) {
      std::array<float, 12> light;
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i), 12, light.begin());
      if (light[8] > 0.0f) bright.push_back(light);
    }
    return bright;
  };
  const auto own = chosen(map.value), other = chosen(square);
  REQUIRE(!own.empty());
  // Strips of patches are cut off elsewhere; the light is the same.
  if (settings.size() == 3) {
    double a = 0.0, b = 0.0;
    for (const auto& light : own) a += static_cast<double>(light[8]);
    for (const auto& light : other) b += static_cast<double>(light[8]);
    CHECK(a == Approx(b).epsilon(1e-4));
    CHECK(a == Approx(map.flux()).epsilon(1e-4));
  } else {
    CHECK(own == other);
  }
}

TEST_CASE("virtual content stands before the picture where it is nearer, and is hidden where it is not") {
  // A virtual wall at 2 m; the captured surfaces at 1 m to the left and at 3 m to the right.
  const auto seen = [](const glm::dvec2& ray) {
    return SeenPixel{ray.x < 0.0 ? 1.0 : 3.0, glm::vec3(ray.x < 0.0 ? 4.0f : 9.0f)};
  };
  Scene scene = sceneWith(captureOf(smallCamera(), {seen}));
  SceneBuilder wall;
  wall.quad({-9, -9, -2}, {18, 0, 0}, {0, 9, 0}, wall.lambert(0.5f));  // its upper edge at the horizon
  wall.scene.cameras = scene.cameras;
  wall.scene.captures = scene.captures;
  const ImageBuffer image = LonePass("captured_frames.composite", wall.scene)
                                .in("gbuffer", gbufferOf(wall.scene))
                                .in("virtual", Image{filled(pixels(60, 40), glm::vec4(7.0f))})
                                .in("frames", read(wall.scene))
                                .image("radiance");
  CHECK(image.at(10, 35, 0) == 4.0f);  // behind the near surface
  CHECK(image.at(50, 35, 0) == 7.0f);  // before the far one
  CHECK(image.at(10, 5, 0) == 4.0f);   // nothing virtual
  CHECK(image.at(50, 5, 0) == 9.0f);
}

TEST_CASE("behind content that is seen from elsewhere the picture is left out") {
  Scene scene = sceneWith(captureOf(smallCamera(), {plane(2.0)}));
  const captured_frames::CapturedFrames frames = read(scene);
  scene.cameras.front().capture = -1;
  scene.cameras.front().eye = {0.5, 0, 0};
  scene.cameras.front().target = {0.5, 0, -1};
  const ImageBuffer image = LonePass("captured_frames.composite", scene)
                                .in("gbuffer", gbufferOf(scene))
                                .in("virtual", Image{filled(pixels(60, 40), glm::vec4(7.0f))})
                                .in("frames", frames)
                                .image("radiance");
  for (const float value : image.values()) REQUIRE(value == 7.0f);
}

TEST_CASE("through a distorting lens the picture is resampled along the same rays") {
  // The radiance is a function of the ray, so that the composite shows it as a pinhole would.
  CaptureCamera camera = distortedCamera();
  if (GENERATE(false, true)) camera.distortion = {0.0, 0.0, 0.04, -0.05, 0.0};  // decentred alone
  const auto radiance = [](const glm::dvec2& ray) { return static_cast<float>(2.0 + ray.x - 0.5 * ray.y); };
  const Scene scene = sceneWith(captureOf(camera, {[&](const glm::dvec2& ray) {
                                            return SeenPixel{2.0, glm::vec3(radiance(ray))};
                                          }}));
  const ImageBuffer image = LonePass("captured_frames.composite", scene)
                                .in("gbuffer", gbufferAt({.hit = false}, {160, 120}))
                                .in("virtual", Image{filled(pixels(160, 120), glm::vec4(0.0f))})
                                .in("frames", read(scene))
                                .image("radiance");
  const CameraView view = snapshotOf(scene, 0.0).camera;
  for (int y = 10; y < 110; y += 7)
    for (int x = 10; x < 150; x += 7) {
      const glm::vec3 direction = view.direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      CHECK(image.at(x, y, 0) == Approx(radiance({direction.x, -direction.y})).margin(2e-3));
    }
}
