// Averaged lights of sparse points, pass by pass, over lights and points made by hand.
#include "support/virtual_area_lights.h"

#include <cmath>
#include <random>

using namespace lumivox;
using namespace lumivox::test;

namespace {

float brightness(const glm::vec4& light) {
  return light.x;
}

/// A square of lights of 2 half x 2 half metres at a height, n x n of them, that faces down.
std::vector<DiscLight> ceiling(float half, float height, int n, float exitance = 1.0f) {
  std::vector<DiscLight> lights;
  const float side = 2.0f * half / static_cast<float>(n);
  for (int z = 0; z < n; ++z)
    for (int x = 0; x < n; ++x)
      lights.push_back({{-half + side * (static_cast<float>(x) + 0.5f), height,
                         -half + side * (static_cast<float>(z) + 0.5f)},
                        {0, -1, 0},
                        side * side,
                        glm::vec3(exitance)});
  return lights;
}

std::vector<SparsePoint> randomPoints(int count, float exponent = -1.0f) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(-1.0f, 1.0f);
  std::vector<SparsePoint> points;
  for (int i = 0; i < count; ++i)
    points.push_back({{place(random), 0.0f, place(random)}, {0, 1, 0}, 0.01f, 0.1f, exponent});
  return points;
}

}  // namespace

TEST_CASE(
    "in a closed box of even exitance all of it arrives: E / M is 1 within 1 % two texels from a wall") {
  constexpr int kSide = 32;
  constexpr float kTexel = 2.0f / kSide;
  std::vector<SparsePoint> points;
  // On the floor, from the middle towards a wall; the last ones two texels and half a texel from it.
  for (const float x : {0.0f, 0.5f, 1.0f - 2.0f * kTexel, 1.0f - 0.5f * kTexel})
    points.push_back({{x, -1, 0.5f * kTexel}});
  SparsePasses passes;
  const SparseLight light = passes.gather(pointsOf(points), lightsOf(shiningBox(kSide)));
  const std::vector<glm::vec4> found = valuesOf(light.diffuse, points.size());
  for (std::size_t i = 0; i < 3; ++i) {
    CAPTURE(i);
    CHECK(kPi * brightness(found[i]) == Approx(1.0).margin(0.01));
  }
  CHECK(kPi * brightness(found[3]) == Approx(0.967).margin(0.02));
}

TEST_CASE("a hundredth of a texel above a light at most its exitance arrives, and at the light nothing bad") {
  SparsePasses passes;
  for (const float height : {1e-3f, 1e-6f, 0.0f}) {
    const std::vector<SparsePoint> points{{{0, 0, 0}, {0, 1, 0}, 0.01f, 0.1f, 10.0f}};
    const SurfacePoints made = pointsOf(points);
    const SparseLight light =
        passes.normalise(made, passes.gather(made, lightsOf({{{0, height, 0}, {0, -1, 0}, 0.01f}})));
    for (const gpu::TextureRef& texture : {light.diffuse, light.glossy}) {
      const glm::vec4 found = valuesOf(texture, 1).front();
      CAPTURE(height);
      CHECK(std::isfinite(found.x));
      CHECK(kPi * found.x >= 0.0);
      CHECK(kPi * found.x <= 1.0 + 1e-5);
      if (height == 0.0f) CHECK(found.x == 0.0f);
    }
  }
}

TEST_CASE("the local model gives back at a point what all lights give there, within 1e-5 unless clamped") {
  const std::vector<SparsePoint> points = randomPoints(200, 10.0f);
  const SurfacePoints made = pointsOf(points);
  SparsePasses passes;
  const SparseLight gathered = passes.gather(made, lightsOf(ceiling(0.5f, 0.6f, 16))),
                    normalised = passes.normalise(made, gathered);
  const auto light = valuesOf(gathered.diffuse, points.size()),
             place = valuesOf(gathered.diffusePosition, points.size()),
             found = valuesOf(normalised.diffuse, points.size());
  const auto glossy = valuesOf(gathered.glossy, points.size()),
             glossyPlace = valuesOf(gathered.glossyPosition, points.size()),
             glossyFound = valuesOf(normalised.glossy, points.size());
  int unclamped = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::vec3 toLight = glm::normalize(glm::vec3(place[i]) - points[i].position);
    CHECK(found[i].x * toLight.y == Approx(light[i].x).epsilon(1e-5));
    const glm::vec3 toGlossy = glm::normalize(glm::vec3(glossyPlace[i]) - points[i].position),
                    mirror = glm::reflect(glm::normalize(points[i].position - glm::vec3(0, 1, 0)),
                                          glm::vec3(0, 1, 0));
    const double lobe = std::pow(std::max(0.0f, glm::dot(mirror, toGlossy)), glossy[i].w - 1.0f);
    CHECK(glossyFound[i].x <= std::min(10.0f * glossy[i].x, light[i].w) * 1.00001f);
    if (lobe > 0.1001 && glossy[i].x / lobe < light[i].w) {
      CHECK(glossyFound[i].x * lobe == Approx(glossy[i].x).epsilon(2e-5));
      ++unclamped;
    }
  }
  CHECK(unclamped > 20);
}

TEST_CASE(
    "light that a point cannot be given back is left out, and none is brighter than the brightest light") {
  // Lights to the left and right of the mirror direction, whose mean place is below the wall that reflects
  // them.
  const std::vector<SparsePoint> points{{{0, 0, 0}, {0, 1, 0}, 0.01f, 0.1f, 10.0f}};
  const SurfacePoints made = pointsOf(points);
  SparsePasses passes;
  SparseLight light = diffuseLight({{1, 1, 1, 2}}, {{0, -1, 0, 1}});
  CHECK(valuesOf(passes.normalise(made, light).diffuse, 1).front().x == 0.0f);
  light.diffusePosition = texels({{1, 0.001, 0, 1}});  // cosine 1e-3
  CHECK(valuesOf(passes.normalise(made, light).diffuse, 1).front().x == Approx(2.0));
  // Of coloured light the strongest channel decides, and the hue stays; however near the place is.
  for (const glm::vec3& colour : {glm::vec3(1, 4, 2), glm::vec3(4, 1, 2), glm::vec3(1, 2, 4)}) {
    SparseLight coloured = light;
    coloured.diffuse = texels({{colour.x, colour.y, colour.z, 8}});
    coloured.diffusePosition = texels({{0.1, 0.0001, 0, 1}});
    const glm::vec4 found = valuesOf(passes.normalise(made, coloured).diffuse, 1).front();
    for (int c = 0; c < 3; ++c) CHECK(found[c] == Approx(2.0 * colour[c]));
  }
  light.diffuse = texels({{1, 1, 1, 100}});
  CHECK(valuesOf(passes.normalise(made, light).diffuse, 1).front().x == Approx(10.0));
  CHECK(valuesOf(passes.normalise(made, light, {{"amplification", 4.0}}).diffuse, 1).front().x ==
        Approx(4.0));
  CHECK(valuesOf(passes.normalise(made, light, {{"as_published", "on"}}).diffuse, 1).front().x ==
        Approx(1000.0).epsilon(0.001));
}

TEST_CASE("a plane one metre wide under a light at half a metre is lit within 2 % by 1024 points") {
  std::vector<SparsePoint> points, seen;
  for (int z = 0; z < 32; ++z)
    for (int x = 0; x < 32; ++x)
      points.push_back({{(static_cast<float>(x) + 0.5f) / 32.0f - 0.5f, 0,
                         (static_cast<float>(z) + 0.5f) / 32.0f - 0.5f}});
  for (int i = 0; i < 64; ++i)
    seen.push_back({{static_cast<float>(i % 8) / 9.1f - 0.37f, 0, static_cast<float>(i / 8) / 8.7f - 0.39f}});
  const SurfaceLights lights = lightsOf({{{0, 0.5f, 0}, {0, -1, 0}, 0.001f}});
  const SurfacePoints made = pointsOf(points, 1.0f / 32.0f);
  SparsePasses passes;
  const ImageBuffer sparse =
                        passes.apply(made, passes.normalise(made, passes.gather(made, lights)), seen).first,
                    exact = passes.bruteForce(lights, seen).first;
  double squared = 0.0, mean = 0.0;
  for (int i = 0; i < 64; ++i) {
    squared += std::pow(sparse.at(i % 8, i / 8, 0) - exact.at(i % 8, i / 8, 0), 2) / 64.0;
    mean += exact.at(i % 8, i / 8, 0) / 64.0;
  }
  CHECK(std::sqrt(squared) <= 0.02 * mean);
}

TEST_CASE("equal light of all neighbours is interpolated to itself, within 1e-6") {
  const std::vector<SparsePoint> points = randomPoints(50);
  const SurfacePoints made = pointsOf(points);
  const SparseLight light = lightOverhead(std::vector<glm::vec4>(50, glm::vec4(1, 2, 3, 9)));
  std::vector<SparsePoint> seen = randomPoints(64);
  SparsePasses passes;
  const ImageBuffer image = passes.apply(made, light, seen).first;
  for (int i = 0; i < 64; ++i)
    for (int c = 0; c < 3; ++c) CHECK(image.at(i % 8, i / 8, c) == Approx(c + 1.0).epsilon(1e-6));
}

TEST_CASE(
    "where no neighbour counts by its distance normals decide, and where they do not either the nearest") {
  const auto lit = [](int count) {
    std::vector<glm::vec4> values;
    for (int i = 0; i < count; ++i) values.emplace_back(static_cast<float>(i + 1), 0, 0, 1);
    return lightOverhead(values);
  };
  const std::vector<SparsePoint> seen(64, SparsePoint{});
  SparsePasses passes;
  // Eight around what is seen, at one distance; two of them turned away so far that they are of its other
  // side.
  std::vector<SparsePoint> ring;
  for (int i = 0; i < 8; ++i) {
    const double turn = i * kPi / 4.0;
    ring.push_back({{std::cos(turn), 0, std::sin(turn)}, {0, i < 2 ? -1.0f : 1.0f, 0}});
  }
  const SurfacePoints equidistant = pointsOf(ring);
  CHECK(passes.apply(equidistant, lit(8), seen).first.at(0, 0, 0) ==
        Approx((3 + 4 + 5 + 6 + 7 + 8) / 6.0).epsilon(1e-3));
  // At right angles to what is seen: no cosine; the first of them is the nearest.
  const SurfacePoints aside = pointsOf({{{0.5f, 0, 0}, {1, 0, 0}}, {{1, 0, 0}, {1, 0, 0}}});
  CHECK(passes.apply(aside, lit(2), seen).first.at(0, 0, 0) == Approx(1.0));
  // A model of one point, and one without any.
  CHECK(passes.apply(pointsOf({{{0.3f, 0, 0}}}), lit(1), seen).first.at(0, 0, 0) == Approx(1.0));
  SparsePoint other;
  other.model = 3;
  CHECK(passes.apply(pointsOf({other}), lit(1), seen).first.at(0, 0, 0) == 0.0f);
}

TEST_CASE("a map with four times the texels moves the averaged light by less than 1 % of its distance") {
  const std::vector<SparsePoint> points = randomPoints(50, 20.0f);
  const SurfacePoints made = pointsOf(points);
  SparsePasses passes;
  const SparseLight coarse = passes.gather(made, lightsOf(ceiling(0.5f, 0.6f, 16))),
                    fine = passes.gather(made, lightsOf(ceiling(0.5f, 0.6f, 32)));
  const auto one = valuesOf(coarse.diffusePosition, 50), other = valuesOf(fine.diffusePosition, 50);
  for (std::size_t i = 0; i < 50; ++i)
    CHECK(glm::distance(glm::vec3(one[i]), glm::vec3(other[i])) <
          0.01f * glm::distance(glm::vec3(one[i]), points[i].position));
}

TEST_CASE("an even disc of lights is a sphere of its own radius, and one light as wide as itself") {
  std::vector<DiscLight> disc;
  for (const DiscLight& light : ceiling(1.0f, 20.0f, 64))
    if (glm::length(glm::vec2(light.position.x, light.position.z)) < 1.0f) disc.push_back(light);
  const SurfacePoints made = pointsOf({SparsePoint{}});
  SparsePasses passes;
  CHECK(valuesOf(passes.gather(made, lightsOf(disc)).diffusePosition, 1).front().w ==
        Approx(1.0).epsilon(0.01));
  const DiscLight one{{0, 1, 0}, {0, -1, 0}, static_cast<float>(kPi * 0.04)};
  CHECK(valuesOf(passes.gather(made, lightsOf({one})).diffusePosition, 1).front().w ==
        Approx(0.2).epsilon(0.001));
}

TEST_CASE(
    "a lobe is no narrower than points as far apart as they are can show: twice the squared distance over spacing") {
  SparsePasses passes;
  const SurfacePoints made = pointsOf({{{0, 0, 0}, {0, 1, 0}, 0.01f, 0.1f, 1000.0f}}, 0.1f);
  const SurfaceLights light = lightsOf({{{0, 0.5f, 0}, {0, -1, 0}, 1e-4f}});
  const auto exponentBy = [&](const char* limit) {
    return valuesOf(passes.gather(made, light, {{"exponent_limit", limit}}).glossy, 1).front().w - 1.0f;
  };
  CHECK(exponentBy("spacing") == Approx(2.0 * 25.0).epsilon(1e-3));
  CHECK(exponentBy("none") == Approx(1000.0).epsilon(1e-5));
  // Lights that lie upon each other shine together.
  SurfaceLights three = light;
  three.overlapping = 3;
  CHECK(valuesOf(passes.gather(made, three).diffuse, 1).front().w == Approx(3.0 / kPi));
}

TEST_CASE(
    "where nothing arrives the averaged place is the mean of all places, and where something does theirs alone") {
  const std::vector<SparsePoint> points{SparsePoint{}, {{0, 0, 0}, {0, -1, 0}}};
  SparsePasses passes;
  // One light overhead; one far away that faces the other way.
  const std::vector<glm::vec4> places =
      valuesOf(passes
                   .gather(pointsOf(points),
                           lightsOf({{{0, 1, 0}, {0, -1, 0}, 0.01f}, {{100, 1, 0}, {0, 1, 0}, 0.01f}}))
                   .diffusePosition,
               2);
  CHECK(glm::distance(glm::vec3(places[0]), glm::vec3(0, 1, 0)) < 0.05f);
  CHECK(glm::distance(glm::vec3(places[1]), glm::vec3(50, 1, 0)) < 0.01f);
  // Of two that arrive each counts by its form factor: A / (pi d^2 + A) times the squared cosine, here 1/2.
  const float wide = 0.4f, small = 0.1f, both = 2.0f * static_cast<float>(kPi);
  const float x =
      valuesOf(passes
                   .gather(pointsOf(points),
                           lightsOf({{{1, 1, 0}, {0, -1, 0}, wide}, {{-1, 1, 0}, {0, -1, 0}, small}}))
                   .diffusePosition,
               1)
          .front()
          .x;
  const float first = wide / (both + wide), second = small / (both + small);
  CHECK(x == Approx((first - second) / (first + second)).epsilon(1e-3));
}

TEST_CASE(
    "a neighbour counts by one minus its distance over that of the farthest, times the cosine between the normals") {
  // Lights 1, 2 and 5 so far away that all stand overhead.
  const SparseLight light = lightOverhead({{1, 0, 0, 1}, {2, 0, 0, 1}, {5, 0, 0, 1}});
  const std::vector<SparsePoint> seen(64);
  SparsePasses passes;
  const auto leaning = [](float cosine) { return glm::vec3(std::sqrt(1.0f - cosine * cosine), cosine, 0); };
  // Both steep: their weights sum to little, and still no other rule takes over.
  for (const auto& [one, other] : {std::pair(1.0f, 1.0f), {0.9f, 0.5f}, {0.2f, 0.1f}}) {
    const float expected = (0.75f * one * 1.0f + 0.25f * other * 2.0f) / (0.75f * one + 0.25f * other);
    CAPTURE(one, other);
    CHECK(
        passes
            .apply(pointsOf({{{0.1f, 0, 0}, leaning(one)}, {{0, 0, 0.3f}, leaning(other)}, {{-0.4f, 0, 0}}}),
                   light, seen)
            .first.at(0, 0, 0) == Approx(expected).epsilon(1e-5));
  }
}

TEST_CASE("points farther than where all are told of count only where none is nearer") {
  const auto lit = [](const std::vector<SparsePoint>& points) {
    std::vector<glm::vec4> values;
    for (const SparsePoint& point : points) values.emplace_back(point.position.x, 0, 0, 1);
    return lightOverhead(values);
  };
  const std::vector<SparsePoint> near{{{0.1f, 0, 0}}, {{0.2f, 0, 0}}, {{0.3f, 0, 0}}, {{0.4f, 0, 0}}},
      far{{{0.3f, 0, 0}}, {{0.4f, 0, 0}}}, seen(64);
  SparsePasses passes;
  const auto shown = [&](const std::vector<SparsePoint>& points) {
    SurfacePoints made = pointsOf(points);
    made.farthest = 0.25f;
    return passes.apply(made, lit(points), seen).first.at(0, 0, 0);
  };
  CHECK(shown(near) == Approx(0.1));  // the second is the farthest of those that count, and weighs nothing
  CHECK(shown(far) == Approx(0.3));
}

TEST_CASE("lights in chunks and through group memory, and lights of two sources, come to the same sums") {
  const std::vector<SparsePoint> points = randomPoints(100, 30.0f);
  const SurfacePoints made = pointsOf(points);
  std::vector<DiscLight> all = ceiling(0.5f, 0.6f, 20);
  all[7].exitance = glm::vec3(1e6f, 1.0f, 0.0f);
  SparsePasses passes;
  using Member = gpu::TextureRef SparseLight::*;
  const auto same = [](const SparseLight& one, const SparseLight& other) {
    for (const Member member : {&SparseLight::diffuse, &SparseLight::diffusePosition, &SparseLight::glossy,
                                &SparseLight::glossyPosition})
      CHECK(valuesOf(one.*member, 100) == valuesOf(other.*member, 100));
  };
  const SparseLight shared = passes.gather(made, lightsOf(all), {{"method", "shared"}}),
                    cached = passes.gather(made, lightsOf(all), {{"method", "cached"}});
  same(shared, cached);
  // More than a loop of a shader may take, the last one brighter than all.
  std::vector<DiscLight> many(70000, all[3]);
  many.back().exitance = glm::vec3(1e6f);
  same(passes.gather(made, lightsOf(many), {{"method", "shared"}}),
       passes.gather(made, lightsOf(many), {{"method", "cached"}}));
  // Two whole chunks from one source, the rest from the other.
  const SurfaceLights rest = lightsOf({all.begin() + 256, all.end()});
  for (const char* method : {"shared", "cached"})
    same(shared,
         passes.gather(made, lightsOf({all.begin(), all.begin() + 256}), {{"method", method}}, &rest));
}

TEST_CASE(
    "every light at every pixel is what is gathered at points there, both lobes, in any number of portions") {
  std::vector<SparsePoint> points = randomPoints(64, 30.0f);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].position.y = 0.002f * static_cast<float>(i);
    points[i].normal = glm::normalize(glm::vec3(0.3f * points[i].position.z, 1, 0.3f * points[i].position.x));
    points[i].exponent = static_cast<float>(i % 4) * 10.0f;
  }
  const SurfacePoints made = pointsOf(points);
  SparsePasses passes({0.2, 0.4, 0.1});
  const std::vector<DiscLight> lights = ceiling(0.5f, 0.3f, 20);
  const SparseLight all = passes.gather(made, lightsOf(lights), {{"exponent_limit", "none"}});
  const auto [diffuse, glossy] = passes.bruteForce(lightsOf(lights), points);
  const std::vector<glm::vec4> asPoints = valuesOf(all.diffuse, 64), asShiny = valuesOf(all.glossy, 64);
  int lit = 0;
  for (int i = 0; i < 64; ++i) {
    const auto n = static_cast<std::size_t>(i);
    CAPTURE(i);
    CHECK(diffuse.at(i % 8, i / 8, 0) == Approx(asPoints[n].x).epsilon(1e-5));
    CHECK(glossy.at(i % 8, i / 8, 0) == Approx(asShiny[n].x).epsilon(1e-5));
    lit += asShiny[n].x > 0.0f ? 1 : 0;
  }
  CHECK(lit > 20);
  // One light, so often that a dispatch cannot take all of them.
  const std::vector<DiscLight> one(61000, {{0, 1, 0}, {0, -1, 0}, 0.01f});
  const ImageBuffer many = passes.bruteForce(lightsOf(one), points).first,
                    single = passes.bruteForce(lightsOf({one.front()}), points).first;
  for (int i = 0; i < 64; ++i)
    CHECK(many.at(i % 8, i / 8, 0) == Approx(61000.0 * single.at(i % 8, i / 8, 0)).epsilon(1e-4));
}

TEST_CASE(
    "a pixel takes a glossy light by its own normal, place and view: the light times cos^k of the angle to the mirror") {
  // Light of exponent 7 at a place near the floor; what is seen lies beside the only point, near the camera
  // too.
  const glm::vec3 place(0.3f, 0.2f, -0.1f), eye(0.05f, 0.2f, 0.1f);
  SparsePasses passes(eye);
  SparsePoint point{{0, 0, 0}, {0, 1, 0}, 0.01f, 0.1f, 7.0f};
  const SparseLight light{nullptr, nullptr, texels({{2, 3, 4, 8}}), texels({{place.x, place.y, place.z, 1}})};
  SparseLight both = light;
  both.diffuse = texels({{2, 3, 4, 1}});
  both.diffusePosition = light.glossyPosition;
  std::vector<SparsePoint> seen = randomPoints(64, 7.0f);
  for (SparsePoint& one : seen) {
    one.normal = glm::normalize(glm::vec3(0.4f + one.position.z, 1, 0.6f * one.position.x));
    one.position = point.position;
  }
  const auto [diffuse, glossy] = passes.apply(pointsOf({point}), both, seen);
  int lit = 0;
  for (std::size_t i = 0; i < 64; ++i) {
    const glm::vec3 toLight = glm::normalize(place - seen[i].position),
                    mirror = glm::reflect(glm::normalize(seen[i].position - eye), seen[i].normal);
    const float cosine = std::max(0.0f, glm::dot(mirror, toLight)),
                expected = glm::dot(toLight, seen[i].normal) > 0.0f ? 3.0f * std::pow(cosine, 7.0f) : 0.0f;
    const int x = static_cast<int>(i) % 8, y = static_cast<int>(i) / 8;
    CAPTURE(i);
    CHECK(glossy.at(x, y, 1) == Approx(expected).epsilon(1e-4).margin(1e-6));
    CHECK(diffuse.at(x, y, 1) ==
          Approx(3.0f * std::max(0.0f, glm::dot(toLight, seen[i].normal))).epsilon(1e-4).margin(1e-6));
    lit += expected > 0.01f ? 1 : 0;
  }
  CHECK(lit > 20);
  // Without a lobe all in front of the mirror's plane counts in full, and a wide one widely.
  for (const float exponent : {0.0f, 0.2f}) {
    both.glossy = texels({{2, 3, 4, 1.0f + exponent}});
    const glm::vec3 mirror = glm::reflect(glm::normalize(-eye), seen[5].normal);
    const float cosine = glm::dot(mirror, glm::normalize(place));
    REQUIRE(cosine > 0.0f);
    CHECK(passes.apply(pointsOf({point}), both, seen).second.at(5, 0, 2) ==
          Approx(4.0 * std::pow(cosine, exponent)).epsilon(1e-4));
  }
  // Points of another exponent, and those that reflect nothing, leave it dark.
  point.exponent = 6.0f;
  CHECK(passes.apply(pointsOf({point}), both, seen).second.at(3, 3, 1) == 0.0f);
  point.exponent = -1.0f;
  for (SparsePoint& one : seen) one.exponent = 0.0f;
  const ImageBuffer dark = passes.apply(pointsOf({point}), both, seen).second;
  for (const float value : dark.values()) CHECK((value == 0.0f || value == 1.0f));  // alpha
}

TEST_CASE("no light gives none, and light of 10^6 : 1 or in a point's plane stays finite and not negative") {
  const std::vector<SparsePoint> points{{{0, 0, 0}, {0, 1, 0}, 0.01f, 0.1f, 0.0f},
                                        {{0.1f, 0, 0}, {0, 1, 0}, 0.01f, 0.1f, 1.0f},
                                        {{0.2f, 0, 0}, {0, 1, 0}, 0.01f, 0.1f, 1e5f},
                                        {{0.3f, 0, 0}, {0, 0, 0}, 0.0f, 0.0f, 10.0f}};
  const SurfacePoints made = pointsOf(points);
  SparsePasses passes;
  const std::vector<std::vector<DiscLight>> cases{
      {},
      {{{1, 0, 0}, {0, -1, 0}, 0.01f}},
      {{{0, 1, 0}, {0, -1, 0}, 0.01f, glm::vec3(1e6f)}, {{0.5f, 1, 0}, {0, -1, 0}, 0.01f}},
      {{{0, 1e-6f, 0}, {0, -1, 0}, 0.01f}},
      {{{0, 1, 0}, {0, -1, 0}, 0.0f, glm::vec3(0.0f)}}};
  for (const std::vector<DiscLight>& lights : cases) {
    const SparseLight light =
        passes.occlude(made, passes.normalise(made, passes.gather(made, lightsOf(lights))));
    const auto [diffuse, glossy] = passes.apply(made, light, {points[0], points[1], points[2]});
    float brightest = 0.0f;
    for (const DiscLight& one : lights)
      brightest = std::max(brightest, one.exitance.x / static_cast<float>(kPi));
    for (const ImageBuffer& image : {diffuse, glossy})
      for (const float value : image.values()) {
        CHECK(std::isfinite(value));
        CHECK(value >= 0.0f);
        CHECK(value <= brightest * 1.0001f);
      }
  }
}
