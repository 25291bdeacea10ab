// A two-storey arcade around an open courtyard: the shape of the usual atrium, 12 m long.
#include <cmath>
#include <initializer_list>
#include <numbers>

#include "models.h"
#include "obj_model.h"

namespace lumivox::models {
namespace {

constexpr double kPi = std::numbers::pi;

// Plan: the columns stand on the rectangle with the half sides kHalfLength and kHalfWidth around the
// courtyard; galleries lie behind them.
constexpr int kBaysLong = 6, kBaysWide = 3;
constexpr double kHalfLength = 4.5, kHalfWidth = 2.1;  // m; bays of 1.5 m and 1.4 m
constexpr double kGallery = 1.6;                       // m, from the columns' axis to the outer wall
constexpr double kOuterWall = 0.3;                     // m, thick
constexpr double kOverhang = 0.2;                      // m, floor and roof edge over the courtyard
// Section.
constexpr double kUpperFloor = 3.1, kSlab = 0.2, kRoof = 5.9, kParapet = 6.3;  // m, top sides
constexpr double kColumnWidth = 0.36, kArcadeWall = 0.3;                       // m
constexpr double kRail = 0.9;                                                  // m above the upper floor
constexpr int kShaftSides = 12, kArchSegments = 10;

/// A storey's arcade: heights of its floor, of the springing of its arches and of the top of its wall.
struct Storey {
  double floor, springing, top;
};
constexpr Storey kStoreys[2] = {{0.0, 1.95, kUpperFloor - kSlab},
                                {kUpperFloor, kUpperFloor + 1.7, kRoof - kSlab}};

/// A side of the courtyard: columns from `start` in steps of `bay` along `along`; `outward` points to the
/// gallery behind.
struct Side {
  glm::dvec3 start, along, outward;
  int bays;
  double bay;
};

Side side(int index) {
  switch (index) {
    case 0:
      return {{-kHalfLength, 0, kHalfWidth}, {1, 0, 0}, {0, 0, 1}, kBaysLong, 2 * kHalfLength / kBaysLong};
    case 1:
      return {{kHalfLength, 0, kHalfWidth}, {0, 0, -1}, {1, 0, 0}, kBaysWide, 2 * kHalfWidth / kBaysWide};
    case 2:
      return {{kHalfLength, 0, -kHalfWidth}, {-1, 0, 0}, {0, 0, -1}, kBaysLong, 2 * kHalfLength / kBaysLong};
    default:
      return {{-kHalfLength, 0, -kHalfWidth}, {0, 0, 1}, {-1, 0, 0}, kBaysWide, 2 * kHalfWidth / kBaysWide};
  }
}

/// A surface of revolution around the vertical axis through `foot`: rings of (radius, height), smooth around,
/// flat along.
void lathe(ObjModel& model, const glm::dvec3& foot, int sides, std::initializer_list<glm::dvec2> profile) {
  for (const glm::dvec2* lower = profile.begin(); lower + 1 != profile.end(); ++lower) {
    const glm::dvec2 r0 = lower[0], r1 = lower[1];
    const glm::dvec2 slope =
        glm::normalize(glm::dvec2(r1.y - r0.y, r0.x - r1.x));  // outward, in (radius, height)
    const auto at = [&](int i, const glm::dvec2& ring) {
      const double angle = 2 * kPi * i / sides;
      const glm::dvec3 radial{std::cos(angle), 0, -std::sin(angle)};
      return Vertex{foot + radial * ring.x + glm::dvec3(0, ring.y, 0),
                    radial * slope.x + glm::dvec3(0, slope.y, 0),
                    {angle * 0.25 / model.textureSize, ring.y / model.textureSize}};
    };
    for (int i = 0; i < sides; ++i) {
      if (r1.x > 0)
        model.quad(at(i, r0), at(i + 1, r0), at(i + 1, r1), at(i, r1));
      else  // the ring is a point
        model.triangle(at(i, r0), at(i + 1, r0), at(i, r1));
    }
  }
}

/// Plinth, shaft with a slight taper, bell-shaped capital and abacus; the wall above starts at the springing
/// of the arches.
void column(ObjModel& model, const glm::dvec3& axis, const Storey& storey) {
  const double half = kColumnWidth / 2, plinth = 0.14, abacus = 0.08, bell = 0.2;
  const glm::dvec3 foot = axis + glm::dvec3(0, storey.floor, 0);
  const double height = storey.springing - storey.floor;
  model.box(foot + glm::dvec3(-half, 0, -half), foot + glm::dvec3(half, plinth, half),
            ObjModel::Facing::outward, "xXYzZ");
  lathe(model, foot, kShaftSides,
        {{0.14, plinth},
         {0.12, height - abacus - bell},
         {0.135, height - abacus - bell * 0.9},
         {half, height - abacus}});
  model.box(foot + glm::dvec3(-half, height - abacus, -half), foot + glm::dvec3(half, height, half),
            ObjModel::Facing::outward, "xXyYzZ");
}

/// The wall over one bay: a semicircular opening between two columns, closed above up to the storey's top.
void arch(ObjModel& model, const Side& s, int bay, const Storey& storey) {
  const double radius = (s.bay - kColumnWidth) / 2, half = s.bay / 2;
  const glm::dvec3 middle = s.start + s.along * (s.bay * (bay + 0.5));
  const auto at = [&](double x, double y, double depth) {
    return middle + s.along * x + glm::dvec3(0, y, 0) + s.outward * depth;
  };
  const double front = -kArcadeWall / 2, back = kArcadeWall / 2;  // the front faces the courtyard
  const auto strip = [&](double x0, double y0, double x1, double y1) {
    // outward = along x up: seen from the courtyard, `along` points to the left.
    model.flatQuad(at(x1, y1, front), at(x0, y0, front), at(x0, storey.top, front),
                   at(x1, storey.top, front));
    model.flatQuad(at(x0, y0, back), at(x1, y1, back), at(x1, storey.top, back), at(x0, storey.top, back));
  };
  strip(-half, storey.springing, -radius, storey.springing);
  for (int i = 0; i < kArchSegments; ++i) {
    const auto point = [&](int step) {
      const double angle = kPi * (1 - static_cast<double>(step) / kArchSegments);
      return glm::dvec2(std::cos(angle), std::sin(angle));
    };
    const glm::dvec2 p = point(i), q = point(i + 1);
    strip(p.x * radius, storey.springing + p.y * radius, q.x * radius, storey.springing + q.y * radius);
    const auto intrados = [&](const glm::dvec2& c, double depth) {
      return Vertex{at(c.x * radius, storey.springing + c.y * radius, depth),
                    -(s.along * c.x + glm::dvec3(0, c.y, 0)),
                    glm::dvec2(std::atan2(c.y, c.x) * radius, depth) / model.textureSize};
    };
    model.quad(intrados(q, front), intrados(q, back), intrados(p, back), intrados(p, front));
  }
  strip(radius, storey.springing, half, storey.springing);
}

/// Lattice panel and hand rail between two columns of the upper storey.
void balustrade(ObjModel& model, const Side& s, int bay, bool rail) {
  const glm::dvec3 base = s.start + s.along * (s.bay * bay) + glm::dvec3(0, kUpperFloor, 0);
  const glm::dvec3 from = base + s.along * 0.12, to = base + s.along * (s.bay - 0.12);
  if (!rail) {
    const double tiles = 3.0, rows = 2.0;
    const glm::dvec3 up{0, kRail, 0};
    const glm::dvec3 normal = -s.outward;
    model.quad({to, normal, {0, 0}}, {from, normal, {tiles, 0}}, {from + up, normal, {tiles, rows}},
               {to + up, normal, {0, rows}});
    return;
  }
  const glm::dvec3 a = from + glm::dvec3(0, kRail, 0) - s.outward * 0.04,
                   b = to + glm::dvec3(0, kRail + 0.06, 0) + s.outward * 0.04;
  model.box(glm::min(a, b), glm::max(a, b), ObjModel::Facing::outward, s.along.x != 0 ? "yYzZ" : "xXyY");
}

/// A cloth that hangs in front of an arch, with folds that deepen towards the hem.
void cloth(ObjModel& model, const Side& s, int bay) {
  constexpr int kAcross = 12, kDown = 6;
  constexpr double kTop = kUpperFloor - kSlab, kLength = 1.9, kFolds = 3.0, kDepth = 0.09, kInset = 0.3;  // m
  const double width = s.bay * 0.72;
  const glm::dvec3 middle = s.start + s.along * (s.bay * (bay + 0.5)) - s.outward * kInset;
  const auto at = [&](double u, double v) {
    const double fold = kDepth * (0.25 + 0.75 * v) * std::sin(2 * kPi * kFolds * u + 0.6 * v + bay);
    return middle + s.along * (width * (u - 0.5)) + glm::dvec3(0, kTop - kLength * v, 0) - s.outward * fold;
  };
  const auto vertex = [&](int i, int j) {
    const double u = static_cast<double>(i) / kAcross, v = static_cast<double>(j) / kDown, step = 1e-4;
    const glm::dvec3 du = at(u + step, v) - at(u - step, v), dv = at(u, v + step) - at(u, v - step);
    return Vertex{
        at(u, v), glm::cross(du, dv), {u * width / model.textureSize, -v * kLength / model.textureSize}};
  };
  for (int i = 0; i < kAcross; ++i)
    for (int j = 0; j < kDown; ++j)
      model.quad(vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1));
}

void materials(ObjModel& model) {
  const glm::dvec3 full(1);
  model.material({.name = "bricks", .diffuse = full, .diffuseMap = "textures/bricks.png"});
  model.material({.name = "stone", .diffuse = full, .diffuseMap = "textures/stone.png"});
  model.material({.name = "tiles",
                  .diffuse = glm::dvec3(0.92),
                  .specular = glm::dvec3(0.08),
                  .exponent = 60,
                  .diffuseMap = "textures/tiles.png"});
  model.material({.name = "plaster", .diffuse = {0.68, 0.64, 0.56}});
  model.material({.name = "lattice", .diffuse = {0.16, 0.13, 0.1}, .maskMap = "textures/lattice_mask.png"});
  model.material({.name = "wood", .diffuse = {0.3, 0.18, 0.1}});
  model.material({.name = "cloth_red", .diffuse = {0.75, 0.08, 0.06}, .diffuseMap = "textures/weave.png"});
  model.material({.name = "cloth_green", .diffuse = {0.1, 0.5, 0.14}, .diffuseMap = "textures/weave.png"});
  model.material({.name = "cloth_blue", .diffuse = {0.09, 0.16, 0.62}, .diffuseMap = "textures/weave.png"});
  model.material({.name = "terracotta", .diffuse = {0.58, 0.25, 0.14}});
  model.material({.name = "leaves", .diffuse = {0.16, 0.42, 0.08}, .maskMap = "textures/leaves_mask.png"});
}

void shell(ObjModel& model) {
  const glm::dvec2 inner{kHalfLength + kGallery, kHalfWidth + kGallery}, outer = inner + kOuterWall;
  const glm::dvec2 edge{kHalfLength - kOverhang, kHalfWidth - kOverhang};
  model.textureSize = 2.0;
  model.object("floor", "tiles");
  model.flatQuad({-inner.x, 0, inner.y}, {inner.x, 0, inner.y}, {inner.x, 0, -inner.y},
                 {-inner.x, 0, -inner.y});
  model.textureSize = 1.2;
  model.object("outer_walls", "bricks");
  model.ring(inner, outer, 0, kParapet);
  model.textureSize = 1.0;
  model.object("slabs", "plaster");
  model.ring(edge, inner, kUpperFloor - kSlab, kUpperFloor);
  model.ring(edge, inner, kRoof - kSlab, kRoof);
  model.object("doors", "wood");
  for (const double x : {-3.0, 0.0, 3.0})
    for (const double z : {-inner.y, inner.y})
      model.box({x - 0.5, 0, z < 0 ? z : z - 0.06}, {x + 0.5, 2.1, z < 0 ? z + 0.06 : z},
                ObjModel::Facing::outward, "xXYzZ");
}

void colonnade(ObjModel& model) {
  model.textureSize = 1.0;
  for (const Storey& storey : kStoreys) {
    model.object(storey.floor == 0 ? "lower_columns" : "upper_columns", "stone");
    for (int i = 0; i < 4; ++i)
      for (int bay = 0; bay < side(i).bays; ++bay) {
        const glm::dvec3 axis = side(i).start + side(i).along * (side(i).bay * bay);
        column(model, axis, storey);
        const double half = kColumnWidth / 2;  // a pier carries each corner, where two walls meet
        if (bay == 0)
          model.box(axis + glm::dvec3(-half, storey.springing, -half),
                    axis + glm::dvec3(half, storey.top, half), ObjModel::Facing::outward, "xXzZ");
      }
    model.object(storey.floor == 0 ? "lower_arches" : "upper_arches", "stone");
    for (int i = 0; i < 4; ++i)
      for (int bay = 0; bay < side(i).bays; ++bay) arch(model, side(i), bay, storey);
  }
}

void furnishing(ObjModel& model) {
  model.object("balustrade", "lattice");
  for (int i = 0; i < 4; ++i)
    for (int bay = 0; bay < side(i).bays; ++bay) balustrade(model, side(i), bay, false);
  model.object("rails", "wood");
  for (int i = 0; i < 4; ++i)
    for (int bay = 0; bay < side(i).bays; ++bay) balustrade(model, side(i), bay, true);

  model.textureSize = 0.25;
  const char* const dyes[3] = {"cloth_red", "cloth_green", "cloth_blue"};
  for (int i = 0; i < 3; ++i) {
    model.object(dyes[i], dyes[i]);
    cloth(model, side(0), 2 * i);
    cloth(model, side(2), 2 * ((i + 1) % 3) + 1);
  }

  model.textureSize = 1.0;
  model.object("pots", "terracotta");
  const glm::dvec3 pots[4] = {{-3.6, 0, 0.9}, {3.6, 0, 0.9}, {3.6, 0, -0.9}, {-3.6, 0, -0.9}};
  for (const glm::dvec3& foot : pots)
    lathe(model, foot, kShaftSides,
          {{0.18, 0}, {0.28, 0.35}, {0.32, 0.38}, {0.32, 0.45}, {0.27, 0.45}, {0.0, 0.4}});
  model.object("plants", "leaves");
  for (const glm::dvec3& foot : pots)
    for (int i = 0; i < 3; ++i) {
      const double angle = kPi * i / 3;
      const glm::dvec3 half = 0.45 * glm::dvec3(std::cos(angle), 0, std::sin(angle)), up{0, 0.9, 0};
      const glm::dvec3 base = foot + glm::dvec3(0, 0.4, 0), normal = glm::cross(half, up);
      model.quad({base - half, normal, {0, 0}}, {base + half, normal, {1, 0}},
                 {base + half + up, normal, {1, 1}}, {base - half + up, normal, {0, 1}});
    }
}

}  // namespace

void writeArcade(const std::filesystem::path& directory) {
  ObjModel model("arcade", "A two-storey arcade around a courtyard");
  materials(model);
  shell(model);
  colonnade(model);
  furnishing(model);
  model.write(directory);
}

}  // namespace lumivox::models
