// Virtual area lights as published (Lensing and Broll 2013): what each printed form must give, worked out by
// hand; light at vertices, through the rasteriser; and the word that sets all of it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "../../techniques/virtual_area_lights/vertices/vertex_points.h"
#include "lumivox/base/error.h"
#include "lumivox/experiment/voxelizers.h"
#include "support/against_reference.h"
#include "support/facts.h"
#include "support/half_masked_sheet.h"
#include "support/kept_table.h"
#include "support/placed.h"
#include "support/virtual_area_lights.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr int kPixels = 48;
const Settings kAsPublished{{"as_published", "on"}};
const Settings kAtVertices{{"at", "vertices"}};

/// What a scene's camera sees at one time, and the pass that shows light on it.
struct Shown {
  const Scene& scene;
  SceneSnapshot snapshot;
  GBuffer gbuffer;

  explicit Shown(const Scene& shownScene, double time = 0.0)
      : scene(shownScene),
        snapshot(snapshotOf(scene, time, {}, kPixels, kPixels)),
        gbuffer(LonePass("direct_lighting.gbuffer", scene, {}, snapshot).out<GBuffer>("gbuffer")) {}
  SurfacePoints points(int count) const {
    return lone("points", {{"points", count}}).out<SurfacePoints>("points");
  }
  virtual_area_lights::VertexPoints vertices(const SurfacePoints& points) const {
    return lone("vertices", {}).in("points", points).out<virtual_area_lights::VertexPoints>("vertices");
  }
  LonePass lone(const std::string& name, const Settings& settings) const {
    return {"virtual_area_lights." + name, scene, settings, snapshot};
  }
  /// Diffuse and, where the scene has glossy surfaces, glossy.
  std::pair<ImageBuffer, ImageBuffer> apply(const SurfacePoints& points, const SparseLight& light,
                                            const Settings& settings) {
    LonePass pass = lone("apply", settings);
    pass.in("gbuffer", gbuffer).in("points", points).in("light", light).in("vertices", vertices(points));
    return {pass.image("diffuse"), light.glossy ? pass.image("glossy") : ImageBuffer()};
  }
};

bool differ(const ImageBuffer& a, const ImageBuffer& b) {
  return !std::equal(a.values().begin(), a.values().end(), b.values().begin(), b.values().end());
}

/// A glossy triangle with corners at `corners`, seen from `height`.
SceneBuilder oneTriangle(const std::vector<glm::vec3>& corners, double height) {
  SceneBuilder builder;
  builder.mesh(corners, builder.phong(0.5f, 0.25f, 10.0f));
  builder.light(LightKind::point, glm::vec3(1.0f), {0, 1, 0});
  builder.look({0.4, height, 1.0}, {0, 0, -0.2}, {0, 1, 0}, 0.9, kPixels, kPixels);
  return builder;
}

}  // namespace

TEST_CASE(
    "Eq. 4 and 5 as printed: the flux, the lobe at the middle of the disc, and no cosine for it at the receiver") {
  constexpr double kFactor = 3.0, kExponent = 100.0;
  // One light above, one aside; both face the point, a metre away.
  const std::vector<DiscLight> lights{{{0, 1, 0}, {0, -1, 0}, 0.01f, glm::vec3(2.0f)},
                                      {{0.6f, 0.8f, 0}, {-0.6f, -0.8f, 0}, 0.02f, glm::vec3(5.0f)}};
  const double fluxes[2] = {0.02, 0.1}, cosines[2] = {1.0, 0.8};
  const glm::dvec3 places[2] = {{0, 1, 0}, {0.6, 0.8, 0}};
  // The limit by the spacing of 0.1 m would be an exponent of 25.
  const SurfacePoints points = pointsOf({{{0, 0, 0}, {0, 1, 0}, 0.01f, 0.1f, kExponent}});
  SparsePasses passes;
  const SparseLight light =
      passes.gather(points, lightsOf(lights), {{"as_published", "on"}, {"factor", kFactor}});
  for (const bool glossy : {false, true}) {
    double sum = 0.0, weights = 0.0;
    glm::dvec3 mean(0.0), squares(0.0);
    for (int i = 0; i < 2; ++i) {
      const double squaredRadius = lights[static_cast<std::size_t>(i)].area / kPi,
                   width = squaredRadius / (1.0 + squaredRadius),
                   lobe = glossy ? std::pow(cosines[i], kExponent) : cosines[i];
      sum += fluxes[i] * width * lobe * (glossy ? kFactor * (kExponent + 1.0) : 1.0 / kPi);
      const double weight = 0.5e-6 + width * lobe;
      weights += weight;
      mean += weight * places[i];
      squares += weight * places[i] * places[i];
    }
    mean /= weights;
    const glm::dvec3 variance = squares / weights - mean * mean;
    CAPTURE(glossy);
    const glm::vec4 found = valuesOf(glossy ? light.glossy : light.diffuse, 1).front(),
                    place = valuesOf(glossy ? light.glossyPosition : light.diffusePosition, 1).front();
    CHECK(found.x == Approx(sum).epsilon(1e-4));
    CHECK(place.x == Approx(mean.x).epsilon(1e-4));
    CHECK(place.y == Approx(mean.y).epsilon(1e-4));
    // Twice the largest deviation of the places, without the discs' own extent.
    CHECK(place.w ==
          Approx(2.0 * std::sqrt(std::max({variance.x, variance.y, variance.z}))).epsilon(2e-3).margin(2e-3));
    if (glossy) CHECK(found.w == Approx(1.0 + kExponent));
  }
  // One light alone is no sphere at all.
  CHECK(valuesOf(passes.gather(points, lightsOf({lights[0]}), kAsPublished).diffusePosition, 1).front().w ==
        Approx(0.0).margin(1e-3));
}

TEST_CASE("Eq. 11 as printed: the squared distance over the cosine or the lobe, without a bound") {
  const SurfacePoints points = pointsOf({{{0, 0, 0}, {0, 1, 0}, 0.01f, 0.1f, 10.0f}});
  const SparseLight light{texels({{3, 3, 3, 1}}), texels({{1.2f, 1.6f, 0, 1}}),  // 2 m away, cosine 0.8
                          texels({{3, 3, 3, 11}}), texels({{1.2f, 1.6f, 0, 1}})};
  SparsePasses passes;
  const SparseLight found = passes.normalise(points, light, kAsPublished);
  CHECK(valuesOf(found.diffuse, 1).front().x == Approx(3.0 * 4.0 / 0.8).epsilon(1e-5));
  CHECK(valuesOf(found.glossy, 1).front().x == Approx(3.0 * 4.0 / std::pow(0.8, 10.0)).epsilon(1e-4));
  // As far as a float holds it.
  SparseLight grazing = light;
  grazing.diffusePosition = texels({{1e6f, 1e-30f, 0, 1}});
  grazing.diffuse = texels({{1e20f, 0, 0, 1}});
  const glm::vec4 most = valuesOf(passes.normalise(points, grazing, kAsPublished).diffuse, 1).front();
  CHECK(most.x == Approx(1e30f));
  CHECK(most.y == 0.0f);
}

TEST_CASE(
    "Sec. 3.3 as printed: a sphere is seen as a disc is, and each disc hides its share of what is left") {
  // A sphere of half a metre at two metres; discs of 0.1 m at 1 m and at 1.2 m, before its middle.
  const SurfacePoints points = pointsOf({{{0, 0, 0}, {0, 1, 0}, 0.01f, 0.1f},
                                         {{0, 1, 0}, {0, -1, 0}, 0.01f, 0.1f},
                                         {{0, 1.2f, 0}, {0, -1, 0}, 0.01f, 0.1f}});
  const std::vector<glm::vec4> lights{{1, 1, 1, 1}, {}, {}}, places{{0, 2, 0, 0.5f}, {}, {}};
  const SparseLight light = diffuseLight(lights, places);
  const auto disc = [](double distance) { return 0.01 / (distance * distance + 0.01); };
  SparsePasses passes;
  const auto open = [&](const Settings& settings) {
    return valuesOf(passes.occlude(points, light, settings).diffuse, 1).front().x;
  };
  const double printed = 0.25 / (4.0 + 0.25), ours = 0.25 / 4.0;
  CHECK(open({{"as_published", "on"}}) ==
        Approx((1.0 - disc(1.0) / printed) * (1.0 - disc(1.2) / printed)).epsilon(1e-4));
  CHECK(open({{"combine", "product"}}) ==
        Approx((1.0 - disc(1.0) / ours) * (1.0 - disc(1.2) / ours)).epsilon(1e-4));
}

TEST_CASE(
    "light and place at the corners of a triangle are interpolated by barycentric coordinates, on the side "
    "seen, and Eq. 10 is evaluated in each pixel, as printed with its squared distance") {
  const std::vector<glm::vec3> corners{{-1, 0, 0.5f}, {1.2f, 0, 0.3f}, {0.1f, 0, -1}};
  for (const float height : {1.2f, -1.2f})
    for (const bool published : {false, true}) {
      const SceneBuilder builder = oneTriangle(corners, height);
      Shown shown(builder.scene);
      const glm::vec3 origin(shown.snapshot.origin);
      // A point of each side at each corner, with a light of its own.
      std::vector<SparsePoint> places;
      std::vector<glm::vec4> diffuse, glossy, diffusePlace, glossyPlace;
      for (const float side : {1.0f, -1.0f})
        for (std::size_t i = 0; i < 3; ++i) {
          places.push_back({corners[i] - origin, {0, side, 0}, 0.01f, 0.1f, 10.0f});
          const float light = 1.0f + 2.0f * static_cast<float>(i) + (side > 0.0f ? 0.0f : 10.0f);
          diffuse.emplace_back(light, 0.5f * light, 3.0f, 1.0f);
          glossy.emplace_back(3.0f, light, 0.5f * light, 11.0f);
          diffusePlace.emplace_back(
              places.back().position + glm::vec3(0.3f * static_cast<float>(i), side, 0.2f), 1);
          glossyPlace.emplace_back(places.back().position + glm::vec3(-0.4f, 0.5f * side, -0.9f), 1);
        }
      SurfacePoints points = pointsOf(places, 0.1f, 1);
      auto set = std::make_shared<SurfacePointSet>();
      for (std::uint32_t i = 0; i < 6; ++i) {
        SurfacePoint point;
        point.place = {0, i % 3 == 1 ? 1.0f : 0.0f, i % 3 == 2 ? 1.0f : 0.0f};
        // The first three are above; fronts are where the normals of the mesh are.
        point.back = (builder.scene.normals.front().y > 0.0f) != (i < 3);
        point.area = 0.01f, point.radius = 0.1f, point.reach = 0.1f;
        set->points.push_back(point);
      }
      set->area = 0.06;
      points.set = set;
      Settings settings = published ? kAsPublished : kAtVertices;
      const auto [diffuseImage, glossyImage] = shown.apply(
          points, {texels(diffuse), texels(diffusePlace), texels(glossy), texels(glossyPlace)}, settings);
      const ImageBuffer positions = imageOf(*shown.gbuffer.position, 4);
      const std::size_t first = height > 0.0f ? 0 : 3;
      const glm::dvec3 normal(0.0, height > 0.0f ? 1.0 : -1.0, 0.0), eye(shown.snapshot.camera.eye);
      const glm::dvec3 a(places[0].position), b(places[1].position), c(places[2].position);
      const glm::dvec3 across = glm::cross(b - a, c - a);
      CAPTURE(height, published);
      int seen = 0, reflected = 0;
      double worst = 0.0;
      for (int y = 0; y < kPixels; ++y)
        for (int x = 0; x < kPixels; ++x) {
          if (positions.at(x, y, 3) == 0.0f) {
            worst = std::max<double>(worst, diffuseImage.at(x, y, 0));
            continue;
          }
          ++seen;
          const glm::dvec3 p(positions.at(x, y, 0), positions.at(x, y, 1), positions.at(x, y, 2));
          const double ofB = glm::dot(glm::cross(p - a, c - a), across) / glm::dot(across, across),
                       ofC = glm::dot(glm::cross(b - a, p - a), across) / glm::dot(across, across);
          const double weights[3] = {1.0 - ofB - ofC, ofB, ofC};
          const auto mixed = [&](const std::vector<glm::vec4>& values) {
            glm::dvec4 sum(0.0);
            for (std::size_t i = 0; i < 3; ++i) sum += weights[i] * glm::dvec4(values[first + i]);
            return sum;
          };
          const auto toward = [&](const std::vector<glm::vec4>& values) {
            return glm::dvec3(mixed(values)) - p;
          };
          const glm::dvec3 path = toward(diffusePlace), glossyPath = toward(glossyPlace);
          const double cosine = std::max(0.0, glm::dot(glm::normalize(path), normal)),
                       mirror = std::max(0.0, glm::dot(glm::reflect(glm::normalize(p - eye), normal),
                                                       glm::normalize(glossyPath)));
          const double diffuseOver = published ? glm::dot(path, path) : 1.0,
                       glossyOver = published ? glm::dot(glossyPath, glossyPath) : 1.0;
          reflected += mirror > 0.8;
          for (int k = 0; k < 3; ++k) {
            const double expected = 0.5 * mixed(diffuse)[k] * cosine / diffuseOver,
                         expectedGlossy = 0.25 * mixed(glossy)[k] * std::pow(mirror, 10.0) / glossyOver;
            worst = std::max({worst, std::abs(diffuseImage.at(x, y, k) - expected) / 10.0,
                              std::abs(glossyImage.at(x, y, k) - expectedGlossy) / 10.0});
          }
        }
      CHECK(seen > 100);
      CHECK(reflected > 20);
      CHECK(worst < 2e-5);
    }
}

TEST_CASE("a corner without a point near it leaves light and place to the other corners") {
  const std::vector<glm::vec3> corners{{-1, 0, 0.5f}, {1.2f, 0, 0.3f}, {0.1f, 0, -1}};
  const SceneBuilder builder = oneTriangle(corners, 1.2);
  Shown shown(builder.scene);
  const bool isFrontAbove = builder.scene.normals.front().y > 0.0f;
  std::vector<SparsePoint> places;
  std::vector<glm::vec4> lights, above;
  auto set = std::make_shared<SurfacePointSet>();
  // On both sides, as on all open surfaces.
  for (const bool back : {false, true})
    for (std::uint32_t i = 0; i < 2; ++i) {
      const float up = back == isFrontAbove ? -1.0f : 1.0f;
      places.push_back({corners[i] - glm::vec3(shown.snapshot.origin), {0, up, 0}});
      lights.emplace_back(2.0f);
      above.emplace_back(places.back().position + glm::vec3(0, up, 0), 1.0f);
      SurfacePoint point;
      point.place = {0, static_cast<float>(i), 0.0f};
      point.back = back;
      point.area = 0.01f, point.radius = 0.1f, point.reach = 0.1f;
      set->points.push_back(point);
    }
  set->area = 0.04;
  SurfacePoints points = pointsOf(places, 0.1f, 1);
  points.set = set;
  const ImageBuffer image = shown.apply(points, diffuseLight(lights, above), kAtVertices).first;
  const ImageBuffer positions = imageOf(*shown.gbuffer.position, 4);
  int seen = 0;
  double worst = 0.0;
  for (int y = 0; y < kPixels; ++y)
    for (int x = 0; x < kPixels; ++x)
      if (positions.at(x, y, 3) != 0.0f) {
        ++seen;
        worst = std::max(worst, std::abs(static_cast<double>(image.at(x, y, 0)) - 0.5 * 2.0));
      }
  CHECK(seen > 100);
  CHECK(worst < 1e-4);
}

TEST_CASE(
    "one light of each model is at vertices what it is at pixels: hidden surfaces, turned, deformed, mirrored, cut "
    "away by masks") {
  const auto check = [](const Scene& scene, double time) {
    Shown shown(scene, time);
    const SurfacePoints points = shown.points(256);
    const auto count = static_cast<std::size_t>(points.count);
    const std::vector<glm::vec4> normals = valuesOf(points.normal, count);
    std::vector<glm::vec4> lights, places(count, glm::vec4(0.3f, 40.0f, 30.0f, 1.0f));
    for (const glm::vec4& normal : normals)
      lights.emplace_back(1.0f + 2.0f * normal.w, 1.0f, 0.5f * normal.w, 0.0f);
    const SparseLight light = diffuseLight(lights, places);
    const ImageBuffer pixels = shown.apply(points, light, {}).first,
                      vertices = shown.apply(points, light, kAtVertices).first;
    double worst = 0.0;
    int lit = 0;
    for (std::size_t i = 0; i < pixels.values().size(); ++i) {
      worst = std::max(worst, std::abs(static_cast<double>(pixels.values()[i] - vertices.values()[i])));
      lit += vertices.values()[i] > 0.0f;
    }
    CHECK(lit > kPixels * kPixels / 10);
    CHECK(worst < 1e-5);
  };
  SECTION("of what turns before what stands still") {
    check(loadScene(sourceDirectory() / "scenes/spinning_box.scene"), 0.7);
  }
  SECTION("of what deforms") {
    check(loadScene(sourceDirectory() / "scenes/waving_cloth.scene"), 0.3);
  }
  SECTION("of what a placement mirrors") {
    SceneBuilder builder = oneTriangle({{-1, 0, 0.5f}, {1.2f, 0, 0.3f}, {0.1f, 0, -1}}, 1.2);
    place(builder.scene, builder.scene.objects[0], glm::dmat4(glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, 1)));
    check(builder.scene, 0.0);
  }
  SECTION("of a sheet whose left half a mask cuts away") {
    SceneBuilder builder;
    addHalfMaskedSheet(builder);
    builder.light(LightKind::point, glm::vec3(1.0f), {0, 1, 0});
    builder.look({0, 3, 0}, {0, 0, 0}, {0, 0, -1}, 0.7, kPixels, kPixels);
    check(builder.scene, 0.0);
  }
}

TEST_CASE(
    "what points reflect, interpolated at vertices, is published nowhere: the two words exclude each other") {
  const SceneBuilder builder = oneTriangle({{-1, 0, 0.5f}, {1.2f, 0, 0.3f}, {0.1f, 0, -1}}, 1.2);
  Shown shown(builder.scene);
  const SurfacePoints points = shown.points(16);
  const std::vector<glm::vec4> ones(static_cast<std::size_t>(points.count), glm::vec4(1.0f));
  const SparseLight light = diffuseLight(ones, ones);
  CHECK_THROWS_MATCHES(shown.apply(points, light, {{"as_published", "on"}, {"interpolate", "plain"}}), Error,
                       Tells("interpolate averaged", "interpolate plain"));
  CHECK_NOTHROW(shown.apply(points, light, {{"at", "vertices"}, {"interpolate", "plain"}}));
}

TEST_CASE("light at vertices without their points, or with those of other points, is refused") {
  const SceneBuilder builder = oneTriangle({{-1, 0, 0.5f}, {1.2f, 0, 0.3f}, {0.1f, 0, -1}}, 1.2);
  Shown shown(builder.scene);
  const SurfacePoints points = shown.points(16), others = shown.points(8);
  const std::vector<glm::vec4> ones(static_cast<std::size_t>(points.count), glm::vec4(1.0f));
  LonePass pass = shown.lone("apply", kAtVertices);
  pass.in("gbuffer", shown.gbuffer).in("points", points).in("light", diffuseLight(ones, ones));
  CHECK_THROWS_MATCHES(pass.run(), Error, Tells("vertices"));
  CHECK_THROWS_MATCHES(pass.in("vertices", shown.vertices(others)).run(), Error, Tells("other points"));
  CHECK_NOTHROW(pass.in("vertices", shown.vertices(points)).run());
}

TEST_CASE("what vertices refer to is found once, by a pass of its own that light at pixels leaves out") {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.5f));
  builder.quad({-0.5f, 0.25f, 0}, {1, 0, 0}, {0, 1, 0}, builder.lambert(0.4f)).motion =
      RigidMotion{.angularSpeed = 1.0};
  builder.light(LightKind::point, glm::vec3(1.0f), {0, 1, 0.4});
  builder.look({0, 0.5, 3}, {0, 0.4, 0}, {0, 1, 0}, 0.7, 16, 16);
  const Pipeline committed = pipeline("virtual_area_lights");
  RenderOptions options = sized(16, 16);
  options.parameters = committed.settings({"points=64", "lights=64"});
  {
    PipelineExecutor pixels(device(), techniques(), builder.scene, committed, options);
    const FrameResult frame = pixels.render(0.0, 0);
    CHECK(ran(frame, "apply"));
    CHECK_FALSE(ran(frame, "vertices"));
  }
  options.parameters = committed.settings({"points=64", "lights=64", "as_published=on"});
  PipelineExecutor vertices(device(), techniques(), builder.scene, committed, options);
  vertices.keepOutput("vertices", "vertices");
  const auto buffer = [&] {
    return kept<virtual_area_lights::VertexPoints>(vertices, "vertices", "vertices").any;
  };
  CHECK(ran(vertices.render(0.0, 0), "vertices"));
  const gpu::BufferRef found = buffer();
  vertices.render(0.5, 1);  // what moved still refers to the same points
  CHECK(buffer() == found);
}

TEST_CASE("vertices that belong to no object change nothing of the light at vertices") {
  const Scene scene = litRoom(kPixels, kPixels);
  // As a mesh leaves them whose parts the scene leaves out.
  Scene gaps = scene;
  constexpr std::uint32_t kUnused = 7;
  gaps.positions.insert(gaps.positions.begin(), kUnused, glm::vec3(0.5f));
  gaps.normals.insert(gaps.normals.begin(), kUnused, glm::vec3(0, 1, 0));
  gaps.texcoords.insert(gaps.texcoords.begin(), kUnused, glm::vec2(0.0f));
  for (std::uint32_t& index : gaps.indices) index += kUnused;
  for (Object& object : gaps.objects) object.firstVertex += kUnused;
  const Pipeline text = pipeline("virtual_area_lights/virtual_area_lights_as_published");
  const std::vector<std::string> settings{"points=64", "map=16"};
  const FrameResult expected = rendered(scene, text, settings), found = rendered(gaps, text, settings);
  for (const char* output : {"indirect_diffuse", "indirect_glossy"})
    CHECK(found.outputs.at(output).values() == expected.outputs.at(output).values());
}

TEST_CASE(
    "'as_published' in every pass is the same image as the printed words set one by one, and as its pipeline") {
  Scene scene = litRoom(kPixels, kPixels);
  const auto shown = [&](const std::string& choose, const std::string& gather, const std::string& occlude,
                         const std::string& apply, const std::string& normalise) {
    const std::string text = fmt::format(R"(pipeline "published" {{
      pass gbuffer direct_lighting.gbuffer {{ }}
      pass points virtual_area_lights.points {{ points 64 }}
      pass vertices virtual_area_lights.vertices {{ points points.points }}
      pass map reflective_shadow_maps.render {{ size 8  lobes none }}
      pass choose reflective_shadow_maps.choose {{ map map.map  lights 64  {} }}
      pass gather virtual_area_lights.gather {{ points points.points  lights choose.lights  {} }}
      pass normalise virtual_area_lights.normalise {{ points points.points  light gather.light  {} }}
      pass occlude virtual_area_lights.occlude {{ points points.points  light normalise.light  {} }}
      pass apply virtual_area_lights.apply {{ gbuffer gbuffer  points points.points  light occlude.light  vertices vertices.vertices  {} }}
      output indirect_diffuse apply.diffuse
      output indirect_glossy apply.glossy
    }})",
                                         choose, gather, normalise, occlude, apply);
    return renderOnce(scene, Pipeline::parse(text, "published.pipeline")).outputs;
  };
  const std::string on = "as_published on";
  const auto published = shown(on, on, on, on, on), ours = shown("", "", "", "", "");
  const auto words = shown("method stride  area facing", on + "  method cached  exponent_limit none",
                           on + "  combine product", on + "  at vertices  interpolate averaged", on);
  RenderOptions options;
  const Pipeline committed = Pipeline::load(
      sourceDirectory() / "scenes/pipelines/virtual_area_lights/virtual_area_lights_as_published.pipeline");
  options.parameters = committed.settings({"points=64", "map=8"});
  const auto pipelined = renderOnce(scene, committed, options).outputs;
  for (const char* output : {"indirect_diffuse", "indirect_glossy"}) {
    CAPTURE(output);
    CHECK(!differ(published.at(output), words.at(output)));
    CHECK(!differ(published.at(output), pipelined.at(output)));
    CHECK(differ(published.at(output), ours.at(output)));
  }
  CHECK(differ(ours.at("indirect_diffuse"), shown(on, "", "", "", "").at("indirect_diffuse")));
  for (const auto& [name, image] : published)
    for (const float value : image.values()) CHECK((std::isfinite(value) && value >= 0.0f));
}

namespace {

/// RMS difference over the mean of the second.
double differenceOf(const ImageBuffer& image, const ImageBuffer& right) {
  return rmsBetween(image, right) / meanOf(right);
}

/// Diffuse light without occlusion, with words added to the passes `normalise` and `apply`.
ImageBuffer diffuseWith(const Scene& scene, int points, const std::string& normalise,
                        const std::string& apply) {
  const Pipeline committed = pipeline("virtual_area_lights");
  std::string text = committed.document->source;
  const auto add = [&](const std::string& line, const std::string& words) {
    REQUIRE(text.find(line) != std::string::npos);
    text.replace(text.find(line), line.size() + std::string("    as_published $as_published\n").size(),
                 line + words);
  };
  add("    light gather.light\n", normalise);
  add("    light occlude.light\n    vertices vertices.vertices\n", apply);
  return pictured(scene, {64, 64}, Pipeline::parse(text, committed.file),
                  {"points=" + std::to_string(points), "occlusion=off", "lights=256"})
      .outputs.at("indirect_diffuse");
}

/// Light at vertices against that at pixels.
double ofVertices(const Scene& scene, int points) {
  return differenceOf(diffuseWith(scene, points, "", "    at vertices\n"),
                      diffuseWith(scene, points, "", ""));
}

Scene finer(Scene scene, int times) {
  for (int i = 0; i < times; ++i) scene = subdivided(scene);
  return scene;
}

}  // namespace

TEST_CASE(
    "light at vertices loses what a mesh coarser than the points cannot hold, and no more on a finer one") {
  const Scene cornell = loadScene(sourceDirectory() / "scenes/cornell.scene");
  const double coarse = ofVertices(cornell, 512), fine = ofVertices(finer(cornell, 4), 512);
  CAPTURE(coarse, fine);
  CHECK(coarse > 0.3);
  CHECK(fine < 0.05);
}

TEST_CASE("table: light at vertices against light at pixels, by triangles", "[.]") {
  KeptTable table("virtual_area_lights.vertices", {{"difference over the mean", 3, 0.005, 0.02}});
  const Scene cornell = loadScene(sourceDirectory() / "scenes/cornell.scene");
  for (int times = 0; times <= 5; ++times) {
    const Scene scene = finer(cornell, times);
    for (const int points : {512, 2048, 8192}) {
      const double difference = ofVertices(scene, points);
      table.row("cornell, " + std::to_string(scene.indices.size() / 3) + " triangles, " +
                    std::to_string(points) + " points",
                {difference});
      CAPTURE(times, points, difference);
      if (times == 0) CHECK(difference > 0.4);  // 38 triangles interpolate over whole walls
      if (times >= 3) CHECK(difference < 0.1);
    }
  }
}

TEST_CASE("table: the squared distance of Eq. 10 and 11 as printed, against every light at every pixel",
          "[.]") {
  const std::string on = "    as_published on\n";
  KeptTable table("virtual_area_lights.squared_distance",
                  {{"without the distance", 3, 0.005, 0.02}, {"with it", 3, 0.005, 0.02}});
  const Scene scene = finer(loadScene(sourceDirectory() / "scenes/cornell.scene"), 5);
  const Pipeline all = Pipeline::load(
      sourceDirectory() / "scenes/pipelines/virtual_area_lights/virtual_area_lights_brute_force.pipeline");
  const ImageBuffer right = pictured(scene, {64, 64}, all, {"lights=256"}).outputs.at("indirect_diffuse");
  double before = 1.0;
  for (const int points : {256, 1024, 4096}) {
    const double ours = differenceOf(diffuseWith(scene, points, "", "    at vertices\n"), right),
                 printed = differenceOf(diffuseWith(scene, points, on, on), right);
    table.row(std::to_string(points) + " points", {ours, printed});
    CHECK(ours < before);
    CHECK(printed < 0.4);
    before = ours;
  }
}

TEST_CASE("table: light at the vertices of large models against that at pixels, on the models alone", "[.]") {
  KeptTable table("virtual_area_lights.vertices_of_models", {{"difference over the mean", 3, 0.005, 0.02}});
  for (const auto& [name, albedo] : {std::pair("bunny", 0.72f), std::pair("dragon", 0.35f)}) {
    const Scene scene = loadScene(sourceDirectory() / ("scenes/" + std::string(name) + ".scene"));
    LonePass seen("direct_lighting.gbuffer", scene, {}, snapshotOf(scene, 0.0, {}, 64, 64));
    const ImageBuffer albedos = imageOf(*seen.out<GBuffer>("gbuffer").diffuse);
    for (const int points : {512, 2048, 8192}) {
      ImageBuffer vertices = diffuseWith(scene, points, "", "    at vertices\n"),
                  pixels = diffuseWith(scene, points, "", "");
      std::vector<float> ofModel[2];
      for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x)
          for (int c = 0; c < 3; ++c)
            if (std::abs(albedos.at(x, y, 0) - albedo) < 1e-4f) {
              ofModel[0].push_back(vertices.at(x, y, c));
              ofModel[1].push_back(pixels.at(x, y, c));
            }
      double squares = 0.0, sum = 0.0;
      for (std::size_t i = 0; i < ofModel[0].size(); ++i) {
        squares += std::pow(static_cast<double>(ofModel[0][i] - ofModel[1][i]), 2.0);
        sum += static_cast<double>(ofModel[1][i]);
      }
      const auto count = static_cast<double>(ofModel[0].size());
      CHECK(sum > 0.0);
      table.row(std::string(name) + ", " + std::to_string(points) + " points",
                {std::sqrt(squares / count) / (sum / count)});
    }
  }
}
