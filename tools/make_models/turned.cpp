// Bodies of revolution and tables with as many vertices as the models of Dong et al. (2007), which are not
// public. The method's elements are vertices, so their number determines its cost and where it leaks. A point
// occurs twice only at texture seams. No normals are written, and scenes smooth by 'crease 180 deg': so a
// loader makes one vertex of each pair of position and texture coordinate.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "models.h"
#include "obj_model.h"

namespace lumivox::models {
namespace {

constexpr double kPi = std::numbers::pi;

/// A profile of radius and height, from the axis at the bottom to the axis at the top.
using Profile = std::vector<glm::dvec2>;

/// A point of the Catmull-Rom spline through a profile. `at`: 0 at the first point, 1 at the last, with an
/// equal share for each span.
glm::dvec2 splinePoint(const Profile& profile, double at) {
  const int spans = static_cast<int>(profile.size()) - 1,
            span = std::min(static_cast<int>(at * spans), spans - 1);
  const double t = at * spans - span;
  const auto point = [&](int i) { return profile[static_cast<std::size_t>(std::clamp(i, 0, spans))]; };
  const glm::dvec2 a = point(span - 1), b = point(span), c = point(span + 1), d = point(span + 2);
  // The spline may overshoot: clamped to the table's plane and the axis.
  return glm::max(b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a))),
                  glm::dvec2(0.0));
}

/// `count` points at equal arc lengths along the spline, including both ends.
Profile evenly(const Profile& profile, int count) {
  constexpr int kSteps = 4096;
  Profile fine;
  std::vector<double> length{0.0};
  for (int i = 0; i <= kSteps; ++i) {
    fine.push_back(splinePoint(profile, static_cast<double>(i) / kSteps));
    if (i > 0) length.push_back(length.back() + glm::length(fine[fine.size() - 1] - fine[fine.size() - 2]));
  }
  Profile result;
  for (int i = 0; i < count; ++i) {
    const double wanted = length.back() * i / (count - 1);
    const auto next = std::lower_bound(length.begin(), length.end(), wanted) - length.begin();
    result.push_back(fine[static_cast<std::size_t>(next)]);
  }
  return result;
}

/// Texture coordinates of a body's part: corner and size of its rectangle.
struct Chart {
  glm::dvec2 low{0.0}, size{1.0};
};

/// Revolves a profile about the Y axis: `rings` between the poles, of `columns` vertices each; the first and
/// the last column coincide. A pole is one vertex or, with `split`, one for every triangle at it.
void turn(ObjModel& model, const Profile& profile, int rings, int columns, bool split, const Chart& chart) {
  const Profile points = evenly(profile, rings + 2);
  const auto at = [&](int ring, double column) {
    const glm::dvec2& point = points[static_cast<std::size_t>(ring)];
    const double angle = 2.0 * kPi * std::fmod(column, columns - 1) / (columns - 1);
    const bool pole = ring == 0 || ring == rings + 1;
    const glm::dvec2 place(pole && !split ? 0.5 : column / (columns - 1),
                           static_cast<double>(ring) / (rings + 1));
    return Vertex{.position = {pole ? 0.0 : point.x * std::cos(angle), point.y,
                               pole ? 0.0 : -point.x * std::sin(angle)},
                  .texcoord = chart.low + place * chart.size};
  };
  for (int column = 0; column + 1 < columns; ++column) {
    model.triangle(at(0, column + 0.5), at(1, column + 1), at(1, column));
    for (int ring = 1; ring < rings; ++ring)
      model.quad(at(ring, column), at(ring, column + 1), at(ring + 1, column + 1), at(ring + 1, column));
    model.triangle(at(rings, column), at(rings, column + 1), at(rings + 1, column + 0.5));
  }
}

/// A handle: a tube along a curve in the plane z = 0 that begins and ends within the body, turned about the Y
/// axis by half a turn for the other side (`side` -1).
void handle(ObjModel& model, double side, int rings, int columns, const Chart& chart) {
  constexpr double kRadius = 0.012;
  const glm::dvec2 curve[4] = {{0.13, 0.19}, {0.27, 0.22}, {0.21, 0.39}, {0.06, 0.335}};
  const auto at = [&](int ring, int column) {
    const double t = static_cast<double>(ring) / (rings - 1), s = 1.0 - t,
                 angle = 2.0 * kPi * (column % (columns - 1)) / (columns - 1);
    const glm::dvec2 middle =
        s * s * s * curve[0] + 3.0 * s * s * t * curve[1] + 3.0 * s * t * t * curve[2] + t * t * t * curve[3];
    const glm::dvec2 along = glm::normalize(
        s * s * (curve[1] - curve[0]) + 2.0 * s * t * (curve[2] - curve[1]) + t * t * (curve[3] - curve[2]));
    const glm::dvec2 across = glm::dvec2(along.y, -along.x) * (kRadius * std::cos(angle));
    return Vertex{
        .position = {side * (middle.x + across.x), middle.y + across.y, side * kRadius * std::sin(angle)},
        .texcoord = chart.low + chart.size * glm::dvec2(t, static_cast<double>(column) / (columns - 1))};
  };
  for (int ring = 0; ring + 1 < rings; ++ring)
    for (int column = 0; column + 1 < columns; ++column)
      model.quad(at(ring, column), at(ring + 1, column), at(ring + 1, column + 1), at(ring, column + 1));
}

struct Fineness {
  int rings, columns, handleRings, handleColumns;
};

// An urn, 44 cm high on y = 0, closed by a lid with a knob, with two handles.
void writeUrn(const std::filesystem::path& directory, const std::string& name, const Fineness& fineness) {
  const Profile profile = {{0, 0},        {0.08, 0},      {0.082, 0.012}, {0.045, 0.035}, {0.06, 0.075},
                           {0.125, 0.15}, {0.15, 0.23},   {0.125, 0.305}, {0.065, 0.34},  {0.085, 0.365},
                           {0.06, 0.385}, {0.018, 0.395}, {0.028, 0.425}, {0, 0.44}};
  ObjModel model(name, "An urn with lid and handles, 44 cm high, about the Y axis");
  model.material({.name = "clay", .diffuse = {0.7, 0.45, 0.3}});
  model.writesNormals = false;
  model.object("body", "clay");
  turn(model, profile, fineness.rings, fineness.columns, false, {{0, 0}, {1, 0.8}});
  model.object("handles", "clay");
  handle(model, 1.0, fineness.handleRings, fineness.handleColumns, {{0, 0.84}, {0.48, 0.16}});
  handle(model, -1.0, fineness.handleRings, fineness.handleColumns, {{0.52, 0.84}, {0.48, 0.16}});
  model.write(directory);
}

}  // namespace

void writeTurned(const std::filesystem::path& directory) {
  writeUrn(directory, "urn_fine", {57, 40, 15, 10});  // 2,582 vertices (Fig. 10a to c)
  writeUrn(directory, "urn_coarse", {31, 22, 9, 6});  // 792 (Fig. 10d)

  // A sphere of radius 1 on y = 0 (Fig. 11), its poles split: 38 * 57 + 2 * 56 = 2,278 vertices.
  ObjModel sphere("sphere", "A sphere of radius 1 about the Y axis, on y = 0, of 2278 vertices");
  sphere.material({.name = "white", .diffuse = {0.7, 0.7, 0.7}});
  sphere.writesNormals = false;
  sphere.object("sphere", "white");
  Profile arc;
  for (int i = 0; i <= 64; ++i) arc.push_back({std::sin(kPi * i / 64), 1.0 - std::cos(kPi * i / 64)});
  turn(sphere, arc, 38, 57, true, {});
  sphere.write(directory);

  // Two of these and the table have 4,782 vertices (Fig. 6b).
  ObjModel piece("chess_piece", "A chess piece, 9.5 cm high on y = 0, about the Y axis");
  piece.material({.name = "wood", .diffuse = {0.6, 0.6, 0.6}});
  piece.writesNormals = false;
  piece.object("piece", "wood");
  turn(piece,
       {{0, 0},
        {0.019, 0},
        {0.02, 0.006},
        {0.0165, 0.012},
        {0.0155, 0.017},
        {0.0095, 0.025},
        {0.0075, 0.045},
        {0.009, 0.058},
        {0.0155, 0.061},
        {0.009, 0.066},
        {0.0115, 0.073},
        {0.0135, 0.082},
        {0.008, 0.0875},
        {0.004, 0.0885},
        {0.0045, 0.0925},
        {0, 0.095}},
       71, 32, false, {});
  piece.write(directory);
}

// A square of side 1 facing up, in 17 x 12 cells: its 234 vertices and the 3,644 of the teapot make up the
// count of the teapot's picture (Fig. 1). A disc of radius 1 with 796 vertices: with the fine urn they are
// the 3,378 of Table 1.
void writeTables(const std::filesystem::path& directory) {
  ObjModel table("table", "A square of side 1 about the origin, facing up (+Y), of 234 vertices");
  table.material({.name = "white", .diffuse = {0.7, 0.7, 0.7}});
  table.writesNormals = false;
  table.object("table", "white");
  constexpr int kAlong = 17, kAcross = 12;
  const auto at = [](int i, int j) {
    const glm::dvec2 place(static_cast<double>(i) / kAlong, static_cast<double>(j) / kAcross);
    return Vertex{.position = {place.x - 0.5, 0, 0.5 - place.y}, .texcoord = place};
  };
  for (int j = 0; j < kAcross; ++j)
    for (int i = 0; i < kAlong; ++i) table.quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
  table.write(directory);

  ObjModel disc("round_table", "A disc of radius 1 about the origin, facing up (+Y), of 796 vertices");
  disc.material({.name = "white", .diffuse = {0.7, 0.7, 0.7}});
  disc.writesNormals = false;
  disc.object("table", "white");
  constexpr int kRings = 15, kAround = 53;
  const auto on = [](int ring, int around) {
    const double angle = 2.0 * kPi * (around % kAround) / kAround, r = static_cast<double>(ring) / kRings;
    const glm::dvec2 place(r * std::cos(angle), r * std::sin(angle));
    return Vertex{.position = {place.x, 0, -place.y}, .texcoord = 0.5 + 0.5 * place};
  };
  for (int around = 0; around < kAround; ++around) {
    disc.triangle(on(0, 0), on(1, around), on(1, around + 1));
    for (int ring = 1; ring < kRings; ++ring)
      disc.quad(on(ring, around), on(ring + 1, around), on(ring + 1, around + 1), on(ring, around + 1));
  }
  disc.write(directory);
}

}  // namespace lumivox::models
