// What a camera with a thin lens sees of voxels.
//
// An edge at depth d is seen through a lens of diameter A that is focused on f as a ramp: in the plane in
// focus a point of it is a disc of diameter C = A |d - f| / d, across which the slope has the variance C^2 /
// 16; the pixel's own square adds p^2 / 12. The cone is the disc of that variance.
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/measure/metrics.h"
#include "support/sheets.h"

using namespace lumivox;
using namespace lumivox::test;
using Catch::Matchers::Contains;
using cones::inputOf;

namespace {

constexpr int kSide = 64;  // pixels along both sides of the images here

struct Lens {
  double aperture = 0.0, focus = 2.0;
  const char* width = "spread";
  const char* opacity = "surfaces";
};

/// A camera at z = 2 that looks along -z at [-1,1]^3.
Scene seenThrough(const Lens& lens, const glm::vec3& environment = glm::vec3(0.0f), double fov = 0.5) {
  SceneBuilder builder;
  Camera& camera = builder.look({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, fov, kSide, kSide);
  camera.aperture = lens.aperture;
  camera.focus = lens.focus;
  builder.scene.environment = environment;
  return builder.scene;
}

template <class Store>
ImageBuffer seen(const Scene& scene, const Store& grid, const Lens& lens, double step = 0.125) {
  PassHarness harness(device(), techniques(), "voxel_cone_tracing", "lens", scene, snapshotOf(scene, 0.0));
  harness.setParameter("width", std::string(lens.width));
  harness.setParameter("opacity", std::string(lens.opacity));
  harness.setParameter("step", step);
  harness.setInput(inputOf(grid), grid);
  harness.run();
  return imageOf(*harness.output<Image>("radiance").texture);
}

/// Distance along the middle row between 0.8 and 0.2 of the radiance on the bright side, pixels.
double edgeWidth(const ImageBuffer& image) {
  const auto placeOf = [&](float level) {
    for (int x = 1; x < kSide; ++x) {
      const float before = image.at(x - 1, kSide / 2, 0), here = image.at(x, kSide / 2, 0);
      if (before >= level && here < level) return x - static_cast<double>((level - here) / (before - here));
    }
    return std::nan("");
  };
  return placeOf(0.2f) - placeOf(0.8f);
}

/// An opaque slab of radiance 1 across x < `edge`, five voxels thick so that nothing shines through, with its
/// front at z.
RadianceGrid litSheet(double z, double edge, int resolution = 128) {
  const int layer = static_cast<int>((z + 1.0) * 0.5 * resolution),
            columns = static_cast<int>((edge + 1.0) * 0.5 * resolution);
  return cones::filtered(cones::makeGrid(resolution, [=](int x, int, int k) {
    return k == layer && x < columns ? glm::vec4(1.0f) : glm::vec4(0.0f);
  }));
}

}  // namespace

TEST_CASE(
    "a constant environment passes cones of any lens unchanged, and a uniform medium dims it by its depth") {
  for (const double aperture : {0.0, 0.3}) {
    for (const char* width : {"spread", "double_cone"}) {
      Lens lens{aperture, 1.5, width, "medium"};
      const Scene scene = seenThrough(lens, {0.5f, 1.0f, 2.0f});
      const ImageBuffer open = seen(scene, cones::uniformGrid(8, glm::vec4(0.0f)), lens);
      for (int channel = 0; channel < 3; ++channel)
        CHECK(open.at(5, 9, channel) == Approx(0.5 * std::exp2(channel)).epsilon(1e-5));
      // 2 m of voxels of 1/16 m along the axis; their radiance is 3, the environment's in the first channel a
      // half.
      const float a = 0.04f;
      const ImageBuffer image =
          seen(scene, cones::filtered(cones::uniformGrid(32, glm::vec4(glm::vec3(3.0f * a), a))), lens);
      const double left = std::pow(1.0 - static_cast<double>(a), 32.0);
      CHECK(image.at(kSide / 2, kSide / 2, 0) == Approx(3.0 * (1.0 - left) + 0.5 * left).epsilon(0.01));
    }
  }
}

TEST_CASE(
    "of a sheet of opacity a the lens sees a of its light and 1 - a of what is behind, in every store") {
  // The middle pixel looks along the sheet's normal; the sheet sends 0.5 W/(sr m^2), the environment 2.
  const float opacity = GENERATE(0.2f, 0.5f, 0.8f);
  const double a = static_cast<double>(opacity);
  cones::forSheets(2, opacity, [&](const auto& store, const char* name) {
    CAPTURE(name, opacity);
    const ImageBuffer image = seen(seenThrough({}, glm::vec3(2.0f)), store, {});
    CHECK(image.at(kSide / 2, kSide / 2, 0) == Approx(0.5 * a + 2.0 * (1.0 - a)).margin(0.06));
    const ImageBuffer dark = seen(seenThrough({}), store, {});
    CHECK(dark.at(kSide / 2, kSide / 2, 0) == Approx(0.5 * a).margin(0.03));
  });
}

TEST_CASE("an edge out of focus is as blurred as its circle of confusion") {
  constexpr double kFov = 0.5;
  for (const double depth : {1.3, 1.7, 2.6}) {
    for (const double aperture : {0.0, 0.15, 0.3}) {
      Lens lens{aperture, 2.0};
      CAPTURE(depth, aperture);
      double measured = 0.0;
      // Voxels lie to an edge in many ways.
      for (const double edge : {0.01, 0.03, 0.05, 0.08})
        measured += 0.25 * edgeWidth(seen(seenThrough(lens), litSheet(2.0 - depth, edge), lens));
      const double pixel = 2.0 * std::tan(0.5 * kFov) / kSide;  // m at a distance of 1 m
      const double circle = aperture * std::abs(depth - lens.focus) / lens.focus / (pixel * depth);
      // What the finest voxels blur by themselves: their standard deviation is half a voxel.
      const double voxel = 2.0 / 128 / (pixel * depth);
      // From 0.2 to 0.8 a normal distribution rises within 1.68 of its standard deviations.
      const double closed = 1.68 * std::sqrt(circle * circle / 16.0 + 1.0 / 12.0);
      CHECK(measured >= 0.85 * closed);
      CHECK(measured <= 1.15 * std::hypot(closed, 1.68 * 0.5 * voxel));
    }
  }
}

TEST_CASE("lamps behind the plane in focus keep their energy") {
  // A lit block of 0.1 m at depth 2.6, through a lens that is focused on 1.5 m, against the pinhole.
  const RadianceGrid block = cones::filtered(cones::makeGrid(80, [](int x, int y, int z) {
    const bool inside = std::max({std::abs(2 * x - 79), std::abs(2 * y - 79)}) < 4 && z >= 14 && z < 18;
    return inside ? glm::vec4(1.0f) : glm::vec4(0.0f);
  }));
  const auto energy = [&](const Lens& lens) {
    double sum = 0.0;
    const ImageBuffer image = seen(seenThrough(lens), block, lens);
    for (const float value : image.values()) sum += static_cast<double>(value);
    return sum;
  };
  const double pinhole = energy({0.0, 1.5});
  REQUIRE(pinhole > 0.0);
  CHECK(energy({0.1, 1.5}) == Approx(pinhole).epsilon(0.25));
}

TEST_CASE(
    "cones of the published double cone are wider than those of the spread, but for the pinhole's plane") {
  const RadianceGrid sheet = litSheet(-0.6, 0.03);
  const auto spread = [&](const char* width) {
    Lens lens{0.3, 1.6, width};
    return edgeWidth(seen(seenThrough(lens), sheet, lens));
  };
  // Their diameters here: C + p, and sqrt(C^2 + 4/3 p^2), where p is 0.12 of C.
  CHECK(spread("double_cone") > spread("spread"));
  CHECK(spread("double_cone") < 1.25 * spread("spread"));
}

namespace {

/// Cards that face the camera, at 1.2, 2.2, 3.2 and 4.2 m, before a wall at 5 m; in focus at 2.2 m.
Scene cards() {
  SceneBuilder builder;
  const int white = builder.lambert(0.8f), dark = builder.lambert(0.1f);
  builder.quad({-2, -1.5f, -3}, {4, 0, 0}, {0, 3, 0}, dark);
  for (int i = 0; i < 4; ++i) {
    const auto z = 0.8f - static_cast<float>(i), x = -0.45f + 0.3f * static_cast<float>(i);
    builder.quad({x, -0.4f, z}, {0.2f, 0, 0}, {0, 0.7f, 0}, white);
  }
  builder.light(LightKind::directional, glm::vec3(3.0f), {}, {-0.2, -0.3, -1});
  builder.scene.environment = glm::vec3(0.3f, 0.4f, 0.6f);
  Camera& camera = builder.look({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 0.7, kSide, kSide);
  camera.aperture = 0.25;
  camera.focus = 2.2;
  return builder.scene;
}

Scene withPinhole(Scene scene) {
  scene.cameras.front().aperture = 0.0;
  return scene;
}

ImageBuffer added(const ImageBuffer& a, const ImageBuffer& b, float share) {
  ImageBuffer sum = a;
  for (std::size_t i = 0; i < sum.values().size(); ++i) sum.values()[i] += share * b.values()[i];
  return sum;
}

double difference(const ImageBuffer& a, const ImageBuffer& b) {
  return compare(a, b).rmse.value;
}

}  // namespace

TEST_CASE("one cone through the lens shows what many narrow ones through its points do") {
  const Scene scene = cards();
  const Pipeline text = pipeline("voxel_cone_tracing_depth_of_field");
  const ImageBuffer lens = renderOnce(scene, text).outputs.at("direct");
  RenderOptions options;
  options.interactive = true;
  PipelineExecutor executor(device(), techniques(), scene, text, options);
  SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  const CameraView camera = snapshot.camera;
  snapshot.camera.aperture = 0.0f;
  const ImageBuffer sharp = executor.render(snapshot).outputs.at("direct");
  ImageBuffer mean(kSide, kSide, 3);
  constexpr int kPoints = 64;
  for (int i = 0; i < kPoints; ++i) {
    // A spiral fills the disc evenly. Seen from its points, the plane in focus stays where it is.
    const auto radius = 0.5f * camera.aperture * std::sqrt((static_cast<float>(i) + 0.5f) / kPoints),
               angle = 2.3999632f * static_cast<float>(i);
    const glm::vec2 place = radius * glm::vec2(std::cos(angle), std::sin(angle));
    snapshot.camera.eye = camera.eye + place.x * camera.right + place.y * camera.up;
    snapshot.camera.shift = glm::vec2(-place.x, place.y) / camera.focus * (0.5f * kSide / camera.tanHalfFov);
    mean = added(mean, executor.render(snapshot).outputs.at("direct"), 1.0f / kPoints);
  }
  CHECK(difference(lens, mean) < 0.6 * difference(sharp, mean));
}

TEST_CASE("through voxels of 16 mm the lens is nearer to the path tracer's than a rasterised pinhole") {
  const Scene scene = cards(), pinhole = withPinhole(scene);
  ReferenceOptions reference = quietly(256, 0);
  reference.useCache = true;
  const ImageBuffer blurred = cachedReference(scene, reference).layers.at("direct");
  const Pipeline text = pipeline("voxel_cone_tracing_depth_of_field");
  RenderOptions options;
  options.parameters = text.settings({"resolution=256"});
  const double lens = difference(renderOnce(scene, text, options).outputs.at("direct"), blurred),
               narrow = difference(renderOnce(pinhole, text, options).outputs.at("direct"), blurred),
               rasterised =
                   difference(renderOnce(pinhole, pipeline("direct_lighting")).outputs.at("direct"), blurred);
  CAPTURE(lens, narrow, rasterised);
  CHECK(lens < 0.75 * narrow);
  CHECK(lens < 0.75 * rasterised);
}

TEST_CASE(
    "the lens sees a lamp of the radiance L as bright as it is where injection takes emission, and else black") {
  SceneBuilder builder;
  Camera& camera = builder.look({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 0.4, kSide, kSide);
  camera.focus = 2.0;
  builder.quad({-1, -1, 0.03f}, {2, 0, 0}, {0, 2, 0}, builder.lambert(0.0f, 5.0f));  // looks at the camera
  builder.quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, builder.lambert(0.5f));
  for (const bool on : {true, false}) {
    cones::InjectSettings settings;
    settings.emission = on;
    const RadianceGrid grid = cones::filtered(cones::injectedGrid(builder.scene, 64, settings));
    const ImageBuffer image = seen(builder.scene, grid, {0.0, 2.0});
    for (int channel = 0; channel < 3; ++channel)
      CHECK(image.at(kSide / 2, kSide / 2, channel) == Approx(on ? 5.0 : 0.0).margin(0.05));
  }
  // Of six grids the back of the lamp stays dark.
  cones::InjectSettings settings;
  settings.emission = true;
  const auto faces = cones::injectedDirections(builder.scene, 32, settings);
  const auto largestOf = [&](std::size_t face) {
    const std::vector<float> texels = faces.faces[face]->downloadFloats(0);
    float most = 0.0f;
    for (std::size_t i = 0; i < texels.size(); i += 4) most = std::max(most, texels[i] * faces.unit);
    return most;
  };
  CHECK(largestOf(4) == Approx(5.0).epsilon(0.01));  // towards +z
  CHECK(largestOf(5) < 0.5f);
}
