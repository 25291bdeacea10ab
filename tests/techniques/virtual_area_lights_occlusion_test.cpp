// What hides an averaged light: squares against circles, discs before a ball.
#include <cmath>
#include <random>

#include "support/glsl_functions.h"
#include "support/virtual_area_lights.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// Share of a circle of radius 1 that one of radius r whose middle is off by d covers.
double lensShare(double r, double d) {
  if (d >= 1.0 + r) return 0.0;
  if (d <= std::abs(1.0 - r)) return std::min(1.0, r * r);
  const double a = std::acos((d * d + 1.0 - r * r) / (2.0 * d)),
               b = std::acos((d * d + r * r - 1.0) / (2.0 * d * r));
  return (a - 0.5 * std::sin(2.0 * a) + r * r * (b - 0.5 * std::sin(2.0 * b))) / kPi;
}

/// Mean over directions of what squares say of circles, which may be hidden at any angle about the normal.
struct Shares {
  double squares, bits, circles;
};
std::vector<Shares> sharesOf(double r) {
  std::vector<glm::vec4> inputs;
  std::vector<Shares> shares;
  for (int step = 0; step <= 24; ++step)
    for (int turn = 0; turn < 8; ++turn) {
      const double d = step / 24.0 * (1.0 + r), angle = turn * kPi / 16.0;
      inputs.emplace_back(d * std::cos(angle), d * std::sin(angle), r, 0.0);
      shares.push_back({0.0, 0.0, lensShare(r, d)});
    }
  const std::vector<glm::vec4> found =
      evaluated({"common/constants.glsl", "virtual_area_lights/squares.glsl"}, R"(
        Square light = Square(vec2(0.3, -0.2), sqrt(kPi)), occluder = Square(light.centre + given.xy, sqrt(kPi) * given.z);
        uvec2 bits = coveredBits(light, occluder);
        found = vec4(coveredShare(light, occluder), float(bitCount(bits.x) + bitCount(bits.y)) / 64.0, 0.0, 0.0);)",
                inputs);
  for (std::size_t i = 0; i < found.size(); ++i) shares[i].squares = found[i].x, shares[i].bits = found[i].y;
  return shares;
}

/// A point that looks up at a ball of radius 1 around (0, 4, 0), with discs before it.
SparseLight ball(float radius = 1.0f) {
  return diffuseLight({{1, 1, 1, 1}}, {{0, 4, 0, radius}});
}
/// What occlusion leaves of the light of the first point.
float left(const std::vector<SparsePoint>& points, const SparseLight& light, const char* combine) {
  return valuesOf(SparsePasses().occlude(pointsOf(points), light, {{"combine", combine}}).diffuse, 1)
      .front()
      .x;
}
float open(const std::vector<SparsePoint>& discs, const char* combine = "product", float radius = 1.0f) {
  std::vector<SparsePoint> points{SparsePoint{}};
  points.insert(points.end(), discs.begin(), discs.end());
  return left(points, ball(radius), combine);
}
SparsePoint disc(const glm::vec3& position, float radius) {
  return {position, glm::normalize(-position), 0.01f, radius};
}

}  // namespace

TEST_CASE("squares hide as much as circles do: within 0.05 for equal areas, 0.12 for twice the radius") {
  for (const Shares& share : sharesOf(1.0)) CHECK(share.squares == Approx(share.circles).margin(0.05));
  for (const Shares& share : sharesOf(2.0)) CHECK(share.squares == Approx(share.circles).margin(0.12));
}

TEST_CASE("a concentric square hides exactly the share of areas, and bits the same within 1/8") {
  for (const double r : {0.25, 0.5, 1.0, 2.0}) {
    const Shares share = sharesOf(r).front();
    CAPTURE(r);
    CHECK(share.squares == Approx(std::min(1.0, r * r)).epsilon(1e-5));
    CHECK(share.bits == Approx(std::min(1.0, r * r)).margin(0.125));
  }
}

TEST_CASE("a bit of the light's square is set where its middle lies in the occluder's, row by row") {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  std::vector<glm::vec4> inputs;
  for (int i = 0; i < 200; ++i)
    inputs.emplace_back(6.0f * unit(random), 6.0f * unit(random), 5.0f + 4.9f * unit(random), 0.0f);
  // Two words of two halves; the light is 8 wide, so that its bits are 1 wide.
  const std::vector<glm::vec4> found =
      evaluated({"common/constants.glsl", "virtual_area_lights/squares.glsl"}, R"(
        uvec2 bits = coveredBits(Square(vec2(2.0, -1.0), 8.0), Square(vec2(2.0, -1.0) + given.xy, given.z));
        found = vec4(float(bits.x & 0xffffu), float(bits.x >> 16), float(bits.y & 0xffffu), float(bits.y >> 16));)",
                inputs);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    std::uint64_t expected = 0, bits = 0;
    for (int bit = 0; bit < 64; ++bit) {
      const glm::vec2 middle(static_cast<float>(bit % 8) - 3.5f, static_cast<float>(bit / 8) - 3.5f);
      const glm::vec2 away = glm::abs(middle - glm::vec2(inputs[i]));
      if (std::max(away.x, away.y) < 0.5f * inputs[i].z) expected |= std::uint64_t{1} << bit;
    }
    for (int half = 0; half < 4; ++half) bits |= static_cast<std::uint64_t>(found[i][half]) << (16 * half);
    CAPTURE(inputs[i].x, inputs[i].y, inputs[i].z);
    CHECK(bits == expected);
  }
}

TEST_CASE("bits of a square are those of its share, wherever it lies, within an eighth of its sides") {
  for (const double r : {0.3, 0.7, 1.0, 2.0})
    for (const Shares& share : sharesOf(r)) CHECK(share.bits == Approx(share.squares).margin(0.13));
}

TEST_CASE(
    "a disc before the light hides it by its share of area, one behind it, below or turned away nothing") {
  // On the axis: F of the disc 0.25 / 4.25 r^2 = ..., F of the ball 1 / 16.
  for (const float radius : {0.1f, 0.25f, 0.4f}) {
    const double disc1 = radius * radius / (4.0 + radius * radius), share = std::min(1.0, disc1 * 16.0);
    CHECK(open({disc({0, 2, 0}, radius)}) == Approx(1.0 - share).margin(1e-4));
  }
  CHECK(open({disc({0, 2, 0}, 2.0f)}) == Approx(0.0).margin(1e-4));
  CHECK(open({disc({0, 5, 0}, 2.0f)}) == 1.0f);
  CHECK(open({disc({0, 4, 0}, 2.0f)}) == 1.0f);
  CHECK(open({disc({0, -2, 0}, 2.0f)}) == 1.0f);
  CHECK(open({{{0, 2, 0}, {0, 1, 0}, 0.01f, 2.0f}}) == 1.0f);
  CHECK(open({disc({2, 2, 0}, 0.2f)}) == 1.0f);  // beside it
  // Inside of it less and less: half way from its near side to its middle by half.
  CHECK(open({disc({0, 3.5f, 0}, 4.0f)}) == Approx(0.5).margin(1e-4));
  CHECK(open({disc({0, 3.5f, 0}, 8.0f)}, "product", 2.0f) == Approx(0.75).margin(1e-4));
  // A sphere without extent is hidden from right before it, and the bits of one disc are its share.
  CHECK(open({disc({0, 3.5f, 0}, 4.0f)}, "product", 1e-4f) == Approx(0.0).margin(1e-4));
  for (const float radius : {0.2f, 0.3f, 0.4f})
    CHECK(open({disc({0, 2, 0}, radius)}, "mask") == Approx(open({disc({0, 2, 0}, radius)})).margin(0.13));
  // One that is nearly seen from its edge still hides by its cosine.
  const float edge = open({{{0, 2, 0}, glm::normalize(glm::vec3(1, -0.2f, 0)), 0.01f, 0.4f}});
  const double cosine = 0.2 / std::sqrt(1.04), area = 0.16 * cosine / (4.0 + 0.16);
  CHECK(edge == Approx(1.0 - area * 16.0).margin(1e-4));
}

TEST_CASE(
    "what hides a light does not depend on where all of it lies, nor on who else is lit, and a dark point stays dark") {
  const std::vector<SparsePoint> discs{SparsePoint{}, disc({0.2f, 2, 0.1f}, 0.3f),
                                       disc({-0.2f, 3, 0.2f}, 0.4f)};
  SparsePasses passes;
  const auto openAt = [&](const glm::vec3& shift, const glm::vec3& light, const char* combine) {
    std::vector<SparsePoint> moved = discs;
    for (SparsePoint& point : moved) point.position += shift;
    const SparseLight lit = diffuseLight(std::vector<glm::vec4>(3, glm::vec4(light, 7)),
                                         std::vector<glm::vec4>(3, glm::vec4(glm::vec3(0, 4, 0) + shift, 1)));
    return valuesOf(passes.occlude(pointsOf(moved), lit, {{"combine", combine}}).diffuse, 3).front();
  };
  for (const char* combine : {"product", "sum", "nearest", "mask"}) {
    CAPTURE(combine);
    const glm::vec4 here = openAt(glm::vec3(0.0f), glm::vec3(1.0f), combine),
                    there = openAt({3, -2, 5}, {0.2, 0, 0}, combine);
    CHECK(here.x < 0.9f);
    CHECK(here.x > 0.1f);
    CHECK(there.x == Approx(0.2 * here.x).epsilon(1e-3));
    CHECK(there.w == 7.0f);
    CHECK(openAt(glm::vec3(0.0f), glm::vec3(0.0f), combine) == glm::vec4(0, 0, 0, 7));
  }
}

TEST_CASE(
    "a sphere aside is hidden by the disc that stands before it, as one overhead is, and not by one overhead") {
  const auto openFrom = [&](const glm::vec3& direction, const SparsePoint& hides) {
    return left({SparsePoint{}, hides}, diffuseLight({{1, 1, 1, 1}}, {glm::vec4(4.0f * direction, 1)}),
                "product");
  };
  const SparsePoint overhead = disc({0, 2, 0}, 0.3f);
  const float straight = openFrom({0, 1, 0}, overhead);
  CHECK(straight == Approx(1.0 - 16.0 * 0.09 / 4.09).margin(1e-4));
  for (const glm::vec3& way : {glm::vec3(1, 1, 0), {0, 0.4f, 1}, {-1, 0.5f, -1}}) {
    const glm::vec3 direction = glm::normalize(way);
    CHECK(openFrom(direction, disc(2.0f * direction, 0.3f)) == Approx(straight).margin(1e-4));
    CHECK(openFrom(direction, overhead) == 1.0f);
  }
}

TEST_CASE("of two discs in line a product hides twice, the nearest and the bits once, a sum the sum") {
  const float far = 0.5f * std::sqrt(2.0f);  // hides as much from twice the square of the distance
  const float one = open({disc({0, 1.5f, 0}, 0.25f)});
  const SparsePoint second = disc({0, 2.9f, 0}, far * 0.25f * 2.9f / 1.5f * std::sqrt(2.0f) / 1.0f);
  const float other = open({second});
  REQUIRE(one > 0.2f);
  REQUIRE(one < 0.8f);
  const std::vector<SparsePoint> both{disc({0, 1.5f, 0}, 0.25f), second};
  CHECK(open(both, "product") == Approx(one * other).margin(1e-5));
  CHECK(open(both, "sum") == Approx(std::max(0.0f, one + other - 1.0f)).margin(1e-5));
  CHECK(open(both, "nearest") == Approx(one).margin(1e-5));
  CHECK(open(both, "mask") == Approx(std::min(open({both[0]}, "mask"), open({second}, "mask"))).margin(1e-5));
}

TEST_CASE(
    "a disc before a ball hides of its light what rays say, RMS within 0.1, 95 % of placements within 0.2") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<double> errors;
  for (int placement = 0; placement < 300; ++placement) {
    const double radius = 0.1 + 0.5 * unit(random), height = 0.8 + 1.8 * unit(random);
    // Towards a place in the ball's outline, or a little beside it.
    const double across = 1.3 * std::sqrt(unit(random)), turn = 2.0 * kPi * unit(random);
    const glm::dvec3 aim(across * std::cos(turn), 4.0, across * std::sin(turn)),
        centre = aim * (height / 4.0),
        normal = glm::normalize(glm::dvec3(0.8 * (unit(random) - 0.5), -1.0, 0.8 * (unit(random) - 0.5)));
    double all = 0.0, hidden = 0.0;
    // The irradiance from the ball over directions even in the cone around it.
    const double cone = std::sqrt(1.0 - 1.0 / 16.0);
    for (int i = 0; i < 64; ++i)
      for (int j = 0; j < 64; ++j) {
        const double cosine = 1.0 - (1.0 - cone) * (i + 0.5) / 64.0, sine = std::sqrt(1.0 - cosine * cosine),
                     phi = 2.0 * kPi * (j + 0.5) / 64.0;
        const glm::dvec3 way(sine * std::cos(phi), cosine, sine * std::sin(phi));
        const double along = glm::dot(centre, normal) / glm::dot(way, normal);
        all += cosine;
        if (along > 0.0 && glm::distance(along * way, centre) < radius) hidden += cosine;
      }
    const SparsePoint one{glm::vec3(centre), glm::vec3(normal), 0.01f, static_cast<float>(radius)};
    errors.push_back(std::abs(1.0 - left({SparsePoint{}, one}, ball(), "product") - hidden / all));
  }
  std::sort(errors.begin(), errors.end());
  double squared = 0.0;
  for (const double error : errors) squared += error * error / 300.0;
  CAPTURE(std::sqrt(squared), errors[285]);
  CHECK(std::sqrt(squared) <= 0.1);
  CHECK(errors[285] <= 0.2);
}

TEST_CASE(
    "a ball of which a point is inside fills its view, and a sphere as printed is too small by 1 + r^2 / d^2") {
  const std::vector<glm::vec4> found = evaluated(
      {"common/constants.glsl", "virtual_area_lights/squares.glsl"},
      "found = vec4(sphereFormFactor(0.5, given.x, given.y, false), sphereFormFactor(0.5, given.x, given.y, true), 0.0, 0.0);",
      {{1, 4, 0, 0}, {4, 1, 0, 0}});
  CHECK(found[0].x == Approx(0.125));
  CHECK(found[0].x / found[0].y == Approx(1.25));
  CHECK(found[1].x == 1.0f);
  CHECK(found[1].y == Approx(0.5 * 4.0 / 5.0));
}
