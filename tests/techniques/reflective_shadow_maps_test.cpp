#include "support/reflective_shadow_maps.h"

#include <cmath>
#include <optional>

#include "lumivox/measure/metrics.h"
#include "lumivox/toolkit/light_samples.h"
#include "support/against_reference.h"

using namespace lumivox;
using namespace lumivox::test;

TEST_CASE("the texels of a plane under a directional light sum to its area and to albedo E cos A") {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.6f));
  for (const glm::dvec3& direction : {glm::dvec3(0, -1, 0), glm::dvec3(1, -1, 0.5)}) {
    builder.scene.lights.clear();
    builder.light(LightKind::directional, glm::vec3(3.0f), {}, direction);
    const Map map = render(builder.scene, 512);
    const double cosine = -glm::normalize(direction).y;
    CHECK(map.area == Approx(4.0).epsilon(0.01));
    CHECK(map.flux == Approx(0.6 * 3.0 * cosine * 4.0).epsilon(0.01));
  }
}

TEST_CASE("in a closed box all light of a point light is reflected: the texels sum to 4 pi I albedo") {
  SceneBuilder builder = closedBox(0.5f);
  builder.light(LightKind::point, glm::vec3(2.0f), {0.3, -0.2, 0.1});
  const Map map = render(builder.scene, 128);
  CHECK(map.flux == Approx(4.0 * kPi * 2.0 * 0.5).epsilon(0.002));
  CHECK(map.area == Approx(24.0).epsilon(0.01));  // six sides of 2 m x 2 m
}

TEST_CASE("a spot light's texels sum to 2 pi I albedo times the mean of its smoothstep over the cone") {
  // smoothstep is odd about its middle, so that the integral over the cosine is (1 - ci) + (ci - co) / 2.
  SceneBuilder builder = closedBox(0.5f);
  Light& spot = builder.light(LightKind::spot, glm::vec3(2.0f), {0, 0.5, 0}, {0.2, -1, 0.1});
  spot.innerAngle = 0.4f;
  spot.outerAngle = 0.7f;
  const double inner = std::cos(0.4), outer = std::cos(0.7);
  const double expected = 2.0 * kPi * 2.0 * 0.5 * ((1.0 - inner) + 0.5 * (inner - outer));
  CHECK(render(builder.scene, 256).flux == Approx(expected).epsilon(0.005));
}

TEST_CASE("an area light's texels sum to pi L A albedo in a closed box") {
  SceneBuilder builder = closedBox(0.5f);
  builder.quad({-0.1f, 0.5f, -0.1f}, {0.2f, 0, 0}, {0, 0, 0.2f}, builder.lambert(0.0f, 10.0f));
  CHECK(render(builder.scene, 64).flux == Approx(kPi * 10.0 * 0.04 * 0.5).epsilon(0.02));
}

TEST_CASE("several lights add up texel by texel") {
  SceneBuilder builder = closedBox(0.5f);
  builder.light(LightKind::point, glm::vec3(2.0f), {0.3, -0.2, 0.1});
  const double one = render(builder.scene, 64).flux;
  builder.scene.lights.clear();
  builder.light(LightKind::spot, glm::vec3(5.0f), {0, 0, 0}).outerAngle = 0.6f;
  const double other = render(builder.scene, 64).flux;
  builder.light(LightKind::point, glm::vec3(2.0f), {0.3, -0.2, 0.1});
  CHECK(render(builder.scene, 64).flux == Approx(one + other).epsilon(1e-4));
}

TEST_CASE("a texel lights a surface on its axis as a disc of its area does") {
  // Lambert: a disc of radius r and exitance M seen from its axis at distance d gives M r^2 / (d^2 + r^2);
  // with A = pi r^2 and flux F = M A that is F / (pi d^2 + A).
  for (const double area : {1e-4, 0.5, 4.0}) {
    const ReflectiveShadowMap map =
        mapOf({{{0, 1, 0, 1}, {0, -1, 0, static_cast<float>(area)}, {3, 3, 3, 0}}});
    for (const char* method : {"all", "flux"})
      CHECK(irradianceAt({}, map, method, 1).x == Approx(3.0 / (kPi + area)).epsilon(1e-4));
  }
}

TEST_CASE("a texel in the very point of a surface lights nothing there") {
  for (const float area : {0.0f, 0.5f})
    for (const char* method : {"all", "flux"})
      CHECK(irradianceAt({}, mapOf({{{0, 0, 0, 1}, {0, -1, 0, area}, {3, 3, 3, 0}}}), method, 1) ==
            glm::vec3(0.0f));
}

TEST_CASE("coloured texels are chosen by their luminance, Rec. 709, and carry the luminance of all of them") {
  // Of two texels one sample takes the one that holds more than half, here by a tenth either way.
  const glm::dvec3 weights(0.2126, 0.7152, 0.0722);
  for (const glm::ivec2 colours : {glm::ivec2(0, 1), {1, 2}, {2, 0}})
    for (const bool firstIsMore : {true, false}) {
      std::vector<Texel> texels(2, {{0, 1, 0, 1}, {0, -1, 0, 0}, {0, 0, 0, 0}});
      const double luminances[2] = {firstIsMore ? 1.1 : 1.0, firstIsMore ? 1.0 : 1.1};
      for (int i = 0; i < 2; ++i)
        texels[static_cast<std::size_t>(i)].flux[colours[i]] =
            static_cast<float>(luminances[i] / weights[colours[i]]);
      const glm::vec3 found = irradianceAt({}, mapOf(texels), "flux", 1);
      const int taken = firstIsMore ? 0 : 1;
      CAPTURE(colours[taken], firstIsMore);
      // A metre away the irradiance is the flux over pi.
      CHECK(found[colours[taken]] * kPi == Approx(2.1 / weights[colours[taken]]).epsilon(1e-4));
      CHECK(found[colours[1 - taken]] == 0.0f);
    }
}

TEST_CASE(
    "a map marks the texels that see a surface with 1, tells whose light they reflect, and leaves the others empty") {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.6f));
  for (int i = 0; i < 2; ++i) builder.light(LightKind::directional, glm::vec3(3.0f), {}, {0, -1, 0});
  const Map map = render(builder.scene, 64);
  const std::vector<float> position = map.value.position->downloadFloats(0),
                           flux = map.value.flux->downloadFloats(0),
                           normal = map.value.normal->downloadFloats(0);
  REQUIRE(position.size() == 2u * 64u * 64u * 4u);
  int hits = 0;
  for (std::size_t i = 0; i < position.size(); i += 4) {
    const bool hit = position[i + 3] != 0.0f;
    CHECK(position[i + 3] == (hit ? 1.0f : 0.0f));
    CHECK(flux[i + 3] == (hit && i >= position.size() / 2 ? 1.0f : 0.0f));
    CHECK((flux[i] > 0.0f) == hit);
    CHECK((normal[i + 3] > 0.0f) == hit);
    hits += hit;
  }
  // The view is a square around the ball around the plane, 1.01 sqrt 2 m to either side.
  CHECK(hits == Approx(2 * 64 * 64 / std::pow(1.01 * std::sqrt(2.0), 2)).epsilon(0.05));
}

TEST_CASE("the pattern lies where the light sees the surface point: texels elsewhere have no part in it") {
  // As below all texels are given one place a metre above the surface, and as flux their size; but only those
  // which see the floor within 0.3 m of the point, so that the sum keeps what the pattern covers.
  constexpr int kSide = 128;
  constexpr float kReach = 0.02f;
  const glm::vec3 point(0.65f, 0.0f, 0.4f);
  for (const LightKind kind : {LightKind::directional, LightKind::spot, LightKind::point}) {
    SceneBuilder builder;
    builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.5f));
    builder.look({0, 2, 0.9}, {0, 0, 0}, {0, 1, 0}, 0.7, 8, 8);
    Light& light = builder.light(kind, glm::vec3(1.0f), {0.2, 1.6, -0.1}, {0, -1, 0});
    if (kind == LightKind::spot) light.innerAngle = light.outerAngle = 0.6f;
    ReflectiveShadowMap map = render(builder.scene, kSide).value;
    const double texel = map.lights->downloadValues<LightSampleData>().front().texelWidth,
                 width = texel * kSide;
    const std::vector<float> seen = map.position->downloadFloats(0);
    const gpu::TextureDescription description = map.flux->description();
    map.position = filled(description, glm::vec4(point + glm::vec3(0, 1, 0), 1));
    map.normal = filled(description, {0, -1, 0, 0});
    for (const bool published : {false, true}) {
      const bool inView = published && kind == LightKind::spot;
      std::vector<float> sizes;
      for (int i = 0; i < kSide * kSide * map.layerCount; ++i) {
        const float* place = seen.data() + 4 * static_cast<std::size_t>(i);
        const double u = (i % kSide + 0.5) * texel - 0.5 * width,
                     v = (i / kSide % kSide + 0.5) * texel - 0.5 * width;
        double size = texel * texel / std::pow(1.0 + u * u + v * v, 1.5);
        if (kind == LightKind::directional) size = texel * texel;
        if (inView) size = 1.0;
        if (place[3] == 0.0f || glm::length(glm::vec3(place[0], place[1], place[2]) - point) > 0.3f)
          size = 0.0;
        sizes.insert(sizes.end(), {float(size), float(size), float(size), 0.0f});
      }
      map.flux = textureOf(description, sizes);
      double expected = 2.0 * kPi * (1.0 - std::cos(kReach * kPi));
      if (kind == LightKind::directional) expected = kPi * std::pow(kReach * width, 2);
      if (inView) expected = kPi * std::pow(kReach * kSide, 2);
      const double found =
          kPi * irradianceAt(point, map, "projected", 1000,
                             {{"weights", published ? "published" : "exact"}, {"reach", kReach}},
                             &builder.scene)
                    .x;
      CAPTURE(static_cast<int>(kind), published, found / expected);
      CHECK(found == Approx(expected).epsilon(0.03));
    }
  }
}

TEST_CASE(
    "as published a point has a part in a spot light's view from its very front on, and none behind the light") {
  constexpr int kSide = 64;
  constexpr float kReach = 0.25f;
  SceneBuilder builder = closedBox(0.5f);
  builder.look({0, 0, 0.9}, {0, 0, 0}, {0, 1, 0}, 0.7, 8, 8);
  Light& light = builder.light(LightKind::spot, glm::vec3(1.0f), {0, 0.6, 0}, {0, -1, 0});
  light.innerAngle = light.outerAngle = 0.6f;
  for (const float ahead : {-0.1f, 0.1f, 0.3f}) {
    // On the axis all of the pattern lies in the view; every texel has a flux of 1 W, a metre above the
    // point.
    const glm::vec3 point(0, 0.6f - ahead, 0);
    ReflectiveShadowMap map = render(builder.scene, kSide).value;
    map.position->clear(glm::vec4(point + glm::vec3(0, 1, 0), 1));
    map.normal->clear({0, -1, 0, 0});
    map.flux->clear({1, 1, 1, 0});
    const double found = kPi * irradianceAt(point, map, "projected", 100,
                                            {{"weights", "published"}, {"reach", kReach}}, &builder.scene)
                                   .x;
    CAPTURE(ahead);
    CHECK(found == Approx(ahead > 0.0f ? kPi * std::pow(kReach * kSide, 2) : 0.0).epsilon(1e-3));
  }
}

TEST_CASE(
    "the pattern around the projection stands for the view, the disc or the cap of the sphere that it covers, by its density and as published") {
  // All texels are given one place a metre above the surface, facing it, so that the irradiance is their flux
  // over pi, whichever of them are taken. Their flux is the size of a texel, on the plane or on the sphere,
  // so that the sum is the size of what the pattern stands for.
  constexpr int kSide = 128;
  // As published the weights are xi1^2, of which a square view of half its pattern's radius, seen from its
  // middle, holds the mean of rho^3 over the angle, rho = 1/2 sec: (sqrt 2 + ln(1 + sqrt 2)) / (4 pi).
  const double insideView = (std::sqrt(2.0) + std::log(1.0 + std::sqrt(2.0))) / (4.0 * kPi);
  struct Kind {
    const char* name;
    std::optional<LightKind> kind;  ///< none: emissive triangles
  };
  for (const Kind& kind : {Kind{"directional", LightKind::directional},
                           {"spot", LightKind::spot},
                           {"point", LightKind::point},
                           {"area", std::nullopt}}) {
    SceneBuilder builder = closedBox(0.5f);
    builder.look({0, 0, 0.9}, {0, 0, 0}, {0, 1, 0}, 0.7, 8, 8);
    if (!kind.kind) {
      builder.quad({-0.1f, 0.6f, -0.1f}, {0.2f, 0, 0}, {0, 0, 0.2f}, builder.lambert(0.0f, 10.0f));
    } else {
      Light& light = builder.light(*kind.kind, glm::vec3(1.0f), {0, 0.6, 0}, {0, -1, 0});
      if (kind.kind == LightKind::spot) light.innerAngle = light.outerAngle = 0.6f;
    }
    ReflectiveShadowMap map = LonePass("reflective_shadow_maps.render", builder.scene,
                                       {{"size", kSide}, {"area_size", kSide}, {"area_samples", 1}})
                                  .out<ReflectiveShadowMap>("map");
    REQUIRE(map.lightCount == 1);
    const double texel = map.lights->downloadValues<LightSampleData>().front().texelWidth;
    const double width = texel * kSide;  // of the view: m, or on the plane one metre away
    const gpu::TextureDescription description = map.flux->description();
    map.position = filled(description, {0, 1, 0, 1});
    map.normal = filled(description, {0, -1, 0, 0});
    for (const bool published : {false, true}) {
      const bool inView = published && kind.kind == LightKind::spot;
      std::vector<float> sizes;
      for (int i = 0; i < kSide * kSide * map.layerCount; ++i) {
        const double u = (i % kSide + 0.5) * texel - 0.5 * width,
                     v = (i / kSide % kSide + 0.5) * texel - 0.5 * width;
        const double size = kind.kind == LightKind::directional ? texel * texel
                            : inView                            ? 1.0
                                     : texel * texel / std::pow(1.0 + u * u + v * v, 1.5);
        sizes.insert(sizes.end(), {float(size), float(size), float(size), 0.0f});
      }
      map.flux = textureOf(description, sizes);
      for (const float reach : {0.125f, 0.25f, 1.0f}) {
        const double side = inView ? kSide : width, tangent = 0.5 * width,
                     disc = kPi * std::pow(reach * side, 2);
        double expected = 2.0 * kPi * (1.0 - std::cos(reach * kPi));
        if (kind.kind == LightKind::directional || inView) {
          expected = disc;
          if (reach == 1.0f) expected = published ? disc * insideView : side * side;
        } else if (kind.kind == LightKind::spot) {
          // A square of the tangent t to either side: 4 asin(t^2 / (1 + t^2)), here wider than the first cap
          // alone.
          if (reach == 0.25f) continue;
          if (reach == 1.0f) expected = 4.0 * std::asin(tangent * tangent / (1.0 + tangent * tangent));
        }
        const double found =
            kPi * irradianceAt({}, map, "projected", 4000,
                               {{"weights", published ? "published" : "exact"}, {"reach", reach}},
                               &builder.scene)
                      .x;
        CAPTURE(kind.name, published, reach, found / expected);
        CHECK(found == Approx(expected).epsilon(0.02));
      }
    }
  }
}

TEST_CASE(
    "texels chosen by flux carry all of it, and the share of it that lies in any part of the map, however dim beside another light") {
  // Texels in the middle of the list face a surface a metre away and the others look aside, so that the
  // irradiance is what of the flux they carry, over pi. Two ends of the part: an error of a sample at either.
  constexpr int kSamples = 2000;
  for (const glm::ivec2 size : {glm::ivec2(1, 1), {5, 1}, {16, 1}, {33, 2}, {64, 6}, {256, 12}})
    for (const bool bright : {false, true}) {
      const int count = size.x * size.x * size.y, from = count * 3 / 10,
                to = std::max(count * 8 / 10, from + 1);
      const gpu::TextureDescription description = layers(size.x, size.x, size.y);
      std::vector<float> fluxes, normals;
      double all = 0.0, facing = 0.0;
      for (int i = 0; i < count; ++i) {
        // A fifth of the rows is black; one texel outside of the part may outshine all others.
        float flux = i / size.x % 5 == 4 ? 0.0f : static_cast<float>(1 + i % 101 * 37 % 101);
        if (bright && i == count / 10) flux = 50.0f * static_cast<float>(count);
        const bool inPart = i >= from && i < to;
        all += flux;
        if (inPart) facing += flux;
        fluxes.insert(fluxes.end(), {flux, flux, flux, 0.0f});
        normals.insert(normals.end(), {0.0f, inPart ? -1.0f : 1.0f, 0.0f, 0.0f});
      }
      ReflectiveShadowMap map;
      map.position = filled(description, {0, 1, 0, 1});
      map.normal = textureOf(description, normals);
      map.flux = textureOf(description, fluxes);
      map.lights = map.views = bufferOf(std::vector<glm::mat4>(1));
      map.lightCount = 1;
      map.layerCount = size.y;
      const auto found = [&](int samples) { return kPi * irradianceAt({}, map, "flux", samples).x; };
      CAPTURE(size.x, size.y, bright, found(kSamples) / all, facing / all);
      CHECK(std::abs(found(kSamples) - facing) <= (2.0 / kSamples + 1e-5) * all);
      // One sample takes the texel in which half of all flux is reached, and stands for all of it.
      if (!bright) CHECK(found(1) == Approx(all).epsilon(1e-5));
    }
}

TEST_CASE("gathering chosen texels converges to gathering all of them, by flux and by projection") {
  const Scene scene = litRoom(16, 16);
  const ReflectiveShadowMap map = render(scene, 32).value;
  const ImageBuffer all = gather(scene, map, "all", 1);
  const auto errorOf = [&](const char* method, int samples) {
    const ImageError error = compare(gather(scene, map, method, samples), all);
    return error.rmse.value / compare(ImageBuffer(16, 16, 3), all).rmse.value;
  };
  for (const char* method : {"flux", "projected"}) {
    const double few = errorOf(method, 160), many = errorOf(method, 40000);
    INFO(method << ": " << few << ", " << many);
    CHECK(many < 0.5 * few);
    CHECK(many < (std::string(method) == "flux" ? 0.05 : 0.1));  // the pattern samples texels unevenly
  }
}

TEST_CASE("reflective shadow maps err on the Cornell box and the arcade by what their card claims") {
  // With 400 samples, here in fewer pixels than there: a tenth above its RMSE, as a share of that of no
  // indirect light, and a twentieth beside its energy are allowed.
  const auto [name, rmse, ratio] =
      GENERATE(table<const char*, double, double>({{"cornell", 0.23, 0.95}, {"arcade", 0.53, 0.87}}));
  const Scene scene = committed(name);
  const Picture picture{64, 36};
  const Against found = lightAgainst(
      referenceOf(scene, picture),
      pictured(scene, picture, pipeline("reflective_shadow_maps"), {}).outputs.at("indirect_diffuse"));
  CAPTURE(name, found.rmse, found.ratio);
  CHECK(found.rmse < 1.1 * rmse);
  CHECK(found.ratio == Approx(ratio).epsilon(0.05));
}
